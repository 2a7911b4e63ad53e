#include "supple/base/parallel.h"

#include <omp.h>


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

Team::Team(int threads) : size_(threads < 1 ? 1 : threads < kMaxThreads ? threads : kMaxThreads) {
    if (size_ > 1) host_ = std::thread([this] { open_region(); });
}

Team::~Team() {
    if (!host_.joinable()) return;
    loop_.store(nullptr, std::memory_order_relaxed);
    epoch_.fetch_add(1, std::memory_order_release);
    epoch_.notify_all();
    host_.join();
    (void)finished_.load(std::memory_order_acquire);  // the join orders the host alone; this, every member
}

// Fewer threads than asked for are no fault: whoever is there takes the chunks of those who are not.
void Team::open_region() {
#pragma omp parallel num_threads(size_ - 1)
    serve(omp_get_thread_num() + 1);
}

void Team::serve(int rank) {
    for (std::uint32_t seen = 0;;) {
        seen = wait_for_change(epoch_, seen);
        if (loop_.load(std::memory_order_relaxed) == nullptr) {
            finished_.fetch_add(1, std::memory_order_release);  // the last touch of this team
            return;
        }
        work(rank, seen);
    }
}

void with_team(int threads, FunctionRef<void(Team&)> body) {
    Team team(threads);
    body(team);
}

}  // namespace supple
