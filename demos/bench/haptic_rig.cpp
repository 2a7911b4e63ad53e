#include "bench/haptic_rig.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "supple/haptics/plain_devices.h"
#include "supple/mesh/box_mesh.h"

namespace supple::demos {

namespace {

using namespace haptics;

constexpr double kTop_m = 0.04, kBall_m = 0.012;
const Vec3 kStart(0.003, kTop_m + kBall_m + 0.002, 0.002);  // 2 mm above the block, off its vertices

World make_world(double hz, double young_pa) {
    WorldDef def;
    def.threads = 1;
    def.time_step_s = 1 / hz;
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.rayleigh_mass_1_s = 5;
    def.solver.rayleigh_stiffness_s = 0.002;
    World world(def);
    const BodyId body = world.add_body({.shape = BodyTemplate::build(make_tet_box({.min_m = Vec3(-0.05, 0, -0.05), .max_m = Vec3(0.05, kTop_m, 0.05), .cells = {8, 4, 8}})),
                                        .material = Corotational{.young_pa = young_pa, .poisson = 0.4}});
    world.fix(body, InsideBox{Vec3(-1, -1, -1), Vec3(1, 1e-9, 1)});
    return world;
}

/// The device of the run, whichever it is.
struct Handle {
    std::unique_ptr<PlayedDevice> played;
    std::unique_ptr<SimulatedDevice> simulated;
    explicit Handle(const HapticRigDef& def) {
        if (def.played) {
            played = std::make_unique<PlayedDevice>(def.limits, def.path);
            return;
        }
        SimulatedDeviceDef d;
        d.limits = def.limits;
        d.mass_kg = 0.08;
        d.damping_n_s_m = def.limits.own_damping_n_s_m();
        d.coulomb_n = 0.05;
        d.encoder_step_m = 20e-6;
        d.start_m = def.path.times_s.empty() ? kStart : def.path.positions_m[0];
        SimulatedHandDef hand;
        if (def.held) {
            hand = {.mass_kg = 0.15, .stiffness_n_m = 300, .damping_n_s_m = 5, .wanted = def.path};
        } else {
            if (def.path.times_s.empty()) d.start_m.y() = kTop_m + kBall_m + 0.0002;
        }
        simulated = std::make_unique<SimulatedDevice>(d, hand);
    }
    Device& device() { return played ? static_cast<Device&>(*played) : *simulated; }
};

void score(HapticRun& run, const HapticLoop& loop) {
    const double tick = run.time_s[1] - run.time_s[0], end = run.time_s.back();
    double low = 1e9, high = -1e9;
    for (std::size_t i = 0; i < run.time_s.size(); ++i) {
        run.finite = run.finite && run.force_n[i].allFinite() && run.handle_m[i].allFinite();
        run.peak_force_n = std::max(run.peak_force_n, run.force_n[i].norm());
        if (run.time_s[i] < end - 0.3) continue;
        low = std::min(low, run.handle_m[i].y());
        high = std::max(high, run.handle_m[i].y());
    }
    run.limit_cycle_um = (high - low) * 1e6;
    run.peak_slew_n_ms = run.slew_between(0, end + tick);
    run.stated_slew_n_ms = loop.def().max_slew_n_s * 1e-3;
    run.lowest_mj = loop.lowest_energy_j() * 1e3;
}

}  // namespace

double HapticRun::slew_between(double from_s, double to_s) const {
    double most = 0;
    for (std::size_t i = 1; i < time_s.size(); ++i)
        if (time_s[i] > from_s && time_s[i] <= to_s) most = std::max(most, (force_n[i] - force_n[i - 1]).norm() / ((time_s[i] - time_s[i - 1]) * 1e3));
    return most;
}

double HapticRun::force_at(double t) const {
    const auto at = std::lower_bound(time_s.begin(), time_s.end(), t - 1e-9);
    return at == time_s.end() ? 0 : force_n[std::size_t(at - time_s.begin())].norm();
}

Trajectory press_and_slide() {
    const double y = kTop_m + kBall_m;
    Trajectory t;
    const auto to = [&](double time, double x, double height) {
        t.times_s.push_back(time);
        t.positions_m.emplace_back(kStart.x() + x, y + height, kStart.z());
    };
    to(0, 0, 0.004);
    to(0.1, 0, 0.004);
    to(0.2667, 0, -0.006);
    to(0.5, 0, -0.006);
    to(0.8, 0.010, -0.006);
    to(0.9, 0.010, -0.006);
    to(1.0667, 0.010, 0.004);
    to(1.2, 0.010, 0.004);
    return t;
}

HapticRun run_haptic_rig(const HapticRigDef& def) {
    World world = make_world(def.simulation_hz, def.young_pa);
    Handle handle(def);
    LoopDef loop_def;
    loop_def.tick_s = 1 / def.haptic_hz;
    loop_def.coupling = {def.coupling_n_m, def.coupling_damping_n_s_m};
    loop_def.passivity = def.passivity;
    loop_def.fade_in_s = 0.05;
    HapticLoop loop(handle.device(), loop_def);
    ToolLinkDef link_def;
    link_def.shape = SphereShape{kBall_m};
    link_def.model.patch_vertices = 60;
    ToolLink link(world, loop, link_def);

    HapticRun run;
    double next_step = 0, model_us = 0;
    int models = 0;
    const auto ticks = std::size_t(std::lround(def.seconds * def.haptic_hz));
    bool grabbed = false, during = false;
    for (std::size_t i = 0; i < ticks; ++i) {
        const double t = double(i) / def.haptic_hz;
        const bool was = during;
        during = def.event != HapticEvent::none && t >= def.event_s && t < def.event_end_s;
        if (handle.simulated) {
            if (!def.held && i == std::size_t(0.1 * def.haptic_hz)) handle.simulated->set_push(Vec3(0, -def.push_n, 0));  // once the force has faded in
            if (def.event == HapticEvent::bad_reading) handle.simulated->spoil(during);
            if (def.event == HapticEvent::unplug) handle.simulated->plug(!during);
        }
        const bool stalled = def.event == HapticEvent::stall && during;
        if (t >= next_step - 1e-9 && !stalled) {
            // A step takes as long as it covers: what it finds is known when the next begins.
            link.publish();
            if (def.event == HapticEvent::grab_and_release) {
                if (during && !grabbed) grabbed = link.grab(0.002) > 0;
                if (was && !during && grabbed) link.release();
                if (!during && grabbed) link.release();
            }
            link.before_step();
            world.step();
            for (const ContactPoint& c : world.contacts()) run.penetration_mm = std::max(run.penetration_mm, c.depth_m * 1e3);
            model_us += link.after_step().total_us;
            ++models;
            next_step = std::max(next_step, t - 1 / def.simulation_hz) + 1 / def.simulation_hz;
        }
        const TickReport tick = loop.tick(1 / def.haptic_hz);
        run.jump_n = std::max(run.jump_n, tick.jump_n);
        run.time_s.push_back(double(i + 1) / def.haptic_hz);
        run.force_n.push_back(tick.force_n);
        run.handle_m.push_back(handle.simulated ? handle.simulated->position_m() : tick.handle_m);
        run.gain.push_back(tick.gain);
    }
    run.model_us = models > 0 ? model_us / models : 0;
    score(run, loop);
    return run;
}

std::vector<Vec3> reference_force(const HapticRigDef& def) {
    World world = make_world(1000, def.young_pa);
    PlayedDevice device(def.limits, def.path);
    LoopDef loop_def;
    loop_def.tick_s = 1 / def.haptic_hz;
    loop_def.coupling = {def.coupling_n_m, def.coupling_damping_n_s_m};
    HapticLoop loop(device, loop_def);  // sizes the coupling as the run's
    ToolLinkDef link_def;
    link_def.shape = SphereShape{kBall_m};
    ToolLink link(world, loop, link_def);
    std::vector<Vec3> force;
    for (int i = 0; i < int(std::lround(def.seconds * 1000)); ++i) {
        loop.tick(1e-3);
        link.before_step();
        world.step();
        force.push_back(-world.collider_state(link.collider()).coupling_force_n);
    }
    return force;
}

}  // namespace supple::demos
