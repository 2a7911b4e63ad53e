#pragma once
#include <atomic>
#include <string>
#include <thread>

#include "supple/haptics/loop.h"
#include "supple/haptics/tick_times.h"

namespace supple::haptics {

struct ServoDef {
    int priority = 80;  ///< SCHED_FIFO, [1, 99]; 0 does not ask
};

/// Ticks a loop on a thread of its own at its nominal rate, with the time that really passed, until it is destroyed; the device then gets a force of zero.
/// The loop and its device belong to the thread meanwhile, but for the loop's two buffers.
class Servo {
public:
    /// @error Error(invalid_argument)
    explicit Servo(HapticLoop& loop, Device& device, const ServoDef& def = {});
    ~Servo();
    Servo(const Servo&) = delete;
    Servo& operator=(const Servo&) = delete;

    /// "SCHED_FIFO, priority 80", or why it was not granted and what to do.
    const std::string& priority() const { return priority_; }
    bool real_time() const { return real_time_; }
    const TickTimes& times() const { return times_; }

private:
    void run() noexcept;

    HapticLoop& loop_;
    Device& device_;
    TickTimes times_;
    std::string priority_;
    bool real_time_ = false;
    std::atomic<bool> asked_{false}, stop_{false};
    int wanted_priority_;
    std::thread thread_;
};

}  // namespace supple::haptics
