#pragma once
// Bodies and numbers that the tests of the core rooms share.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "supple/mesh/box_mesh.h"
#include "supple/world/body_template.h"
#include "supple/world/world.h"

namespace supple::test {

/// The same numbers on every machine: the standard's distributions may differ, splitmix64 does not.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    double uniform(double low, double high) {
        state_ += 0x9e3779b97f4a7c15ULL;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        z ^= z >> 31;
        return low + (high - low) * (double(z >> 11) * 0x1p-53);
    }
    Vec3 vector(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
    Mat3 matrix(double size) {
        Mat3 A;
        for (int i = 0; i < 9; ++i) A(i / 3, i % 3) = uniform(-size, size);
        return A;
    }
    /// Uniform over the rotations.
    Eigen::Quaterniond quaternion() {
        for (;;) {
            const Eigen::Vector4d q(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
            const double n = q.norm();
            if (n > 0.1 && n < 1) return {q[0] / n, q[1] / n, q[2] / n, q[3] / n};
        }
    }
    Mat3 rotation() { return quaternion().toRotationMatrix(); }

private:
    std::uint64_t state_;
};

/// The bar of the common workload, 0.4 x 0.1 x 0.1 m along x; 16 x 4 x 4 cells are 1,536 tets.
inline std::shared_ptr<const BodyTemplate> bar(std::array<int, 3> cells = {16, 4, 4}) {
    return BodyTemplate::build(make_tet_box({.min_m = Vec3::Zero(), .max_m = {0.4, 0.1, 0.1}, .cells = cells}));
}

/// The same bar of hexahedra.
inline std::shared_ptr<const BodyTemplate> hex_bar(std::array<int, 3> cells = {16, 4, 4}) {
    return BodyTemplate::build(make_hex_box({.min_m = Vec3::Zero(), .max_m = {0.4, 0.1, 0.1}, .cells = cells}));
}

/// A unit cube of hexahedra whose inner vertices are shaken by up to `shake` of a cell: no two alike.
inline std::shared_ptr<const BodyTemplate> irregular_hex_cube(int cells, double shake, std::uint64_t seed) {
    VolumeMesh mesh = make_hex_box({.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {cells, cells, cells}});
    Random random(seed);
    for (Vec3& x : mesh.vertices) {
        const Vec3 d = random.vector(shake / cells);
        if (x.minCoeff() > 1e-9 && x.maxCoeff() < 1 - 1e-9) x += d;
    }
    return BodyTemplate::build(std::move(mesh));
}

inline std::shared_ptr<const BodyTemplate> cube(int cells, double size_m = 1) {
    return BodyTemplate::build(make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3::Constant(size_m), .cells = {cells, cells, cells}}));
}

/// A box whose inner vertices are shaken by up to `shake` of a cell: no two tets alike.
inline std::shared_ptr<const BodyTemplate> irregular_cube(int cells, double shake, std::uint64_t seed) {
    VolumeMesh mesh = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {cells, cells, cells}});
    Random random(seed);
    for (Vec3& x : mesh.vertices) {
        const Vec3 d = random.vector(shake / cells);
        if (x.minCoeff() > 1e-9 && x.maxCoeff() < 1 - 1e-9) x += d;
    }
    return BodyTemplate::build(std::move(mesh));
}

inline std::shared_ptr<const BodyTemplate> one_tet(const std::array<Vec3, 4>& x) {
    VolumeMesh mesh;
    mesh.vertices.assign(x.begin(), x.end());
    mesh.tets = {{0, 1, 2, 3}};
    return BodyTemplate::build(std::move(mesh));
}

/// The tetrahedron whose deformation gradient is the matrix of its three edges.
inline std::shared_ptr<const BodyTemplate> unit_tet() {
    return one_tet({Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()});
}

inline std::array<Vec3, 4> unit_tet_at(const Mat3& F, const Vec3& origin = Vec3::Zero()) {
    return {origin, origin + F.col(0), origin + F.col(1), origin + F.col(2)};
}

inline InsideBox at_x(double x_m) { return {{x_m - 1e-9, -1e9, -1e9}, {x_m + 1e-9, 1e9, 1e9}}; }

/// max |a - b| / max |b|
inline double relative_difference(std::span<const Vec3> a, std::span<const Vec3> b) {
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
        difference = std::max(difference, (a[i] - b[i]).cwiseAbs().maxCoeff());
        size = std::max(size, b[i].cwiseAbs().maxCoeff());
    }
    return a.size() != b.size() ? HUGE_VAL : size > 0 ? difference / size : difference;
}

inline std::vector<Vec3> copy(std::span<const Vec3> field) { return {field.begin(), field.end()}; }

inline bool all_finite(std::span<const Vec3> field) {
    return std::all_of(field.begin(), field.end(), [](const Vec3& v) { return v.allFinite(); });
}

inline double total_mass(const World& world, BodyId body) {
    double sum = 0;
    for (const double m : world.masses(body)) sum += m;
    return sum;
}

inline Vec3 momentum(const World& world, BodyId body) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < world.masses(body).size(); ++i) sum += world.masses(body)[i] * world.velocities(body)[i];
    return sum;
}

/// Steps until nothing moves faster than `speed_m_s`; false after `limit` steps.
inline bool run_to_rest(World& world, double speed_m_s, int limit) {
    for (int i = 0; i < limit; ++i) {
        world.step();
        double fastest = 0;
        for (const BodyId body : world.bodies())
            for (const Vec3& v : world.velocities(body)) fastest = std::max(fastest, v.norm());
        if (fastest < speed_m_s) return true;
    }
    return false;
}

/// Mean position of the selected vertices: the tip of a bar.
inline Vec3 mean_position(const World& world, BodyId body, const Selection& where) {
    Vec3 sum = Vec3::Zero();
    const auto vertices = select_vertices(world.shape(body).mesh(), where);
    for (const std::int32_t v : vertices) sum += world.positions(body)[std::size_t(v)];
    return sum / double(vertices.size());
}

}  // namespace supple::test
