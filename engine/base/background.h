#pragma once
#include <atomic>
#include <functional>
#include <thread>

namespace supple {

/// Work on a thread of its own that nobody waits for until its result is wanted. The job must not throw and must own, or outlive, what it touches.
class Background {
public:
    explicit Background(std::function<void()> job);
    ~Background();  ///< waits
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    bool done() const { return done_.load(std::memory_order_acquire); }
    void wait();

private:
    std::atomic<bool> done_{false};
    std::thread thread_;
};

}  // namespace supple
