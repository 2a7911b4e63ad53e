#include "supple/base/parallel.h"

#include <omp.h>

#include <exception>
#include <thread>

namespace supple {

namespace {

// About 20 microseconds of polling: longer than the gap between two loops of a step, far shorter than a scheduler tick.
constexpr int kSpins = 2000;

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

void Team::run_share(int rank) const {
    const std::size_t begin = chunks_ * std::size_t(rank) / std::size_t(size_);
    const std::size_t end = chunks_ * std::size_t(rank + 1) / std::size_t(size_);
    for (std::size_t chunk = begin; chunk < end; ++chunk) (*loop_)(chunk);
}

void Team::for_chunks(std::size_t chunks, FunctionRef<void(std::size_t)> body) {
    if (size_ == 1 || chunks < 2) {
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) body(chunk);
        return;
    }
    loop_ = &body;
    chunks_ = chunks;
    hand_out();
    run_share(0);
    await_shares();
}

void Team::serve(int rank) {
    for (std::uint32_t seen = 0;;) {
        seen = wait_for_change(epoch_, seen);
        const bool home = loop_ == nullptr;
        if (!home) run_share(rank);
        finished_.fetch_add(1, std::memory_order_release);
        finished_.notify_one();
        if (home) return;
    }
}

void Team::dismiss() {
    loop_ = nullptr;
    hand_out();
    await_shares();
}

void Team::hand_out() {
    expected_ += std::uint32_t(size_ - 1);
    epoch_.fetch_add(1, std::memory_order_release);
    epoch_.notify_all();
}

void Team::await_shares() const {
    for (std::uint32_t done = finished_.load(std::memory_order_acquire); done != expected_;) done = wait_for_change(finished_, done);
}

/// Everything that happens inside the OpenMP region, kept out of the function that holds the pragma.
struct TeamRegion {
    FunctionRef<void(Team&)> body;
    Team team;
    std::exception_ptr failure;

    void enter(int rank, int size) {
        if (rank != 0) {
            team.serve(rank);
            return;
        }
        team.start(size);  // published to the others by the release of the first loop
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
