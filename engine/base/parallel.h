#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "supple/base/function_ref.h"

namespace supple {

/// Threads that this machine offers.
int hardware_threads();

/// A team of threads inside one with_team() region. Rank 0 runs serial code and hands out loops; the others wait for them.
///
/// A loop is cut into chunks whose number depends on the problem only, never on the team: sums are taken chunk by chunk, so every
/// team size gives the same bits. Chunk i goes to the rank that owns it in every loop of the same length (locality). Waiting is a bounded spin, then a futex:
/// a team whose cores are taken by others sleeps instead of burning the time slice that its partner needs.
class Team {
public:
    int size() const { return size_; }

    /// Runs body(chunk) for chunk = 0..chunks-1 and waits for all. `body` must not throw. Rank 0 only.
    void for_chunks(std::size_t chunks, FunctionRef<void(std::size_t)> body);

    /// for_chunks over [0, n) in pieces of `grain`: body(begin, end).
    template <class Body>
    void for_range(std::size_t n, std::size_t grain, Body&& body) {
        for_chunks((n + grain - 1) / grain, [&](std::size_t chunk) {
            const std::size_t begin = chunk * grain;
            body(begin, begin + grain < n ? begin + grain : n);
        });
    }

private:
    friend void with_team(int threads, FunctionRef<void(Team&)> body);
    friend struct TeamRegion;

    using Loop = FunctionRef<void(std::size_t)>;

    void start(int size) { size_ = size; }
    void run_share(int rank) const;
    void hand_out();
    void await_shares() const;
    void serve(int rank);
    void dismiss();

    int size_ = 1;
    std::size_t chunks_ = 0;
    const Loop* loop_ = nullptr;                         ///< null tells the others to go home
    alignas(64) std::atomic<std::uint32_t> epoch_{0};    ///< one more for every loop handed out
    alignas(64) std::atomic<std::uint32_t> finished_{0}; ///< shares done since the team began
    std::uint32_t expected_ = 0;
};

/// Runs body(team) on the calling thread, with `threads` threads at its call; one OpenMP region. 1 runs it without any.
/// An exception from `body` passes through after the team has gone home.
void with_team(int threads, FunctionRef<void(Team&)> body);

}  // namespace supple
