#pragma once
#include <vector>

#include "supple/contact/shape.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::contact {

/// Triangles of a shape's surface in its own frame, outward counter-clockwise: for pictures.
struct ShapeSurface {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
};

/// @param plane_m  half the side of the square that stands for a plane, around the point of it nearest to `about`
ShapeSurface surface_of(const Shape& shape, double plane_m, const Vec3& about = Vec3::Zero());

}  // namespace supple::contact
