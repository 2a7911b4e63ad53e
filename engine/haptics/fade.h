#pragma once
#include <algorithm>

namespace supple::haptics {

/// The part of the force that is let through: rises over fade_in_s while all is well, falls to zero over fade_out_s while it is not. Linear in time.
class Fade {
public:
    Fade(double in_s, double out_s) : in_s_(in_s), out_s_(out_s) {}
    double advance(bool well, double dt_s) noexcept {
        const double over = well ? in_s_ : out_s_;
        gain_ = over > 0 ? std::clamp(gain_ + (well ? dt_s : -dt_s) / over, 0.0, 1.0) : well ? 1.0 : 0.0;
        return gain_;
    }
    void close() noexcept { gain_ = 0; }
    double gain() const noexcept { return gain_; }

private:
    double in_s_, out_s_, gain_ = 0;
};

/// Says whether something still comes: stalled once nothing has come for a time, and before the first.
class Watchdog {
public:
    explicit Watchdog(double patience_s) : patience_s_(patience_s) {}
    void feed() noexcept {
        silent_s_ = 0;
        fed_ = true;
    }
    void advance(double dt_s) noexcept { silent_s_ = std::min(silent_s_ + dt_s, 1e6); }
    bool stalled() const noexcept { return !fed_ || silent_s_ > patience_s_; }
    double silent_s() const noexcept { return silent_s_; }

private:
    double patience_s_, silent_s_ = 0;
    bool fed_ = false;
};

}  // namespace supple::haptics
