#pragma once
// A block of gel with a ball inside, as implicit shapes, in metres; y up, the foot at y = 0.
#include "shapes.h"

namespace supple_assets {

inline double gel_block(const Point& x) { return rounded_box(x, {0, 0.045, 0}, {0.060, 0.045, 0.050}, 0.012); }
inline double gel_inclusion(const Point& x) { return sphere(x, {0.010, 0.048, 0.004}, 0.021); }

}  // namespace supple_assets
