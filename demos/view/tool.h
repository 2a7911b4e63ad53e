#pragma once
#include <memory>
#include <string>
#include <vector>

#include "supple/render/frame_view.h"
#include "supple/world/world.h"

namespace supple::demos::view {

/// Where the hand points, and how a movement on the screen lies in space.
struct Pointer {
    Ray ray;                          ///< from the eye through the cursor; its direction has length 1
    Vec3 forward = Vec3(0, 0, -1);    ///< into the picture
    Vec3 right = Vec3(1, 0, 0);       ///< of the picture
};

/// What a tool needs to know of the scene's size: everything it chooses by itself is a part of these.
struct ToolScale {
    double size_m = 1;    ///< diagonal of the bodies' box
    double weight_n = 1;  ///< of the body at hand
};

/// A thing that a hand does to bodies: press, move, release. One file each; a new one is a line in make_tools().
/// Tools that bring shapes of their own into the world act in before_step().
class Tool {
public:
    virtual ~Tool() = default;
    virtual const char* name() const = 0;
    virtual const char* hint() const = 0;  ///< a sentence: how it is used

    /// True where it took hold of something; otherwise the movement is the camera's. `scale` is of the scene as it is.
    virtual bool press(World& world, const Pointer& pointer, const ToolScale& scale) = 0;
    virtual void move(World& world, const Pointer& pointer) = 0;
    virtual void scroll(World& world, double steps) = 0;  ///< of the wheel while it holds: along the line of sight
    virtual void before_step(World& world, double step_s) { (void)world, (void)step_s; }
    /// Lets go; does nothing where it holds nothing, or where its body is gone.
    virtual void release(World& world) = 0;
    virtual void cancel(World& world) { release(world); }  ///< lets go without doing what release() would do
    virtual bool holds() const = 0;
    virtual bool begins_beside() const { return false; }  ///< its movement may begin where no body is
    virtual bool edits() const { return false; }          ///< what it does to meshes can be undone
    /// Takes back what it did last where World::undo_edit() alone would not do, bodies of its own making. False: nothing of that kind was done last to any body.
    virtual bool undo(World& world) { return (void)world, false; }

    virtual void forget() {}                              ///< another world: ids that it kept are void

    virtual double force_n(const World& world) const = 0;  ///< size of what it does to the body, in the last step
    virtual void draw(const World& world, FrameView& view) const = 0;
    virtual void panel(double ui_scale) = 0;               ///< its settings
};

std::vector<std::unique_ptr<Tool>> make_tools();

}  // namespace supple::demos::view
