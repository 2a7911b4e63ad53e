#pragma once
#include <algorithm>
#include <cmath>

#include "supple/math/types.h"

namespace supple::haptics {

/// Cuts a force to a length, and its change from one tick to the next. The result never exceeds max_force_n: it lies between two forces that do not.
class ForceLimits {
public:
    ForceLimits(double max_force_n, double max_slew_n_s) : max_force_n_(max_force_n), max_slew_n_s_(max_slew_n_s) {}

    Vec3 apply(Vec3 force, double dt_s) noexcept {
        clamped_ = slewed_ = false;
        if (!force.allFinite()) force = Vec3::Zero();
        if (const double size = force.norm(); size > max_force_n_) {
            force *= max_force_n_ / size;
            clamped_ = true;
        }
        const Vec3 change = force - last_;
        if (const double size = change.norm(), most = max_slew_n_s_ * dt_s; size > most) {
            force = last_ + change * (most / size);
            slewed_ = true;
        }
        return last_ = force;
    }
    void drop() noexcept { last_ = Vec3::Zero(); }  ///< of a device that is gone
    const Vec3& last() const noexcept { return last_; }
    bool clamped() const noexcept { return clamped_; }
    bool slewed() const noexcept { return slewed_; }

private:
    double max_force_n_, max_slew_n_s_;
    Vec3 last_ = Vec3::Zero();
    bool clamped_ = false, slewed_ = false;
};

}  // namespace supple::haptics
