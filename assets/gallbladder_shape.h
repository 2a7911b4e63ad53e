#pragma once
// A gallbladder as an implicit shape, in metres: its fundus down and to the front, its neck up and behind, with the first turns of the cystic duct. 0.08 m long.
#include "shapes.h"

namespace supple_assets {

inline double gallbladder(const Point& x) {
    double d = capsule(x, {0.000, -0.026, 0.010}, {0.001, -0.006, 0.004}, 0.0180, 0.0158);
    d = blend(d, capsule(x, {0.001, -0.006, 0.004}, {0.003, 0.014, -0.002}, 0.0158, 0.0100), 0.010);
    d = blend(d, sphere(x, {0.0060, 0.0185, -0.0035}, 0.0086), 0.008);  // Hartmann's pouch
    // The neck turns back on itself, then the duct winds, as its spiral valve makes it.
    d = blend(d, tube(x, {{{0.004, 0.022, -0.005}, 0.0062}, {{-0.003, 0.030, -0.007}, 0.0048}, {{-0.004, 0.037, -0.006}, 0.0040}}, 0.004), 0.004);
    return blend(d, tube(x, {{{-0.004, 0.037, -0.006}, 0.0040}, {{0.003, 0.042, -0.003}, 0.0036}, {{0.010, 0.042, -0.001}, 0.0036},
                             {{0.016, 0.047, -0.002}, 0.0036}, {{0.023, 0.049, -0.004}, 0.0038}}, 0.003), 0.002);
}

}  // namespace supple_assets
