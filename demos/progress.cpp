#include "progress.h"

#include <unistd.h>

#include <cstdio>

namespace supple::demos {

Progress::Progress(std::string what, std::size_t total, bool quiet)
    : what_(std::move(what)), total_(total), active_(!quiet && total > 0 && isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    if (active_) std::fputs("\r\033[K", stderr);
}

void Progress::show(std::size_t done) {
    if (!active_) return;
    const Clock::time_point now = Clock::now();
    if (done < total_ && now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    constexpr int kWidth = 40;
    const double part = static_cast<double>(done) / static_cast<double>(total_);
    const int filled = static_cast<int>(part * kWidth);
    std::string bar(static_cast<std::size_t>(filled), '#');
    bar.resize(kWidth, '.');
    const double elapsed_s = std::chrono::duration<double>(now - start_).count();
    const double left_s = part > 0 ? elapsed_s * (1 - part) / part : 0;
    std::fprintf(stderr, "\r\033[K%s [%s] %3.0f %%  %.0f s left", what_.c_str(), bar.c_str(), 100 * part, left_s);
    std::fflush(stderr);
}

}  // namespace supple::demos
