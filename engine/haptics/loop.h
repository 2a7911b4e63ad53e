#pragma once
#include <cstdint>

#include "supple/base/triple_buffer.h"
#include "supple/haptics/coupling.h"
#include "supple/haptics/device.h"
#include "supple/haptics/fade.h"
#include "supple/haptics/force_limits.h"
#include "supple/haptics/local_model.h"
#include "supple/haptics/passivity.h"
#include "supple/haptics/proxy.h"

namespace supple::haptics {

/// Settings of a loop. Zero means: from the device's limits.
struct LoopDef {
    double tick_s = 1e-3;             ///< nominal, [1e-5, 0.1]
    Vec3 origin_m = Vec3::Zero();     ///< where the handle's zero is in the scene
    Mat3 axes = Mat3::Identity();     ///< the device's axes in the scene, a rotation
    double workspace_scale = 1;       ///< metres in the scene for a metre of the handle, > 0
    double force_scale = 1;           ///< newtons at the handle for a newton in the scene, > 0
    VirtualCoupling coupling{};       ///< scene; zero stiffness: size_coupling()
    double max_force_n = 0;           ///< at the handle; the device's limit bounds it
    double max_slew_n_s = 0;          ///< at the handle; 0: what its largest stiffness gives at 1 m/s
    double max_damping_n_s_m = 0;     ///< of the passivity controller, at the handle
    double fade_in_s = 0.5;           ///< after a start, a stall, a break, [0, 10]
    double fade_out_s = 0.04;         ///< [0, 0.1]
    double patience_s = 0.05;         ///< a simulation that is silent for longer has stalled; with fade_out_s at most 0.1
    bool passivity = true;            ///< the controller; the observer always looks
    bool blend = true;                ///< a new model's force takes over within a step of the simulation, not at once
};

/// What happened in a tick. Bits of TickReport::flags.
enum TickFlag : std::uint32_t {
    kBadReading = 1,     ///< the device said something that is no position: its last place is used, the force fades out
    kUnplugged = 2,      ///< the device is gone: no force, and it fades in when it is back
    kStalled = 4,        ///< nothing from the simulation for patience_s, or nothing yet: the force fades out
    kBadModel = 8,       ///< the simulation sent something that is not finite: not taken
    kForceLimit = 16,    ///< the force was cut to its limit
    kSlewLimit = 32,     ///< its change was cut to its limit
    kDamped = 64,        ///< the passivity controller took energy back
    kHandOver = 128,     ///< a new model was taken over
};

struct TickReport {
    std::uint32_t flags = 0;
    Vec3 force_n = Vec3::Zero();        ///< at the handle, as written
    Vec3 model_force_n = Vec3::Zero();  ///< of the model through the coupling, before damping, fading and limits; scene
    Vec3 handle_m = Vec3::Zero(), proxy_m = Vec3::Zero();  ///< scene
    double gain = 0;                    ///< of the fade
    double jump_n = 0;                  ///< by how much the new model's force differs from the old one's, scene
    double penetration_m = 0;           ///< of the proxy
    double energy_j = 0;                ///< taken from the hand since the start, at the handle
    std::uint32_t touching = 0, sweeps = 0;
    std::uint32_t buttons = 0;
};

/// What the simulation gets of a loop.
struct ToolSample {
    std::uint64_t tick = 0;  ///< 0: none yet
    double time_s = 0;       ///< of the loop
    Vec3 handle_m = Vec3::Zero();  ///< scene
    std::array<double, 4> rotation_wxyz{1, 0, 0, 0};
    std::uint32_t buttons = 0;
    Vec3 force_n = Vec3::Zero();   ///< at the handle
    std::uint32_t flags = 0;
    double gain = 0;
    bool placed = false;           ///< the handle has said where it is
};

/// The fast loop: device in, force out, once a tick, with the newest local model of the simulation. tick() depends on nothing but what came before: virtual time
/// and a thread of its own run the same code. It neither locks nor allocates nor throws.
class HapticLoop {
public:
    /// @error Error(invalid_argument) naming the field. `device` must outlive the loop
    HapticLoop(Device& device, const LoopDef& def);

    TickReport tick(double dt_s) noexcept;

    TripleBuffer<LocalModel>& models() { return models_; }    ///< the simulation publishes
    TripleBuffer<ToolSample>& samples() { return samples_; }  ///< the simulation reads
    const LoopDef& def() const { return def_; }               ///< with the defaults filled in
    const DeviceLimits& limits() const { return limits_; }
    double lowest_energy_j() const { return passivity_.lowest_j(); }

private:
    bool take_reading(double dt_s, TickReport& report) noexcept;
    Vec3 model_force(TickReport& report) noexcept;

    Device& device_;
    DeviceLimits limits_;
    LoopDef def_;
    TripleBuffer<LocalModel> models_;
    TripleBuffer<ToolSample> samples_;
    Proxy proxy_;
    Fade fade_;
    Watchdog watchdog_;
    ForceLimits force_limits_;
    PassivityControl passivity_;
    DeviceReading reading_;
    Vec3 x_ = Vec3::Zero(), p_ = Vec3::Zero(), slip_velocity_ = Vec3::Zero(), offset_ = Vec3::Zero();
    double age_s_ = 0, blend_left_s_ = 0, blend_s_ = 0, time_s_ = 0;
    std::uint64_t ticks_ = 0;
    bool placed_ = false;
};

}  // namespace supple::haptics
