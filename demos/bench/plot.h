#pragma once
#include <string>
#include <vector>

#include "bench/measure.h"

namespace supple::demos {

/// The distribution of the step's time, a row per workload on one logarithmic axis, as SVG.
std::string frame_time_svg(const std::vector<Measurement>& all, const std::string& machine);
/// Time per element and step against the number of elements, a curve per series, as SVG; empty where no series has two sizes.
std::string cost_svg(const std::vector<Measurement>& all, const std::string& machine);

}  // namespace supple::demos
