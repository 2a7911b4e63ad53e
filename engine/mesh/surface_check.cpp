#include "supple/mesh/surface_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <tuple>

#include "supple/base/disjoint_sets.h"
#include "supple/base/error.h"
#include "supple/mesh/topology.h"

namespace supple::mesh {

namespace {

struct Edge {
    std::int32_t low, high, triangle;
    bool forward;  ///< the triangle runs from low to high
    bool operator<(const Edge& o) const { return std::tie(low, high, triangle) < std::tie(o.low, o.high, o.triangle); }
};

void count_triangles(const TriangleMesh& mesh, SurfaceReport& report) {
    std::vector<Triangle> sorted;
    std::vector<char> used(mesh.vertices.size(), 0);
    bool any = false;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const double twice_area = (b - a).cross(c - a).norm();
        const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
        if (!(twice_area > 2e-12 * longest)) ++report.degenerate_triangles;
        report.area_m2 += twice_area / 2;
        for (const std::int32_t v : t) {
            used[v] = 1;
            report.min_m = any ? report.min_m.cwiseMin(mesh.vertices[v]) : mesh.vertices[v];
            report.max_m = any ? report.max_m.cwiseMax(mesh.vertices[v]) : mesh.vertices[v];
            any = true;
        }
        sorted.push_back(t);
        std::sort(sorted.back().begin(), sorted.back().end());
    }
    // From the middle of the box: far from the origin the terms would cancel.
    const Vec3 centre = 0.5 * (report.min_m + report.max_m);
    for (const Triangle& t : mesh.triangles)
        report.volume_m3 += (mesh.vertices[t[0]] - centre).dot((mesh.vertices[t[1]] - centre).cross(mesh.vertices[t[2]] - centre)) / 6;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 1; i < sorted.size(); ++i) report.duplicate_triangles += sorted[i] == sorted[i - 1];
    report.unreferenced_vertices = std::size_t(std::count(used.begin(), used.end(), 0));

    std::vector<std::array<double, 3>> positions;
    for (const Vec3& x : mesh.vertices) positions.push_back({x.x() + 0.0, x.y() + 0.0, x.z() + 0.0});
    std::sort(positions.begin(), positions.end());
    for (std::size_t i = 1; i < positions.size(); ++i) report.duplicate_vertices += positions[i] == positions[i - 1];
}

std::vector<Edge> edges_of(const TriangleMesh& mesh) {
    std::vector<Edge> edges;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int i = 0; i < 3; ++i) {
            const std::int32_t a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
            if (a != b) edges.push_back({std::min(a, b), std::max(a, b), std::int32_t(t), a < b});
        }
    std::sort(edges.begin(), edges.end());
    return edges;
}

void count_edges(const TriangleMesh& mesh, SurfaceReport& report) {
    const std::vector<Edge> edges = edges_of(mesh);
    DisjointSets parts(mesh.triangles.size());
    DisjointSets corners(3 * mesh.triangles.size());  // a triangle's corners, joined across edges: the fans of each vertex
    const auto corner = [&](std::int32_t triangle, std::int32_t v) {
        const Triangle& t = mesh.triangles[triangle];
        return std::size_t(3 * triangle + (t[0] == v ? 0 : t[1] == v ? 1 : 2));
    };
    for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
        while (next < edges.size() && edges[next].low == edges[i].low && edges[next].high == edges[i].high) ++next;
        for (std::size_t k = i + 1; k < next; ++k) {
            parts.join(std::size_t(edges[i].triangle), std::size_t(edges[k].triangle));
            for (const std::int32_t v : {edges[i].low, edges[i].high})
                corners.join(corner(edges[i].triangle, v), corner(edges[k].triangle, v));
        }
        if (next - i == 1) ++report.open_edges;
        if (next - i > 2) ++report.crowded_edges;
        if (next - i == 2 && edges[i].forward == edges[i + 1].forward) ++report.turned_edges;
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) report.components += parts.root(t) == t;
    std::vector<std::int32_t> fans(mesh.vertices.size(), 0);
    for (std::size_t c = 0; c < 3 * mesh.triangles.size(); ++c)
        if (corners.root(c) == c) ++fans[mesh.triangles[c / 3][c % 3]];
    report.pinched_vertices = std::size_t(std::count_if(fans.begin(), fans.end(), [](std::int32_t n) { return n > 1; }));
}

std::string counted(std::size_t n, const char* one, const char* many) { return std::to_string(n) + " " + (n == 1 ? one : many); }

}  // namespace

void require_sound(const TriangleMesh& mesh) {
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        if (!mesh.vertices[v].allFinite())
            throw Error(ErrorCode::invalid_argument, "TriangleMesh.vertices[" + std::to_string(v) + "]", "the position is not finite");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const std::int32_t v : mesh.triangles[t])
            if (v < 0 || std::size_t(v) >= mesh.vertices.size())
                throw Error(ErrorCode::invalid_argument, "TriangleMesh.triangles[" + std::to_string(t) + "]",
                            "vertex " + std::to_string(v) + " is outside [0, " + std::to_string(mesh.vertices.size()) + ")");
}

SurfaceReport check_surface(const TriangleMesh& mesh) {
    require_sound(mesh);
    SurfaceReport report;
    count_triangles(mesh, report);
    count_edges(mesh, report);
    return report;
}

std::vector<std::string> SurfaceReport::sentences() const {
    std::vector<std::string> out;
    if (degenerate_triangles) out.push_back(counted(degenerate_triangles, "triangle has", "triangles have") + " no area");
    if (duplicate_triangles) out.push_back(counted(duplicate_triangles, "triangle repeats", "triangles repeat") + " an earlier one");
    if (open_edges)
        out.push_back("it is open: " + counted(open_edges, "edge belongs", "edges belong") + " to one triangle alone, the rim of a hole");
    if (crowded_edges)
        out.push_back(counted(crowded_edges, "edge is", "edges are") +
                      " shared by more than two triangles: the surface is no manifold there");
    if (turned_edges)
        out.push_back(counted(turned_edges, "edge lies", "edges lie") + " between triangles that disagree about which side is outside");
    if (pinched_vertices) out.push_back("at " + counted(pinched_vertices, "vertex", "vertices") + " separate fans of triangles touch");
    if (is_closed() && volume_m3 < 0) out.push_back("its triangles face inwards: turn them round");
    if (unreferenced_vertices) out.push_back(counted(unreferenced_vertices, "vertex belongs", "vertices belong") + " to no triangle");
    if (duplicate_vertices)
        out.push_back(counted(duplicate_vertices, "vertex lies", "vertices lie") +
                      " at the very position of another: seams may look like holes");
    return out;
}

}  // namespace supple::mesh
