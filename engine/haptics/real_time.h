#pragma once
#include <cstdint>
#include <string>

namespace supple::haptics {

/// What the operating system is asked for by the servo thread, and nothing else of it: another system has another real_time.cpp.

/// Nanoseconds on the clock that sleep_until() knows.
std::int64_t servo_clock_ns() noexcept;
/// Returns at or after an absolute time on that clock.
void sleep_until(std::int64_t time_ns) noexcept;
/// Asks for real-time priority for the calling thread. Empty if it was granted, else why not.
std::string ask_for_real_time(int priority);

}  // namespace supple::haptics
