#pragma once
#include <string>
#include <vector>

#include "supple/haptics/simulated_device.h"
#include "supple/haptics/tool_link.h"

namespace supple::demos {

/// What is done to the loop while it runs, for the events of the scorecard.
enum class HapticEvent { none, grab_and_release, stall, bad_reading, unplug };

/// A ball of 12 mm on a simulated or played device over a block of 100 x 40 x 100 mm that stands on its face, in virtual time.
struct HapticRigDef {
    haptics::DeviceLimits limits = haptics::device_preset("touch");
    double simulation_hz = 60, haptic_hz = 1000;
    double young_pa = 1e4;            ///< about 300 N/m under the ball
    double coupling_n_m = 0;          ///< at the handle; 0: sized by the device
    double coupling_damping_n_s_m = 0;///< with it
    bool passivity = true;
    bool held = true;                 ///< a hand of 0.15 kg, 300 N/m, 5 Ns/m moves the device; else nobody holds it and a steady force presses
    double push_n = 1.5;              ///< of nobody
    bool played = false;              ///< the handle goes along `path` whatever the force
    haptics::Trajectory path{};       ///< of the hand, or played
    double seconds = 1;
    HapticEvent event = HapticEvent::none;
    double event_s = 0.5, event_end_s = 0.7;
};

struct HapticRun {
    std::vector<double> time_s;          ///< of every tick
    std::vector<Vec3> force_n, handle_m; ///< at the handle, as the device got it; where it really was
    std::vector<double> gain;
    double lowest_mj = 0;                ///< least energy that the hand had given, net [mJ]
    double peak_force_n = 0, peak_slew_n_ms = 0, stated_slew_n_ms = 0;
    double penetration_mm = 0;           ///< of the tool in the simulation, most
    double jump_n = 0;                   ///< most that a new model changed the force by, before it is blended
    double limit_cycle_um = 0;           ///< peak to peak of the handle along y over the last 0.3 s
    double model_us = 0;                 ///< mean time to make a model
    bool finite = true;

    /// Most that the force changed in a tick between two moments [N/ms].
    double slew_between(double from_s, double to_s) const;
    double force_at(double time_s) const;  ///< its size
};

/// A path down onto the block and back: touch at 60 mm/s, 6 mm deep, along by 10 mm, up again.
haptics::Trajectory press_and_slide();
HapticRun run_haptic_rig(const HapticRigDef& def);
/// The force of a simulation at 1 kHz whose tool follows the same handle, tick by tick at 1 kHz; nothing between it and the handle but the coupling.
std::vector<Vec3> reference_force(const HapticRigDef& def);

}  // namespace supple::demos
