#include <algorithm>
#include <cmath>
#include <map>

#include "supple/base/disjoint_sets.h"
#include "supple/mesh/mesh_edit.h"
#include "supple/mesh/surface.h"
#include "supple/mesh/topology.h"

namespace supple {

bool TopologyDelta::is_identity() const {
    if (vertex_to_new.size() != vertex_parents.size() || element_to_new.size() != element_parent.size()) return false;
    for (std::size_t v = 0; v < vertex_to_new.size(); ++v)
        if (vertex_to_new[v] != std::int32_t(v)) return false;
    for (std::size_t e = 0; e < element_to_new.size(); ++e)
        if (element_to_new[e] != std::int32_t(e)) return false;
    return true;
}

bool TopologyDelta::is_merged(std::size_t v) const {
    const VertexParents& p = vertex_parents[v];
    return p.vertex[1] >= 0 && vertex_to_new[std::size_t(p.vertex[0])] == std::int32_t(v);
}

std::vector<std::int32_t> TopologyDelta::removed_elements() const {
    std::vector<char> lives(element_to_new.size(), 0);
    for (const std::int32_t e : element_parent) lives[std::size_t(e)] = 1;
    std::vector<std::int32_t> out;
    for (std::size_t e = 0; e < lives.size(); ++e)
        if (!lives[e]) out.push_back(std::int32_t(e));
    return out;
}

std::vector<std::int32_t> TopologyDelta::cut_elements() const {
    std::vector<std::int32_t> out;
    for (const std::int32_t e : element_parent)
        if (element_to_new[std::size_t(e)] < 0) out.push_back(e);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

std::vector<std::int32_t> TopologyDelta::added_vertices() const {
    std::vector<char> is_old(vertex_parents.size(), 0);
    for (const std::int32_t v : vertex_to_new)
        if (v >= 0) is_old[std::size_t(v)] = 1;
    std::vector<std::int32_t> out;
    for (std::size_t v = 0; v < is_old.size(); ++v)
        if (!is_old[v]) out.push_back(std::int32_t(v));
    return out;
}

TopologyDelta identity_delta(const VolumeMesh& mesh) {
    TopologyDelta d;
    d.vertex_parents.resize(mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        d.vertex_to_new.push_back(std::int32_t(v));
        d.vertex_parents[v].vertex[0] = std::int32_t(v);
        d.vertex_parents[v].weight[0] = 1;
    }
    for (std::size_t e = 0; e < mesh.element_count(); ++e) {
        d.element_to_new.push_back(std::int32_t(e));
        d.element_parent.push_back(std::int32_t(e));
        d.element_share.push_back(1);
    }
    return d;
}

TopologyDelta compose(const TopologyDelta& first, const TopologyDelta& second) {
    TopologyDelta d;
    for (const std::int32_t v : first.vertex_to_new) d.vertex_to_new.push_back(v < 0 ? -1 : second.vertex_to_new[std::size_t(v)]);
    for (const std::int32_t e : first.element_to_new) d.element_to_new.push_back(e < 0 ? -1 : second.element_to_new[std::size_t(e)]);
    for (std::size_t e = 0; e < second.element_parent.size(); ++e) {
        const auto middle = std::size_t(second.element_parent[e]);
        d.element_parent.push_back(first.element_parent[middle]);
        d.element_share.push_back(second.element_share[e] * first.element_share[middle]);
    }
    d.vertex_parents.reserve(second.vertex_parents.size());
    for (const VertexParents& late : second.vertex_parents) {
        if (late.vertex[1] < 0) {  // the same, or a copy
            d.vertex_parents.push_back(first.vertex_parents[std::size_t(late.vertex[0])]);
            continue;
        }
        std::map<std::int32_t, double> sum;  // a point lies in one tet of the first mesh: four corners at most
        for (std::size_t k = 0; k < 4 && late.vertex[k] >= 0; ++k) {
            const VertexParents& early = first.vertex_parents[std::size_t(late.vertex[k])];
            for (std::size_t j = 0; j < 4 && early.vertex[j] >= 0; ++j) sum[early.vertex[j]] += late.weight[k] * early.weight[j];
        }
        while (sum.size() > 4) {  // new matter between two cuts: the least goes
            const auto least = std::min_element(sum.begin(), sum.end(), [](const auto& a, const auto& b) { return std::abs(a.second) < std::abs(b.second); });
            const double rest = least->second / double(sum.size() - 1);
            sum.erase(least);
            for (auto& [vertex, weight] : sum) weight += rest;
        }
        VertexParents p;
        std::size_t k = 0;
        for (const auto& [vertex, weight] : sum) {
            p.vertex[k] = vertex;
            p.weight[k++] = weight;
        }
        d.vertex_parents.push_back(p);
    }
    return d;
}

std::vector<std::int32_t> boundary_parents(const VolumeMesh& before, const MeshEdit& edit) {
    const BoundarySurface was = extract_boundary(before), now = extract_boundary(edit.mesh);
    std::vector<std::int32_t> out(now.triangles.size(), -1);
    for (std::size_t t = 0; t < out.size(); ++t) {
        // Its corners lie in one face of its parent, so they have that face's vertices as parents.
        std::vector<std::int32_t> corners;
        for (const std::int32_t v : now.triangles[t]) {
            const VertexParents& p = edit.delta.vertex_parents[std::size_t(v)];
            for (std::size_t k = 0; k < 4 && p.vertex[k] >= 0; ++k) corners.push_back(p.vertex[k]);
        }
        std::sort(corners.begin(), corners.end());
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        const std::int32_t parent = edit.delta.element_parent[std::size_t(now.element[t])];
        // Its corners may be several old ones, merged.
        Triangle names = now.triangles[t];
        std::sort(names.begin(), names.end());
        const auto first = std::lower_bound(was.element.begin(), was.element.end(), parent);
        for (auto i = first; i != was.element.end() && *i == parent; ++i) {
            Triangle old = was.triangles[std::size_t(i - was.element.begin())], later = old;
            for (std::int32_t& v : later) v = edit.delta.vertex_to_new[std::size_t(v)];
            std::sort(old.begin(), old.end());
            std::sort(later.begin(), later.end());
            if (later == names || std::includes(old.begin(), old.end(), corners.begin(), corners.end())) out[t] = std::int32_t(i - was.element.begin());
        }
        if (out[t] >= 0 || corners.size() != 3 || parent < std::int32_t(before.tets.size())) continue;
        // A quad may now be drawn with its other diagonal: then the old half that shares two corners, on the same face.
        const Hex& hex = before.hexes[std::size_t(parent) - before.tets.size()];
        for (const auto& face : kHexFaces) {
            const auto on_face = [&](std::int32_t v) { return std::any_of(face.begin(), face.end(), [&](int a) { return hex[std::size_t(a)] == v; }); };
            if (!std::all_of(corners.begin(), corners.end(), on_face)) continue;
            for (auto i = first; i != was.element.end() && *i == parent; ++i) {
                const Triangle& old = was.triangles[std::size_t(i - was.element.begin())];
                if (std::all_of(old.begin(), old.end(), on_face)) out[t] = std::int32_t(i - was.element.begin());
            }
        }
    }
    return out;
}

Pieces find_pieces(const VolumeMesh& mesh) {
    DisjointSets joined(mesh.vertices.size());
    for (const Tet& t : mesh.tets)
        for (const std::int32_t v : t) joined.join(std::size_t(t[0]), std::size_t(v));
    for (const Hex& h : mesh.hexes)
        for (const std::int32_t v : h) joined.join(std::size_t(h[0]), std::size_t(v));
    Pieces out;
    std::vector<std::int32_t> number(mesh.vertices.size(), -1);
    const auto add = [&](std::int32_t vertex, double volume) {
        std::int32_t& piece = number[joined.root(std::size_t(vertex))];
        if (piece < 0) {
            piece = std::int32_t(out.volume_m3.size());
            out.volume_m3.push_back(0);
        }
        out.of_element.push_back(piece);
        out.volume_m3[std::size_t(piece)] += volume;
    };
    const auto X = [&](std::int32_t v) -> const Vec3& { return mesh.vertices[std::size_t(v)]; };
    for (const Tet& t : mesh.tets) add(t[0], tet_volume(X(t[0]), X(t[1]), X(t[2]), X(t[3])));
    for (const Hex& h : mesh.hexes) {
        std::array<Vec3, 8> x;
        for (std::size_t a = 0; a < 8; ++a) x[a] = X(h[a]);
        add(h[0], hex_volume(x));
    }
    return out;
}

}  // namespace supple
