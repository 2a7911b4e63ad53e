#pragma once
#include <algorithm>

#include "supple/haptics/device.h"

namespace supple::haptics {

/// The spring and damper between the handle and the tool, in units of the scene.
struct VirtualCoupling {
    double stiffness_n_m = 0;
    double damping_n_s_m = 0;
};

/// The stiffest that a device renders without help: 0.8 of its limit, and no more than its own damping allows at this rate (K T/2 + B < b). Half of what
/// is left of b becomes the coupling's damping.
/// @param workspace_scale  metres in the scene for a metre of the handle, > 0
/// @param force_scale      newtons at the handle for a newton in the scene, > 0
/// @source Colgate and Schenkel 1997; CHAI3D's rule K <= K_max / workspace scale, here with the force scale
inline VirtualCoupling size_coupling(const DeviceLimits& limits, double tick_s, double workspace_scale = 1, double force_scale = 1) {
    const double b = limits.own_damping_n_s_m();
    const double K = 0.8 * std::min(limits.stiffness_n_m, 2 * b / tick_s), B = 0.5 * std::max(0.0, b - K * tick_s / 2), scale = workspace_scale * force_scale;
    return {K / scale, B / scale};
}

}  // namespace supple::haptics
