#include "supple/haptics/servo.h"

#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/haptics/real_time.h"

namespace supple::haptics {

void TickTimes::add(std::int64_t interval_ns, std::int64_t work_ns) noexcept {
    // One writer: a load and a store are enough, and no other thread ever waits for them.
    const auto raise = [](std::atomic<std::int64_t>& most, std::int64_t value) {
        if (value > most.load(std::memory_order_relaxed)) most.store(value, std::memory_order_relaxed);
    };
    const auto grow = [](auto& sum, auto by) { sum.store(sum.load(std::memory_order_relaxed) + by, std::memory_order_relaxed); };
    const auto bin = std::size_t(std::clamp<std::int64_t>(interval_ns / kBin_ns, 0, std::int64_t(bin_.size()) - 1));
    grow(bin_[bin], std::uint32_t(1));
    grow(missed_, std::uint64_t(std::max<std::int64_t>(0, (interval_ns + nominal_ns_ / 2) / nominal_ns_ - 1)));
    grow(work_ns_, work_ns);
    raise(longest_ns_, interval_ns);
    raise(longest_work_ns_, work_ns);
    grow(ticks_, std::uint64_t(1));
}

double TickTimes::percentile_us(double part) const noexcept {
    std::uint64_t total = 0, sum = 0;
    for (const auto& b : bin_) total += b.load(std::memory_order_relaxed);
    if (total == 0) return 0;
    const auto wanted = std::uint64_t(std::ceil(part * double(total)));
    for (std::size_t i = 0; i + 1 < bin_.size(); ++i) {
        sum += bin_[i].load(std::memory_order_relaxed);
        if (sum >= std::max<std::uint64_t>(wanted, 1)) return double((std::int64_t(i) + 1) * kBin_ns) * 1e-3;
    }
    return longest_us();
}

double TickTimes::mean_work_us() const noexcept { return ticks() > 0 ? double(work_ns_.load(std::memory_order_relaxed)) * 1e-3 / double(ticks()) : 0; }

Servo::Servo(HapticLoop& loop, Device& device, const ServoDef& def)
    : loop_(loop), device_(device), times_(std::llround(loop.def().tick_s * 1e9)), wanted_priority_(def.priority) {
    require_in_range(def.priority, 0, 99, "ServoDef.priority", "0 does not ask for real-time priority");
    thread_ = std::thread([this] {
        if (wanted_priority_ > 0) {
            const std::string refused = ask_for_real_time(wanted_priority_);
            real_time_ = refused.empty();
            priority_ = real_time_ ? "SCHED_FIFO, priority " + std::to_string(wanted_priority_)
                                   : "no real-time priority: " + refused + "; raise `ulimit -r` or give the program CAP_SYS_NICE";
        } else {
            priority_ = "no real-time priority: not asked for";
        }
        asked_.store(true, std::memory_order_release);
        asked_.notify_one();
        run();
    });
    asked_.wait(false, std::memory_order_acquire);
}

Servo::~Servo() {
    stop_.store(true, std::memory_order_relaxed);
    thread_.join();
}

void Servo::run() noexcept {
    const auto period = std::int64_t(std::llround(loop_.def().tick_s * 1e9));
    std::int64_t last = servo_clock_ns(), next = last + period;
    while (!stop_.load(std::memory_order_relaxed)) {
        sleep_until(next);
        const std::int64_t now = servo_clock_ns();
        loop_.tick(double(now - last) * 1e-9);
        times_.add(now - last, servo_clock_ns() - now);
        last = now;
        // The ticks of a stall are not made up for: the hand has moved on.
        next += period;
        if (next <= now) next = now + period - (now - next) % period;
    }
    device_.write(Vec3::Zero());
}

}  // namespace supple::haptics
