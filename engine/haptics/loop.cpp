#include "supple/haptics/loop.h"

#include <Eigen/Geometry>
#include <cmath>

#include "supple/base/error.h"

namespace supple::haptics {

namespace {

constexpr double kFilter_s = 2e-3;  // of the velocity that the coupling's damper sees: an encoder's step in one tick is noise

LoopDef filled_in(LoopDef d, const DeviceLimits& limits) {
    require_in_range(limits.force_n, 1e-6, 1e6, "DeviceLimits.force_n");
    require_in_range(limits.stiffness_n_m, 1e-6, 1e9, "DeviceLimits.stiffness_n_m");
    require_in_range(limits.damping_n_s_m, 0, 1e6, "DeviceLimits.damping_n_s_m");
    require_in_range(d.tick_s, 1e-5, 0.1, "LoopDef.tick_s", "1e-3 is usual");
    require_in_range(d.workspace_scale, 1e-6, 1e6, "LoopDef.workspace_scale");
    require_in_range(d.force_scale, 1e-6, 1e6, "LoopDef.force_scale");
    require_in_range(d.coupling.stiffness_n_m, 0, 1e9, "LoopDef.coupling.stiffness_n_m");
    require_in_range(d.coupling.damping_n_s_m, 0, 1e6, "LoopDef.coupling.damping_n_s_m");
    require_in_range(d.max_force_n, 0, limits.force_n, "LoopDef.max_force_n", "0 takes the device's own limit");
    require_in_range(d.max_slew_n_s, 0, 1e9, "LoopDef.max_slew_n_s");
    require_in_range(d.max_damping_n_s_m, 0, 1e6, "LoopDef.max_damping_n_s_m");
    require_in_range(d.fade_in_s, 0, 10, "LoopDef.fade_in_s");
    require_in_range(d.fade_out_s, 0, 0.1, "LoopDef.fade_out_s");
    require_in_range(d.patience_s, 1e-3, 0.1 - d.fade_out_s, "LoopDef.patience_s", "a stalled simulation's force is gone after 0.1 s, fade_out_s included");
    if (!d.origin_m.allFinite()) throw Error(ErrorCode::invalid_argument, "LoopDef.origin_m", "is not finite");
    if (!((d.axes * d.axes.transpose() - Mat3::Identity()).norm() < 1e-6) || d.axes.determinant() < 0)
        throw Error(ErrorCode::invalid_argument, "LoopDef.axes", "is no rotation; its columns are the device's axes in the scene, orthonormal and right-handed");
    if (d.coupling.stiffness_n_m == 0) d.coupling = size_coupling(limits, d.tick_s, d.workspace_scale, d.force_scale);
    if (d.max_force_n == 0) d.max_force_n = limits.force_n;
    if (d.max_slew_n_s == 0) d.max_slew_n_s = limits.stiffness_n_m * 1.0;
    if (d.max_damping_n_s_m == 0) d.max_damping_n_s_m = limits.damping_n_s_m;
    return d;
}

}  // namespace

HapticLoop::HapticLoop(Device& device, const LoopDef& def)
    : device_(device),
      limits_(device.limits()),
      def_(filled_in(def, limits_)),
      fade_(def_.fade_in_s, def_.fade_out_s),
      watchdog_(def_.patience_s),
      force_limits_(def_.max_force_n, def_.max_slew_n_s),
      passivity_(limits_.own_damping_n_s_m(), def_.max_damping_n_s_m) {}

/// x_ from the device, if it says something of use.
bool HapticLoop::take_reading(double dt_s, TickReport& report) noexcept {
    reading_ = device_.read(dt_s);
    report.buttons = reading_.buttons;
    if (!reading_.connected) {
        report.flags |= kUnplugged;
        return false;
    }
    const Vec3 x = def_.origin_m + def_.workspace_scale * (def_.axes * reading_.position_m);
    if (!x.allFinite() || !(x.squaredNorm() < 1e24)) {
        report.flags |= kBadReading;
        return false;
    }
    x_ = x;
    if (!placed_) p_ = x;
    placed_ = true;
    return true;
}

/// Force of the newest model on the tool at x_, scene.
Vec3 HapticLoop::model_force(TickReport& report) noexcept {
    const double k = def_.coupling.stiffness_n_m;
    if (models_.update()) {
        const LocalModel& news = models_.front();
        if (news.finite() && news.step_s > 0) {
            const Vec3 before = proxy_.solve(x_, k, age_s_) + (blend_left_s_ > 0 ? Vec3(blend_left_s_ / blend_s_ * offset_) : Vec3(Vec3::Zero()));
            const bool first = watchdog_.stalled();
            proxy_.adopt(news);
            age_s_ = 0;
            watchdog_.feed();
            const Vec3 jump = before - proxy_.solve(x_, k, 0);
            report.flags |= kHandOver;
            report.jump_n = first ? 0 : jump.norm();
            offset_ = def_.blend && !first ? jump : Vec3(Vec3::Zero());
            blend_s_ = blend_left_s_ = news.step_s;
        } else {
            report.flags |= kBadModel;
        }
    }
    Vec3 force = proxy_.solve(x_, k, age_s_);
    proxy_.settle();
    if (blend_left_s_ > 0 && blend_s_ > 0) force += blend_left_s_ / blend_s_ * offset_;
    report.touching = std::uint32_t(proxy_.touching());
    report.sweeps = std::uint32_t(proxy_.sweeps());
    report.penetration_m = proxy_.penetration_m();
    report.model_force_n = force;
    return force;
}

TickReport HapticLoop::tick(double dt_s) noexcept {
    TickReport report;
    if (!(dt_s > 0) || !(dt_s < 10)) dt_s = def_.tick_s;
    time_s_ += dt_s;
    ++ticks_;
    const Vec3 x_before = x_, p_before = p_;
    const bool placed_before = placed_;
    const bool sees = take_reading(dt_s, report);
    const double k = def_.coupling.stiffness_n_m, to_handle = def_.force_scale;
    Vec3 force = placed_ ? model_force(report) : Vec3(Vec3::Zero());
    p_ = x_ + force / k;
    age_s_ += dt_s;
    blend_left_s_ = std::max(0.0, blend_left_s_ - dt_s);
    watchdog_.advance(dt_s);
    if (watchdog_.stalled()) report.flags |= kStalled;
    report.gain = fade_.advance(sees && !watchdog_.stalled(), dt_s);

    // Both ends' motion as the damper sees it; none across a gap in what is known.
    const Vec3 slip = placed_before ? Vec3(((p_ - p_before) - (x_ - x_before)) / dt_s) : Vec3(Vec3::Zero());
    slip_velocity_ += std::min(1.0, dt_s / (kFilter_s + dt_s)) * (slip - slip_velocity_);
    const bool free = report.touching == 0 && blend_left_s_ == 0;
    if (free) slip_velocity_ = Vec3::Zero();

    PassivityControl::Tick account;
    const Mat3 back = def_.axes.transpose();
    account.x = back * (x_ / def_.workspace_scale);
    account.p = back * (p_ / def_.workspace_scale);
    account.stiffness = report.gain * k * to_handle * def_.workspace_scale;
    account.spring_force = report.gain * to_handle * (back * force);
    account.free = free;
    Vec3 out = account.spring_force + report.gain * to_handle * def_.coupling.damping_n_s_m * (back * slip_velocity_);
    if (sees) {
        const Vec3 damper = passivity_.observe(account, dt_s);
        if (def_.passivity && damper.squaredNorm() > 0) {
            out += report.gain * damper;
            report.flags |= kDamped;
        }
    }
    if ((report.flags & kUnplugged) != 0) {
        fade_.close();
        force_limits_.drop();
        report.gain = 0;
        out = Vec3::Zero();
    }
    out = force_limits_.apply(out, dt_s);
    if (report.gain == 0 && out.squaredNorm() > 0) out = Vec3::Zero(), force_limits_.drop();  // the fade has ended: nothing may linger behind the slew limit
    if (force_limits_.clamped()) report.flags |= kForceLimit;
    if (force_limits_.slewed()) report.flags |= kSlewLimit;
    if (sees) {
        passivity_.wrote(account, out);
    } else {
        passivity_.restart();  // where the hand was meanwhile, nobody knows
    }
    device_.write(out);

    report.force_n = out;
    report.handle_m = x_;
    report.proxy_m = p_;
    report.energy_j = passivity_.taken_j();
    const auto& q = reading_.rotation_wxyz;
    const Eigen::Quaterniond turned = Eigen::Quaterniond(def_.axes) * Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    samples_.back() = {ticks_, time_s_, x_, {turned.w(), turned.x(), turned.y(), turned.z()}, reading_.buttons, out, report.flags, report.gain, placed_};
    samples_.publish();
    return report;
}

}  // namespace supple::haptics
