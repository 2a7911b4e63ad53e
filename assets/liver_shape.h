#pragma once
// The liver as an implicit shape, in metres, seen as in the body: x towards the patient's left, y up, z to the front. About 0.2 m
// wide.
#include "shapes.h"

namespace supple_assets {

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

/// The portal vein: in at the hilum below and behind, a branch to each lobe.
inline double portal_vein(const Point& x) {
    double d = tube(x, {{{0.006, -0.018, -0.020}, 0.0075}, {{0.000, 0.004, -0.006}, 0.0075}, {{-0.018, 0.008, 0.000}, 0.0070}});
    d = blend(d, tube(x, {{{-0.018, 0.008, 0.000}, 0.0070}, {{-0.046, 0.004, 0.006}, 0.0060}, {{-0.070, -0.020, 0.010}, 0.0048}, {{-0.078, -0.052, 0.010}, 0.0036}}), 0.006);
    d = blend(d, tube(x, {{{-0.046, 0.004, 0.006}, 0.0055}, {{-0.064, 0.028, 0.006}, 0.0044}, {{-0.070, 0.046, 0.000}, 0.0034}}), 0.005);
    d = blend(d, tube(x, {{{-0.018, 0.008, 0.000}, 0.0060}, {{-0.030, -0.010, 0.016}, 0.0046}, {{-0.044, -0.046, 0.024}, 0.0034}}), 0.005);
    return blend(d, tube(x, {{{0.000, 0.004, -0.006}, 0.0065}, {{0.022, 0.020, 0.010}, 0.0055}, {{0.050, 0.026, 0.016}, 0.0044}, {{0.078, 0.028, 0.016}, 0.0032}}), 0.006);
}

/// The hepatic veins: three, together where they leave at the upper rear.
inline double hepatic_veins(const Point& x) {
    const TubeNode out{{-0.006, 0.052, -0.026}, 0.0075};
    double d = tube(x, {out, {{-0.030, 0.040, -0.022}, 0.0062}, {{-0.062, 0.014, -0.018}, 0.0050}, {{-0.082, -0.018, -0.012}, 0.0036}});
    d = blend(d, tube(x, {out, {{-0.012, 0.034, 0.006}, 0.0060}, {{-0.020, 0.014, 0.028}, 0.0046}, {{-0.026, -0.004, 0.036}, 0.0034}}), 0.005);
    return blend(d, tube(x, {out, {{0.020, 0.040, -0.006}, 0.0056}, {{0.050, 0.034, 0.004}, 0.0044}, {{0.072, 0.032, 0.008}, 0.0032}}), 0.005);
}

/// The vessels and their sheath, which makes them stiffer than the tissue around them.
inline double liver_vessels(const Point& x) { return std::min(portal_vein(x), hepatic_veins(x)); }

}  // namespace supple_assets
