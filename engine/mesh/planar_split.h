#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "supple/math/types.h"

namespace supple::mesh {

/// Cuts a triangle into smaller ones so that given points are corners and given segments are edges of them.
/// @param points    in its plane, 0, 1, 2 its corners, counter-clockwise; no two at one place
/// @param on_edge   [k] points on the edge from corner k to corner k + 1, in this order
/// @param inside    the other points
/// @param segments  pairs of points; no two cross but at their ends
/// @return          triangles, counter-clockwise; all their corners are among the points
std::vector<std::array<std::int32_t, 3>> split_triangle(std::span<const Eigen::Vector2d> points, const std::array<std::vector<std::int32_t>, 3>& on_edge, std::span<const std::int32_t> inside,
                                                        std::span<const std::array<std::int32_t, 2>> segments);

}  // namespace supple::mesh
