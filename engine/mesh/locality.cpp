#include "supple/mesh/locality.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supple {

namespace {

constexpr int kBits = 21;  // per axis: three fit 64

/// The low 21 bits with two zeros between each and the next.
std::uint64_t spread(std::uint64_t bits) {
    bits &= 0x1fffff;
    bits = (bits | bits << 32) & 0x001f00000000ffff;
    bits = (bits | bits << 16) & 0x001f0000ff0000ff;
    bits = (bits | bits << 8) & 0x100f00f00f00f00f;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
    return (bits | bits << 2) & 0x1249249249249249;
}

/// The cell along one axis, modulo 2^21: that is twice the box, no two of its places fall together, wherever it lies.
std::uint64_t cell(double at, int power) {
    const double scaled = std::ldexp(at, kBits - 1 - power);
    return std::isfinite(scaled) ? std::uint64_t(std::int64_t(std::fmod(std::floor(scaled), 1 << kBits))) : 0;
}

}  // namespace

std::vector<std::int32_t> locality_order(std::span<const Vec3> points) {
    Vec3 low = Vec3::Constant(HUGE_VAL), high = -low;
    for (const Vec3& x : points) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }
    int power = 0;
    if (!points.empty()) std::frexp((high - low).maxCoeff(), &power);
    std::vector<std::pair<std::uint64_t, std::int32_t>> keyed(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::uint64_t key = 0;
        for (Eigen::Index c = 0; c < 3; ++c) key |= spread(cell(points[i][c], power)) << c;
        keyed[i] = {key, std::int32_t(i)};
    }
    std::sort(keyed.begin(), keyed.end());
    std::vector<std::int32_t> order(points.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = keyed[i].second;
    return order;
}

}  // namespace supple
