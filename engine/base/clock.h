#pragma once
#include <chrono>
#include <cstdint>

namespace supple {

/// Nanoseconds on the monotonic clock.
inline std::int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Milliseconds on the monotonic clock since construction.
class Stopwatch {
public:
    double ms() const { return std::chrono::duration<double, std::milli>(Clock::now() - start_).count(); }
    /// Milliseconds since construction or the last lap.
    double lap_ms() {
        const Clock::time_point now = Clock::now();
        const double ms = std::chrono::duration<double, std::milli>(now - lap_).count();
        lap_ = now;
        return ms;
    }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
    Clock::time_point lap_ = start_;
};

}  // namespace supple
