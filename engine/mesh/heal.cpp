// Lips that were cut or torn apart coincide at rest, to the bit: their vertices are copies. So healing is naming, as opening is: all vertices at one rest place get one name, pairs of boundary
// faces of the same name that are near enough now are shut, the others stay torn, and the sets of elements at a name that hang together across shut faces are the vertices after.
#include <algorithm>
#include <cmath>
#include <map>

#include "supple/base/disjoint_sets.h"
#include "supple/base/error.h"
#include "supple/mesh/edit_draft.h"
#include "supple/mesh/mesh_grow.h"
#include "supple/mesh/surface.h"
#include "supple/mesh/topology.h"

namespace supple {

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, "heal", message); }

/// [vertex] the first boundary vertex at the same rest place; itself where there is none, or more than VertexParents holds.
std::vector<std::int32_t> names_by_place(const VolumeMesh& mesh, const BoundarySurface& boundary) {
    std::vector<std::int32_t> name(mesh.vertices.size()), ids;
    std::vector<char> on(mesh.vertices.size(), 0);
    for (const Triangle& t : boundary.triangles)
        for (const std::int32_t v : t) on[std::size_t(v)] = 1;
    for (std::size_t v = 0; v < name.size(); ++v) {
        name[v] = std::int32_t(v);
        if (on[v] != 0) ids.push_back(std::int32_t(v));
    }
    const auto X = [&](std::int32_t v) -> const Vec3& { return mesh.vertices[std::size_t(v)]; };
    std::stable_sort(ids.begin(), ids.end(), [&](std::int32_t a, std::int32_t b) { return std::lexicographical_compare(X(a).data(), X(a).data() + 3, X(b).data(), X(b).data() + 3); });
    for (std::size_t i = 0; i < ids.size();) {
        std::size_t end = i + 1;
        while (end < ids.size() && X(ids[end]) == X(ids[i])) ++end;
        for (std::size_t k = i; k < end && end - i <= 4; ++k) name[std::size_t(ids[k])] = ids[i];
        i = end;
    }
    return name;
}

/// Weights of the members of a merged vertex, summing to one.
VertexParents merged_from(const std::vector<std::int32_t>& members, std::span<const double> weight) {
    VertexParents p;
    double sum = 0;
    const bool any_infinite = std::any_of(members.begin(), members.end(), [&](std::int32_t v) { return std::isinf(weight[std::size_t(v)]); });
    for (std::size_t k = 0; k < members.size(); ++k) {
        const double w = weight[std::size_t(members[k])];
        p.vertex[k] = members[k];
        p.weight[k] = any_infinite ? double(std::isinf(w)) : w;
        sum += p.weight[k];
    }
    for (double& w : p.weight) w /= sum;
    return p;
}

/// Faces by the names of their vertices.
using NamedFaces = std::map<mesh::FaceKey, std::vector<Face>>;

void count(const std::set<mesh::FaceKey>& wanted, const NamedFaces& at, const TopologyDelta& delta, HealReport& report) {
    for (const auto& [key, faces] : at) {  // one whose corners were all merged at its neighbours is shut as well
        if (faces.size() != 2) continue;
        bool is_shut = true;
        for (const std::int32_t a : std::span(faces[0].vertices).first(std::size_t(faces[0].corners))) {
            const auto one = [&](std::int32_t b) { return b >= 0 && delta.vertex_to_new[std::size_t(a)] == delta.vertex_to_new[std::size_t(b)]; };
            is_shut = is_shut && std::any_of(faces[1].vertices.begin(), faces[1].vertices.end(), one);
        }
        report.faces += is_shut;
        report.left += !is_shut && wanted.contains(key);
    }
    report.merged = delta.vertex_to_new.size() - delta.vertex_parents.size();
}

/// The mesh with one vertex for each set of elements that hangs together at a name.
MeshEdit merge(const VolumeMesh& mesh, const mesh::Draft& draft, const std::set<std::int32_t>& affected, std::span<const double> weight) {
    const std::size_t n = mesh.vertices.size();
    DisjointSets one(n);
    for (const std::int32_t v : affected)
        for (const std::vector<std::int32_t>& set : draft.sets(v)) {
            std::int32_t first = -1;
            for (const std::int32_t e : set) {
                const auto& named = draft.elements[std::size_t(e)].vertex;
                const auto corner = std::size_t(std::find(named.begin(), named.end(), v) - named.begin());
                const std::int32_t was = std::size_t(e) < mesh.tets.size() ? mesh.tets[std::size_t(e)][corner] : mesh.hexes[std::size_t(e) - mesh.tets.size()][corner];
                if (first < 0) first = was;
                one.join(std::size_t(first), std::size_t(was));
            }
        }
    MeshEdit out;
    std::vector<std::vector<std::int32_t>> members(n);
    for (std::size_t v = 0; v < n; ++v) members[one.root(v)].push_back(std::int32_t(v));
    out.delta = identity_delta(mesh);
    out.delta.vertex_parents.clear();
    out.mesh = mesh;
    out.mesh.vertices.clear();
    for (std::size_t v = 0; v < n; ++v) {
        if (members[v].empty()) continue;  // the first of its vertices stands for it
        for (const std::int32_t m : members[v]) out.delta.vertex_to_new[std::size_t(m)] = std::int32_t(out.mesh.vertices.size());
        VertexParents p;
        if (members[v].size() == 1) {
            p.vertex[0] = std::int32_t(v);
            p.weight[0] = 1;
        } else {
            p = merged_from(members[v], weight);
        }
        out.delta.vertex_parents.push_back(p);
        out.mesh.vertices.push_back(mesh.vertices[v]);
    }
    const auto rename = [&](auto& element) {
        for (std::int32_t& v : element) v = out.delta.vertex_to_new[std::size_t(v)];
    };
    for (Tet& t : out.mesh.tets) rename(t);
    for (Hex& h : out.mesh.hexes) rename(h);
    for (VertexGroup& group : out.mesh.groups) {  // as in every edit: who has all parents in it
        std::vector<char> in(n, 0);
        for (const std::int32_t v : group.vertices) in[std::size_t(v)] = 1;
        group.vertices.clear();
        for (std::size_t v = 0; v < n; ++v)
            if (!members[v].empty() && std::all_of(members[v].begin(), members[v].end(), [&](std::int32_t m) { return in[std::size_t(m)] != 0; }))
                group.vertices.push_back(out.delta.vertex_to_new[v]);
    }
    return out;
}

}  // namespace

