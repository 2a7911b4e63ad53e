#pragma once
// A gallbladder as an implicit shape, in metres: its fundus down and to the front, its neck up and behind, with the first turns of the cystic duct. 0.08 m long.
#include "shapes.h"

namespace supple_assets {

inline double gallbladder(const Point& x) {
    // The bag, then the neck, which turns back on itself, and the duct, which winds as its spiral valve makes it.
    double d = tube(x, {{{-0.001, -0.027, 0.011}, 0.0172}, {{0.000, -0.012, 0.006}, 0.0178}, {{0.002, 0.004, 0.001}, 0.0142}, {{0.004, 0.017, -0.003}, 0.0090}, {{0.002, 0.027, -0.006}, 0.0056},
                        {{-0.004, 0.034, -0.007}, 0.0046}});
    d = blend(d, sphere(x, {0.0090, 0.0170, -0.0030}, 0.0078), 0.010);  // Hartmann's pouch
    return blend(d, tube(x, {{{-0.004, 0.034, -0.007}, 0.0046}, {{-0.003, 0.041, -0.005}, 0.0038}, {{0.005, 0.044, -0.002}, 0.0036}, {{0.012, 0.042, -0.002}, 0.0036},
                             {{0.019, 0.047, -0.003}, 0.0036}, {{0.027, 0.048, -0.004}, 0.0038}}), 0.002);
}

}  // namespace supple_assets
