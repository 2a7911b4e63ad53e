#pragma once
#include "supple/base/triple_buffer.h"
#include "supple/haptics/trajectory.h"

namespace supple::haptics {

/// Goes along a trajectory whatever the force: scripted, or recorded from a hand.
class PlayedDevice final : public Device {
public:
    /// @error Error(invalid_argument) as Trajectory::check
    PlayedDevice(const DeviceLimits& limits, Trajectory trajectory);
    DeviceLimits limits() const noexcept override { return limits_; }
    DeviceReading read(double dt_s) noexcept override;
    void write(const Vec3& force_n) noexcept override { force_n_ = force_n; }

    double time_s() const { return time_s_; }
    const Vec3& force_n() const { return force_n_; }  ///< the last one

private:
    DeviceLimits limits_;
    Trajectory trajectory_;
    double time_s_ = 0;
    Vec3 force_n_ = Vec3::Zero();
};

/// A device whose position a host feeds: a mouse, a tablet, a network. put() and force_n() belong to one thread of the host, read() and write() to the loop's.
/// A host feeds at the rate of its frames; between them the handle goes on to the last place exponentially, so that a frame is not felt as a step.
class FedDevice final : public Device {
public:
    /// @param smoothing_s  time constant of that, >= 0; 0: at once
    explicit FedDevice(const DeviceLimits& limits, double smoothing_s = 0.02) : limits_(limits), smoothing_s_(smoothing_s) {}
    DeviceLimits limits() const noexcept override { return limits_; }
    DeviceReading read(double dt_s) noexcept override;
    void write(const Vec3& force_n) noexcept override;

    void put(const DeviceReading& reading) noexcept;
    Vec3 force_n() noexcept;  ///< what the hand would feel

private:
    DeviceLimits limits_;
    double smoothing_s_;
    Vec3 position_m_ = Vec3::Zero();
    bool placed_ = false;
    TripleBuffer<DeviceReading> readings_;
    TripleBuffer<Vec3> forces_{Vec3(Vec3::Zero())};
};

}  // namespace supple::haptics
