// Over a triangle whose corners lie on a smooth surface the gap to that surface is a quadratic polynomial to leading order, which the mean of its values at the middles
// of the three edges integrates exactly. A corner is lifted by the mean gap of its triangles: the volume under the lifted triangles is then that under the surface.
#include "supple/mesh/boundary_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "supple/mesh/quality.h"
#include "supple/mesh/surface.h"

namespace supple {
namespace {

constexpr double kWorstMin_deg = 8.9, kWorstMax_deg = 158.8;
constexpr double kFarthest = 0.1;     // edges: a lift
constexpr double kDeepest = 0.3;      // edges: a gap that still is that of a smooth surface, not of a hole
constexpr double kSharp = 0.25;       // cosine: the surface turns by more between two corners at a sharp edge
constexpr std::size_t kGrain = 128;

double least_margin(const VolumeMesh& mesh, const Tet& t) {
    const TetQuality q = tet_quality(mesh.vertices[std::size_t(t[0])], mesh.vertices[std::size_t(t[1])], mesh.vertices[std::size_t(t[2])], mesh.vertices[std::size_t(t[3])]);
    return std::min(q.min_dihedral_deg - kWorstMin_deg, kWorstMax_deg - q.max_dihedral_deg);
}

}  // namespace

std::size_t fit_boundary(VolumeMesh& mesh, const SolidRegion& region, const mesh::TriangleMesh& surface, double edge_m, Team& team) {
    const std::vector<Triangle> triangles = extract_boundary(mesh).triangles;
    std::vector<std::array<std::int32_t, 2>> edges;
    for (const Triangle& t : triangles)
        for (std::size_t k = 0; k < 3; ++k)
            if (t[k] < t[(k + 1) % 3]) edges.push_back({t[k], t[(k + 1) % 3]});
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

    // Normals of the surface under the corners; zero where it is far, as in a hole.
    std::vector<std::int32_t> corners;
    for (const auto& e : edges) corners.insert(corners.end(), e.begin(), e.end());
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    std::vector<Vec3> normal(mesh.vertices.size(), Vec3::Zero());
    team.for_range(corners.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto v = std::size_t(corners[i]);
            const NearestPoint near = region.tree().nearest(mesh.vertices[v], 0.05 * edge_m);
            if (near.triangle < 0) continue;
            const Triangle& t = surface.triangles[std::size_t(near.triangle)];
            const Vec3 &a = surface.vertices[std::size_t(t[0])], &b = surface.vertices[std::size_t(t[1])], &c = surface.vertices[std::size_t(t[2])];
            normal[v] = (b - a).cross(c - a).normalized();
        }
    });
    std::vector<double> gap(edges.size(), 0);
    team.for_range(edges.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto a = std::size_t(edges[i][0]), b = std::size_t(edges[i][1]);
            if (normal[a].isZero() || normal[b].isZero() || normal[a].dot(normal[b]) < kSharp) continue;
            const double d = region.signed_distance(0.5 * (mesh.vertices[a] + mesh.vertices[b]), edge_m);
            if (std::abs(d) < kDeepest * edge_m) gap[i] = -d;
        }
    });
    const auto gap_of = [&](std::int32_t a, std::int32_t b) {
        const std::array<std::int32_t, 2> e{std::min(a, b), std::max(a, b)};
        return gap[std::size_t(std::lower_bound(edges.begin(), edges.end(), e) - edges.begin())];
    };
    std::vector<double> volume(mesh.vertices.size(), 0);            // between surface and triangles, a third per corner
    std::vector<Vec3> area(mesh.vertices.size(), Vec3::Zero());
    for (const Triangle& t : triangles) {
        const Vec3 &a = mesh.vertices[std::size_t(t[0])], &b = mesh.vertices[std::size_t(t[1])], &c = mesh.vertices[std::size_t(t[2])];
        const Vec3 A = 0.5 * (b - a).cross(c - a);
        const double mean = (gap_of(t[0], t[1]) + gap_of(t[1], t[2]) + gap_of(t[2], t[0])) / 3;
        for (const std::int32_t v : t) {
            area[std::size_t(v)] += A;
            volume[std::size_t(v)] += mean * A.norm();
        }
    }
    std::map<std::int32_t, Vec3> before;  // of the vertices that moved, ascending
    for (const std::int32_t v : corners) {
        const double A = area[std::size_t(v)].norm();
        if (volume[std::size_t(v)] == 0 || !(A > 0)) continue;
        // Along the normal n, lifting a corner by s adds s n . area / 3: n . area is less than the sum of the areas where the boundary is bent.
        const double lift = std::clamp(volume[std::size_t(v)] / A, -kFarthest * edge_m, kFarthest * edge_m);
        before.emplace(v, mesh.vertices[std::size_t(v)]);
        mesh.vertices[std::size_t(v)] += lift / A * area[std::size_t(v)];
    }
    // Tets that would be worse than the lattice promises take their corners back; that can only spoil others, so until none is left.
    for (bool again = true; again && !before.empty();) {
        again = false;
        std::vector<char> bad(mesh.tets.size(), 0);
        team.for_range(mesh.tets.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) bad[t] = least_margin(mesh, mesh.tets[t]) < 0;
        });
        for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
            if (bad[t] == 0) continue;
            for (const std::int32_t v : mesh.tets[t]) {
                const auto it = before.find(v);
                if (it == before.end()) continue;
                mesh.vertices[std::size_t(v)] = it->second;
                before.erase(it);
                again = true;
            }
        }
    }
    return before.size();
}

}  // namespace supple
