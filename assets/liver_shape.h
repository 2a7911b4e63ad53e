#pragma once
// The liver as an implicit shape, in metres, seen as in the body: x towards the patient's left, y up, z to the front. About 0.2 m
// wide. Only additions, products, quotients and square roots: the same bits from every compiler.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace supple_assets {

using Point = Eigen::Vector3d;

/// Nearly the distance to an axis-parallel ellipsoid, negative inside: exact on its surface to first order.
inline double ellipsoid(const Point& x, const Point& centre, const Point& radii) {
    const Point p = (x - centre).cwiseQuotient(radii);
    const double level = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    const Point g = p.cwiseQuotient(radii);
    const double slope = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    return slope > 0 ? level * (level - 1) / slope : -radii.minCoeff();
}

/// Distance to the segment a b thickened from radius ra to rb, negative inside.
inline double capsule(const Point& x, const Point& a, const Point& b, double ra, double rb) {
    const Point d = b - a, e = x - a;
    const double t = std::clamp((e[0] * d[0] + e[1] * d[1] + e[2] * d[2]) / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), 0.0, 1.0);
    const Point r = e - t * d;
    return std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]) - (ra + t * (rb - ra));
}

/// Union with a fillet of about k metres.
inline double blend(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0);
    return std::min(a, b) - h * h / (4 * k);
}

/// What of a is left outside of b, with an edge rounded over about k metres.
inline double carve(double a, double b, double k) { return -blend(-a, b, k); }

/// 1 at u = 0, falling smoothly to 0 at |u| = w.
inline double bump(double u, double w) {
    const double t = std::max(1 - (u / w) * (u / w), 0.0);
    return t * t;
}

inline double liver(const Point& x) {
    // Diaphragmatic side: one dome, high and full on the right, tapering and flattening to the left.
    double d = ellipsoid(x, {-0.044, 0.006, -0.006}, {0.060, 0.072, 0.060});
    d = blend(d, ellipsoid(x, {-0.060, -0.036, 0.002}, {0.042, 0.058, 0.048}), 0.030);
    d = blend(d, ellipsoid(x, {0.000, 0.018, 0.010}, {0.060, 0.048, 0.046}), 0.040);
    d = blend(d, ellipsoid(x, {0.048, 0.022, 0.014}, {0.052, 0.032, 0.036}), 0.034);
    d = blend(d, ellipsoid(x, {0.080, 0.027, 0.014}, {0.030, 0.016, 0.029}), 0.024);
    // The falciform ligament's line between the lobes: a shallow valley over the front and the top.
    d += 0.0026 * bump(x[0] - 0.026 - 0.10 * x[1], 0.018) * bump(x[2] - 0.06, 0.080);
    // Visceral side: hollowed from below and behind, which leaves the thin lower border in front.
    d = carve(d, ellipsoid(x, {0.034, -0.092, -0.052}, {0.112, 0.092, 0.084}), 0.017);
    d = carve(d, ellipsoid(x, {0.068, -0.026, -0.022}, {0.048, 0.042, 0.042}), 0.016);   // stomach
    d = carve(d, ellipsoid(x, {-0.062, -0.064, -0.068}, {0.036, 0.046, 0.036}), 0.014);  // right kidney
    // Gallbladder bed with its notch in the border; fissure of the round ligament; groove of the vena cava.
    d = carve(d, capsule(x, {-0.024, -0.078, 0.042}, {-0.014, -0.006, -0.014}, 0.014, 0.010), 0.014);
    d = carve(d, capsule(x, {0.034, -0.040, 0.052}, {0.026, 0.004, -0.016}, 0.011, 0.008), 0.014);
    d = carve(d, capsule(x, {-0.004, 0.080, -0.056}, {-0.004, -0.080, -0.058}, 0.014, 0.014), 0.010);
    return d;
}

}  // namespace supple_assets
