#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "supple/world/world.h"

namespace supple::io {

/// What a report says beside the steps.
struct RunSummary {
    double time_step_s = 0;
    int threads = 0;        ///< that took part, not 0 for "all"
    std::string isa;        ///< "avx2", ...: kernels that ran
    std::string precision;  ///< "single" or "double"
    std::size_t vertices = 0, elements = 0, bodies = 0;
    std::uint64_t state_hash = 0;
    Energy energy;
    Vec3 reaction_n = Vec3::Zero();
    Vec3 contact_force_n = Vec3::Zero();
};

/// Reads all of it from a world as it stands now.
/// @param isa      name of the instruction set that the kernels use
/// @param threads  number of threads that step() really uses
RunSummary summarise(const World& world, std::string isa, int threads);

/// Gathers the reports of the steps of one run and makes the report file of them.
class RunReport {
public:
    void add(const StepReport& step);

    std::size_t steps() const { return step_ms_.size(); }
    StepFlag flags() const { return flags_; }  ///< of all the steps
    double median_step_ms() const;

    /// JSON, keys: steps, time_step_s, threads, isa, precision, bodies, vertices, elements, step_ms {median, p99, p999, max},
    /// stages_ms {stage: median}, cg_iterations {mean, max} (per step), cg_relative_residual {median, max}, flags [names], state_hash (16
    /// hexadecimal digits), energy_j {kinetic, elastic, gravity, loads}, reaction_n [3], contact_force_n [3] (of all
    /// colliders on the bodies in the last step). p99 and p999 are nearest ranks: the least time that 99 % (99.9 %) of the steps do not exceed. Without a step all numbers
    /// are 0.
    std::string to_json(const RunSummary& summary) const;
    void write(const std::filesystem::path& file, const RunSummary& summary) const;

private:
    std::vector<double> step_ms_;
    std::array<std::vector<double>, kStageCount> stage_ms_;
    std::vector<double> residual_;
    double cg_iterations_sum_ = 0;
    int cg_iterations_max_ = 0;
    StepFlag flags_ = StepFlag::none;
};

/// The least value that at least the given part (0..1] of the values does not exceed; 0 of none.
double percentile(std::vector<double> values, double part);
/// The middle value, the mean of the middle two of an even number; 0 of none.
double median(std::vector<double> values);

}  // namespace supple::io
