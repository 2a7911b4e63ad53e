#include "drawn_shapes.h"

#include <Eigen/Geometry>
#include <cmath>

namespace supple::demos {
namespace {

constexpr int kSides = 16;

}  // namespace

void DrawnShapes::tube(std::span<const Vec3> way, std::span<const double> radius_m, const std::array<float, 3>& color, Look look) {
    mesh::TriangleMesh mesh;
    const std::size_t n = way.size();
    Vec3 side = (way[1] - way[0]).unitOrthogonal();
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3 along = (way[std::min(i + 1, n - 1)] - way[i == 0 ? 0 : i - 1]).normalized();
        side = (side - side.dot(along) * along).normalized();  // carried along without a twist
        const Vec3 other = along.cross(side);
        const double radius = radius_m[std::min(i, radius_m.size() - 1)];
        for (int k = 0; k < kSides; ++k) {
            const double angle = 2 * M_PI * k / kSides;
            mesh.vertices.push_back(way[i] + radius * (std::cos(angle) * side + std::sin(angle) * other));
        }
    }
    for (std::int32_t i = 0; i + 1 < std::int32_t(n); ++i)
        for (std::int32_t k = 0; k < kSides; ++k) {
            const std::int32_t a = i * kSides + k, b = i * kSides + (k + 1) % kSides;
            mesh.triangles.push_back({a, b, a + kSides});
            mesh.triangles.push_back({b, b + kSides, a + kSides});
        }
    const auto first = std::int32_t(mesh.vertices.size()), last = std::int32_t(n - 1) * kSides;
    mesh.vertices.push_back(way.front());
    mesh.vertices.push_back(way.back());
    for (std::int32_t k = 0; k < kSides; ++k) {
        mesh.triangles.push_back({first, (k + 1) % kSides, k});
        mesh.triangles.push_back({first + 1, last + k, last + (k + 1) % kSides});
    }
    surface(std::move(mesh), color, look);
}

void DrawnShapes::surface(mesh::TriangleMesh surface, const std::array<float, 3>& color, Look look, double opacity) {
    shapes_.push_back({std::move(surface), color, look, opacity});
}

void DrawnShapes::add_to(FrameView& view) const {
    for (const Drawn& drawn : shapes_) {
        SurfaceView surface;
        surface.positions = drawn.mesh.vertices;
        surface.triangles = drawn.mesh.triangles;
        surface.look = drawn.look;
        surface.color = drawn.color;
        surface.opacity = drawn.opacity;
        view.surfaces.push_back(surface);
    }
}

mesh::TriangleMesh thick_strip(std::span<const Vec3> a, std::span<const Vec3> b, double thickness_m) {
    mesh::TriangleMesh mesh;
    const auto n = std::int32_t(a.size());
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 0; i + 1 < a.size(); ++i) normal += (a[i + 1] - a[i]).cross(b[i] - a[i]) + (b[i + 1] - b[i]).cross(b[i + 1] - a[i + 1]);
    normal = normal.norm() > 0 ? Vec3(normal.normalized()) : (b[0] - a[0]).unitOrthogonal();
    for (const double side : {-0.5, 0.5})
        for (const auto& line : {a, b})
            for (const Vec3& p : line) mesh.vertices.push_back(p + side * thickness_m * normal);
    const auto quad = [&](std::int32_t p, std::int32_t q, std::int32_t r, std::int32_t s) {
        mesh.triangles.push_back({p, q, r});
        mesh.triangles.push_back({p, r, s});
    };
    for (std::int32_t i = 0; i + 1 < n; ++i) {
        quad(i, n + i, n + i + 1, i + 1);                          // the lower face, seen from below
        quad(2 * n + i, 2 * n + i + 1, 3 * n + i + 1, 3 * n + i);  // the upper one
        quad(i, i + 1, 2 * n + i + 1, 2 * n + i);
        quad(n + i + 1, n + i, 3 * n + i, 3 * n + i + 1);
    }
    quad(0, 2 * n, 3 * n, n);
    quad(n - 1, 2 * n - 1, 4 * n - 1, 3 * n - 1);
    return mesh;
}

}  // namespace supple::demos