MeshEdit heal(const VolumeMesh& mesh, std::span<const Vec3> positions, std::span<const double> weight, const HealDef& def, HealReport* report) {
    const std::size_t n = mesh.vertices.size();
    if (positions.size() != n || weight.size() != n)
        refuse(std::to_string(positions.size()) + " positions and " + std::to_string(weight.size()) + " weights for a mesh of " + std::to_string(n) + " vertices");
    if (!(std::isfinite(def.gap_m) && def.gap_m > 0)) refuse("HealDef.gap_m " + to_text(def.gap_m) + " must be above 0; lips that are farther apart stay open");
    require_in_range(def.radius_m, 0, 1e9, "HealDef.radius_m", "0: everywhere");
    if (!def.centre_m.allFinite()) refuse("HealDef.centre_m is not finite");
    for (std::size_t v = 0; v < n; ++v)
        if (!positions[v].allFinite() || !(weight[v] >= 0)) refuse("a position or weight is not a number");
    HealReport unread;
    if (report == nullptr) report = &unread;
    *report = {};

    const BoundarySurface boundary = extract_boundary(mesh);
    const std::vector<std::int32_t> name = names_by_place(mesh, boundary);
    mesh::Draft draft(mesh);
    for (mesh::DraftElement& e : draft.elements)
        for (std::int32_t a = 0; a < e.corners; ++a) e.vertex[std::size_t(a)] = name[std::size_t(e.vertex[std::size_t(a)])];
    // Faces of the boundary, two of which have one name.
    NamedFaces at;
    for_each_face(mesh, [&](std::span<const HalfFace> sides) {
        if (sides.size() != 1) return;
        const Face f = half_face(mesh, sides[0]);
        mesh::FaceKey key = f.vertices;
        for (int i = 0; i < f.corners; ++i) key[std::size_t(i)] = name[std::size_t(key[std::size_t(i)])];
        at[mesh::ascending(key, std::size_t(f.corners))].push_back(f);
    });
    std::set<mesh::FaceKey> glued, torn;
    std::set<std::int32_t> affected;
    for (const auto& [key, faces] : at) {
        if (faces.size() < 2) continue;
        bool near = faces.size() == 2;
        for (int i = 0; near && i < faces[0].corners; ++i) {
            const std::int32_t a = faces[0].vertices[std::size_t(i)];
            const auto same = [&](std::int32_t b) { return b >= 0 && name[std::size_t(b)] == name[std::size_t(a)]; };
            const auto b = std::find_if(faces[1].vertices.begin(), faces[1].vertices.end(), same);
            near = b != faces[1].vertices.end() && (positions[std::size_t(a)] - positions[std::size_t(*b)]).norm() <= def.gap_m &&
                   (def.radius_m == 0 || (positions[std::size_t(a)] - def.centre_m).norm() <= def.radius_m);
        }
        (near ? glued : torn).insert(key);
        for (const std::int32_t v : key)
            if (v >= 0) affected.insert(v);
    }
    for (std::size_t v = 0; v < n; ++v)  // whoever bears the name of another has to get one of its own
        if (name[v] != std::int32_t(v)) affected.insert(name[v]);
    const std::set<mesh::FaceKey> wanted = glued;
    for (; !glued.empty();) {
        glued = draft.glue(glued, torn, affected);
        MeshEdit edit = merge(mesh, draft, affected, weight);
        // The names of corners do not tell all: what has come of it is looked at once more.
        std::set<std::int32_t> touched, bad;
        for (std::size_t v = 0; v < n; ++v)
            if (affected.contains(name[v])) touched.insert(edit.delta.vertex_to_new[v]);
        for (const auto& pinch : mesh::Draft(edit.mesh).pinches(touched))
            for (const std::int32_t v : pinch)
                if (v >= 0) bad.insert(v);
        if (!mesh.hexes.empty())
            for (const auto& edge : mesh::doubled_edges(edit.mesh)) bad.insert(edge.begin(), edge.end());
        if (bad.empty()) {
            count(wanted, at, edit.delta, *report);
            return glued.empty() ? MeshEdit{mesh, identity_delta(mesh)} : std::move(edit);
        }
        const std::size_t before = glued.size();
        std::set<std::int32_t> names;
        for (std::size_t v = 0; v < n; ++v)
            if (bad.contains(edit.delta.vertex_to_new[v])) names.insert(name[v]);
        for (auto key = glued.begin(); key != glued.end();) {
            const bool here = std::any_of(key->begin(), key->end(), [&](std::int32_t v) { return names.contains(v); });
            if (here) torn.insert(*key);
            key = here ? glued.erase(key) : std::next(key);
        }
        if (glued.size() == before) break;
    }
    report->left = wanted.size();
    return {mesh, identity_delta(mesh)};
}

}  // namespace supple
