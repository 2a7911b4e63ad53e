#include "supple/contact/triangle_tree.h"

#include <algorithm>

#include "supple/contact/closest.h"

namespace supple::contact {

namespace {
constexpr std::int32_t kLeaf = 4;
constexpr std::size_t kDeepest = 64;

double square_distance(const Bounds& box, const Vec3& p) {
    return (box.min_m - p).cwiseMax(p - box.max_m).cwiseMax(0.0).squaredNorm();
}
}  // namespace

TriangleTree::TriangleTree(std::span<const Triangle> triangles, std::span<const Vec3> positions) : triangles_(triangles) {
    std::vector<Vec3> centre(triangles.size());
    leaf_.resize(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        leaf_[t] = std::int32_t(t);
        centre[t] = (positions[std::size_t(triangles[t][0])] + positions[std::size_t(triangles[t][1])] + positions[std::size_t(triangles[t][2])]) / 3;
    }
    if (triangles.empty()) return;
    node_.reserve(triangles.size());
    build(centre, 0, std::int32_t(triangles.size()));
    refit(positions);
}

std::int32_t TriangleTree::build(std::span<const Vec3> centre, std::int32_t first, std::int32_t count) {
    const auto self = std::int32_t(node_.size());
    node_.push_back({{}, -1, first, count});
    if (count <= kLeaf) return self;
    Bounds box = Bounds::nothing();
    for (std::int32_t i = first; i < first + count; ++i) box.include(centre[std::size_t(leaf_[std::size_t(i)])]);
    Eigen::Index axis = 0;
    (box.max_m - box.min_m).maxCoeff(&axis);
    const std::int32_t half = count / 2;
    const auto begin = leaf_.begin() + first;
    std::nth_element(begin, begin + half, begin + count, [&](std::int32_t a, std::int32_t b) {
        const double xa = centre[std::size_t(a)][axis], xb = centre[std::size_t(b)][axis];
        return xa != xb ? xa < xb : a < b;
    });
    build(centre, first, half);
    const std::int32_t right = build(centre, first + half, count - half);
    node_[std::size_t(self)].right = right;
    return self;
}

void TriangleTree::refit(std::span<const Vec3> a, std::span<const Vec3> b, double margin_m) {
    for (std::size_t n = node_.size(); n-- > 0;) {
        Node& node = node_[n];
        Bounds box = Bounds::nothing();
        if (node.right >= 0) {
            const Bounds &left = node_[n + 1].box, &right = node_[std::size_t(node.right)].box;
            box = {left.min_m.cwiseMin(right.min_m), left.max_m.cwiseMax(right.max_m)};
        } else {
            for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
                for (const std::int32_t v : triangles_[std::size_t(leaf_[std::size_t(i)])]) {
                    box.include(a[std::size_t(v)]);
                    if (!b.empty()) box.include(b[std::size_t(v)]);
                }
            }
            box.grow(margin_m);
        }
        node.box = box;
    }
}

void TriangleTree::overlapping(const Bounds& box, FunctionRef<void(std::int32_t)> visit) const {
    if (node_.empty()) return;
    std::array<std::int32_t, kDeepest> stack{};
    std::size_t height = 0;
    stack[height++] = 0;
    while (height > 0) {
        const auto n = std::size_t(stack[--height]);
        const Node& node = node_[n];
        if (!node.box.overlaps(box)) continue;
        if (node.right < 0) {
            for (std::int32_t i = node.first; i < node.first + node.count; ++i) visit(leaf_[std::size_t(i)]);
        } else {
            stack[height++] = node.right;
            stack[height++] = std::int32_t(n) + 1;
        }
    }
}

TriangleTree::Nearest TriangleTree::nearest(std::span<const Vec3> positions, const Vec3& query, double within) const {
    Nearest best;
    best.square = within * within;
    if (node_.empty()) return best;
    std::array<std::int32_t, kDeepest> stack{};
    std::size_t height = 0;
    stack[height++] = 0;
    while (height > 0) {
        const auto n = std::size_t(stack[--height]);
        const Node& node = node_[n];
        if (square_distance(node.box, query) > best.square) continue;
        if (node.right >= 0) {
            const auto left = std::int32_t(n) + 1;
            const bool left_first = square_distance(node_[std::size_t(left)].box, query) <= square_distance(node_[std::size_t(node.right)].box, query);
            stack[height++] = left_first ? node.right : left;
            stack[height++] = left_first ? left : node.right;
            continue;
        }
        for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
            const std::int32_t t = leaf_[std::size_t(i)];
            const Triangle& corner = triangles_[std::size_t(t)];
            const Vec3 &a = positions[std::size_t(corner[0])], &b = positions[std::size_t(corner[1])], &c = positions[std::size_t(corner[2])];
            const Vec3 w = closest_on_triangle(a, b, c, query);
            const Vec3 point = w[0] * a + w[1] * b + w[2] * c;
            const double square = (point - query).squaredNorm();
            if (square < best.square || (square == best.square && (best.triangle < 0 || t < best.triangle))) best = {t, square, point};
        }
    }
    return best;
}

}  // namespace supple::contact
