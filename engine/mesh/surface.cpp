// Watertight ray-triangle intersection (the idea of Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection"): positions
// are taken relative to the ray's origin and sheared so that the ray becomes the z axis; the triangle is hit if the 2D origin is on
// the same side of its three edges. Two triangles that share an edge compute its side from the same two sheared points, as
// p.x q.y - p.y q.x, whose value only changes its sign when p and q are swapped (products commute and a - b = -(b - a) in floating
// point, as long as nothing is contracted into a fused multiply-add: the build sets -ffp-contract=off). So at most one of them can
// reject the point on account of that edge; points on the edge belong to both.
#include "supple/mesh/surface.h"

#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/mesh/topology.h"

namespace supple {
namespace {

void append_triangles(const Face& f, BoundarySurface& out) {
    const auto& v = f.vertices;
    if (f.corners == 3) {
        out.triangles.push_back({v[0], v[1], v[2]});
        out.element.push_back(f.element);
        return;
    }
    const int s = static_cast<int>(std::min_element(v.begin(), v.end()) - v.begin());
    const std::int32_t a = v[s], b = v[(s + 1) % 4], c = v[(s + 2) % 4], d = v[(s + 3) % 4];
    out.triangles.push_back({a, b, c});
    out.triangles.push_back({a, c, d});
    out.element.insert(out.element.end(), 2, f.element);
}

struct ShearedRay {
    int x, y, z;  ///< axes, z the direction's largest
    double shear_x, shear_y, scale_z;
    Vec3 origin;

    explicit ShearedRay(const Ray& ray) : origin(ray.origin) {
        const Vec3& d = ray.direction;
        d.cwiseAbs().maxCoeff(&z);
        x = (z + 1) % 3;
        y = (z + 2) % 3;
        shear_x = d[x] / d[z];
        shear_y = d[y] / d[z];
        scale_z = 1 / d[z];
    }

    /// (x, y) across the ray, z along it in lengths of the direction.
    Vec3 transform(const Vec3& p) const {
        const Vec3 q = p - origin;
        return {q[x] - shear_x * q[z], q[y] - shear_y * q[z], scale_z * q[z]};
    }
};

}  // namespace

BoundarySurface extract_boundary(const VolumeMesh& mesh) {
    std::vector<char> open(half_face_count(mesh), 0);
    for_each_face(mesh, [&](std::span<const HalfFace> sides) {
        if (sides.size() == 1) open[sides[0]] = 1;
    });
    std::vector<HalfFace> half_faces;
    for (HalfFace h = 0; h < open.size(); ++h)
        if (open[h]) half_faces.push_back(h);
    return boundary_of(mesh, half_faces);
}

BoundarySurface boundary_of(const VolumeMesh& mesh, std::span<const HalfFace> half_faces) {
    BoundarySurface out;
    // Edges ascending: filed under their smaller vertex, so that nothing large is sorted.
    std::vector<std::int32_t> start(mesh.vertices.size() + 1, 0);
    const auto each_edge = [&](auto&& visit) {
        for (const HalfFace h : half_faces) {
            const Face f = half_face(mesh, h);
            for (int i = 0; i < f.corners; ++i) {
                const auto [low, high] = std::minmax(f.vertices[i], f.vertices[(i + 1) % f.corners]);
                visit(std::size_t(low), high);
            }
        }
    };
    for (const HalfFace h : half_faces) append_triangles(half_face(mesh, h), out);
    each_edge([&](std::size_t low, std::int32_t) { ++start[low + 1]; });
    for (std::size_t v = 0; v + 1 < start.size(); ++v) start[v + 1] += start[v];
    std::vector<std::int32_t> high(std::size_t(start.back())), next(start.begin(), start.end() - 1);
    each_edge([&](std::size_t low, std::int32_t other) { high[std::size_t(next[low]++)] = other; });
    for (std::size_t v = 0; v + 1 < start.size(); ++v) {
        const auto first = high.begin() + start[v], last = high.begin() + start[v + 1];
        std::sort(first, last);
        std::for_each(first, std::unique(first, last), [&](std::int32_t other) { out.edges.push_back({std::int32_t(v), other}); });
    }
    return out;
}

std::optional<RayHit> intersect(const Ray& ray, std::span<const Triangle> triangles, std::span<const Vec3> positions) {
    if (!ray.direction.allFinite() || !(ray.direction.cwiseAbs().maxCoeff() >= 1e-150))
        throw Error(ErrorCode::invalid_argument, "Ray.direction", "the direction is zero or not finite; give a vector of any other length");
    if (!ray.origin.allFinite()) throw Error(ErrorCode::invalid_argument, "Ray.origin", "the origin is not finite");
    const ShearedRay sheared(ray);
    const auto count = static_cast<std::int64_t>(positions.size());
    std::optional<RayHit> best;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Triangle& t = triangles[i];
        for (const std::int32_t v : t)
            if (v < 0 || v >= count)
                throw Error(
                    ErrorCode::invalid_argument, "intersect",
                    "triangle " + std::to_string(i) + " uses vertex " + std::to_string(v) + " of " + std::to_string(count) + " positions");
        const Vec3 a = sheared.transform(positions[t[0]]), b = sheared.transform(positions[t[1]]), c = sheared.transform(positions[t[2]]);
        const double u = b.x() * c.y() - b.y() * c.x();
        const double v = c.x() * a.y() - c.y() * a.x();
        const double w = a.x() * b.y() - a.y() * b.x();
        if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) continue;
        const double det = u + v + w;
        if (!(std::abs(det) > 0)) continue;
        const double distance = (u * a.z() + v * b.z() + w * c.z()) / det;
        if (!(distance >= 0) || !std::isfinite(distance) || (best && distance >= best->distance)) continue;
        best = RayHit{static_cast<std::int32_t>(i), {u / det, v / det, w / det}, distance};
    }
    return best;
}

}  // namespace supple
