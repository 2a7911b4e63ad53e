#pragma once
#include <optional>

#include "supple/contact/shape.h"

namespace supple::contact {

/// A point of a triangle against a solid.
struct TrianglePoint {
    Vec3 barycentric = Vec3(1, 0, 0);
    Distance at;
};

/// The point of triangle (a, b, c) whose signed distance from the shape is least. Exact for spheres; for the others to about a thousandth of the
/// triangle's size: Frank and Wolfe's descent, and a search by lines where that meets a crease. The distance from a convex shape is convex; in a mesh shape
/// it may find a point that is only the deepest around. Of points that are about as deep (to a tenth of the size) the one nearer to the middle is taken, which
/// moves smoothly with the two.
TrianglePoint deepest_on_triangle(const Shape& shape, const Vec3& a, const Vec3& b, const Vec3& c);

/// First touch of something that moves linearly, in the frame of the shape, over time 0..1.
struct Touch {
    double time = 0;
    TrianglePoint point;
};

/// A point from p0 to p1; none if it begins inside or does not come nearer than `near_m`. Marches by the distance, which no step can overshoot.
std::optional<Touch> sweep_point(const Shape& shape, const Vec3& p0, const Vec3& p1, double near_m);
/// A triangle, corners from `from` to `to`.
std::optional<Touch> sweep_triangle(const Shape& shape, const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to, double near_m);

}  // namespace supple::contact
