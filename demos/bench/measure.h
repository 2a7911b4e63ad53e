#pragma once
#include <optional>
#include <string>
#include <vector>

#include "bench/workload.h"
#include "statistics.h"

namespace supple::demos {

/// What timing a workload found.
struct Measurement {
    std::string name, series;
    io::RunSummary world;                  ///< after the last step
    StepStatistics statistics;             ///< of all repetitions
    std::vector<double> repeat_median_ms;  ///< of the step, one per repetition: how far the machine itself varies
    double cpu_ms = 0;                     ///< processor time of all threads, median step: what neighbours on the machine do not change
    double first_step_ms = 0;              ///< median of the first steps, which build what a snapshot does not hold
    bool repeats_agree = true;             ///< every repetition ended in the same bits
    std::optional<Vec3> tip_m;
    double resident_mb = 0;                ///< memory that the process grew by
    int threads = 1;                       ///< that shared the steps: one where the body is too small for more

    /// Rotation, force, stress and assembly: wall clock times threads over elements, of the median step [ns].
    double setup_ns() const;
    /// What the solves of the median step read and write, had the caches nothing of it [MB], and per second of the solve [GB/s].
    double solve_mb() const;
    double solve_gb_s() const;
};

/// Warm-up, then the same steps again and again from the same state. A world that nobody touches goes back by its snapshot; a scripted one is made anew.
Measurement measure(const Workload& workload, const BenchOptions& options);

}  // namespace supple::demos
