#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "supple/math/types.h"

namespace supple {

/// Indices of points along a Z-shaped curve, so that what is near in space is near in the order (Morton 1966); at the same place by index. The curve runs through a lattice
/// about the origin with 2^20 cells to the power of two above the longest side of the points' box: points that come or go leave the others in their order unless the box
/// comes to another power of two.
/// @param points  finite
std::vector<std::int32_t> locality_order(std::span<const Vec3> points);

}  // namespace supple
