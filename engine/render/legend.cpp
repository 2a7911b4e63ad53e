#include "supple/render/legend.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "supple/base/error.h"

namespace supple {
namespace {

/// Smallest of {1, 2, 2.5, 5} x 10^k that is not below `least`.
double round_step(double least) {
    const double power = std::pow(10.0, std::floor(std::log10(least)));
    for (const double digit : {1.0, 2.0, 2.5, 5.0})
        if (digit * power >= least * (1 - 1e-9)) return digit * power;
    return 10 * power;
}

/// How many decimals it takes to write a multiple of `step` exactly (2.5 needs one).
int decimals_of(double step) {
    for (int d = 0; d < 9; ++d) {
        const double scaled = step * std::pow(10.0, d);
        if (std::abs(scaled - std::round(scaled)) < 1e-6 * scaled) return d;
    }
    return 9;
}

}  // namespace

LegendTicks legend_ticks(double low, double high, const std::string& unit, int max_ticks) {
    if (!(std::isfinite(low) && std::isfinite(high) && low < high))
        throw Error(ErrorCode::invalid_argument, "ColorScale",
                    "low = " + to_text(low) + ", high = " + to_text(high) + "; low < high is needed, both finite");
    const double step = round_step((high - low) / std::max(1, max_ticks - 1));
    const double first = std::ceil(low / step - 1e-9), last = std::floor(high / step + 1e-9);

    LegendTicks out;
    const double largest = std::max(std::abs(first), std::abs(last)) * step;
    double factor = 1;
    out.unit = unit;
    if (!unit.empty() && unit != "%" && largest > 0) {
        static constexpr const char* kPrefix[] = {"n", "\xC2\xB5", "m", "", "k", "M", "G"};
        const int group = std::clamp(int(std::floor(std::log10(largest * (1 + 1e-9)) / 3)), -3, 3);
        factor = std::pow(10.0, -3 * group);
        out.unit = kPrefix[group + 3] + unit;
    }
    const int decimals = decimals_of(step * factor);
    for (double k = first; k <= last; ++k) {
        const double value = k == 0 ? 0.0 : k * step;  // no "-0"
        char text[48];
        const bool wide = std::abs(value * factor) >= 1e6;  // beyond the largest prefix, or a unit that takes none
        if (wide)
            std::snprintf(text, sizeof text, "%.4g", value * factor);
        else
            std::snprintf(text, sizeof text, "%.*f", decimals, value * factor);
        out.ticks.push_back({value, text});
    }
    return out;
}

}  // namespace supple
