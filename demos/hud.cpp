#include "hud.h"

#include <cstdio>

#include "statistics.h"
#include "supple/io/report.h"

namespace supple::demos {
namespace {

constexpr std::size_t kWindow = 30;  // steps

}  // namespace

Hud::Hud(const World& world) : world_(&world), threads_(summary_of(world).threads) {}

void Hud::add(const StepReport& report) {
    last_ms_.push_back(report.step_ms);
    last_iterations_.push_back(report.cg_iterations);
    if (last_ms_.size() <= kWindow) return;
    last_ms_.erase(last_ms_.begin());
    last_iterations_.erase(last_iterations_.begin());
}

std::string Hud::text() const {
    std::size_t elements = 0;  // edits change it
    for (const BodyId body : world_->bodies()) elements += world_->shape(body).mesh().element_count();
    char line[160];
    std::snprintf(line, sizeof line, "step %.1f ms   %.0f iterations   %zu elements   %d thread%s", io::median(last_ms_),
                  io::median(last_iterations_), elements, threads_, threads_ == 1 ? "" : "s");
    return line;
}

}  // namespace supple::demos
