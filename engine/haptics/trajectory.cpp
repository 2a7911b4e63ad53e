#include "supple/haptics/trajectory.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

#include "supple/base/error.h"

namespace supple::haptics {

DeviceReading Trajectory::at(double time_s) const noexcept {
    DeviceReading r;
    if (times_s.empty()) return r;
    const auto after = std::upper_bound(times_s.begin(), times_s.end(), time_s);
    const auto b = std::min(std::size_t(after - times_s.begin()), times_s.size() - 1), a = after == times_s.begin() || after == times_s.end() ? b : b - 1;
    const double s = a == b ? 0 : (time_s - times_s[a]) / (times_s[b] - times_s[a]);
    r.position_m = (1 - s) * positions_m[a] + s * positions_m[b];
    if (!buttons.empty()) r.buttons = buttons[a];
    return r;
}

void Trajectory::check(const std::string& where) const {
    const auto wrong = [&](const std::string& what) { throw Error(ErrorCode::invalid_argument, where, what); };
    if (times_s.empty()) wrong("has no entries; give at least one time and position");
    if (positions_m.size() != times_s.size() || (!buttons.empty() && buttons.size() != times_s.size()))
        wrong(std::to_string(times_s.size()) + " times, " + std::to_string(positions_m.size()) + " positions and " + std::to_string(buttons.size()) +
              " buttons; give as many of each (buttons may be left out)");
    for (std::size_t i = 0; i < times_s.size(); ++i) {
        if (!std::isfinite(times_s[i]) || !positions_m[i].allFinite()) wrong("entry " + std::to_string(i) + " is not finite");
        if (i > 0 && !(times_s[i] > times_s[i - 1])) wrong("time " + to_text(times_s[i]) + " of entry " + std::to_string(i) + " does not follow " + to_text(times_s[i - 1]) + "; sort the entries");
    }
}

Trajectory parse_trajectory(std::string_view text, const std::string& source) {
    Trajectory t;
    std::istringstream lines{std::string(text)};
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        line = line.substr(0, line.find('#'));
        std::replace_if(line.begin(), line.end(), [](char c) { return c == ',' || c == ';' || c == '\r'; }, ' ');
        std::istringstream words(line);
        const std::vector<std::string> word{std::istream_iterator<std::string>(words), {}};
        if (word.empty()) continue;
        std::vector<double> value;
        bool numbers = true;
        for (const std::string& w : word) {
            char* end = nullptr;
            value.push_back(std::strtod(w.c_str(), &end));
            numbers = numbers && *end == '\0';
        }
        if (!numbers && t.times_s.empty()) continue;  // the heading
        const std::string where = source + ":" + std::to_string(number);
        if (!numbers || value.size() < 4 || value.size() > 5)
            throw Error(ErrorCode::parse, where, "\"" + line + "\" is not a line t, x, y, z or t, x, y, z, buttons in seconds and metres");
        if (value.size() != (t.buttons.empty() && !t.times_s.empty() ? 4u : t.times_s.empty() ? value.size() : 5u))
            throw Error(ErrorCode::parse, where, "has " + std::to_string(value.size()) + " numbers, the lines before have another count");
        t.times_s.push_back(value[0]);
        t.positions_m.emplace_back(value[1], value[2], value[3]);
        if (value.size() == 5) {
            if (!(value[4] >= 0 && value[4] <= 4294967295.0)) throw Error(ErrorCode::parse, where, "buttons " + to_text(value[4]) + " is outside [0, 4294967295]");
            t.buttons.push_back(std::uint32_t(value[4]));
        }
    }
    t.check(source);
    return t;
}

Trajectory read_trajectory(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) throw Error(ErrorCode::file_unreadable, path, "cannot be opened");
    return parse_trajectory(std::string(std::istreambuf_iterator<char>(in), {}), path);
}

std::string to_csv(const Trajectory& t) {
    std::string out = t.buttons.empty() ? "t_s,x_m,y_m,z_m\n" : "t_s,x_m,y_m,z_m,buttons\n";
    for (std::size_t i = 0; i < t.times_s.size(); ++i) {
        out += to_text(t.times_s[i]);
        for (int c = 0; c < 3; ++c) out += "," + to_text(t.positions_m[i][c]);
        if (!t.buttons.empty()) out += "," + std::to_string(t.buttons[i]);
        out += "\n";
    }
    return out;
}

}  // namespace supple::haptics
