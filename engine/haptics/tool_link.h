#pragma once
#include "supple/haptics/loop.h"
#include "supple/haptics/model_builder.h"

namespace supple::haptics {

struct ToolLinkDef {
    Shape shape = SphereShape{0.01};
    double friction = 0.3;    ///< [0, 10]
    double mass_kg = 0;       ///< of the tool in the simulation; 0: a tenth of what the coupling weighs over a step, K h^2 / 10
    ModelBuilderDef model{};
};

/// The simulation's end of a haptic loop: a tool of the world behind the loop's coupling, and the local models that go back. All calls on the simulation's thread.
/// Around every step: before_step(), World::step(), after_step(); publish() when the loop may see the result (in real time at once).
class ToolLink {
public:
    /// The tool comes into the world with the first step after the loop's first reading. World and loop must outlive the link.
    ToolLink(World& world, HapticLoop& loop, const ToolLinkDef& def);
    ~ToolLink();  ///< removes it
    ToolLink(const ToolLink&) = delete;
    ToolLink& operator=(const ToolLink&) = delete;

    void before_step();  ///< the tool's target is where the handle was last
    const ModelReport& after_step();
    void publish();

    /// Takes hold of the surface where the tool touches it: of at most kMostHeld vertices, the nearest first, within `reach_m` of the tool's surface.
    /// Returns how many; none where there is nothing.
    std::size_t grab(double reach_m);
    void release();  ///< lets go; also before the world is reset, or a held body removed
    bool holds() const { return !held_.empty(); }

    ColliderId collider() const { return collider_; }  ///< none before the handle has said where it is
    const ToolSample& sample() const { return loop_.samples().front(); }  ///< the one that before_step() took
    const ModelReport& report() const { return builder_.report(); }

private:
    void add_tool(const Pose& pose);

    World& world_;
    HapticLoop& loop_;
    ToolLinkDef def_;
    ModelBuilder builder_;
    ColliderId collider_;
    std::vector<HeldPoint> held_;
    std::uint64_t number_ = 0;
    bool ready_ = false;
};

}  // namespace supple::haptics
