// viridis, magma, inferno: S. van der Walt, N. Smith, matplotlib 1.5 (values in the public domain, CC0). cividis: J. Nunez, C. Anderton,
// R. Renslow, PLoS ONE 13(7), 2018. Ten evenly spaced values of each are enough: a cubic through them stays within a few levels of the
// published tables. coolwarm: our own, in OKLab (B. Ottosson, "A perceptual color space for image processing", 2020), after the idea of K.
// Moreland, "Diverging Color Maps for Scientific Visualization", 2009: two hues of equal lightness that meet in a light grey, so that the
// sign reads without the value being lost.
#include "supple/render/color_map.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "supple/base/error.h"

namespace supple {
namespace {

using Color = std::array<double, 3>;

constexpr std::array<std::string_view, 5> kNames{"viridis", "magma", "inferno", "cividis", "coolwarm"};
constexpr std::size_t kControls = 10;
constexpr std::uint32_t kSequential[4][kControls] = {
    {0x440154, 0x482878, 0x3e4a89, 0x31688e, 0x26828e, 0x1f9e89, 0x35b779, 0x6dcd59, 0xb4de2c, 0xfde725},
    {0x000004, 0x180f3e, 0x451077, 0x721f81, 0x9f2f7f, 0xcd4071, 0xf1605d, 0xfd9567, 0xfec98d, 0xfcfdbf},
    {0x000004, 0x1b0c42, 0x4b0c6b, 0x781c6d, 0xa52c60, 0xcf4446, 0xed6925, 0xfb9a06, 0xf7d03c, 0xfcffa4},
    {0x00204d, 0x00336f, 0x39486b, 0x575c6d, 0x707173, 0x8a8779, 0xa69d75, 0xc4b56c, 0xe4cf5b, 0xffea46},
};

double to_linear(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }
double to_srgb(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055; }

std::uint8_t level(double share) { return std::uint8_t(std::lround(255 * std::clamp(share, 0.0, 1.0))); }

std::array<std::uint8_t, 3> srgb_of_oklab(const Color& lab) {
    const double l = lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2];
    const double m = lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2];
    const double s = lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2];
    const double l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
    const Color rgb{4.0767416621 * l3 - 3.3077115913 * m3 + 0.2309699292 * s3, -1.2684380046 * l3 + 2.6097574011 * m3 - 0.3413193965 * s3,
                    -0.0041960863 * l3 - 0.7034186147 * m3 + 1.7076147010 * s3};
    std::array<std::uint8_t, 3> out;
    for (std::size_t c = 0; c < 3; ++c) out[c] = level(to_srgb(std::max(rgb[c], 0.0)));
    return out;
}

/// Catmull-Rom through evenly spaced values; the ends continue straight.
Color spline(std::span<const Color> controls, double t) {
    const std::ptrdiff_t last = std::ptrdiff_t(controls.size()) - 1;
    const std::ptrdiff_t i = std::min(std::ptrdiff_t(t * double(last)), last - 1);
    const double u = t * double(last) - double(i);
    const auto at = [&](std::ptrdiff_t k, std::size_t c) {
        if (k < 0) return 2 * controls[0][c] - controls[1][c];
        if (k > last) return 2 * controls[std::size_t(last)][c] - controls[std::size_t(last) - 1][c];
        return controls[std::size_t(k)][c];
    };
    Color out;
    for (std::size_t c = 0; c < 3; ++c) {
        const double p0 = at(i - 1, c), p1 = at(i, c), p2 = at(i + 1, c), p3 = at(i + 2, c);
        out[c] = p1 + 0.5 * u * (p2 - p0 + u * (2 * p0 - 5 * p1 + 4 * p2 - p3 + u * (3 * (p1 - p2) + p3 - p0)));
    }
    return out;
}

ColorTable sequential(const std::uint32_t (&hex)[kControls]) {
    std::array<Color, kControls> controls;
    for (std::size_t k = 0; k < kControls; ++k)
        controls[k] = {double(hex[k] >> 16 & 255) / 255, double(hex[k] >> 8 & 255) / 255, double(hex[k] & 255) / 255};
    ColorTable table;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const Color c = spline(controls, double(i) / 255);
        table[i] = {level(c[0]), level(c[1]), level(c[2])};
    }
    return table;
}

ColorTable diverging() {
    ColorTable table;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double t = 2 * double(i) / 255 - 1;                                       // -1 cool .. 1 warm
        const double away = std::abs(t), round_top = std::sqrt(t * t + 0.0064) - 0.08;  // no crease in the middle
        const double chroma = 0.135 * std::pow(away, 0.85), hue = t < 0 ? 4.55 : 0.45;
        table[i] = srgb_of_oklab({0.91 - 0.42 * round_top, chroma * std::cos(hue), chroma * std::sin(hue)});
    }
    return table;
}

}  // namespace

std::span<const std::string_view> color_map_names() { return kNames; }

const ColorTable& color_map(std::string_view name) {
    static const std::array<ColorTable, kNames.size()> tables{sequential(kSequential[0]), sequential(kSequential[1]),
                                                              sequential(kSequential[2]), sequential(kSequential[3]), diverging()};
    for (std::size_t i = 0; i < kNames.size(); ++i)
        if (kNames[i] == name) return tables[i];
    std::string known;
    for (const std::string_view n : kNames) known.append(known.empty() ? "" : ", ").append(n);
    throw Error(ErrorCode::invalid_argument, "ColorScale.map", "'" + std::string(name) + "' is not a colour map; known are " + known);
}

double lightness(const std::array<std::uint8_t, 3>& srgb) {
    const double y =
        0.2126729 * to_linear(srgb[0] / 255.0) + 0.7151522 * to_linear(srgb[1] / 255.0) + 0.0721750 * to_linear(srgb[2] / 255.0);
    return y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : y * 24389.0 / 27;
}

}  // namespace supple
