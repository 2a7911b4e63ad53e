#include "meshes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "random.h"
#include "supple/mesh/box_mesh.h"

namespace supple::verify {

VolumeMesh mapped_box(Kind kind, std::array<int, 3> cells, const Map& map) {
    const BoxDef def{.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = cells};
    VolumeMesh mesh = kind == Kind::tets ? make_tet_box(def) : make_hex_box(def);
    for (Vec3& x : mesh.vertices) x = map(x);
    return mesh;
}

VolumeMesh box(Kind kind, std::array<int, 3> cells, const Vec3& size) {
    return mapped_box(kind, cells, [&](const Vec3& s) { return Vec3(s.cwiseProduct(size)); });
}

VolumeMesh crossed_box(std::array<int, 2> cells, const Vec3& size) {
    VolumeMesh mesh;
    const auto [nx, ny] = cells;
    const auto add = [&](double x, double y) {  // a column of two vertices: 2 k at the bottom, 2 k + 1 above it
        for (const double z : {0.0, size.z()}) mesh.vertices.push_back(Vec3(size.x() * x / nx, size.y() * y / ny, z));
    };
    for (int i = 0; i <= nx; ++i)
        for (int j = 0; j <= ny; ++j) add(i, j);
    const auto corner = [&, ny = ny](int i, int j) { return std::int32_t(i * (ny + 1) + j); };
    for (int i = 0; i < nx; ++i) {
        for (int j = 0; j < ny; ++j) {
            const auto middle = std::int32_t(mesh.vertices.size() / 2);
            add(i + 0.5, j + 0.5);
            const std::array<std::int32_t, 4> around{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
            for (std::size_t k = 0; k < 4; ++k) {
                // Prisms over sorted columns share the diagonals of their faces.
                const std::int32_t a = std::min(around[k], around[(k + 1) % 4]), b = std::max(around[k], around[(k + 1) % 4]), c = middle;
                for (Tet tet : {Tet{2 * a, 2 * b, 2 * c, 2 * c + 1}, Tet{2 * a, 2 * b, 2 * b + 1, 2 * c + 1}, Tet{2 * a, 2 * a + 1, 2 * b + 1, 2 * c + 1}}) {
                    const auto at = [&](std::size_t n) { return mesh.vertices[std::size_t(tet[n])]; };
                    if ((at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) < 0) std::swap(tet[2], tet[3]);
                    mesh.tets.push_back(tet);
                }
            }
        }
    }
    return mesh;
}

VolumeMesh welded(const std::vector<VolumeMesh>& patches) {
    double size = 0;
    for (const VolumeMesh& patch : patches)
        for (const Vec3& x : patch.vertices) size = std::max(size, x.cwiseAbs().maxCoeff());
    const double tolerance = 1e-9 * size;
    VolumeMesh all;
    std::map<std::array<long long, 3>, std::int32_t> place;
    for (const VolumeMesh& patch : patches) {
        std::vector<std::int32_t> number;
        for (const Vec3& x : patch.vertices) {
            std::array<long long, 3> cell;
            for (int k = 0; k < 3; ++k) cell[std::size_t(k)] = std::llround(x[k] / tolerance / 16 + 0.25);  // the offset keeps symmetry planes off the edges
            const auto [it, added] = place.emplace(cell, std::int32_t(all.vertices.size()));
            if (added) all.vertices.push_back(x);
            number.push_back(it->second);
        }
        for (Tet tet : patch.tets) {
            for (auto& v : tet) v = number[std::size_t(v)];
            all.tets.push_back(tet);
        }
        for (Hex hex : patch.hexes) {
            for (auto& v : hex) v = number[std::size_t(v)];
            all.hexes.push_back(hex);
        }
    }
    return all;
}

VolumeMesh shell_octant(Kind kind, int n, int layers, double inner_m, double outer_m) {
    std::vector<VolumeMesh> patches;
    for (int axis = 0; axis < 3; ++axis) {
        // From the corner on this axis to the middle of the octant.
        const Vec3 e0 = Vec3::Unit(axis), e1 = Vec3::Unit((axis + 1) % 3), e2 = Vec3::Unit((axis + 2) % 3);
        patches.push_back(mapped_box(kind, {n, n, layers}, [&](const Vec3& s) {
            // Equal angles along the edges of the face of a cube.
            const double a = std::tan(s.x() * M_PI / 4), b = std::tan(s.y() * M_PI / 4);
            return Vec3((inner_m + s.z() * (outer_m - inner_m)) * (e0 + a * e1 + b * e2).normalized());
        }));
    }
    return welded(patches);
}

VolumeMesh quarter_tube(Kind kind, int n, int layers, int along, double inner_m, double outer_m, double height_m) {
    return mapped_box(kind, {layers, n, along}, [=](const Vec3& s) {
        const double r = inner_m + s.x() * (outer_m - inner_m), a = s.y() * M_PI / 2;
        return Vec3(r * std::cos(a), r * std::sin(a), s.z() * height_m);
    });
}

VolumeMesh cylinder(Kind kind, int n, int along, double radius_m, double height_m) {
    // The core is a square whose sides bulge; a side's patch runs from it to the circle. Points on the sides are ordered along +x or +y for all, so that the
    // tets of neighbouring patches cut their common faces alike.
    const auto core = [=](double u, double v) {  // u, v in [-1, 1]
        const double half = 0.45 * radius_m, bulge = 0.15;
        return Vec3(half * u * (1 + bulge * (1 - v * v)), half * v * (1 + bulge * (1 - u * u)), 0);
    };
    std::vector<VolumeMesh> patches{mapped_box(kind, {n, n, along}, [&](const Vec3& s) { return Vec3(core(2 * s.x() - 1, 2 * s.y() - 1) + Vec3(0, 0, s.z() * height_m)); })};
    for (const bool vertical : {false, true}) {
        for (const double side : {-1.0, 1.0}) {
            patches.push_back(mapped_box(kind, {n, n, along}, [&](const Vec3& s) {
                const double w = 2 * s.y() - 1, angle = w * M_PI / 4;
                const Vec3 inner = vertical ? core(w, side) : core(side, w);
                const Vec3 outer = radius_m * (vertical ? Vec3(std::sin(angle), side * std::cos(angle), 0) : Vec3(side * std::cos(angle), std::sin(angle), 0));
                return Vec3(inner + s.x() * (outer - inner) + Vec3(0, 0, s.z() * height_m));
            }));
        }
    }
    return welded(patches);
}

VolumeMesh irregular_cube(Kind kind, int cells, double shake, std::uint64_t seed) {
    VolumeMesh mesh = box(kind, {cells, cells, cells}, Vec3::Ones());
    Random random(seed);
    for (Vec3& x : mesh.vertices) {
        const Vec3 d = random.vector(shake / cells);
        if (x.minCoeff() > 1e-9 && x.maxCoeff() < 1 - 1e-9) x += d;
    }
    return mesh;
}

double graded(double s, double ratio) { return ratio == 1 ? s : (std::pow(ratio, s) - 1) / (ratio - 1); }

}  // namespace supple::verify
