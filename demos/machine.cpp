#include "machine.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <vector>

#include "supple/base/clock.h"
#include "supple/base/parallel.h"

namespace supple::demos {
namespace {

std::string processor_name() {
    std::ifstream in("/proc/cpuinfo");
    std::string line;
    while (std::getline(in, line)) {
        const std::size_t colon = line.find(": ");
        if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown processor";
}

/// Best of so many passes over the buffer [GB/s]. Sums of integers, so that the compiler may use its widest loads.
double read_gb_s(const std::vector<std::uint64_t>& buffer, int threads, int passes) {
    constexpr std::size_t kChunks = 64;
    const std::size_t grain = buffer.size() / kChunks;
    std::array<std::uint64_t, kChunks> sums{};
    double best_ms = 1e300;
    with_team(threads, [&](Team& team) {
        for (int pass = 0; pass < passes; ++pass) {
            const Stopwatch watch;
            team.for_chunks(kChunks, [&](std::size_t chunk) {
                std::uint64_t sum = sums[chunk];
                for (std::size_t i = chunk * grain; i < (chunk + 1) * grain; ++i) sum += buffer[i];
                sums[chunk] = sum;
            });
            best_ms = std::min(best_ms, watch.ms());
        }
    });
    std::uint64_t total = 0;
    for (const std::uint64_t sum : sums) total += sum;
    volatile std::uint64_t sink = total;  // the sums must not be optimised away
    (void)sink;
    return static_cast<double>(buffer.size() * sizeof(std::uint64_t)) / best_ms * 1e-6;
}

}  // namespace

std::string Machine::line() const {
    char text[256];
    std::snprintf(text, sizeof text, "%s, %d core%s, memory read %.0f GB/s on one, %.0f GB/s on all; cache %.0f and %.0f GB/s", processor.c_str(), cores,
                  cores == 1 ? "" : "s", read_one_gb_s, read_all_gb_s, cache_one_gb_s, cache_all_gb_s);
    return text;
}

Machine measure_machine() {
    Machine machine;
    machine.processor = processor_name();
    machine.cores = hardware_threads();
    const std::vector<std::uint64_t> memory(std::size_t(256) << 17, 1), cache(std::size_t(10) << 17, 1);  // 256 and 10 MB
    machine.read_one_gb_s = read_gb_s(memory, 1, 5);
    machine.read_all_gb_s = read_gb_s(memory, machine.cores, 5);
    machine.cache_one_gb_s = read_gb_s(cache, 1, 100);
    machine.cache_all_gb_s = read_gb_s(cache, machine.cores, 100);
    return machine;
}

}  // namespace supple::demos
