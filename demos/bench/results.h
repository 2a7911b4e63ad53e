#pragma once
#include <string>
#include <vector>

#include "bench/measure.h"
#include "machine.h"

namespace supple::demos {

/// A block of text for the terminal; flags are left to StepStatistics::flag_sentences().
std::string text_of(const Measurement& m, const Machine& machine);
/// One line per measurement, for many at once.
std::string summary_table(const std::vector<Measurement>& all);
/// The file that tests/bench/compare.py reads.
std::string json_of(const std::vector<Measurement>& all, const Machine& machine, const BenchOptions& options);

}  // namespace supple::demos
