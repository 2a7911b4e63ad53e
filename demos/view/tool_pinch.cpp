#include <imgui.h>

#include <algorithm>
#include <array>
#include <optional>

#include "view/drag_spring.h"
#include "view/gui.h"
#include "view/tools.h"

namespace supple::demos::view {
namespace {

constexpr double kClose_s = 0.4;

/// Two patches, left and right of the cursor, are drawn towards each other; then the pair follows the cursor.
class Pinch : public Tool {
public:
    const char* name() const override { return "Pinch"; }
    const char* hint() const override { return "Hold the left button: two jaws close on the surface, then follow; the wheel lifts."; }

    bool press(World& world, const Pointer& pointer, const ToolScale& scale) override {
        const auto middle = world.pick(pointer.ray);
        if (!middle) return false;
        // Where a jaw would miss the body, both come nearer together.
        std::array<std::optional<PickHit>, 2> hits;
        double half_m = 0.5 * gap_ * scale.size_m;
        for (int trial = 0; trial < 5 && !(hits[0] && hits[1]); ++trial, half_m *= 0.5) {
            for (std::size_t jaw = 0; jaw < 2; ++jaw) {
                const Vec3 at = middle->position_m + (jaw == 0 ? -half_m : half_m) * pointer.right;
                hits[jaw] = world.pick({pointer.ray.origin, (at - pointer.ray.origin).normalized()});
                if (hits[jaw] && hits[jaw]->body != middle->body) hits[jaw].reset();
            }
        }
        if (!(hits[0] && hits[1])) return false;
        for (std::size_t jaw = 0; jaw < 2; ++jaw) {
            springs_[jaw].begin(world, *hits[jaw], radius_ * scale.size_m, max_force_n_, scale);
            open_m_[jaw] = hits[jaw]->position_m - middle->position_m;
        }
        plane_m_ = middle_m_ = middle->position_m;
        scale_ = scale;
        pointer_ = pointer;
        closed_ = 0;
        return true;
    }

    void move(World&, const Pointer& pointer) override {
        if (!holds()) return;
        pointer_ = pointer;
        const double slope = pointer.ray.direction.dot(pointer.forward);
        middle_m_ = pointer.ray.origin + (plane_m_ - pointer.ray.origin).dot(pointer.forward) / slope * pointer.ray.direction;
    }

    void scroll(World& world, double steps) override {
        plane_m_ -= 0.02 * steps * scale_.size_m * pointer_.forward;
        move(world, pointer_);
    }

    void before_step(World& world, double step_s) override {
        if (!holds()) return;
        closed_ = std::min(1.0, closed_ + step_s / kClose_s);
        for (std::size_t jaw = 0; jaw < 2; ++jaw) springs_[jaw].move(world, middle_m_ + (1 - closure_ * closed_) * open_m_[jaw]);
    }

    void release(World& world) override {
        for (DragSpring& spring : springs_) spring.end(world);
    }
    bool holds() const override { return springs_[0].holds(); }

    /// Of the jaws together: what lifts the body, not what they do to each other.
    double force_n(const World& world) const override {
        return holds() ? (springs_[0].state(world).force_n + springs_[1].state(world).force_n).norm() : 0;
    }
    void draw(const World& world, FrameView& view) const override {
        for (std::size_t jaw = 0; jaw < 2; ++jaw) springs_[jaw].draw(world, view, jaw == 0 ? -0.07 : 0.07);
    }

    void panel(double) override {
        percent_slider("Gap", "jaw gap", gap_, 0.02, 0.5, "between the jaws before they close, as a part of the scene's size");
        percent_slider("Closure", "jaw closure", closure_, 0.0, 1.0, "how far the jaws close: 100 %: they meet");
        percent_slider("Radius", "tool radius", radius_, 0.0, 0.2, "of the patch that each jaw holds, as a part of the scene's size");
        force_slider(max_force_n_);
    }

private:
    std::array<DragSpring, 2> springs_;
    std::array<Vec3, 2> open_m_{Vec3::Zero(), Vec3::Zero()};
    Vec3 plane_m_ = Vec3::Zero(), middle_m_ = Vec3::Zero();
    ToolScale scale_;
    Pointer pointer_;
    double closed_ = 0, gap_ = 0.16, closure_ = 0.7, radius_ = 0.03, max_force_n_ = 0;
};

}  // namespace

std::unique_ptr<Tool> make_pinch_tool() { return std::make_unique<Pinch>(); }

}  // namespace supple::demos::view
