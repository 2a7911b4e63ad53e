#pragma once
#include <array>
#include <memory>
#include <variant>

#include "supple/math/types.h"
#include "supple/mesh/box_tree.h"

namespace supple {

namespace contact {
class DistanceGrid;
}

/// Where a rigid thing is: x_world = position + R x_local.
struct Pose {
    Vec3 position_m = Vec3::Zero();
    std::array<double, 4> rotation_wxyz{1, 0, 0, 0};  ///< unit quaternion
};

/// Half space: solid where normal . x < offset (in the frame of the shape).
struct PlaneShape {
    Vec3 normal = Vec3(0, 1, 0);  ///< any length but zero
    double offset_m = 0;          ///< along the unit normal
};
struct SphereShape {
    double radius_m = 0.05;
};
/// A segment along y, from -half_length to +half_length, with a radius.
struct CapsuleShape {
    double radius_m = 0.02, half_length_m = 0.05;
};
struct BoxShape {
    Vec3 half_extents_m = Vec3(0.05, 0.05, 0.05);
};
/// Solid cylinder with its axis along y.
struct CylinderShape {
    double radius_m = 0.05, half_length_m = 0.05;
};
/// The inside of a closed surface, as a grid of signed distances: contact::DistanceGrid::build(vertices, triangles).
struct MeshShape {
    std::shared_ptr<const contact::DistanceGrid> grid{};
};

/// A rigid solid. Alternatives in the order of their names in scene files.
using Shape = std::variant<PlaneShape, SphereShape, CapsuleShape, BoxShape, CylinderShape, MeshShape>;

namespace contact {

/// Signed distance from a solid, negative inside, and its gradient: the unit vector along which it grows fastest.
struct Distance {
    double d = 0;
    Vec3 normal = Vec3(0, 1, 0);
};

using Bounds = Box;

/// Volume, centre and inertia of a solid of density one: of a plane all zero.
struct MassProperties {
    double volume_m3 = 0;
    Vec3 centre_m = Vec3::Zero();
    Mat3 inertia_m5 = Mat3::Zero();  ///< about the centre, axes of the shape
};

/// @error Error(invalid_argument) at `where` for a size out of range; makes a plane's normal a unit vector
void check_shape(Shape& shape, const std::string& where);

/// Exact for all shapes but meshes, where it is that of the grid. Convex functions of p for the convex shapes.
Distance distance(const Shape& shape, const Vec3& p);

/// In the frame of the shape; of a plane: everything.
Bounds bounds(const Shape& shape);

/// Half of the least thickness [m]: nothing that moves less in a step can pass through. Infinite for a plane.
double thinness_m(const Shape& shape);

/// Least radius of curvature of the surface [m]; 0 where it has edges. Triangles much smaller than that need no contact points but their vertices.
double feature_radius_m(const Shape& shape);

MassProperties mass_properties(const Shape& shape);

}  // namespace contact
}  // namespace supple
