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
    d = blend(d, tube(x, {{{0.012, -0.002, -0.003}, 0.0085}, {{0.027, -0.005, -0.004}, 0.0070}, {{0.035, -0.014, -0.004}, 0.0050},
                          {{0.037, -0.030, -0.003}, 0.0040}, {{0.036, -0.050, -0.001}, 0.0038}, {{0.033, -0.066, 0.002}, 0.0038}}, 0.004), 0.005);
    d = blend(d, tube(x, {{{0.014, 0.006, 0.003}, 0.0060}, {{0.030, 0.008, 0.005}, 0.0054}, {{0.052, 0.013, 0.007}, 0.0056}}), 0.004);
    return blend(d, tube(x, {{{0.016, 0.010, -0.004}, 0.0040}, {{0.032, 0.018, -0.004}, 0.0038}, {{0.050, 0.027, -0.003}, 0.0040}}), 0.004);
}

}  // namespace supple_assets
