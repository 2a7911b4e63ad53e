#pragma once
// More implicit shapes, in metres, y up: organs beside the liver, a creature, a block of gel. Only additions, products, quotients and square roots, as liver_shape.h.
#include "liver_shape.h"

namespace supple_assets {

/// The portal tree of the liver: a trunk at the hilum that forks into both lobes.
inline double liver_vessels(const Point& x) {
    const Point hilum(0.004, -0.020, -0.016), fork(-0.006, -0.002, -0.006), right(-0.046, 0.010, -0.004), left(0.040, 0.020, 0.010);
    double d = capsule(x, hilum, fork, 0.0085, 0.0085);
    d = blend(d, capsule(x, fork, right, 0.0080, 0.0065), 0.004);
    d = blend(d, capsule(x, fork, left, 0.0075, 0.0060), 0.004);
    d = blend(d, capsule(x, right, {-0.070, 0.030, 0.006}, 0.0065, 0.0050), 0.004);
    d = blend(d, capsule(x, right, {-0.064, -0.038, 0.004}, 0.0065, 0.0050), 0.004);
    return blend(d, capsule(x, left, {0.074, 0.024, 0.012}, 0.0060, 0.0045), 0.004);
}

/// 11 cm long, the hilum towards +x.
inline double kidney(const Point& x) {
    double d = ellipsoid(x, {0.000, 0.026, 0.000}, {0.029, 0.032, 0.022});
    d = blend(d, ellipsoid(x, {0.001, -0.026, 0.001}, {0.027, 0.031, 0.021}), 0.022);
    d = blend(d, ellipsoid(x, {-0.007, 0.000, 0.000}, {0.026, 0.040, 0.021}), 0.016);
    d = carve(d, ellipsoid(x, {0.037, 0.000, 0.000}, {0.022, 0.018, 0.016}), 0.012);
    return blend(d, capsule(x, {0.008, -0.004, -0.001}, {0.032, -0.018, -0.003}, 0.0080, 0.0050), 0.008);  // renal pelvis and ureter
}

/// 9 cm long: fundus below, neck and duct above.
inline double gallbladder(const Point& x) {
    double d = ellipsoid(x, {0.000, -0.020, 0.000}, {0.019, 0.030, 0.019});
    d = blend(d, capsule(x, {0.000, 0.000, 0.000}, {0.004, 0.026, 0.000}, 0.0130, 0.0070), 0.014);
    d = blend(d, capsule(x, {0.004, 0.026, 0.000}, {0.011, 0.036, 0.000}, 0.0070, 0.0048), 0.006);
    return blend(d, capsule(x, {0.011, 0.036, 0.000}, {0.016, 0.047, 0.000}, 0.0048, 0.0046), 0.004);
}

/// A round creature on four legs, with ears, a snout and a tail, 0.6 m long; it looks to +z.
inline double creature(const Point& x) {
    const Point m(std::abs(x[0]), x[1], x[2]);  // left and right alike
    double d = ellipsoid(m, {0.00, 0.20, -0.04}, {0.125, 0.115, 0.185});
    d = blend(d, ellipsoid(m, {0.00, 0.31, 0.17}, {0.105, 0.098, 0.098}), 0.070);
    d = blend(d, ellipsoid(m, {0.00, 0.275, 0.262}, {0.052, 0.042, 0.048}), 0.040);                // snout
    d = blend(d, capsule(m, {0.066, 0.380, 0.150}, {0.100, 0.475, 0.120}, 0.036, 0.020), 0.030);   // ears
    d = blend(d, capsule(m, {0.078, 0.150, 0.080}, {0.088, 0.042, 0.096}, 0.050, 0.040), 0.040);   // fore legs
    d = blend(d, capsule(m, {0.080, 0.150, -0.150}, {0.090, 0.042, -0.160}, 0.056, 0.042), 0.045); // hind legs
    d = blend(d, capsule(m, {0.00, 0.245, -0.200}, {0.00, 0.345, -0.310}, 0.038, 0.024), 0.040);   // tail
    d = carve(d, ellipsoid(m, {0.046, 0.345, 0.268}, {0.016, 0.020, 0.016}), 0.008);               // eyes
    return std::max(d, 0.004 - x[1]);                                                             // flat soles
}

/// A block of 0.20 x 0.14 x 0.14 m with rounded edges.
inline double gel_block(const Point& x) {
    const Point half(0.10, 0.07, 0.07);
    const double r = 0.012;
    const Point q(std::abs(x[0]) - half[0] + r, std::abs(x[1]) - half[1] + r, std::abs(x[2]) - half[2] + r);
    const Point out = q.cwiseMax(0.0);
    return std::sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]) + std::min(q.maxCoeff(), 0.0) - r;
}

/// What is hard in it.
inline double gel_inclusion(const Point& x) { return ellipsoid(x, {0.022, 0.010, 0.008}, {0.034, 0.024, 0.024}); }

}  // namespace supple_assets
