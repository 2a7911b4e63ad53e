#pragma once
#include "view/tool.h"

namespace supple::demos::view {

/// One implicit drag spring of the world and its picture; the handle of the tools that hold a patch.
class DragSpring {
public:
    /// @param max_force_n  0: twice the weight of the body
    void begin(World& world, const PickHit& hit, double radius_m, double max_force_n, const ToolScale& scale);
    void move(World& world, const Vec3& target_m) const { world.move_drag(id_, target_m); }
    void end(World& world);
    bool holds() const { return bool(id_); }
    DragState state(const World& world) const { return world.drag_state(id_); }

    /// The held point, the spring to its target, and the force: an arrow with its newtons at the tip.
    /// @param aside  of the number, to the right, in parts of the scene's size: neighbours must not cover each other's
    void draw(const World& world, FrameView& view, double aside = 0) const;

private:
    DragId id_;
    double size_m_ = 1, weight_n_ = 1;
};

/// Mass times gravity of a body; of free space as on Earth [N].
double weight_of(const World& world, BodyId body);

}  // namespace supple::demos::view
