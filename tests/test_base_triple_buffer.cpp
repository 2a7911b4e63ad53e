// The hand-over between a fast and a slow thread.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "supple/base/triple_buffer.h"

namespace supple {
namespace {

TEST(BaseTripleBuffer, HandsOverTheNewest) {
    TripleBuffer<int> buffer(7);
    EXPECT_FALSE(buffer.update());
    EXPECT_EQ(buffer.front(), 7);
    for (int i = 1; i <= 3; ++i) {
        buffer.back() = i;
        buffer.publish();
    }
    EXPECT_TRUE(buffer.update());
    EXPECT_EQ(buffer.front(), 3);
    EXPECT_FALSE(buffer.update()) << "nothing new since";
    EXPECT_EQ(buffer.front(), 3);
    buffer.back() = 4;
    EXPECT_EQ(buffer.front(), 3) << "not published yet";
    buffer.publish();
    EXPECT_TRUE(buffer.update());
    EXPECT_EQ(buffer.front(), 4);
}

/// A value that shows it where it was torn: all its numbers are equal.
struct Wide {
    std::array<std::uint64_t, 64> number{};
};

TEST(BaseTripleBuffer, TwoThreadsNeverSeeATornOrAnOlderValue) {
    constexpr std::uint64_t kLast = 200000;
    TripleBuffer<Wide> buffer;
    std::thread producer([&] {
        for (std::uint64_t i = 1; i <= kLast; ++i) {
            buffer.back().number.fill(i);
            buffer.publish();
        }
    });
    std::uint64_t seen = 0, torn = 0, older = 0, values = 0;
    while (seen < kLast) {
        if (!buffer.update()) continue;
        const Wide& w = buffer.front();
        ++values;
        for (const std::uint64_t n : w.number) torn += n != w.number[0];
        older += w.number[0] <= seen;
        seen = w.number[0];
    }
    producer.join();
    EXPECT_EQ(torn, 0u);
    EXPECT_EQ(older, 0u);
    EXPECT_GT(values, 0u);
}

}  // namespace
}  // namespace supple
