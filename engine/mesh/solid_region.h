#pragma once
#include "supple/base/parallel.h"
#include "supple/mesh/triangle_tree.h"

namespace supple {

/// What a surface encloses: the points around which it goes more than half a time (generalised winding number > 1/2). Holes are closed by the smoothest
/// membrane, overlapping parts are united, open sheets enclose nothing; a surface wound inside out is turned. Immutable: any number of threads may ask.
class SolidRegion {
public:
    /// @error Error(invalid_argument) for no triangle, an index out of range or a coordinate that is not finite
    explicit SolidRegion(const mesh::TriangleMesh& surface);

    bool inside(const Vec3& x) const { return sign_ * tree_.winding_number(x, kAccuracy) > 0.5; }

    /// Distance to the surface [m], no more than `limit`, negative inside, never zero. Jumps at a hole, where only its sign is meant.
    double signed_distance(const Vec3& x, double limit) const;

    /// True if no surface comes nearer than `radius` to x and no hole is about there: inside() is then the same in all of that ball.
    bool uniform(const Vec3& x, double radius, bool& is_inside) const;

    /// Volume of the part of an axis-parallel box that is inside, relative to the box: where the surface passes, it is halved in all directions `depth` times and the
    /// distance decides about parts of the last cells.
    double fraction(const Box& box, int depth) const;

    /// The same for a tetrahedron.
    double fraction(const std::array<Vec3, 4>& tet, int depth) const;

    /// Volume [m^3], to about 0.2 % for shapes that are not thinner than 1/100 of their box.
    double volume(Team& team) const;

    const TriangleTree& tree() const { return tree_; }
    const Box& box() const { return tree_.box(); }
    bool was_inside_out() const { return sign_ < 0; }

    static constexpr double kAccuracy = 1.5;  ///< of winding numbers: errors below 0.05, a third of the time; only on which side of one half they are matters

private:
    double leaf_fraction(const Vec3& centre, double radius, double side) const;

    TriangleTree tree_;
    double sign_ = 1;
};

/// Signs of a region far from its surface, block by block, so that only points near the surface are asked one by one.
class FarSigns {
public:
    /// @param margin_m  how much farther than its block the surface must be from a block's points, >= 0
    /// @param block_m   side of the blocks, > 0; made longer where the box would hold more than 2^21
    FarSigns(const SolidRegion& region, double margin_m, double block_m, Team& team);

    /// -1 or 1 where the ball of radius margin_m around x is all inside or all outside; 0 where that is not known.
    int side(const Vec3& x) const;

    /// As SolidRegion::signed_distance(); in a block far from the surface `limit` with its sign.
    double signed_distance(const Vec3& x, double limit) const;

private:
    const SolidRegion& region_;
    double block_m_;
    Vec3 origin_;
    std::array<std::int64_t, 3> blocks_{};
    std::vector<signed char> sign_;  ///< -1 inside, 1 outside, 0 near the surface
};

}  // namespace supple
