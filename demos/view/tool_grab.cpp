#include <imgui.h>

#include "view/drag_spring.h"
#include "view/gui.h"
#include "view/tools.h"

namespace supple::demos::view {
namespace {

/// The held point follows the cursor in the plane through it that faces the eye; the wheel moves that plane.
class Grab : public Tool {
public:
    const char* name() const override { return "Grab"; }
    const char* hint() const override { return "Hold the left button on a body and pull; the wheel pulls nearer or pushes away."; }

    bool press(World& world, const Pointer& pointer, const ToolScale& scale) override {
        const auto hit = world.pick(pointer.ray);
        if (!hit) return false;
        spring_.begin(world, *hit, radius_ * scale.size_m, max_force_n_, scale);
        plane_m_ = hit->position_m;
        scale_ = scale;
        pointer_ = pointer;
        return true;
    }

    void move(World& world, const Pointer& pointer) override {
        if (!holds()) return;
        pointer_ = pointer;
        const double slope = pointer.ray.direction.dot(pointer.forward);
        const double distance = (plane_m_ - pointer.ray.origin).dot(pointer.forward) / slope;
        spring_.move(world, pointer.ray.origin + distance * pointer.ray.direction);
    }

    void scroll(World& world, double steps) override {
        plane_m_ -= 0.02 * steps * scale_.size_m * pointer_.forward;
        move(world, pointer_);
    }

    void release(World& world) override { spring_.end(world); }
    bool holds() const override { return spring_.holds(); }
    double force_n(const World& world) const override { return holds() ? spring_.state(world).force_n.norm() : 0; }
    void draw(const World& world, FrameView& view) const override { spring_.draw(world, view); }

    void panel(double) override {
        percent_slider("Radius", "tool radius", radius_, 0.0, 0.3, "of the held patch, as a part of the scene's size; 0: one triangle");
        force_slider(max_force_n_);
    }

private:
    DragSpring spring_;
    Vec3 plane_m_ = Vec3::Zero();
    ToolScale scale_;
    Pointer pointer_;
    double radius_ = 0.1, max_force_n_ = 0;
};

}  // namespace

std::unique_ptr<Tool> make_grab_tool() { return std::make_unique<Grab>(); }

}  // namespace supple::demos::view
