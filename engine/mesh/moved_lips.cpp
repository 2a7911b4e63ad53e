#include "supple/mesh/moved_lips.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>

#include "supple/mesh/opened_surface.h"
#include "supple/mesh/topology.h"

namespace supple::mesh {

namespace {

constexpr double kApart = 1e-5;  // of the mean edge at the place

}  // namespace

MovedLips::MovedLips(const VolumeMesh& mesh) : x(mesh.vertices), on_lip(mesh.vertices.size(), 0) {
    std::vector<std::int32_t> order(x.size());
    std::iota(order.begin(), order.end(), 0);
    const auto at = [&](std::int32_t v) -> const Vec3& { return mesh.vertices[std::size_t(v)]; };
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        for (Eigen::Index k = 0; k < 3; ++k)
            if (at(a)[k] != at(b)[k]) return at(a)[k] < at(b)[k];
        return a < b;
    });
    std::vector<std::int32_t> place(x.size());  // [vertex] the first one there
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && at(order[i]) == at(order[i - 1]);
        place[std::size_t(order[i])] = same ? place[std::size_t(order[i - 1])] : order[i];
        if (same) on_lip[std::size_t(order[i])] = on_lip[std::size_t(place[std::size_t(order[i])])] = 1, any = true;
    }
    if (!any) return;
    std::map<FaceKey, FaceKey> face_at;  // [places] vertices of the first face there
    for (std::size_t e = 0; e < mesh.element_count(); ++e) {
        const auto ids = element_vertices(mesh, e);
        if (std::none_of(ids.begin(), ids.end(), [&](std::int32_t v) { return on_lip[std::size_t(v)] != 0; })) continue;
        const auto look = [&](const auto& face) {
            FaceKey by_vertex{-1, -1, -1, -1}, by_place = by_vertex;
            for (std::size_t k = 0; k < face.size(); ++k) {
                by_vertex[k] = ids[std::size_t(face[k])];
                by_place[k] = place[std::size_t(by_vertex[k])];
            }
            by_vertex = ascending(by_vertex, face.size());
            const auto [known, is_new] = face_at.try_emplace(ascending(by_place, face.size()), by_vertex);
            if (!is_new && known->second != by_vertex) lip_faces.insert({by_vertex, known->second});
        };
        if (ids.size() == 4) std::for_each(kTetFaces.begin(), kTetFaces.end(), look);
        else std::for_each(kHexFaces.begin(), kHexFaces.end(), look);
    }
    // Away from the other lip, within the planes of what else is there: a skin on flat sides stays on them.
    struct Around {
        Vec3 normal = Vec3::Zero();
        std::vector<Vec3> sides;
        double edge = 0;
    };
    std::map<std::int32_t, Around> around;
    const BoundarySurface boundary = extract_boundary(mesh);
    for (std::size_t b = 0; b < boundary.triangles.size(); ++b) {
        const Triangle& t = boundary.triangles[b];
        if (!on_lip[std::size_t(t[0])] && !on_lip[std::size_t(t[1])] && !on_lip[std::size_t(t[2])]) continue;
        const bool lip = is_lip(mesh, boundary.element[b], t);
        const Vec3 n = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).normalized();
        for (std::size_t k = 0; k < 3; ++k) {
            if (!on_lip[std::size_t(t[k])]) continue;
            Around& a = around[t[k]];
            if (lip) a.normal += n;
            else a.sides.push_back(n);
            a.edge = std::max(a.edge, (at(t[(k + 1) % 3]) - at(t[k])).norm());
        }
    }
    for (const auto& [v, a] : around) {
        Vec3 inward = -a.normal;
        std::vector<Vec3> axes;
        for (Vec3 side : a.sides) {
            for (const Vec3& other : axes) side -= other.dot(side) * other;
            if (side.norm() > 1e-3 && axes.size() < 2) axes.push_back(side.normalized());
        }
        for (const Vec3& axis : axes) inward -= axis.dot(inward) * axis;
        if (inward.norm() < 0.05) inward = -a.normal;
        if (inward.norm() > 0) x[std::size_t(v)] += kApart * a.edge * inward.normalized();
    }
}

bool MovedLips::is_lip(const VolumeMesh& mesh, std::int32_t element, const Triangle& t) const {
    const auto corners = face_corners(mesh, element, t);
    FaceKey key{-1, -1, -1, -1};
    std::copy(corners.begin(), corners.end(), key.begin());
    return lip_faces.contains(ascending(key, corners.size()));
}

MovedLips::MovedLips(const MovedLips& before, const MeshEdit& edit) : x(edit.mesh.vertices), on_lip(x.size(), 0), any(before.any) {
    for (std::size_t v = 0; v < x.size() && any; ++v) {
        const VertexParents& p = edit.delta.vertex_parents[v];
        bool some = false;
        Vec3 sum = Vec3::Zero();
        for (std::size_t k = 0; k < 4 && p.vertex[k] >= 0; ++k) {
            const bool lip = before.on_lip[std::size_t(p.vertex[k])] != 0;
            some = some || lip;
            sum += p.weight[k] * before.x[std::size_t(p.vertex[k])];
        }
        if (!some) continue;
        x[v] = sum;
        on_lip[v] = 1;
    }
}

}  // namespace supple::mesh
