#pragma once
#include <array>
#include <atomic>
#include <cstdint>

namespace supple::haptics {

/// Counts of the time between ticks, in bins of five microseconds up to 20 ms. One thread adds, any other may look.
class TickTimes {
public:
    explicit TickTimes(std::int64_t nominal_ns) : nominal_ns_(nominal_ns) {}
    void add(std::int64_t interval_ns, std::int64_t work_ns) noexcept;

    std::uint64_t ticks() const noexcept { return ticks_.load(std::memory_order_relaxed); }
    /// Ticks that should have been and were not: of an interval of 3.2 nominal ones two.
    std::uint64_t missed() const noexcept { return missed_.load(std::memory_order_relaxed); }
    /// Upper end of the bin that this part of the intervals does not exceed [us]; beyond the bins: the longest. @param part in [0, 1]
    double percentile_us(double part) const noexcept;
    double longest_us() const noexcept { return double(longest_ns_.load(std::memory_order_relaxed)) * 1e-3; }
    double mean_work_us() const noexcept;     ///< of a tick itself
    double longest_work_us() const noexcept { return double(longest_work_ns_.load(std::memory_order_relaxed)) * 1e-3; }

private:
    static constexpr std::int64_t kBin_ns = 5000;
    std::int64_t nominal_ns_;
    std::array<std::atomic<std::uint32_t>, 4001> bin_{};
    std::atomic<std::uint64_t> ticks_{0}, missed_{0};
    std::atomic<std::int64_t> longest_ns_{0}, work_ns_{0}, longest_work_ns_{0};
};

}  // namespace supple::haptics
