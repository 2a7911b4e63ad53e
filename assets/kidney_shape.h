#pragma once
// A left kidney as an implicit shape, in metres: y up, x towards the hilum, z to the front. 0.11 m long. Its vein and artery are cut short, its ureter after a few
// centimetres.
#include "shapes.h"

namespace supple_assets {

inline double kidney(const Point& x) {
    // An ellipsoid bent around the hilum: both poles lean towards it.
    const Point bent(x[0] - 6.0 * x[1] * x[1], x[1], x[2] + 0.06 * x[0]);
    double d = ellipsoid(bent, {0, 0, 0}, {0.0285, 0.0555, 0.0215});
    d = blend(d, ellipsoid(bent, {-0.004, 0.024, 0}, {0.026, 0.029, 0.0215}), 0.012);  // the upper pole is the broader one
    // The hilum: a slit with rounded lips, deeper from below and behind.
    d = carve(d, ellipsoid(x, {0.040, -0.001, 0.000}, {0.0245, 0.0170, 0.0120}), 0.011);
    // Renal pelvis and ureter behind, vein in front, artery between them.
    d = blend(d, tube(x, {{{0.010, -0.002, -0.003}, 0.0090}, {{0.027, -0.004, -0.004}, 0.0075}, {{0.039, -0.015, -0.004}, 0.0054},
                          {{0.043, -0.034, -0.003}, 0.0048}, {{0.042, -0.052, -0.001}, 0.0046}, {{0.037, -0.069, 0.002}, 0.0046}}), 0.004);
    d = blend(d, tube(x, {{{0.012, 0.005, 0.003}, 0.0062}, {{0.030, 0.008, 0.005}, 0.0054}, {{0.054, 0.015, 0.007}, 0.0058}}), 0.004);
    return blend(d, tube(x, {{{0.008, 0.010, -0.004}, 0.0052}, {{0.033, 0.021, -0.005}, 0.0046}, {{0.052, 0.032, -0.003}, 0.0048}}), 0.004);
}

}  // namespace supple_assets
