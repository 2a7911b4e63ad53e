#include "supple/mesh/locality.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "supple/math/morton.h"

namespace supple {

namespace {

constexpr int kBits = 21;  // of a key, per axis

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
        const auto at = [&](Eigen::Index c) { return cell(points[i][c], power); };
        keyed[i] = {morton_key(at(2), at(1), at(0)), std::int32_t(i)};
    }
    std::sort(keyed.begin(), keyed.end());
    std::vector<std::int32_t> order(points.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = keyed[i].second;
    return order;
}

}  // namespace supple
