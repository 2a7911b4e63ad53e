#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple::io {

/// Cuts a polygon, flat or not, convex or not, into corners.size() - 2 triangles of the same winding and appends them; fewer than three
/// corners give none. Quads take the diagonal whose triangles face the same way, the first one of two; larger ones lose an ear at a time
/// (G. H. Meisters, "Polygons have ears", 1975), seen along their mean normal. Beyond 256 corners they become a fan.
void append_polygon(std::span<const std::int32_t> corners, std::span<const Vec3> vertices, std::vector<Triangle>& triangles);

}  // namespace supple::io
