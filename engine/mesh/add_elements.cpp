#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "supple/base/error.h"
#include "supple/mesh/edit_draft.h"
#include "supple/mesh/mesh_grow.h"
#include "supple/mesh/topology.h"

namespace supple {

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, "add_elements", message); }

/// Four vertices of an element and the weights by which a point is their mean, continued beyond the element.
VertexParents parents_in(const VolumeMesh& mesh, std::size_t source, const Vec3& x) {
    std::array<std::int32_t, 4> v{};
    if (source < mesh.tets.size()) {
        v = mesh.tets[source];
    } else {
        const Hex& h = mesh.hexes[source - mesh.tets.size()];
        v = {h[0], h[1], h[3], h[4]};
    }
    const auto X = [&](std::size_t a) -> const Vec3& { return mesh.vertices[std::size_t(v[a])]; };
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = X(std::size_t(k) + 1) - X(0);
    const Vec3 w = edges.inverse() * (x - X(0));
    std::array<std::pair<std::int32_t, double>, 4> of{{{v[0], 1 - w.sum()}, {v[1], w[0]}, {v[2], w[1]}, {v[3], w[2]}}};
    std::sort(of.begin(), of.end());
    VertexParents p;
    for (std::size_t k = 0; k < 4; ++k) {
        p.vertex[k] = of[k].first;
        p.weight[k] = of[k].second;
    }
    return p;
}

template <class T>
void insert_at(std::vector<T>& list, std::size_t at, const std::vector<T>& values) {
    list.insert(list.begin() + std::ptrdiff_t(at), values.begin(), values.end());
}

}  // namespace

