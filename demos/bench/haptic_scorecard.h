#pragma once
#include <string>
#include <vector>

#include "supple/base/function_ref.h"

namespace supple::demos {

/// Which change of a number is for the worse. Errors, blows and energy that comes from nowhere may become less without anybody's complaint.
enum class Worse { either, higher, lower };

/// A number of the scorecard, with how far it may be from one machine's instruction set to another's.
struct ScoreLine {
    std::string name;      ///< "fidelity sim=60 haptic=1000 rms_error_n"
    double value = 0;
    double tolerance = 0;  ///< absolute
    Worse worse = Worse::either;
    bool good = true;      ///< of what must hold whatever the rest
    std::string demand{};  ///< what must hold; empty: nothing
};

/// The virtual-time scorecard: the same numbers every time. `quick` is a part of the full one.
/// @param print  takes each finished row of the tables as text
std::vector<ScoreLine> haptic_scorecard(bool quick, FunctionRef<void(const std::string&)> print);

/// One line "name = value +- tolerance" each.
std::string regression_text(const std::vector<ScoreLine>& lines);
/// Sentences about what differs from a regression file for the worse: values beyond its tolerance, missing and unknown names. @error Error(parse / file_unreadable)
std::vector<std::string> differences(const std::vector<ScoreLine>& lines, const std::string& file);
std::string json_of(const std::vector<ScoreLine>& lines);

/// The servo on its own thread beside a simulation that takes all the time it gets: never compared, only shown.
struct HapticRealTime {
    int threads = 0;
    std::string priority;
    double seconds = 0, step_ms = 0, model_us = 0;  ///< medians
    std::uint64_t steps = 0, ticks = 0, missed = 0;
    double p50_us = 0, p99_us = 0, p999_us = 0, longest_us = 0, tick_us = 0;
    std::string text() const;
    std::string json() const;
};
HapticRealTime haptic_real_time(int threads, double seconds);

}  // namespace supple::demos
