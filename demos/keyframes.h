#pragma once
#include <vector>

#include "supple/world/collider.h"

namespace supple::demos {

/// A place that something reaches at a time.
struct Stop {
    double time_s = 0;
    Vec3 position_m = Vec3::Zero();
};

/// Keyframes of a way that starts and ends gently at each stop.
PoseKeys eased(const std::vector<Stop>& stops);

/// The place on such a way.
Vec3 eased_at(const std::vector<Stop>& stops, double time_s);

}  // namespace supple::demos
