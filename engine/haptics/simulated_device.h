#pragma once
#include <vector>

#include "supple/haptics/trajectory.h"

namespace supple::haptics {

/// The mechanics of a device. Legal: mass > 0, everything else >= 0.
struct SimulatedDeviceDef {
    DeviceLimits limits{};
    double mass_kg = 0.05;           ///< as felt at the handle
    double damping_n_s_m = 0.2;
    double coulomb_n = 0.05;         ///< dry friction of its joints
    double encoder_step_m = 20e-6;   ///< positions are read in steps of this; 0: exactly
    int delay_ticks = 0;             ///< ticks that pass until a force arrives, 0..64
    int substeps = 20;               ///< of its motion per tick, 1..1000
    Vec3 start_m = Vec3::Zero();
};

/// The hand on it: its own mass, drawn to where it wants to be.
struct SimulatedHandDef {
    double mass_kg = 0;              ///< 0, with no stiffness: nobody holds the device
    double stiffness_n_m = 0;
    double damping_n_s_m = 0;
    Trajectory wanted{};             ///< where it wants to be; empty: where the device starts
    Vec3 push_n = Vec3::Zero();      ///< a steady force besides
};

/// A device and a hand in virtual time: (m + m_h) a = F + k_h (wanted - x) - (b + b_h) v + b_h v_wanted + push - dry friction. F is the force last written, held
/// between ticks (zero-order hold), late by the delay, cut to what the motors give. Semi-implicit steps; the same bits every time.
class SimulatedDevice final : public Device {
public:
    /// @error Error(invalid_argument) naming the field
    explicit SimulatedDevice(const SimulatedDeviceDef& def, const SimulatedHandDef& hand = {});
    DeviceLimits limits() const noexcept override { return def_.limits; }
    DeviceReading read(double dt_s) noexcept override;
    void write(const Vec3& force_n) noexcept override;

    // What happens to it.
    void plug(bool connected) { connected_ = connected; }
    void spoil(bool not_a_number) { spoiled_ = not_a_number; }  ///< its readings are not numbers
    void set_push(const Vec3& push_n) { hand_.push_n = push_n; }

    // The truth behind the encoder.
    const Vec3& position_m() const { return x_; }
    const Vec3& velocity_m_s() const { return v_; }
    const Vec3& force_n() const { return applied_; }  ///< that acts on the handle
    /// Work of the motors on the handle since the start: what the rendered world gave away, as long as it is positive [J].
    double work_j() const { return work_j_; }
    double time_s() const { return time_s_; }

private:
    SimulatedDeviceDef def_;
    SimulatedHandDef hand_;
    std::vector<Vec3> line_;    ///< forces under way, a ring
    std::size_t next_ = 0;
    Vec3 x_, v_ = Vec3::Zero(), applied_ = Vec3::Zero();
    double time_s_ = 0, work_j_ = 0;
    bool connected_ = true, spoiled_ = false;
};

}  // namespace supple::haptics
