#include "supple/haptics/device.h"

#include <string>

#include "supple/base/error.h"

namespace supple::haptics {

std::span<const DeviceLimits> device_presets() {
    static constexpr DeviceLimits presets[] = {
        {"touch", 3.3, 400, 4},     {"omni", 3.3, 700, 5},    {"desktop", 7.9, 1000, 5},  {"premium_1_5", 8.5, 800, 5}, {"premium_3_0", 22, 1000, 5},
        {"falcon", 8, 3000, 20},    {"omega_x", 12, 5000, 30}, {"delta_3", 20, 5000, 30}, {"sigma_7", 12, 4000, 30},    {"lambda_7", 12, 8000, 30},
    };
    return presets;
}

const DeviceLimits& device_preset(std::string_view name) {
    std::string names;
    for (const DeviceLimits& d : device_presets()) {
        if (d.name == name) return d;
        names += (names.empty() ? "" : ", ") + std::string(d.name);
    }
    throw Error(ErrorCode::invalid_argument, "device_preset", "no device is called \"" + std::string(name) + "\"; there are " + names);
}

}  // namespace supple::haptics
