#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace supple {

/// viridis, magma, inferno, cividis (sequential), coolwarm (diverging, muted; its middle is light).
std::span<const std::string_view> color_map_names();

using ColorTable = std::array<std::array<std::uint8_t, 3>, 256>;  ///< sRGB, from low to high

/// The table of a map; it lives as long as the process. @error Error(invalid_argument) for an unknown name, with the known ones
const ColorTable& color_map(std::string_view name);

/// CIE 1976 lightness L* of an sRGB colour, 0..100 (D65).
double lightness(const std::array<std::uint8_t, 3>& srgb);

}  // namespace supple
