#include <imgui.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>

#include "view/drag_spring.h"
#include "view/gui.h"
#include "view/tools.h"

namespace supple::demos::view {
namespace {

constexpr double kStick = 0.05;  // of the body's weight

/// A ball pushes the patch under it along the line of sight: it goes in while the button is held, and the wheel moves it. Where the spring would pull, it lets go.
class Poke : public Tool {
public:
    const char* name() const override { return "Poke"; }
    const char* hint() const override { return "Hold the left button on a body: a ball is pressed in, up to the depth set below; the wheel presses on."; }

    bool press(World& world, const Pointer& pointer, const ToolScale& scale) override {
        const auto hit = world.pick(pointer.ray);
        if (!hit) return false;
        radius_m_ = radius_ * scale.size_m;
        spring_.begin(world, *hit, radius_m_, max_force_n_, scale);
        start_m_ = hit->position_m;
        inwards_ = pointer.ray.direction;
        goal_m_ = depth_ * scale.size_m;
        depth_m_ = 0;
        scale_ = scale;
        return true;
    }

    void move(World&, const Pointer& pointer) override {
        if (!holds()) return;
        // Sideways in the plane that faces the eye: the ball drags the patch along.
        const auto in_plane = [&](const Pointer& p) {
            return Vec3(p.ray.origin + (start_m_ - p.ray.origin).dot(p.forward) / p.ray.direction.dot(p.forward) * p.ray.direction);
        };
        aside_m_ = in_plane(pointer) - start_m_;
    }

    void scroll(World&, double steps) override { goal_m_ = std::max(0.0, goal_m_ + 0.01 * steps * scale_.size_m); }

    void before_step(World& world, double step_s) override {
        if (!holds()) return;
        const double stride_m = speed_ * scale_.size_m * step_s;
        depth_m_ += std::clamp(goal_m_ - depth_m_, -stride_m, stride_m);
        // Where the ball no longer goes in and the surface would have to be drawn after it, it lets go: a ball does not stick.
        const bool goes_in = depth_m_ < goal_m_;
        if (!goes_in && spring_.state(world).force_n.dot(inwards_) < -kStick * scale_.weight_n) return spring_.end(world);
        spring_.move(world, start_m_ + aside_m_ + depth_m_ * inwards_);
    }

    void release(World& world) override {
        spring_.end(world);
        aside_m_ = Vec3::Zero();
    }
    bool holds() const override { return spring_.holds(); }
    double force_n(const World& world) const override { return holds() ? spring_.state(world).force_n.norm() : 0; }

    void draw(const World& world, FrameView& view) const override {
        if (!holds()) return;
        const DragState now = spring_.state(world);
        const double ball_m = std::max(0.4 * radius_m_, 0.008 * scale_.size_m);
        const Vec3 ball = now.anchor_m - ball_m * inwards_;
        view.markers.push_back({ball, ball_m});
        char text[32];
        std::snprintf(text, sizeof text, "%.3g N", now.force_n.norm());
        view.labels.push_back({ball + 2.2 * ball_m * view.camera.up.normalized(), text});
        const Vec3 push = std::min(1.0, now.force_n.norm() / std::max(scale_.weight_n, 1e-12)) * 0.12 * scale_.size_m * now.force_n.normalized();
        const Vec3 tail = ball - 1.3 * ball_m * inwards_;
        if (push.norm() > 0) view.arrows.push_back({tail - push, tail});
    }

    void panel(double) override {
        percent_slider("Radius", "tool radius", radius_, 0.01, 0.3, "of the pressed patch, as a part of the scene's size");
        percent_slider("Depth", "poke depth", depth_, 0.0, 0.5, "how far the ball goes in, as a part of the scene's size");
        percent_slider("Speed", "poke speed", speed_, 0.01, 2.0, "of the ball, in scene sizes a second");
        force_slider(max_force_n_);
    }

private:
    DragSpring spring_;
    Vec3 start_m_ = Vec3::Zero(), inwards_ = Vec3(0, 0, -1), aside_m_ = Vec3::Zero();
    ToolScale scale_;

    double radius_m_ = 0, depth_m_ = 0, goal_m_ = 0;
    double radius_ = 0.08, depth_ = 0.1, speed_ = 0.3, max_force_n_ = 0;
};

}  // namespace

std::unique_ptr<Tool> make_poke_tool() { return std::make_unique<Poke>(); }

}  // namespace supple::demos::view
