#include "view/drag_spring.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>

namespace supple::demos::view {
namespace {

constexpr double kWeights = 2;

}  // namespace

double weight_of(const World& world, BodyId body) {
    const auto masses = world.masses(body);
    const double g = world.def().gravity_m_s2.norm();
    return std::accumulate(masses.begin(), masses.end(), 0.0) * (g > 0 ? g : 9.81);
}

void DragSpring::begin(World& world, const PickHit& hit, double radius_m, double max_force_n, const ToolScale& scale) {
    const double cap_n = max_force_n > 0 ? max_force_n : kWeights * weight_of(world, hit.body);
    id_ = world.begin_drag(hit, {.radius_m = radius_m, .max_force_n = cap_n});
    size_m_ = scale.size_m;
    weight_n_ = std::max(scale.weight_n, 1e-12);
}

void DragSpring::end(World& world) {
    if (!id_) return;
    const DragId id = std::exchange(id_, DragId{});
    try {
        world.end_drag(id);
    } catch (const Error&) {
        // Its body was removed, or the world was reset: the drag ended with it.
    }
}

void DragSpring::draw(const World& world, FrameView& view, double aside) const {
    if (!holds()) return;
    const DragState now = state(world);
    const double ball_m = 0.008 * size_m_;
    view.markers.push_back({now.anchor_m, ball_m});
    view.markers.push_back({now.target_m, 0.8 * ball_m, {1.0f, 0.85f, 0.2f}});
    view.arrows.push_back({now.anchor_m, now.target_m, {0.75f, 0.85f, 0.95f}});
    // Small forces are seen and large ones stay in the picture; the number says the rest.
    const double length_m = 0.2 * size_m_ * (1 - std::exp(-now.force_n.norm() / weight_n_));
    const Vec3 tip_m = now.anchor_m + length_m * now.force_n.normalized();
    view.arrows.push_back({now.anchor_m, tip_m});
    char text[32];
    std::snprintf(text, sizeof text, "%.3g N", now.force_n.norm());
    const Vec3 up = view.camera.up.normalized(), right = (view.camera.target_m - view.camera.eye_m).cross(up).normalized();
    view.labels.push_back({tip_m + 3.5 * ball_m * up + aside * size_m_ * right, text});
}

}  // namespace supple::demos::view
