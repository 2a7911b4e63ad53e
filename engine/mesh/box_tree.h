#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "supple/math/types.h"

namespace supple {

/// An axis-parallel box [m]; empty until something is included.
struct Box {
    Vec3 min_m = Vec3::Constant(1e300), max_m = Vec3::Constant(-1e300);

    void include(const Vec3& x) {
        min_m = min_m.cwiseMin(x);
        max_m = max_m.cwiseMax(x);
    }
    void include(const Box& other) {
        min_m = min_m.cwiseMin(other.min_m);
        max_m = max_m.cwiseMax(other.max_m);
    }
    bool empty() const { return !(min_m.x() <= max_m.x()); }
    Vec3 centre() const { return 0.5 * (min_m + max_m); }
    Vec3 size() const { return max_m - min_m; }
    bool contains(const Vec3& x) const { return (x.array() >= min_m.array()).all() && (x.array() <= max_m.array()).all(); }
    bool overlaps(const Box& other) const { return (min_m.array() <= other.max_m.array()).all() && (other.min_m.array() <= max_m.array()).all(); }
    void grow(double by) {
        min_m.array() -= by;
        max_m.array() += by;
    }
    double squared_distance(const Vec3& x) const { return (min_m - x).cwiseMax(x - max_m).cwiseMax(0.0).squaredNorm(); }
};

/// A binary tree over boxes, halved at the median of their centres along the longest axis: the same tree for the same boxes from every
/// library and thread count. Nodes lie in depth-first order: the left child of node i is i + 1.
class BoxTree {
public:
    struct Node {
        Box box;
        std::int32_t right = -1;  ///< right child; -1 for a leaf
        std::int32_t first = 0;   ///< a leaf's items are order()[first .. first + count)
        std::int32_t count = 0;   ///< 0 for an inner node
        bool leaf() const { return count > 0; }
    };
    static constexpr int kMaxDepth = 64;  ///< of a stack that walks the tree

    BoxTree() = default;
    explicit BoxTree(std::span<const Box> boxes, std::int32_t leaf_size = 4);

    std::span<const Node> nodes() const { return nodes_; }
    std::span<const std::int32_t> order() const { return order_; }  ///< items leaf by leaf

    /// Fits the nodes to boxes that have changed; the tree stays as it was halved.
    void refit(std::span<const Box> boxes);

    /// Calls visit(item) for every item whose box holds x.
    template <class Visit>
    void at_point(std::span<const Box> boxes, const Vec3& x, Visit&& visit) const {
        walk(boxes, [&](const Box& box) { return box.contains(x); }, visit);
    }

    /// Calls visit(item) for every item whose box overlaps `other`.
    template <class Visit>
    void overlapping(std::span<const Box> boxes, const Box& other, Visit&& visit) const {
        walk(boxes, [&](const Box& box) { return box.overlaps(other); }, visit);
    }

private:
    template <class Test, class Visit>
    void walk(std::span<const Box> boxes, Test&& test, Visit&& visit) const {
        if (nodes_.empty()) return;
        std::int32_t stack[kMaxDepth];
        int top = 0;
        stack[top++] = 0;
        while (top > 0) {
            const std::int32_t i = stack[--top];
            const Node& node = nodes_[std::size_t(i)];
            if (!test(node.box)) continue;
            if (node.leaf()) {
                for (std::int32_t k = node.first; k < node.first + node.count; ++k)
                    if (const std::int32_t item = order_[std::size_t(k)]; test(boxes[std::size_t(item)])) visit(item);
            } else {
                stack[top++] = node.right;
                stack[top++] = i + 1;
            }
        }
    }

    void build(std::span<const Box> boxes, std::span<const Vec3> centres, std::int32_t first, std::int32_t count, std::int32_t leaf_size);

    std::vector<Node> nodes_;
    std::vector<std::int32_t> order_;
};

}  // namespace supple
