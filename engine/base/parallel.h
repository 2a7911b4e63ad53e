#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>

#include "supple/base/function_ref.h"

namespace supple {

/// Threads that this machine offers.
int hardware_threads();

inline constexpr int kMaxThreads = 256;

/// Threads that share loops. The thread that owns the team is rank 0: it runs serial code and hands out loops; the others help with them, and sleep when there is
/// nothing to help with. They live as long as the team, inside one OpenMP region: no step waits for a region to begin or end.
///
/// A loop is cut into chunks whose number depends on the problem only, never on the team: sums are taken chunk by chunk, so every
/// team size gives the same bits. Each rank first takes the chunks that it owns in every loop of the same length (locality), then those that others have not begun.
/// Nobody is waited for but who holds a chunk: a partner whose core is taken by another process costs its help, not a scheduler tick.
class Team {
public:
    /// @param threads  rank 0 included; 1 makes a team that is just its owner. At most kMaxThreads are used.
    explicit Team(int threads = 1);
    ~Team();
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

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
    using Loop = FunctionRef<void(std::size_t)>;

    /// Next chunk of the share of one rank, tagged with the loop it belongs to (loop << 32 | chunk): a rank that wakes late finds
    /// another tag and takes nothing.
    struct alignas(64) Cursor {
        std::atomic<std::uint64_t> next{0};
    };

    std::size_t share_begin(std::size_t chunks, int rank) const { return chunks * std::size_t(rank) / std::size_t(size_); }
    void work(int rank, std::uint32_t epoch);
    void open_region();
    void serve(int rank);

    int size_ = 1;
    std::atomic<const Loop*> loop_{nullptr};             ///< null tells the others to go home
    std::atomic<std::size_t> chunks_{0};
    alignas(64) std::atomic<std::uint32_t> epoch_{0};    ///< number of the loop handed out last
    alignas(64) std::atomic<std::uint32_t> finished_{0}; ///< chunks of it that are done
    std::array<Cursor, kMaxThreads> cursor_;
    std::thread host_;  ///< opens the OpenMP region and is its first member
};

/// Runs body(team) on the calling thread with a team of its own. An exception from `body` passes through after the team has gone home.
void with_team(int threads, FunctionRef<void(Team&)> body);

}  // namespace supple
