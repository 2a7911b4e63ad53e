#pragma once
#include <span>
#include <vector>

#include "supple/base/function_ref.h"
#include "supple/mesh/box_tree.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::contact {

/// A tree of boxes over triangles: built once, its boxes fitted again wherever the vertices have moved. Deterministic.
class MovingTriangles {
public:
    MovingTriangles() = default;
    /// The triangles stay with the caller and must outlive the tree.
    MovingTriangles(std::span<const Triangle> triangles, std::span<const Vec3> positions);

    /// Boxes around the triangles at `a`, and at `b` too where that is given: what moves between them is swept. Each grows by `margin_m`.
    void refit(std::span<const Vec3> a, std::span<const Vec3> b = {}, double margin_m = 0);

    /// Calls visit(triangle) for each triangle whose box overlaps `box`, in the order of the tree.
    void overlapping(const Box& box, FunctionRef<void(std::int32_t)> visit) const;

    /// Of a triangle, as fitted last.
    const Box& box(std::int32_t triangle) const { return box_[std::size_t(triangle)]; }

private:
    void fit_boxes(std::span<const Vec3> a, std::span<const Vec3> b, double margin_m);

    std::span<const Triangle> triangles_;
    std::vector<Box> box_;  ///< [triangle]
    BoxTree tree_;
};

}  // namespace supple::contact
