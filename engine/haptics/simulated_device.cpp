#include "supple/haptics/simulated_device.h"

#include <cmath>
#include <limits>

#include "supple/base/error.h"

namespace supple::haptics {

SimulatedDevice::SimulatedDevice(const SimulatedDeviceDef& def, const SimulatedHandDef& hand) : def_(def), hand_(hand), x_(def.start_m) {
    require_in_range(def.mass_kg, 1e-6, 1e3, "SimulatedDeviceDef.mass_kg");
    require_in_range(def.damping_n_s_m, 0, 1e6, "SimulatedDeviceDef.damping_n_s_m");
    require_in_range(def.coulomb_n, 0, 1e6, "SimulatedDeviceDef.coulomb_n");
    require_in_range(def.encoder_step_m, 0, 1, "SimulatedDeviceDef.encoder_step_m");
    require_in_range(def.delay_ticks, 0, 64, "SimulatedDeviceDef.delay_ticks");
    require_in_range(def.substeps, 1, 1000, "SimulatedDeviceDef.substeps");
    require_in_range(hand.mass_kg, 0, 1e3, "SimulatedHandDef.mass_kg");
    require_in_range(hand.stiffness_n_m, 0, 1e6, "SimulatedHandDef.stiffness_n_m");
    require_in_range(hand.damping_n_s_m, 0, 1e6, "SimulatedHandDef.damping_n_s_m");
    if (!hand.wanted.times_s.empty()) hand.wanted.check("SimulatedHandDef.wanted");
    line_.assign(std::size_t(def.delay_ticks), Vec3::Zero());
}

DeviceReading SimulatedDevice::read(double dt_s) noexcept {
    const double m = def_.mass_kg + hand_.mass_kg, h = dt_s / def_.substeps;
    const double k = hand_.stiffness_n_m, b = def_.damping_n_s_m + hand_.damping_n_s_m;
    const Vec3 motors = connected_ ? applied_ : Vec3(Vec3::Zero());
    const auto wanted_at = [&](double t) { return hand_.wanted.times_s.empty() ? def_.start_m : hand_.wanted.at(t).position_m; };
    Vec3 wanted_before = wanted_at(time_s_);
    for (int i = 0; i < def_.substeps; ++i) {
        time_s_ += h;
        const Vec3 wanted = wanted_at(time_s_), wanted_v = (wanted - wanted_before) / h;
        wanted_before = wanted;
        // The hand's spring and all damping at the end of the step, the motors' force as it is held; dry friction takes away what it can.
        Vec3 impulse = m * v_ + h * (motors + hand_.push_n + k * (wanted - x_) + hand_.damping_n_s_m * wanted_v);
        const double size = impulse.norm(), dry = h * def_.coulomb_n;
        impulse *= size > dry ? 1 - dry / size : 0;
        v_ = impulse / (m + h * b + h * h * k);
        x_ += h * v_;
        work_j_ += h * motors.dot(v_);
    }
    DeviceReading r;
    r.connected = connected_;
    r.position_m = x_;
    if (def_.encoder_step_m > 0)
        for (int c = 0; c < 3; ++c) r.position_m[c] = def_.encoder_step_m * std::floor(x_[c] / def_.encoder_step_m + 0.5);
    if (spoiled_) r.position_m.x() = std::numeric_limits<double>::quiet_NaN();
    return r;
}

void SimulatedDevice::write(const Vec3& force_n) noexcept {
    Vec3 arriving = force_n;
    if (!line_.empty()) {
        std::swap(arriving, line_[next_]);
        next_ = (next_ + 1) % line_.size();
    }
    const double size = arriving.norm();
    applied_ = size > def_.limits.force_n ? Vec3(arriving * (def_.limits.force_n / size)) : arriving;
}

}  // namespace supple::haptics
