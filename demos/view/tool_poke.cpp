#include <imgui.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>

#include "view/gui.h"
#include "view/tools.h"

namespace supple::demos::view {
namespace {

constexpr double kGive = 0.02;      // of the scene's size: how far the hand is ahead of the ball at its largest force
constexpr double kWeights = 2;      // largest force, in weights of the body, where none is given
constexpr double kFriction = 0.3;
constexpr double kBackOff = 0.01;   // of the scene's size: where the ball begins, before the surface

/// A ball on a spring of limited force, a collider of the world: it comes along the line of sight, meets whatever is in its way, and slides with friction.
class Poke : public Tool {
public:
    const char* name() const override { return "Poke"; }
    const char* hint() const override { return "Hold the left button on a body: a ball is pressed in, up to the depth set below; the wheel presses on. Move it along: it rubs."; }

    bool press(World& world, const Pointer& pointer, const ToolScale& scale) override {
        const auto hit = world.pick(pointer.ray);
        if (!hit) return false;
        release(world);
        scale_ = scale;
        inwards_ = pointer.ray.direction;
        ball_m_ = radius_ * scale.size_m;
        cap_n_ = max_force_n_ > 0 ? max_force_n_ : kWeights * scale.weight_n;
        start_m_ = hit->position_m - (ball_m_ + kBackOff * scale.size_m) * inwards_;
        aside_m_ = Vec3::Zero();
        goal_m_ = (depth_ + kBackOff) * scale.size_m;
        depth_m_ = 0;
        ColliderDef ball;
        ball.name = "poke";
        ball.shape = SphereShape{ball_m_};
        ball.pose.position_m = start_m_;
        ball.friction = kFriction;
        ball.motion = ColliderMotion::tool;
        ball.coupling.max_force_n = cap_n_;
        ball.coupling.stiffness_n_m = cap_n_ / (kGive * scale.size_m);
        // As heavy as its spring over a step: it follows at once and still has something to weigh against the contacts.
        const double h = world.def().time_step_s;
        ball.mass_kg = ball.coupling.stiffness_n_m * h * h;
        ball_ = world.add_collider(ball);
        return true;
    }

    void move(World&, const Pointer& pointer) override {
        // Sideways in the plane that faces the eye.
        const auto in_plane = [&](const Pointer& p) {
            return Vec3(p.ray.origin + (start_m_ - p.ray.origin).dot(p.forward) / p.ray.direction.dot(p.forward) * p.ray.direction);
        };
        aside_m_ = in_plane(pointer) - start_m_;
    }

    void scroll(World&, double steps) override { goal_m_ = std::max(0.0, goal_m_ + 0.01 * steps * scale_.size_m); }

    void before_step(World& world, double step_s) override {
        if (!alive(world)) return;
        const double stride_m = speed_ * scale_.size_m * step_s;
        depth_m_ += std::clamp(goal_m_ - depth_m_, -stride_m, stride_m);
        Vec3 target = start_m_ + aside_m_ + depth_m_ * inwards_;
        // A hand that is far ahead of a ball at its largest force would take long to come back: it waits.
        const Vec3 at = world.collider_state(ball_).pose.position_m;
        const double lead = (target - at).norm(), most = 1.5 * kGive * scale_.size_m + stride_m;
        if (lead > most) target = at + most / lead * (target - at);
        world.move_collider(ball_, {target, {1, 0, 0, 0}});
    }

    void release(World& world) override {
        if (alive(world)) world.remove_collider(ball_);
        ball_ = {};
    }
    bool holds() const override { return bool(ball_); }
    double force_n(const World& world) const override { return alive(world) ? world.collider_state(ball_).force_n.norm() : 0; }

    void draw(const World& world, FrameView& view) const override {
        if (!alive(world)) return;
        const ColliderState now = world.collider_state(ball_);  // the ball itself is drawn with the colliders
        char text[32];
        std::snprintf(text, sizeof text, "%.3g N", now.force_n.norm());
        view.labels.push_back({now.pose.position_m + (ball_m_ + 0.02 * scale_.size_m) * view.camera.up.normalized(), text});
        const double force = now.force_n.norm();
        if (!(force > 0)) return;
        const Vec3 push = std::min(1.0, force / std::max(scale_.weight_n, 1e-12)) * 0.12 * scale_.size_m * -now.force_n / force;
        const Vec3 tail = now.pose.position_m - 1.1 * ball_m_ * inwards_;
        view.arrows.push_back({tail - push, tail});
    }

    void panel(double) override {
        percent_slider("Radius", "tool radius", radius_, 0.01, 0.3, "of the ball, as a part of the scene's size");
        percent_slider("Depth", "poke depth", depth_, 0.0, 0.5, "how far the ball goes in, as a part of the scene's size");
        percent_slider("Speed", "poke speed", speed_, 0.01, 2.0, "of the ball, in scene sizes a second");
        force_slider(max_force_n_);
    }

private:
    /// A scene that was opened or reset anew may no longer have it.
    bool alive(const World& world) const {
        if (!ball_) return false;
        const std::vector<ColliderId> all = world.colliders();
        return std::find(all.begin(), all.end(), ball_) != all.end();
    }

    ColliderId ball_;
    Vec3 start_m_ = Vec3::Zero(), inwards_ = Vec3(0, 0, -1), aside_m_ = Vec3::Zero();
    ToolScale scale_;
    double ball_m_ = 0, cap_n_ = 0, depth_m_ = 0, goal_m_ = 0;
    double radius_ = 0.06, depth_ = 0.1, speed_ = 0.3, max_force_n_ = 0;
};

}  // namespace

std::unique_ptr<Tool> make_poke_tool() { return std::make_unique<Poke>(); }

}  // namespace supple::demos::view
