#include "supple/base/parallel.h"

#include <omp.h>

#include <exception>
#include <thread>

namespace supple {

namespace {

// About 20 microseconds of polling: longer than the gap between two loops of a step, far shorter than a scheduler tick.
constexpr int kSpins = 2000;

// A cursor between two loops: its chunk lies past every end.
constexpr std::uint64_t kClosed = ~std::uint64_t(0);

inline void relax() {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    asm volatile("yield");
#endif
}

/// Waits until `counter` differs from `old`; returns the new value.
std::uint32_t wait_for_change(const std::atomic<std::uint32_t>& counter, std::uint32_t old) {
    for (int spin = 0; spin < kSpins; ++spin) {
        const std::uint32_t now = counter.load(std::memory_order_acquire);
        if (now != old) return now;
        relax();
    }
    for (;;) {
        counter.wait(old, std::memory_order_acquire);
        const std::uint32_t now = counter.load(std::memory_order_acquire);
        if (now != old) return now;
    }
}

}  // namespace

int hardware_threads() {
    const unsigned n = std::thread::hardware_concurrency();
    return n == 0 ? 1 : int(n);
}

void Team::for_chunks(std::size_t chunks, FunctionRef<void(std::size_t)> body) {
    if (size_ == 1 || chunks < 2) {
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) body(chunk);
        return;
    }
    const std::uint32_t epoch = epoch_.load(std::memory_order_relaxed) + 1;
    // A rank that wakes late may read the new length while it holds the old loop's number: no cursor may carry that number by then,
    // or the old loop's end would look like a chunk of a longer loop.
    for (int rank = 0; rank < size_; ++rank) cursor_[std::size_t(rank)].next.store(kClosed, std::memory_order_relaxed);
    loop_.store(&body, std::memory_order_release);
    chunks_.store(chunks, std::memory_order_release);
    finished_.store(0, std::memory_order_relaxed);
    for (int rank = 0; rank < size_; ++rank) {
        cursor_[std::size_t(rank)].next.store(std::uint64_t(epoch) << 32 | share_begin(chunks, rank), std::memory_order_release);
    }
    epoch_.store(epoch, std::memory_order_release);
    epoch_.notify_all();
    work(0, epoch);
    for (std::uint32_t done = finished_.load(std::memory_order_acquire); done != chunks;) done = wait_for_change(finished_, done);
}

/// Takes chunks of loop `epoch`, the rank's own share first. A chunk taken keeps the loop open, so what was read of it stays true.
void Team::work(int rank, std::uint32_t epoch) {
    const Loop* loop = loop_.load(std::memory_order_acquire);
    const std::size_t chunks = chunks_.load(std::memory_order_acquire);
    for (int turn = 0; turn < size_; ++turn) {
        const int owner = (rank + turn) % size_;
        const std::size_t end = share_begin(chunks, owner + 1);
        std::atomic<std::uint64_t>& next = cursor_[std::size_t(owner)].next;
        std::uint64_t seen = next.load(std::memory_order_acquire);
        while (seen >> 32 == epoch && std::uint32_t(seen) < end) {
            if (!next.compare_exchange_weak(seen, seen + 1, std::memory_order_acq_rel, std::memory_order_acquire)) continue;
            (*loop)(std::uint32_t(seen));
            finished_.fetch_add(1, std::memory_order_release);
            if (rank != 0) finished_.notify_one();
            seen = next.load(std::memory_order_acquire);
        }
    }
}

void Team::serve(int rank) {
    for (std::uint32_t seen = 0;;) {
        seen = wait_for_change(epoch_, seen);
        if (loop_.load(std::memory_order_relaxed) == nullptr) return;
        work(rank, seen);
    }
}

void Team::dismiss() {
    loop_.store(nullptr, std::memory_order_relaxed);
    epoch_.fetch_add(1, std::memory_order_release);
    epoch_.notify_all();
}

/// Everything that happens inside the OpenMP region, kept out of the function that holds the pragma.
struct TeamRegion {
    FunctionRef<void(Team&)> body;
    Team team{};
    std::exception_ptr failure{};

    void enter(int rank, int size) {
        if (rank != 0) {
            team.serve(rank);
            return;
        }
        team.size_ = size;  // published to the others by the release of the first loop
        try {
            body(team);
        } catch (...) {
            failure = std::current_exception();
        }
        team.dismiss();
    }
};

namespace {

#if defined(__SANITIZE_THREAD__)
// ThreadSanitizer cannot see that libgomp's futexes order the entry of a region: say the same in words it knows.
std::atomic<std::uint32_t> region_entry{0};
void announce_region() { region_entry.fetch_add(1, std::memory_order_release); }
void join_region() { (void)region_entry.load(std::memory_order_acquire); }
#else
void announce_region() {}
void join_region() {}
#endif

// The compiler's own hand-over of `region` is beyond ThreadSanitizer; all that happens inside synchronises by Team.
__attribute__((no_sanitize("thread"))) void open_region(TeamRegion* region, int threads) {
#pragma omp parallel num_threads(threads) default(none) firstprivate(region)
    {
        join_region();
        region->enter(omp_get_thread_num(), omp_get_num_threads());
    }
}

}  // namespace

void with_team(int threads, FunctionRef<void(Team&)> body) {
    if (threads <= 1) {
        Team alone;
        body(alone);
        return;
    }
    TeamRegion region{body, {}, nullptr};
    announce_region();
    open_region(&region, threads);
    if (region.failure) std::rethrow_exception(region.failure);
}

}  // namespace supple
