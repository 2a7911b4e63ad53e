#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/function_ref.h"
#include "supple/contact/shape.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::contact {

/// A tree of boxes over triangles: built once, its boxes fitted again wherever the vertices have moved. Deterministic.
class TriangleTree {
public:
    TriangleTree() = default;
    /// The triangles stay with the caller and must outlive the tree.
    TriangleTree(std::span<const Triangle> triangles, std::span<const Vec3> positions);

    /// Boxes around the triangles at `a`, and at `b` too where that is given: what moves between them is swept. Each grows by `margin_m`.
    void refit(std::span<const Vec3> a, std::span<const Vec3> b = {}, double margin_m = 0);

    /// Calls visit(triangle) for each triangle whose box overlaps `box`, in the order of the tree.
    void overlapping(const Bounds& box, FunctionRef<void(std::int32_t)> visit) const;

    struct Nearest {
        std::int32_t triangle = -1;
        double square = 0;  ///< of the distance
        Vec3 point = Vec3::Zero();
    };
    /// Nearest point of the triangles at `positions` (where the tree was fitted last); nothing beyond `within` of the query.
    Nearest nearest(std::span<const Vec3> positions, const Vec3& query, double within) const;

    const Bounds& box() const { return node_.front().box; }
    bool empty() const { return node_.empty(); }

private:
    struct Node {
        Bounds box;
        std::int32_t right = -1;             ///< its left child follows it; -1: a leaf
        std::int32_t first = 0, count = 0;   ///< of leaf_
    };
    std::int32_t build(std::span<const Vec3> centre, std::int32_t first, std::int32_t count);

    std::span<const Triangle> triangles_;
    std::vector<std::int32_t> leaf_;  ///< triangles in the order of the leaves
    std::vector<Node> node_;          ///< depth first: children come after their parent
};

}  // namespace supple::contact
