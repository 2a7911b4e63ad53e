#pragma once
// What the implicit shapes of this directory are put together from: signed, nearly distances [m], negative inside. Only additions, products, quotients and square
// roots: the same bits from every compiler.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

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

/// A node of a tube: where its axis passes and how thick it is there [m].
struct TubeNode {
    Point at;
    double radius;
};

/// Distance to a tube along a smooth curve through the nodes (Catmull-Rom), cut into straight pieces; its radius changes as smoothly.
inline double tube(const Point& x, std::initializer_list<TubeNode> nodes) {
    constexpr int kPieces = 6;
    const TubeNode* n = nodes.begin();
    const auto last = int(nodes.size()) - 1;
    double d = 1e9;
    for (int i = 0; i < last; ++i) {
        const TubeNode &before = n[std::max(i - 1, 0)], &a = n[i], &b = n[i + 1], &after = n[std::min(i + 2, last)];
        const auto at = [&](double t) {
            const double w0 = t * (-1 + t * (2 - t)) / 2, w1 = 1 + t * t * (3 * t - 5) / 2, w2 = t * (1 + t * (4 - 3 * t)) / 2, w3 = t * t * (t - 1) / 2;
            return TubeNode{w0 * before.at + w1 * a.at + w2 * b.at + w3 * after.at, w0 * before.radius + w1 * a.radius + w2 * b.radius + w3 * after.radius};
        };
        TubeNode from = a;
        for (int k = 1; k <= kPieces; ++k) {
            const TubeNode to = at(double(k) / kPieces);
            d = std::min(d, capsule(x, from.at, to.at, from.radius, to.radius));
            from = to;
        }
    }
    return d;
}

/// Distance to an axis-parallel box with edges rounded over r, negative inside.
inline double rounded_box(const Point& x, const Point& centre, const Point& half, double r) {
    const Point q = (x - centre).cwiseAbs() - half + Point::Constant(r);
    const Point out = q.cwiseMax(0.0);
    return std::sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]) + std::min(q.maxCoeff(), 0.0) - r;
}

inline double sphere(const Point& x, const Point& centre, double radius) {
    const Point p = x - centre;
    return std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - radius;
}

/// x mirrored to the side where z >= 0, for shapes that are alike on both sides.
inline Point mirrored_z(const Point& x) { return {x[0], x[1], std::abs(x[2])}; }

}  // namespace supple_assets
