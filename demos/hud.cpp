#include "hud.h"

#include <cstdio>

#include "statistics.h"

namespace supple::demos {
namespace {

constexpr std::size_t kWindow = 30;  // steps

}  // namespace

Hud::Hud(const World& world) : summary_(summary_of(world)) {}

void Hud::add(const StepReport& report) {
    last_ms_.push_back(report.step_ms);
    last_iterations_.push_back(report.cg_iterations);
    if (last_ms_.size() <= kWindow) return;
    last_ms_.erase(last_ms_.begin());
    last_iterations_.erase(last_iterations_.begin());
}

std::string Hud::text() const {
    char line[160];
    std::snprintf(line, sizeof line, "step %.1f ms   %.0f iterations   %zu elements   %d thread%s", io::median(last_ms_),
                  io::median(last_iterations_), summary_.elements, summary_.threads, summary_.threads == 1 ? "" : "s");
    return line;
}

}  // namespace supple::demos
