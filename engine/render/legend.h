#pragma once
#include <string>
#include <vector>

namespace supple {

struct LegendTick {
    double value;      ///< in the unit of the scale, e.g. Pa
    std::string text;  ///< in the prefixed unit, e.g. "12.5"
};

struct LegendTicks {
    std::vector<LegendTick> ticks;  ///< ascending, inside [low, high], never empty
    std::string unit;               ///< with its prefix, e.g. "kPa"; empty if the unit is
};

/// Round numbers (1, 2, 2.5 or 5 times a power of ten) inside [low, high], all written with the same number of decimals.
/// @param unit      SI unit without prefix; n, u, m, k, M, G are put in front so that the largest tick is in [1, 1000). "" and "%" take
/// none.
/// @param max_ticks 2 or more; about that many are made
/// @error Error(invalid_argument) unless low < high, both finite
LegendTicks legend_ticks(double low, double high, const std::string& unit, int max_ticks = 6);

}  // namespace supple
