#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "supple/math/types.h"

namespace supple {

/// Indices of points along a Z-shaped curve through their bounding box, so that what is near in space is near in the order (Morton 1966): 2^21 places along its
/// longest side, the same place by index.
/// @param points  finite
std::vector<std::int32_t> locality_order(std::span<const Vec3> points);

}  // namespace supple
