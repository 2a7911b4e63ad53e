#pragma once
#include <array>
#include <atomic>
#include <cstdint>

namespace supple {

/// The newest value of one thread, for one other thread. Three copies: one is written, one is read, and one waits between them, so that nobody ever waits:
/// both sides are one atomic exchange. Values that nobody looked at in time are lost; what is read is always whole and never older than before.
/// One producer thread calls back() and publish(), one consumer thread calls update() and front().
template <class T>
class TripleBuffer {
public:
    TripleBuffer() = default;
    explicit TripleBuffer(const T& first) : copies_{first, first, first} {}
    TripleBuffer(const TripleBuffer&) = delete;
    TripleBuffer& operator=(const TripleBuffer&) = delete;

    // -- the producer's
    T& back() noexcept { return copies_[back_]; }  ///< to be written in full: it holds an older value
    void publish() noexcept { back_ = middle_.exchange(std::uint8_t(back_ | kFresh), std::memory_order_acq_rel) & kIndex; }

    // -- the consumer's
    /// Takes what is newest. True if that is something new.
    bool update() noexcept {
        if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
        front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
        return true;
    }
    const T& front() const noexcept { return copies_[front_]; }

private:
    static constexpr std::uint8_t kFresh = 4, kIndex = 3;
    static constexpr std::size_t kLine = 64;  // what two threads write lies in cache lines of its own
    std::array<T, 3> copies_{};
    alignas(kLine) std::uint8_t back_ = 0;
    alignas(kLine) std::atomic<std::uint8_t> middle_{1};
    alignas(kLine) std::uint8_t front_ = 2;
};

}  // namespace supple
