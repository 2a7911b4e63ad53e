#pragma once
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "supple/base/error.h"
#include "supple/mesh/surface.h"
#include "supple/mesh/volume_mesh.h"

namespace supple_test {

/// Runs code that must throw supple::Error with a code and a message that holds some text.
template <class Code>
void expect_error(supple::ErrorCode code, const std::string& text, Code run) {
    try {
        run();
        ADD_FAILURE() << "no error; expected one about \"" << text << "\"";
    } catch (const supple::Error& error) {
        EXPECT_EQ(error.code(), code) << error.what();
        EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
}

/// A closed, orientable 2-manifold: every directed edge once, its opposite once, and the triangles at a vertex form one fan.
inline bool closed_and_oriented(const supple::BoundarySurface& surface) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> opposite;  // edge (a, b) of triangle a b c: c
    std::map<std::int32_t, std::pair<std::int32_t, int>> corners;            // vertex: one neighbour, number of triangles
    for (const auto& t : surface.triangles)
        for (int i = 0; i < 3; ++i) {
            if (!opposite.emplace(std::make_pair(t[i], t[(i + 1) % 3]), t[(i + 2) % 3]).second) return false;
            auto& [neighbour, count] = corners[t[i]];
            neighbour = t[(i + 1) % 3];
            ++count;
        }
    for (const auto& [edge, vertex] : opposite)
        if (opposite.count({edge.second, edge.first}) == 0) return false;
    for (const auto& [vertex, corner] : corners) {
        std::int32_t w = corner.first;
        int steps = 0;
        do {
            w = opposite.at({vertex, w});
            ++steps;
        } while (w != corner.first);
        if (steps != corner.second) return false;
    }
    return !corners.empty();
}

/// Volume by the divergence theorem: positive if the triangles face outward.
inline double enclosed_volume(const supple::BoundarySurface& surface, const supple::VolumeMesh& mesh) {
    double six_v = 0;
    for (const auto& t : surface.triangles) six_v += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
    return six_v / 6;
}

inline double sum_of_tets(const supple::VolumeMesh& mesh) {
    double v = 0;
    for (const auto& t : mesh.tets)
        v += supple::tet_volume(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], mesh.vertices[t[3]]);
    return v;
}

/// Repeatable pseudo-random numbers in [0, 1), the same with every standard library.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15ULL + 1) {}
    double operator()() {
        state_ ^= state_ >> 12;
        state_ ^= state_ << 25;
        state_ ^= state_ >> 27;
        return static_cast<double>((state_ * 0x2545f4914f6cdd1dULL) >> 11) / 9007199254740992.0;
    }
    supple::Vec3 vec() {
        const double x = (*this)(), y = (*this)(), z = (*this)();
        return {2 * x - 1, 2 * y - 1, 2 * z - 1};
    }

private:
    std::uint64_t state_;
};

/// Directory of the shared reference data, or empty where it is absent.
inline std::filesystem::path shared_data() {
    const char* set = std::getenv("SUPPLE_SHARED");
    const std::filesystem::path path = set ? std::filesystem::path(set) : std::filesystem::path(SUPPLE_SOURCE_DIR).parent_path() / "shared";
    return std::filesystem::is_directory(path) ? path : std::filesystem::path();
}

}  // namespace supple_test
