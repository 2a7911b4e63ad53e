#include "supple/render/normals.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "supple/base/disjoint_sets.h"

namespace supple::render {
namespace {

struct HalfEdge {
    std::int32_t low, high;                 // vertices, low < high
    std::uint32_t corner_low, corner_high;  // 3 * triangle + k, where those vertices sit
};

}  // namespace

SmoothTopology split_at_creases(std::span<const Vec3> positions, std::span<const Triangle> triangles, double crease_angle_deg, std::span<const char> inner) {
    const std::size_t count = triangles.size();
    std::vector<Vec3> face(count);  // unit normals; zero where the face has no area
    std::vector<HalfEdge> halves;
    halves.reserve(3 * count);
    for (std::size_t t = 0; t < count; ++t) {
        const Triangle& tri = triangles[t];
        const auto at = [&](int k) -> const Vec3& { return positions[std::size_t(tri[std::size_t(k)])]; };
        face[t] = (at(1) - at(0)).cross(at(2) - at(0)).stableNormalized();
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t n = (k + 1) % 3;
            HalfEdge h{tri[k], tri[n], std::uint32_t(3 * t + k), std::uint32_t(3 * t + n)};
            if (h.low > h.high) {
                std::swap(h.low, h.high);
                std::swap(h.corner_low, h.corner_high);
            }
            halves.push_back(h);
        }
    }
    std::sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
        if (a.low != b.low) return a.low < b.low;
        if (a.high != b.high) return a.high < b.high;
        return a.corner_low < b.corner_low;
    });

    SmoothTopology out;
    out.closed = true;
    DisjointSets corners(3 * count);
    const double least_cosine = std::cos(crease_angle_deg * std::numbers::pi / 180);
    for (std::size_t i = 0; i < halves.size(); ++i) {
        const HalfEdge& a = halves[i];
        const bool first = i == 0 || halves[i - 1].low != a.low || halves[i - 1].high != a.high;
        const bool paired = i + 1 < halves.size() && halves[i + 1].low == a.low && halves[i + 1].high == a.high;
        if (!paired) {
            if (first) {
                out.edges.push_back({a.low, a.high, std::int32_t(a.corner_low / 3), -1, true});
                out.closed = false;
            }
            continue;
        }
        const HalfEdge& b = halves[i + 1];
        const Vec3 &na = face[a.corner_low / 3], &nb = face[b.corner_low / 3];
        const bool flat = na.isZero() || nb.isZero();
        const bool parted = !inner.empty() && inner[a.corner_low / 3] != inner[b.corner_low / 3];
        const bool crisp = parted || (!flat && na.dot(nb) < least_cosine);
        if (!crisp) {
            corners.join(a.corner_low, b.corner_low);
            corners.join(a.corner_high, b.corner_high);
        }
        out.edges.push_back({a.low, a.high, std::int32_t(a.corner_low / 3), std::int32_t(b.corner_low / 3), crisp});
    }

    std::vector<std::uint32_t> number(3 * count);
    out.triangles.resize(count);
    for (std::uint32_t c = 0; c < 3 * count; ++c) {
        const auto r = std::uint32_t(corners.root(c));  // r <= c: already numbered unless it is c itself
        if (r == c) {
            number[c] = std::uint32_t(out.vertex_of.size());
            out.vertex_of.push_back(triangles[c / 3][c % 3]);
        }
        out.triangles[c / 3][c % 3] = number[r];
    }
    if (out.closed) {
        double volume = 0;
        const Vec3 base = count > 0 ? positions[std::size_t(triangles[0][0])] : Vec3::Zero();
        for (const Triangle& t : triangles) {
            const auto at = [&](std::size_t k) { return Vec3(positions[std::size_t(t[k])] - base); };
            volume += at(0).dot(at(1).cross(at(2)));
        }
        if (volume < 0)
            for (auto& t : out.triangles) std::swap(t[1], t[2]);
    }
    return out;
}

void compute_normals(const SmoothTopology& topology, std::span<const Eigen::Vector3f> positions, std::vector<Eigen::Vector3f>& normals) {
    normals.assign(positions.size(), Eigen::Vector3f::Zero());
    for (const auto& t : topology.triangles) {
        const Eigen::Vector3f &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
        const Eigen::Vector3f ab = b - a, bc = c - b, ca = a - c;
        const Eigen::Vector3f area = ab.cross(-ca);
        const float ab2 = ab.squaredNorm(), bc2 = bc.squaredNorm(), ca2 = ca.squaredNorm();
        // The face's weight at a corner is 1 / (product of its two squared edges); multiplied by all three squares to spare the divisions,
        // and divided by the size of that product, so that faces of different sizes keep their ratio.
        const float scale = 1.0f / std::max(ab2 * bc2 * ca2, 1e-37f);
        normals[t[0]] += area * (bc2 * scale);
        normals[t[1]] += area * (ca2 * scale);
        normals[t[2]] += area * (ab2 * scale);
    }
    for (Eigen::Vector3f& n : normals) {
        const float length = n.norm();
        n = length > 0 && std::isfinite(length) ? Eigen::Vector3f(n / length) : Eigen::Vector3f(0, 1, 0);
    }
}

}  // namespace supple::render
