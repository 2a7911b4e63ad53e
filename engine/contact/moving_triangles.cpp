#include "supple/contact/moving_triangles.h"

namespace supple::contact {

MovingTriangles::MovingTriangles(std::span<const Triangle> triangles, std::span<const Vec3> positions) : triangles_(triangles), box_(triangles.size()) {
    fit_boxes(positions, {}, 0);
    tree_ = BoxTree(box_);
}

void MovingTriangles::fit_boxes(std::span<const Vec3> a, std::span<const Vec3> b, double margin_m) {
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        Box& box = box_[t] = {};
        for (const std::int32_t v : triangles_[t]) {
            box.include(a[std::size_t(v)]);
            if (!b.empty()) box.include(b[std::size_t(v)]);
        }
        box.grow(margin_m);
    }
}

void MovingTriangles::refit(std::span<const Vec3> a, std::span<const Vec3> b, double margin_m) {
    fit_boxes(a, b, margin_m);
    tree_.refit(box_);
}

void MovingTriangles::overlapping(const Box& box, FunctionRef<void(std::int32_t)> visit) const { tree_.overlapping(box_, box, visit); }

}  // namespace supple::contact
