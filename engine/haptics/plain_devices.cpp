#include "supple/haptics/plain_devices.h"

#include <cmath>
#include <utility>

namespace supple::haptics {

PlayedDevice::PlayedDevice(const DeviceLimits& limits, Trajectory trajectory) : limits_(limits), trajectory_(std::move(trajectory)) {
    trajectory_.check("PlayedDevice.trajectory");
}

DeviceReading PlayedDevice::read(double dt_s) noexcept {
    time_s_ += dt_s;
    return trajectory_.at(time_s_);
}

DeviceReading FedDevice::read(double dt_s) noexcept {
    const bool news = readings_.update();
    DeviceReading r = readings_.front();
    if (!r.position_m.allFinite()) return r;  // the loop's to deal with; what was before stays
    if (!placed_ || smoothing_s_ <= 0) position_m_ = r.position_m;
    placed_ = placed_ || news;
    if (smoothing_s_ > 0) position_m_ += (1 - std::exp(-dt_s / smoothing_s_)) * (r.position_m - position_m_);
    r.position_m = position_m_;
    return r;
}

void FedDevice::write(const Vec3& force_n) noexcept {
    forces_.back() = force_n;
    forces_.publish();
}

void FedDevice::put(const DeviceReading& reading) noexcept {
    readings_.back() = reading;
    readings_.publish();
}

Vec3 FedDevice::force_n() noexcept {
    forces_.update();
    return forces_.front();
}

}  // namespace supple::haptics
