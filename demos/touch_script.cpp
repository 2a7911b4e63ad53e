#include "touch_script.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "supple/base/error.h"

namespace supple::demos {
namespace {

constexpr double kApproach_s = 1.0;
constexpr double kHalfStep = 0.5;  // of the world's time step: moments that are equal but for rounding

}  // namespace

double smooth_step(double from, double to, double time) {
    const double s = std::clamp((time - from) / (to - from), 0.0, 1.0);
    return s * s * (3 - 2 * s);
}

void show_force(FrameView& view, const Vec3& force_n) {
    char text[40];
    std::snprintf(text, sizeof text, "   force %.2f N", force_n.norm());
    view.hud += text;
}

TouchScript::TouchScript(World& world, std::vector<Touch> touches, double arrow_m, double usual_n)
    : world_(&world), touches_(std::move(touches)), arrow_m_(arrow_m), usual_n_(usual_n) {}

void TouchScript::before_step() {
    if (next_ == touches_.size()) return;
    const Touch& touch = touches_[next_];
    const double now = world_->time_s() + kHalfStep * world_->def().time_step_s;
    if (now < touch.begin_s) return;
    if (!drag_) {
        const auto hit = world_->pick(touch.ray);
        if (!hit) throw Error(ErrorCode::invalid_argument, "touch \"" + touch.caption + "\"", "its ray meets no surface; aim it at the body");
        start_m_ = hit->position_m;
        drag_ = world_->begin_drag(*hit, {.radius_m = touch.radius_m, .stiffness_n_m = touch.stiffness_n_m, .max_force_n = touch.max_force_n});
    }
    if (now >= touch.end_s) {
        world_->end_drag(drag_);
        drag_ = {};
        ++next_;
        return;
    }
    world_->move_drag(drag_, start_m_ + touch.displacement_m.at(world_->time_s() - touch.begin_s));
}

void TouchScript::let_go() {
    if (drag_) world_->end_drag(drag_);
    drag_ = {};
    next_ = touches_.size();
}

const Touch* TouchScript::coming() const {
    if (drag_ || next_ == touches_.size()) return nullptr;
    return world_->time_s() > touches_[next_].begin_s - kApproach_s ? &touches_[next_] : nullptr;
}

void TouchScript::decorate(FrameView& view) const {
    if (const Touch* touch = coming()) {
        const Vec3 along = touch->ray.direction.normalized();
        const auto hit = world_->pick(touch->ray);
        if (hit) {
            const double s = smooth_step(touch->begin_s - kApproach_s, touch->begin_s, world_->time_s());
            const double gap = ((1 - s) * 15 + 1) * touch->tool_radius_m;
            view.markers.push_back({hit->position_m - gap * along, touch->tool_radius_m});
        }
        view.caption = touch->caption;
    }
    if (!drag_) return;
    const Touch& touch = touches_[next_];
    const DragState state = world_->drag_state(drag_);
    const Vec3 along = touch.ray.direction.normalized();
    const Vec3 tool = state.anchor_m - touch.tool_radius_m * along;
    const Vec3 behind = tool - touch.tool_radius_m * along;
    const Vec3 arrow = arrow_m_ * (1 - std::exp(-state.force_n.norm() / usual_n_)) * state.force_n.normalized();
    view.markers.push_back({tool, touch.tool_radius_m});
    if (touch.pushes)
        view.arrows.push_back({behind - arrow, behind});
    else
        view.arrows.push_back({tool, tool + arrow});
    view.caption = touch.caption;
    show_force(view, state.force_n);
}

}  // namespace supple::demos
