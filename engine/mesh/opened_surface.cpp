#include "supple/mesh/opened_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "supple/mesh/edit_draft.h"
#include "supple/mesh/topology.h"

namespace supple::mesh {

namespace {

struct Lexicographic {
    bool operator()(const Vec3& a, const Vec3& b) const { return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3); }
};

}  // namespace

std::vector<std::int32_t> face_corners(const VolumeMesh& mesh, std::int32_t element, const Triangle& t) {
    const auto ids = element_vertices(mesh, std::size_t(element));
    const auto try_face = [&](const auto& face) {
        std::vector<std::int32_t> corners;
        for (const int a : face) corners.push_back(ids[std::size_t(a)]);
        const bool all = std::all_of(t.begin(), t.end(), [&](std::int32_t v) { return std::find(corners.begin(), corners.end(), v) != corners.end(); });
        return all ? corners : std::vector<std::int32_t>{};
    };
    if (ids.size() == 4) {
        for (const auto& face : kTetFaces)
            if (auto found = try_face(face); !found.empty()) return found;
    } else {
        for (const auto& face : kHexFaces)
            if (auto found = try_face(face); !found.empty()) return found;
    }
    return {};
}

OpenedSurface opened_surface(const MeshEdit& edit, const BoundarySurface& boundary, std::span<const std::int32_t> parent, std::span<const Vec3> x, std::span<const char> on_lip,
                             const std::function<double(const Vec3& at, double edge)>& height) {
    const VolumeMesh& mesh = edit.mesh;
    const auto count = std::int32_t(mesh.vertices.size());
    OpenedSurface out;
    std::map<Vec3, std::int32_t, Lexicographic> at;  // copies of a vertex lie at the very same place
    std::map<std::int32_t, std::int32_t> place;      // [vertex of an opened face] vertex of the surface
    const auto placed = [&](std::int32_t v) {
        const auto [known, is_new] = at.try_emplace(x[std::size_t(v)], std::int32_t(out.surface.vertices.size()));
        if (is_new) out.surface.vertices.push_back(x[std::size_t(v)]);
        place.emplace(v, known->second);
        return known->second;
    };
    struct Known {
        std::int32_t element;
        std::vector<std::size_t> triangles;
    };
    std::map<FaceKey, Known> faces;
    std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> edge_of_lip;  // [directed edge of a first lip] its triangle
    double length = 0;
    for (std::size_t b = 0; b < parent.size(); ++b) {
        if (parent[b] >= 0) continue;
        const Triangle& t = boundary.triangles[b];
        const std::int32_t element = boundary.element[b];
        const std::vector<std::int32_t> corners = face_corners(mesh, element, t);
        FaceKey key{-1, -1, -1, -1};
        for (std::size_t k = 0; k < corners.size(); ++k) key[k] = placed(corners[k]);
        key = ascending(key, corners.size());
        const auto [known, is_new] = faces.try_emplace(key, Known{element, {}});
        if (!is_new && known->second.element != element) {  // the other lip, whichever diagonal it is drawn with
            for (const std::size_t c : known->second.triangles)
                for (std::size_t k = 0; k < 3; ++k)
                    for (const std::int32_t v : corners)
                        if (place.at(v) == out.surface.triangles[c][k]) {
                            out.lips[c][1].element = element;
                            out.lips[c][1].vertex[k] = v;
                        }
            continue;
        }
        known->second.triangles.push_back(out.surface.triangles.size());
        for (std::size_t k = 0; k < 3; ++k) {
            edge_of_lip[{t[k], t[(k + 1) % 3]}] = out.surface.triangles.size();
            length += (x[std::size_t(t[k])] - x[std::size_t(t[(k + 1) % 3])]).norm();
        }
        out.surface.triangles.push_back({place.at(t[0]), place.at(t[1]), place.at(t[2])});
        out.lips.push_back({OpenedSurface::Lip{element, t}, OpenedSurface::Lip{}});
    }
    out.faces = out.surface.triangles.size();
    if (out.faces == 0) return out;
    out.size = length / double(3 * out.faces);
    // Walls stand on the edges that first lips have in common with what was the boundary before, along its normals there.
    std::map<std::int32_t, Vec3> normal;  // [vertex of the surface]
    struct Rim {
        std::int32_t a, b;  // of the mesh, as the lip's triangle runs
        std::size_t triangle;
    };
    std::vector<Rim> rims;
    for (std::size_t b = 0; b < parent.size(); ++b) {
        if (parent[b] < 0 || on_lip[b]) continue;  // what lies on a lip lies exactly there
        const Triangle& t = boundary.triangles[b];
        // Of the rest shape: a cut that goes on where an earlier one ended has the wall's edge there in common with it.
        const auto X = [&](std::size_t k) -> const Vec3& { return mesh.vertices[std::size_t(t[k % 3])]; };
        for (std::size_t k = 0; k < 3; ++k) {
            const auto found = place.find(t[k]);
            if (found == place.end()) continue;
            // By the angle there: two triangles of a quad weigh no more than one.
            const Vec3 u = (X(k + 1) - X(k)).normalized(), w = (X(k + 2) - X(k)).normalized();
            const Vec3 n = u.cross(w);
            const double sine = n.norm();
            if (sine > 0) normal.try_emplace(found->second, Vec3::Zero()).first->second += std::atan2(sine, u.dot(w)) / sine * n;
            if (const auto lip = edge_of_lip.find({t[(k + 1) % 3], t[k]}); lip != edge_of_lip.end()) rims.push_back({t[(k + 1) % 3], t[k], lip->second});
        }
    }
    std::map<std::int32_t, std::int32_t> outer;  // [vertex of the surface] the end of the wall there
    const auto end_of = [&](std::int32_t p) {
        const auto [known, is_new] = outer.try_emplace(p, std::int32_t(out.surface.vertices.size()));
        if (is_new) {
            const Vec3 foot = out.surface.vertices[std::size_t(p)];
            out.surface.vertices.push_back(foot + height(foot, out.size) * normal.try_emplace(p, Vec3::Zero()).first->second.normalized());
        }
        return known->second;
    };
    for (const Rim& rim : rims) {
        const std::int32_t u = place.at(rim.a), v = place.at(rim.b), above_u = end_of(u), above_v = end_of(v);
        const std::array<OpenedSurface::Lip, 2> lips = out.lips[rim.triangle];
        const auto add = [&](const Triangle& wall) {
            std::array<OpenedSurface::Lip, 2> of;
            for (std::size_t side = 0; side < 2; ++side) {
                if (lips[side].element < 0) continue;
                of[side].element = lips[side].element;
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::int32_t below = wall[k] == above_u ? u : wall[k] == above_v ? v : wall[k];
                    const Triangle& t = out.surface.triangles[rim.triangle];
                    const std::int32_t vertex = lips[side].vertex[std::size_t(std::find(t.begin(), t.end(), below) - t.begin())];
                    of[side].vertex[k] = below == wall[k] ? vertex : vertex + count;
                }
            }
            out.surface.triangles.push_back(wall);
            out.lips.push_back(of);
        };
        add({v, u, above_u});
        add({v, above_u, above_v});
    }
    return out;
}

}  // namespace supple::mesh
