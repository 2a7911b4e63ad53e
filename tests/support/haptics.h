#pragma once
#include <cmath>

#include "supple/haptics/loop.h"
#include "supple/haptics/simulated_device.h"

namespace supple::test {

/// A wall that fills x < 0, answered with W = compliance I; a step of the simulation lasts step_s.
inline haptics::LocalModel wall(double compliance_m_n = 0, double friction = 0, double step_s = 1.0 / 60) {
    haptics::LocalModel m;
    m.number = 1;
    m.step_s = step_s;
    m.contacts = 1;
    m.contact[0].normal = Vec3(1, 0, 0);
    m.contact[0].friction = friction;
    for (std::size_t i = 0; i < 3; ++i) m.W(i, i) = compliance_m_n;
    return m;
}

/// Feeds a loop with the same model as a simulation would, and ticks it.
struct FedLoop {
    haptics::HapticLoop loop;
    haptics::LocalModel model;
    double since_s = 1e9;
    bool silent = false;  ///< the simulation has stalled
    FedLoop(haptics::Device& device, const haptics::LoopDef& def, const haptics::LocalModel& m) : loop(device, def), model(m) {}
    haptics::TickReport tick(double dt) {
        since_s += dt;
        if (!silent && since_s >= model.step_s) {
            loop.models().back().copy_from(model);
            loop.models().publish();
            ++model.number;
            since_s = 0;
        }
        return loop.tick(dt);
    }
};

/// A loop without the comforts: what a test looks at alone.
inline haptics::LoopDef bare(double stiffness_n_m, double damping_n_s_m = 0) {
    haptics::LoopDef def;
    def.coupling = {stiffness_n_m, damping_n_s_m};
    def.fade_in_s = 0;
    def.max_slew_n_s = 1e9;
    def.passivity = false;
    return def;
}

}  // namespace supple::test
