#pragma once
#include <algorithm>
#include <cmath>

#include "supple/math/types.h"

namespace supple::haptics {

/// Keeps account of the energy at the handle and damps away what the rendering made of nothing.
///
/// Two accounts, both in joules. The port: E -= F.dx, what the rendered world has taken from the hand; it must not fall below zero. What was stored has come
/// back when the tool is free, so the account then starts anew: a credit of the last touch cannot pay for the next, a debt of it fades in some hundredths of a second.
/// The spring: a coupling F = k (p - x) that is sampled and held gives k |d(p - x)|^2 / 2 too much every tick. The account takes what goes in at its ends less what it
/// stores, and adds what the device's own damping takes away; it is never in credit. A device that damps more than k T/2 is left alone.
/// A deficit of either is taken back by a damper for one tick: alpha = deficit / (dt |v|^2), at most max_damping.
/// @source Hannaford and Ryu 2002, Time-domain passivity control of haptic interfaces (the port's account and the damper); the spring's: derived above
class PassivityControl {
public:
    struct Tick {
        Vec3 x, p;               ///< handle and proxy
        Vec3 spring_force;       ///< on the handle, with the gain
        double stiffness = 0;    ///< of the coupling as the handle feels it, with the gain
        bool free = false;       ///< touches nothing
    };

    PassivityControl(double own_damping_n_s_m, double max_damping_n_s_m) : own_damping_(own_damping_n_s_m), max_damping_(max_damping_n_s_m) {}

    /// The damper's force, to be added to that of the tick. Does not change the accounts: wrote() does.
    Vec3 observe(const Tick& now, double dt_s) noexcept {
        damping_ = 0;
        if (!begun_) return Vec3::Zero();
        const Vec3 dx = now.x - last_.x, dp = now.p - last_.p;
        const double own = own_damping_ * dx.squaredNorm() / dt_s;
        port_j_ += own - written_.dot(dx);
        taken_j_ -= written_.dot(dx);
        lowest_j_ = std::min(lowest_j_, taken_j_);
        const double stored = now.stiffness / 2 * ((now.p - now.x).squaredNorm() - (last_.p - last_.x).squaredNorm());
        spring_j_ += last_.spring_force.dot(dp) - written_.dot(dx) - stored + own;
        spring_j_ = std::min(spring_j_, 0.0);
        if (now.free) {  // no credit, and a debt is forgotten soon: what is done in a touch is damped in it and right after, not in free air
            port_j_ = std::min(port_j_, 0.0) * std::exp(-dt_s / kForget_s);
            spring_j_ *= std::exp(-dt_s / kForget_s);
        }
        const double deficit = std::max({-port_j_, -spring_j_, 0.0}), speed2 = dx.squaredNorm() / (dt_s * dt_s);
        if (!(deficit > 0) || !(speed2 > 0)) return Vec3::Zero();
        damping_ = std::min(deficit / (dt_s * speed2), max_damping_);
        return -damping_ * dx / dt_s;
    }
    /// The force that went to the device in the end, whatever became of it on the way.
    void wrote(const Tick& now, const Vec3& force) noexcept {
        last_ = now;
        written_ = force;
        begun_ = true;
    }
    /// After a break in which nothing is known.
    void restart() noexcept {
        begun_ = false;
        port_j_ = spring_j_ = 0;
    }

    double port_j() const noexcept { return port_j_; }
    double spring_j() const noexcept { return spring_j_; }
    double damping_n_s_m() const noexcept { return damping_; }
    double taken_j() const noexcept { return taken_j_; }    ///< from the hand since the start, as the encoder sees it
    double lowest_j() const noexcept { return lowest_j_; }  ///< least of that: negative where the rendering gave more than it had taken

private:
    static constexpr double kForget_s = 0.02;
    double own_damping_, max_damping_;
    Tick last_{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    Vec3 written_ = Vec3::Zero();
    double port_j_ = 0, spring_j_ = 0, taken_j_ = 0, lowest_j_ = 0, damping_ = 0;
    bool begun_ = false;
};

}  // namespace supple::haptics
