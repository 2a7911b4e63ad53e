#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "supple/math/types.h"

namespace supple::haptics {

/// What a device can do without shaking.
struct DeviceLimits {
    std::string_view name = "touch";
    double force_n = 3.3;          ///< most that it can hold
    double stiffness_n_m = 400;    ///< most that it renders at 1 kHz
    double damping_n_s_m = 4;

    /// Damping of its own mechanics that makes a sampled wall of its largest stiffness just passive at 1 kHz, b = K T/2.
    /// @source Colgate and Schenkel 1997, Passivity of a class of sampled-data systems
    double own_damping_n_s_m() const { return stiffness_n_m * 0.5e-3; }
};

/// Of common devices: touch, omni, desktop, premium_1_5, premium_3_0, falcon, omega_x, delta_3, sigma_7, lambda_7.
/// @source the limits that CHAI3D gives its devices (CPhantomDevices.cpp, CDeltaDevices.cpp)
std::span<const DeviceLimits> device_presets();
/// @error Error(invalid_argument) naming the presets
const DeviceLimits& device_preset(std::string_view name);

struct DeviceReading {
    Vec3 position_m = Vec3::Zero();  ///< of the handle, in the device's own frame
    std::array<double, 4> rotation_wxyz{1, 0, 0, 0};
    std::uint32_t buttons = 0;       ///< bit b: button b is down
    bool connected = true;
};

/// Something that a hand holds: says where it is, takes a force. Called by one thread, once a tick each, first read() then write().
/// Implementations must neither wait nor allocate nor throw.
class Device {
public:
    virtual ~Device() = default;
    virtual DeviceLimits limits() const noexcept = 0;
    /// @param dt_s  since the last reading: a simulated or recorded device moves on by it, others ignore it
    virtual DeviceReading read(double dt_s) noexcept = 0;
    virtual void write(const Vec3& force_n) noexcept = 0;
};

}  // namespace supple::haptics
