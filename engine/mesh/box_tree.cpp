#include "supple/mesh/box_tree.h"

#include <algorithm>
#include <numeric>

namespace supple {

BoxTree::BoxTree(std::span<const Box> boxes, std::int32_t leaf_size) {
    if (boxes.empty()) return;
    order_.resize(boxes.size());
    std::iota(order_.begin(), order_.end(), 0);
    std::vector<Vec3> centres;
    centres.reserve(boxes.size());
    for (const Box& box : boxes) centres.push_back(box.centre());
    build(boxes, centres, 0, static_cast<std::int32_t>(boxes.size()), leaf_size);
}

void BoxTree::build(std::span<const Box> boxes, std::span<const Vec3> centres, std::int32_t first, std::int32_t count, std::int32_t leaf_size) {
    const auto begin = order_.begin() + first, end = begin + count;
    Box box, middle;
    for (auto it = begin; it != end; ++it) {
        box.include(boxes[std::size_t(*it)]);
        middle.include(centres[std::size_t(*it)]);
    }
    const std::size_t self = nodes_.size();
    nodes_.push_back({box, -1, first, count});
    if (count <= leaf_size) {
        std::sort(begin, end);
        return;
    }
    int axis = 0;
    middle.size().maxCoeff(&axis);
    const std::int32_t half = count / 2;
    std::nth_element(begin, begin + half, end, [&](std::int32_t a, std::int32_t b) {
        const double ca = centres[std::size_t(a)][axis], cb = centres[std::size_t(b)][axis];
        return ca != cb ? ca < cb : a < b;  // a total order: which half an item falls into does not depend on the library
    });
    nodes_[self].count = 0;
    build(boxes, centres, first, half, leaf_size);
    nodes_[self].right = static_cast<std::int32_t>(nodes_.size());
    build(boxes, centres, first + half, count - half, leaf_size);
}

void BoxTree::refit(std::span<const Box> boxes) {
    for (std::size_t i = nodes_.size(); i-- > 0;) {  // children come after their parent
        Node& node = nodes_[i];
        node.box = {};
        if (node.leaf()) {
            for (std::int32_t k = node.first; k < node.first + node.count; ++k) node.box.include(boxes[std::size_t(order_[std::size_t(k)])]);
        } else {
            node.box.include(nodes_[i + 1].box);
            node.box.include(nodes_[std::size_t(node.right)].box);
        }
    }
}

}  // namespace supple
