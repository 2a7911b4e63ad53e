// What contact knows of a body's surface from its rest shape, and where the surface is in a step.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "supple/world/body.h"

namespace supple {

namespace {

constexpr double kMargin = 0.5;   // of the mean edge: gaps that are watched
constexpr double kSharp = 0.766;  // cosine between the normals at a sharp edge: 40 degrees. Facets of a round shape turn by less

/// Edges of closed surfaces where two triangles meet in a convex ridge.
void find_sharp(std::span<const Triangle> triangles, std::span<const Vec3> X, ContactSurface& surface) {
    struct Side {
        std::array<std::int32_t, 2> vertex;
        std::int32_t triangle, corner;
    };
    std::vector<Side> sides;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
            sides.push_back({{low, high}, std::int32_t(t), std::int32_t(k)});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.vertex != b.vertex ? a.vertex < b.vertex : a.triangle < b.triangle; });
    surface.sharp_of.assign(triangles.size(), {-1, -1, -1});
    const auto point = [&](std::int32_t t, std::size_t k) -> const Vec3& { return X[std::size_t(triangles[std::size_t(t)][k % 3])]; };
    const auto normal = [&](std::int32_t t) -> Vec3 { return (point(t, 1) - point(t, 0)).cross(point(t, 2) - point(t, 0)).normalized(); };
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
        const Side &a = sides[i], &b = sides[i + 1];
        if (a.vertex != b.vertex) continue;
        const Vec3 one = normal(a.triangle), two = normal(b.triangle);
        const Vec3 across = point(b.triangle, std::size_t(b.corner) + 2) - point(b.triangle, std::size_t(b.corner));
        if (!(one.dot(two) < kSharp) || !(one.dot(across) < 0)) continue;
        surface.sharp_of[std::size_t(a.triangle)][std::size_t(a.corner)] = std::int32_t(surface.sharp.size());
        surface.sharp.push_back({a.vertex, {a.triangle, b.triangle}});
    }
}

}  // namespace

ContactSurface::ContactSurface(const TemplateData& data)
    : tree(data.boundary.triangles, data.mesh.vertices), triangle(data.mesh.vertices.size(), -1), edge_m(data.mesh.vertices.size(), 0.0), end(data.mesh.vertices) {
    std::vector<int> count(triangle.size(), 0);
    double sum = 0;
    std::size_t edges = 0;
    for (std::size_t t = 0; t < data.boundary.triangles.size(); ++t) {
        const Triangle& corner = data.boundary.triangles[t];
        for (std::size_t k = 0; k < 3; ++k) {
            const auto a = std::size_t(corner[k]), b = std::size_t(corner[(k + 1) % 3]);
            const double length = (data.mesh.vertices[a] - data.mesh.vertices[b]).norm();
            for (const std::size_t v : {a, b}) {
                edge_m[v] += length;
                ++count[v];
            }
            if (triangle[a] < 0) triangle[a] = std::int32_t(t);
            longest_edge_m = std::max(longest_edge_m, length);
            sum += length;
            ++edges;
        }
    }
    around_start.assign(triangle.size() + 1, 0);
    for (const Triangle& corner : data.boundary.triangles)
        for (const std::int32_t v : corner) ++around_start[std::size_t(v) + 1];
    for (std::size_t v = 0; v < triangle.size(); ++v) around_start[v + 1] += around_start[v];
    around.resize(std::size_t(around_start.back()));
    std::vector<std::int32_t> next(around_start.begin(), around_start.end() - 1);
    for (std::size_t t = 0; t < data.boundary.triangles.size(); ++t)
        for (const std::int32_t v : data.boundary.triangles[t]) around[std::size_t(next[std::size_t(v)]++)] = std::int32_t(t);
    for (std::size_t v = 0; v < edge_m.size(); ++v) edge_m[v] = count[v] > 0 ? edge_m[v] / count[v] : 0.0;
    mean_edge_m = edges > 0 ? sum / double(edges) : 0;
    margin_m = kMargin * mean_edge_m;
    find_sharp(data.boundary.triangles, data.mesh.vertices, *this);
}

void ContactSurface::fit(std::span<const Triangle> triangles, std::span<const Vec3> start) {
    if (fitted) return;
    fitted = true;
    tree.refit(start, end);
    normal.resize(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const Vec3& a = end[std::size_t(triangles[t][0])];
        normal[t] = (end[std::size_t(triangles[t][1])] - a).cross(end[std::size_t(triangles[t][2])] - a).normalized();
    }
}

}  // namespace supple