MeshEdit add_elements(const VolumeMesh& mesh, const AddedElements& added) {
    const std::size_t tets = added.tets.size(), count = tets + added.hexes.size(), old_vertices = mesh.vertices.size(), vertices = old_vertices + added.vertices.size();
    if (count == 0 && added.vertices.empty()) return {mesh, identity_delta(mesh)};
    if (added.source.size() != 1 && added.source.size() != count)
        refuse(std::to_string(added.source.size()) + " sources for " + std::to_string(count) + " elements; give one for each, or one for all");
    const auto called = [&](std::size_t i) { return i < tets ? "new tet " + std::to_string(i) : "new hex " + std::to_string(i - tets); };
    const auto source = [&](std::size_t i) { return added.source[added.source.size() == 1 ? 0 : i]; };
    for (const Vec3& x : added.vertices)
        if (!x.allFinite()) refuse("a new vertex is not finite");

    MeshEdit out;
    VolumeMesh& m = out.mesh;
    m = mesh;
    m.vertices.insert(m.vertices.end(), added.vertices.begin(), added.vertices.end());
    m.tets.insert(m.tets.end(), added.tets.begin(), added.tets.end());
    m.hexes.insert(m.hexes.end(), added.hexes.begin(), added.hexes.end());
    const auto number = [&](std::size_t i) { return i < tets ? mesh.tets.size() + i : m.tets.size() + mesh.hexes.size() + i - tets; };
    const auto corners = [&](std::size_t i) -> std::span<std::int32_t> {
        if (i < tets) return m.tets[mesh.tets.size() + i];
        return m.hexes[mesh.hexes.size() + i - tets];
    };
    std::vector<std::int32_t> first_with(added.vertices.size(), -1);
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t from = source(i);
        const bool in_range = from >= 0 && std::size_t(from) < mesh.element_count();
        if (!in_range || (std::size_t(from) < mesh.tets.size()) != (i < tets))
            refuse(called(i) + " has the source " + std::to_string(from) + "; it must be " + (i < tets ? "a tet" : "a hex") + " of the mesh, which has " + std::to_string(mesh.tets.size()) +
                   " tets and " + std::to_string(mesh.hexes.size()) + " hexes behind them");
        for (const std::int32_t v : corners(i)) {
            if (v < 0 || std::size_t(v) >= vertices) refuse(called(i) + " uses vertex " + std::to_string(v) + "; legal are 0 to " + std::to_string(vertices - 1));
            if (std::size_t(v) >= old_vertices && first_with[std::size_t(v) - old_vertices] < 0) first_with[std::size_t(v) - old_vertices] = std::int32_t(i);
        }
        if (i < tets) {
            Tet& t = m.tets[mesh.tets.size() + i];
            const auto X = [&](std::size_t a) -> const Vec3& { return m.vertices[std::size_t(t[a])]; };
            if (tet_volume(X(0), X(1), X(2), X(3)) < 0) std::swap(t[2], t[3]);
        } else {
            Hex& h = m.hexes[mesh.hexes.size() + i - tets];
            std::array<Vec3, 8> x;
            for (std::size_t a = 0; a < 8; ++a) x[a] = m.vertices[std::size_t(h[a])];
            if (hex_volume(x) < 0) std::swap_ranges(h.begin(), h.begin() + 4, h.begin() + 4);
        }
    }
    for (std::size_t k = 0; k < first_with.size(); ++k)
        if (first_with[k] < 0) refuse("new vertex " + std::to_string(k) + " is in no new element");

    TopologyDelta& d = out.delta;
    d = identity_delta(mesh);
    for (std::size_t k = 0; k < first_with.size(); ++k) d.vertex_parents.push_back(parents_in(mesh, std::size_t(source(std::size_t(first_with[k]))), added.vertices[k]));
    for (std::size_t e = mesh.tets.size(); e < d.element_to_new.size(); ++e) d.element_to_new[e] += std::int32_t(tets);
    std::vector<std::int32_t> is_new(m.element_count(), 0);
    for (std::size_t i = 0; i < count; ++i) is_new[number(i)] = -1;
    for (const bool hexes : {true, false}) {  // the hexes first: they do not move the tets
        const std::size_t at = hexes ? mesh.element_count() : mesh.tets.size(), begin = hexes ? tets : 0, end = hexes ? count : tets;
        std::vector<std::int32_t> parent, region;
        std::vector<double> fill;
        for (std::size_t i = begin; i < end; ++i) {
            parent.push_back(source(i));
            if (!mesh.element_region.empty()) region.push_back(mesh.element_region[std::size_t(source(i))]);
            if (!mesh.fill.empty()) fill.push_back(mesh.fill[std::size_t(source(i))]);
        }
        insert_at(d.element_parent, at, parent);
        insert_at(d.element_share, at, std::vector<double>(end - begin, 0.0));
        if (!mesh.element_region.empty()) insert_at(m.element_region, at, region);
        if (!mesh.fill.empty()) insert_at(m.fill, at, fill);
    }
    const bool all_good = keeps_new_elements(m, is_new);
    for (std::size_t i = 0; !all_good && i < count; ++i) {  // which one is not
        std::vector<std::int32_t> one(m.element_count(), 0);
        one[number(i)] = -1;
        if (!keeps_new_elements(m, one)) refuse(called(i) + " repeats a vertex or is too flat");
    }

    std::set<std::int32_t> affected;
    for (std::size_t i = 0; i < count; ++i)
        for (const std::int32_t v : corners(i)) affected.insert(v);
    std::map<std::vector<std::int32_t>, std::size_t> known;
    std::map<mesh::FaceKey, int> at_face;
    const mesh::Draft draft_of_faces(m);
    for (std::size_t e = 0; e < m.element_count(); ++e) {
        std::vector<std::int32_t> ids;
        const std::span<const std::int32_t> vertices_of = element_vertices(m, e);
        ids.assign(vertices_of.begin(), vertices_of.end());
        if (std::none_of(ids.begin(), ids.end(), [&](std::int32_t v) { return affected.contains(v); })) continue;
        std::sort(ids.begin(), ids.end());
        if (const auto [other, fresh] = known.emplace(ids, e); !fresh) refuse("element " + std::to_string(e) + " has the vertices of element " + std::to_string(other->second));
        for (int f = 0; f < draft_of_faces.faces(std::int32_t(e)); ++f)
            if (++at_face[draft_of_faces.face(std::int32_t(e), f)] > 2) refuse("element " + std::to_string(e) + " shares a face with two others");
    }
    mesh::Draft draft(m);
    if (const auto pinched = draft.pinches(affected); !pinched.empty())
        refuse("the boundary would touch itself at vertex " + std::to_string(pinched[0][0]) + "; share whole faces, and close the fans around edges and vertices");
    if (const auto doubled = m.hexes.empty() ? std::vector<std::array<std::int32_t, 2>>{} : mesh::doubled_edges(m); !doubled.empty())
        refuse("the boundary would touch itself along a diagonal at vertex " + std::to_string(doubled[0][0]));
    return out;
}

}  // namespace supple
