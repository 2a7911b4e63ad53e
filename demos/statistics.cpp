#include "statistics.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "supple/base/parallel.h"
#include "supple/math/isa.h"

namespace supple::demos {

double mean(const std::vector<double>& values) {
    return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

void StepStatistics::add(const World& world, const StepReport& report) {
    report_.add(report);
    step_ms_.push_back(report.step_ms);
    for (std::size_t s = 0; s < kStageCount; ++s) stage_ms_[s].push_back(report.stage_ms[s]);
    iterations_.push_back(report.cg_iterations);
    residuals_.push_back(report.cg_relative_residual);
    solve_bytes_.push_back(report.solve_bytes);
    add_untimed(world, report);
}

void StepStatistics::add_untimed(const World& world, const StepReport& report) {
    ++seen_;
    for (const StepFlag flag : kAllStepFlags) {
        if ((report.flags & flag) == StepFlag::none) continue;
        auto record = std::find_if(flags_.begin(), flags_.end(), [&](const FlagRecord& r) { return r.flag == flag; });
        if (record == flags_.end()) record = flags_.insert(flags_.end(), {flag, report.step, 0, {}});
        ++record->steps;
        if (flag != StepFlag::non_finite && flag != StepFlag::frozen) continue;
        for (const BodyId body : world.bodies()) {
            const std::string& name = world.name(body);
            if (world.is_frozen(body) && std::find(record->bodies.begin(), record->bodies.end(), name) == record->bodies.end())
                record->bodies.push_back(name);
        }
    }
}

std::string StepStatistics::table() const {
    std::string text;
    char line[160];
    const auto row = [&](std::string_view what, const std::vector<double>& ms) {
        std::snprintf(line, sizeof line, "  %-12.*s %9.3f %9.3f %9.3f\n", static_cast<int>(what.size()), what.data(), io::median(ms),
                      io::percentile(ms, 0.99), io::percentile(ms, 0.999));
        text += line;
    };
    std::snprintf(line, sizeof line, "  %-12s %9s %9s %9s\n", "[ms]", "median", "p99", "p99.9");
    text += line;
    for (std::size_t s = 0; s < kStageCount; ++s) row(name(static_cast<Stage>(s)), stage_ms_[s]);
    row("step", step_ms_);
    return text;
}

std::string StepStatistics::flag_sentences() const {
    std::string text;
    for (const FlagRecord& r : flags_) {
        text += "flag " + std::string(name(r.flag));
        for (std::size_t i = 0; i < r.bodies.size(); ++i) text += (i == 0 ? " on " : ", ") + r.bodies[i];
        text += ", first at step " + std::to_string(r.first_step) + ", in " + std::to_string(r.steps) + " of " + std::to_string(seen_) +
                " steps: " + std::string(cure(r.flag)) + "\n";
    }
    return text;
}

std::string hash_text(std::uint64_t hash) {
    char text[20];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

void StepStatistics::write_report(const std::filesystem::path& file, const World& world) const { report_.write(file, summary_of(world)); }

io::RunSummary summary_of(const World& world) {
    const int asked = world.def().threads;
    return io::summarise(world, std::string(name(world.def().isa.value_or(best_isa()))), asked > 0 ? asked : hardware_threads());
}

}  // namespace supple::demos
