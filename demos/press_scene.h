#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "supple/haptics/tool_link.h"
#include "supple/io/mesh_file.h"
#include "supple/world/world.h"

namespace supple::demos {

/// The liver that a hand presses, and the ball on its device: of the demo and of the program that recorded the hand (assets/make_press_recording.cpp).
struct PressScene {
    static constexpr double kTool_m = 0.012;
    static constexpr double kRate_hz = 120;
    World world;
    Vec3 inwards = Vec3(0.80, -0.25, -0.55).normalized();  ///< from the front and the side, so that tool and arrow are seen
    Vec3 aside = Vec3(0.15, 1, 0).cross(inwards).normalized();
    Vec3 touch_m;                                          ///< where a ball on that line would meet the liver as it hangs

    PressScene(const std::string& liver_file, int threads) : world(definition(threads)) {
        BodyDef def;
        def.name = "liver";
        def.shape = BodyTemplate::build(io::read_mesh(liver_file));
        def.material = Corotational{.young_pa = 6e3, .poisson = 0.45};
        def.density_kg_m3 = 1060;
        const BodyId body = world.add_body(def);
        world.fix(body, InGroup{"ligament"});
        touch_m = Vec3(-0.058, -0.008, 0.052);
    }
    static WorldDef definition(int threads) {
        WorldDef def;
        def.threads = threads;
        def.time_step_s = 1 / kRate_hz;
        def.solver.rayleigh_mass_1_s = 4;  // the tissue around it calms the swinging
        def.solver.rayleigh_stiffness_s = 0.004;
        def.solver.contact_iterations = 40;  // a dozen is too few where the ball is dragged with friction
        return def;
    }
    haptics::LoopDef loop() const {
        haptics::LoopDef def;
        def.origin_m = touch_m;
        return def;
    }
    haptics::ToolLinkDef link() const { return {.shape = SphereShape{kTool_m}, .friction = 0.2, .mass_kg = 0.02}; }
};

/// One step of a simulation beside its loop in virtual time: what the last step found is published, the next sees the handle of this moment, and the ticks of its
/// duration pass meanwhile. Call before World::step(). @param each  takes every TickReport
template <class Each>
void run_beside_step(haptics::HapticLoop& loop, haptics::ToolLink& link, const World& world, Each&& each) {
    if (world.step_count() > 0) {
        link.after_step();
        link.publish();
    }
    link.before_step();
    const auto before = std::uint64_t(std::llround(world.time_s() / loop.def().tick_s));
    const auto after = std::uint64_t(std::llround((world.time_s() + world.def().time_step_s) / loop.def().tick_s));
    for (std::uint64_t i = before; i < after; ++i) each(double(i + 1) * loop.def().tick_s, loop.tick(loop.def().tick_s));
}

}  // namespace supple::demos
