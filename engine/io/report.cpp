#include "supple/io/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "supple/io/binary_file.h"

namespace supple::io {

double percentile(std::vector<double> values, double part) {
    if (values.empty()) return 0;
    // part * n may land a hair above a whole number: 0.99 * 100 must be rank 99.
    const double rank = std::ceil(part * double(values.size()) - 1e-9);
    const std::size_t index = std::size_t(std::clamp(rank, 1.0, double(values.size()))) - 1;
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(index), values.end());
    return values[index];
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 == 1) return *middle;
    return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

RunSummary summarise(const World& world, std::string isa, int threads) {
    RunSummary summary;
    summary.time_step_s = world.def().time_step_s;
    summary.threads = threads;
    summary.isa = std::move(isa);
    summary.precision = world.def().solver.precision == Precision::single ? "single" : "double";
    for (BodyId body : world.bodies()) {
        const VolumeMesh& mesh = world.shape(body).mesh();
        summary.vertices += mesh.vertices.size();
        summary.elements += mesh.element_count();
        ++summary.bodies;
    }
    summary.state_hash = world.hash();
    summary.energy = world.energy();
    summary.reaction_n = world.reaction_n();
    summary.contact_force_n = world.contact_force_n();
    return summary;
}

void RunReport::add(const StepReport& step) {
    step_ms_.push_back(step.step_ms);
    for (std::size_t s = 0; s < kStageCount; ++s) stage_ms_[s].push_back(step.stage_ms[s]);
    // JSON has no infinity, and the order statistics need comparable numbers; such a step carries a flag besides.
    residual_.push_back(std::isfinite(step.cg_relative_residual) ? step.cg_relative_residual : std::numeric_limits<double>::max());
    cg_iterations_sum_ += step.cg_iterations;
    cg_iterations_max_ = std::max(cg_iterations_max_, step.cg_iterations);
    flags_ |= step.flags;
}

double RunReport::median_step_ms() const { return median(step_ms_); }

std::string RunReport::to_json(const RunSummary& summary) const {
    using Json = nlohmann::ordered_json;
    const double slowest = step_ms_.empty() ? 0 : *std::max_element(step_ms_.begin(), step_ms_.end());
    const double worst = residual_.empty() ? 0 : *std::max_element(residual_.begin(), residual_.end());
    Json stages = Json::object();
    for (std::size_t s = 0; s < kStageCount; ++s) stages[std::string(name(Stage(s)))] = median(stage_ms_[s]);
    Json flags = Json::array();
    for (StepFlag flag : kAllStepFlags) {
        if ((flags_ & flag) != StepFlag::none) flags.push_back(std::string(name(flag)));
    }
    char hash[17];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(summary.state_hash));
    const Vec3 &reaction = summary.reaction_n, &contact = summary.contact_force_n;
    const Json report = {
        {"steps", steps()},
        {"time_step_s", summary.time_step_s},
        {"threads", summary.threads},
        {"isa", summary.isa},
        {"precision", summary.precision},
        {"bodies", summary.bodies},
        {"vertices", summary.vertices},
        {"elements", summary.elements},
        {"step_ms",
         {{"median", median_step_ms()}, {"p99", percentile(step_ms_, 0.99)}, {"p999", percentile(step_ms_, 0.999)}, {"max", slowest}}},
        {"stages_ms", stages},
        {"cg_iterations", {{"mean", step_ms_.empty() ? 0 : cg_iterations_sum_ / double(steps())}, {"max", cg_iterations_max_}}},
        {"cg_relative_residual", {{"median", median(residual_)}, {"max", worst}}},
        {"flags", flags},
        {"state_hash", hash},
        {"energy_j", {{"kinetic", summary.energy.kinetic_j}, {"elastic", summary.energy.elastic_j}, {"gravity", summary.energy.gravity_j}, {"loads", summary.energy.loads_j}}},
        {"reaction_n", Json::array({reaction[0], reaction[1], reaction[2]})},
        {"contact_force_n", Json::array({contact[0], contact[1], contact[2]})},
    };
    return report.dump(2) + "\n";
}

void RunReport::write(const std::filesystem::path& file, const RunSummary& summary) const { write_text_file(file, to_json(summary)); }

}  // namespace supple::io
