// The servo thread: it ticks, says what priority it has, and never allocates. Nothing here depends on how fast the machine is.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <new>
#include <thread>

#include "supple/base/error.h"
#include "supple/haptics/plain_devices.h"
#include "supple/haptics/servo.h"
#include "support/haptics.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SUPPLE_OWN_ALLOCATOR 0  // the sanitizers bring their own
#else
#define SUPPLE_OWN_ALLOCATOR 1
#endif

namespace {
std::atomic<bool> counting{false};
std::atomic<long> allocations{0};
}  // namespace

#if SUPPLE_OWN_ALLOCATOR
namespace {
void* counted(std::size_t size) {
    if (counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
    void* p = std::malloc(size == 0 ? 1 : size);
    if (p == nullptr) throw std::bad_alloc();
    return p;
}
void released(void* p) { std::free(p); }
}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* p) noexcept { released(p); }
void operator delete[](void* p) noexcept { released(p); }
void operator delete(void* p, std::size_t) noexcept { released(p); }
void operator delete[](void* p, std::size_t) noexcept { released(p); }
#endif

namespace supple::haptics {
namespace {

TEST(HapticsServo, TicksOnItsOwnAndLeavesTheDeviceAtRest) {
    FedDevice device(device_preset("omega_x"), 0);
    device.put({Vec3(-0.002, 0, 0)});
    LoopDef def = test::bare(500);
    HapticLoop loop(device, def);
    double force = 0;
    {
        Servo servo(loop, device);
        EXPECT_FALSE(servo.priority().empty());
        EXPECT_EQ(servo.priority().find("SCHED_FIFO") == 0, servo.real_time()) << servo.priority();
        for (int i = 0; i < 3000 && (servo.times().ticks() < 300 || force == 0); ++i) {
            loop.models().back().copy_from(test::wall(0, 0));
            loop.models().publish();
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            force = std::max(force, device.force_n().x());
        }
        EXPECT_GE(servo.times().ticks(), 300u);
        EXPECT_NEAR(force, 1.0, 1e-6) << "500 N/m times 2 mm, felt through two threads";
        EXPECT_TRUE(loop.samples().update());
        EXPECT_EQ(loop.samples().front().handle_m, Vec3(-0.002, 0, 0));
        const TickTimes& t = servo.times();
        EXPECT_LE(t.percentile_us(0.5), t.percentile_us(0.99));
        EXPECT_LE(t.percentile_us(0.99), t.percentile_us(0.999));
        EXPECT_GT(t.longest_us(), 0);
    }
    EXPECT_EQ(device.force_n(), Vec3(0, 0, 0));
    EXPECT_THROW(Servo(loop, device, {.priority = 100}), Error);
}

TEST(HapticsServo, CountsIntervalsAndMissedTicks) {
    TickTimes t(1'000'000);
    for (int i = 0; i < 98; ++i) t.add(1'001'000, 20'000);
    t.add(3'200'000, 40'000);
    t.add(1'400'000, 20'000);
    EXPECT_EQ(t.ticks(), 100u);
    EXPECT_EQ(t.missed(), 2u);
    EXPECT_NEAR(t.percentile_us(0.5), 1005, 1e-9);
    EXPECT_NEAR(t.percentile_us(0.99), 1405, 1e-9);
    EXPECT_NEAR(t.percentile_us(1.0), 3205, 1e-9);
    EXPECT_NEAR(t.mean_work_us(), 20.2, 1e-9);
    EXPECT_NEAR(t.longest_us(), 3200, 1e-9);
}

TEST(HapticsServo, ATickAllocatesNothing) {
    if (!SUPPLE_OWN_ALLOCATOR) {
        std::printf("skipped: a sanitizer owns operator new; allocations were not counted\n");
        return;
    }
    SimulatedDevice device({.delay_ticks = 2, .start_m = Vec3(-0.001, 0, 0)}, {.push_n = Vec3(-1, 0.2, 0)});
    test::FedLoop fed(device, {}, test::wall(1e-3, 0.3));
    counting = true;
    for (int i = 0; i < 500; ++i) {
        device.spoil(i % 100 == 50);
        device.plug(i % 150 != 149);
        fed.tick(1e-3);
    }
    counting = false;
    EXPECT_EQ(allocations.load(), 0);
    counting = true;
    int* volatile one = new int(1);  // the count itself works
    delete one;
    counting = false;
    EXPECT_GE(allocations.load(), 1);
}

}  // namespace
}  // namespace supple::haptics
