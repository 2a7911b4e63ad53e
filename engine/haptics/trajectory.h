#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "supple/haptics/device.h"

namespace supple::haptics {

/// Where a handle was over time. Linear between the entries, constant before the first and after the last.
struct Trajectory {
    std::vector<double> times_s{};           ///< strictly ascending, at least one
    std::vector<Vec3> positions_m{};         ///< as many
    std::vector<std::uint32_t> buttons{};    ///< as many, or empty

    DeviceReading at(double time_s) const noexcept;
    /// @error Error(invalid_argument) naming the entry
    void check(const std::string& where) const;
};

/// Lines of `t, x, y, z` or `t, x, y, z, buttons` [s, m], separated by commas or blanks; `#` begins a comment, a first line of words is a heading.
/// @param source  named in messages
/// @error Error(parse) with the line; Error(invalid_argument) where times do not ascend
Trajectory parse_trajectory(std::string_view text, const std::string& source);
/// @error Error(file_unreadable) as well
Trajectory read_trajectory(const std::string& path);
std::string to_csv(const Trajectory& trajectory);

}  // namespace supple::haptics
