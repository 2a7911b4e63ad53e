#pragma once
#include <string>
#include <vector>

#include "bench/workload.h"

namespace supple::demos {

/// What two things of the same duration take beside busy processes, done in turns: a step of the bar of 12,288 tets, and a plain loop on one thread.
struct BusyResult {
    double idle_ms = 0;                  ///< the step before the others begin: least of many
    int processes = 0;
    std::vector<double> step_ms, spin_ms;
    double step_tail_ms() const;         ///< p99 - median
    double spin_tail_ms() const;
    std::string text() const;
    std::string json() const;            ///< a JSON object
};

/// Starts a busy process per core, which end with this one.
/// @error Error(external_tool) where no process can be started
BusyResult measure_busy(const BenchOptions& options);

}  // namespace supple::demos
