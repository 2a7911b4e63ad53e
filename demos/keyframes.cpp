#include "keyframes.h"

#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr int kParts = 12;  // keyframes are joined by straight lines

}  // namespace

Vec3 eased_at(const std::vector<Stop>& stops, double time_s) {
    for (std::size_t i = 1; i < stops.size(); ++i)
        if (time_s < stops[i].time_s)
            return stops[i - 1].position_m + smooth_step(stops[i - 1].time_s, stops[i].time_s, time_s) * (stops[i].position_m - stops[i - 1].position_m);
    return stops.back().position_m;
}

PoseKeys eased(const std::vector<Stop>& stops) {
    PoseKeys keys;
    for (std::size_t i = 0; i < stops.size(); ++i) {
        for (int part = 1; i > 0 && part < kParts; ++part) {
            const double time = stops[i - 1].time_s + (stops[i].time_s - stops[i - 1].time_s) * part / kParts;
            keys.times_s.push_back(time);
            keys.positions_m.push_back(eased_at(stops, time));
        }
        keys.times_s.push_back(stops[i].time_s);
        keys.positions_m.push_back(stops[i].position_m);
    }
    return keys;
}

}  // namespace supple::demos
