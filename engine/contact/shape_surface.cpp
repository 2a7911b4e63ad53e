#include "supple/contact/shape_surface.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "supple/contact/distance_grid.h"

namespace supple::contact {

namespace {

constexpr int kSides = 48, kRings = 12;

/// A body of revolution about y: rings of (radius, y) from the bottom to the top; the first and last have radius 0. A ring given twice makes a crisp edge.
ShapeSurface turned(const std::vector<std::array<double, 2>>& rings) {
    ShapeSurface s;
    for (const auto& ring : rings) {
        for (int k = 0; k < kSides; ++k) {
            const double turn = 2 * std::numbers::pi * k / kSides;
            s.vertices.push_back({ring[0] * std::sin(turn), ring[1], ring[0] * std::cos(turn)});
        }
    }
    for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
        for (int k = 0; k < kSides; ++k) {
            const auto a = std::int32_t(r) * kSides + k, b = std::int32_t(r) * kSides + (k + 1) % kSides;
            if (rings[r][0] > 0) s.triangles.push_back({a, b, a + kSides});
            if (rings[r + 1][0] > 0) s.triangles.push_back({b, b + kSides, a + kSides});
        }
    }
    return s;
}

/// Rings of half a sphere, around (0, y).
void add_cap(std::vector<std::array<double, 2>>& rings, double radius, double y, bool upper) {
    for (int r = 0; r <= kRings; ++r) {
        const double polar = std::numbers::pi / 2 * (upper ? r : r - kRings) / kRings;
        const bool pole = r == (upper ? kRings : 0);
        rings.push_back({pole ? 0.0 : radius * std::cos(polar), y + radius * std::sin(polar)});
    }
}

struct SurfaceOf {
    double plane_m;
    const Vec3& about;

    ShapeSurface operator()(const PlaneShape& s) const {
        const Vec3 middle = about - (s.normal.dot(about) - s.offset_m) * s.normal;
        const Vec3 u = plane_m * s.normal.unitOrthogonal(), v = s.normal.cross(u);
        return {{middle - u - v, middle + u - v, middle + u + v, middle - u + v}, {{0, 1, 2}, {0, 2, 3}}};
    }
    ShapeSurface operator()(const SphereShape& s) const { return (*this)(CapsuleShape{s.radius_m, 0}); }
    ShapeSurface operator()(const CapsuleShape& s) const {
        std::vector<std::array<double, 2>> rings;
        add_cap(rings, s.radius_m, -s.half_length_m, false);
        if (!(s.half_length_m > 0)) rings.pop_back();
        add_cap(rings, s.radius_m, s.half_length_m, true);
        return turned(rings);
    }
    ShapeSurface operator()(const BoxShape& s) const {
        ShapeSurface box;
        for (int i = 0; i < 8; ++i) {
            box.vertices.push_back(Vec3(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0).cwiseProduct(s.half_extents_m));
        }
        box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
        return box;
    }
    ShapeSurface operator()(const CylinderShape& s) const {
        const double r = s.radius_m, l = s.half_length_m;
        return turned({{0, -l}, {r, -l}, {r, l}, {0, l}});
    }
    ShapeSurface operator()(const MeshShape& s) const { return {s.grid->vertices(), s.grid->triangles()}; }
};

}  // namespace

ShapeSurface surface_of(const Shape& shape, double plane_m, const Vec3& about) { return std::visit(SurfaceOf{plane_m, about}, shape); }

}  // namespace supple::contact
