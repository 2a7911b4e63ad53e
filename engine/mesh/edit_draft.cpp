// A vertex is shared by elements that hang together across faces. separate() finds, around each affected vertex, the sets of elements joined by faces that are not torn;
// a set is the vertex's name for its elements, so two elements share a face exactly where they are in the same set at all its vertices. A torn face of which no
// vertex was taken apart is shut again by that rule.
//
// The boundary at one set is a closed manifold if each of its edges there has two boundary faces and these form one fan. Where that fails, the outside pinches the
// part. Un-tearing the torn faces there, or taking elements away, mends it; both can go on only so long, so the loop ends.
#include "supple/mesh/edit_draft.h"

#include <algorithm>

#include "supple/base/disjoint_sets.h"
#include "supple/mesh/surface.h"
#include "supple/mesh/topology.h"

namespace supple::mesh {

namespace {

bool holds(const FaceKey& key, std::int32_t vertex) { return std::find(key.begin(), key.end(), vertex) != key.end(); }

double volume_of(const std::vector<Vec3>& x, const DraftElement& e) {
    const auto X = [&](std::size_t a) -> const Vec3& { return x[std::size_t(e.vertex[a])]; };
    if (e.corners == 4) return tet_volume(X(0), X(1), X(2), X(3));
    std::array<Vec3, 8> corners;
    for (std::size_t a = 0; a < 8; ++a) corners[a] = X(a);
    return hex_volume(corners);
}

}  // namespace

Draft::Draft(const VolumeMesh& mesh) : old(mesh), vertices(mesh.vertices) {
    elements.resize(mesh.element_count());
    for (std::size_t e = 0; e < elements.size(); ++e) {
        DraftElement& element = elements[e];
        element.parent = std::int32_t(e);
        if (e < mesh.tets.size()) {
            std::copy_n(mesh.tets[e].begin(), 4, element.vertex.begin());
        } else {
            element.vertex = mesh.hexes[e - mesh.tets.size()];
            element.corners = 8;
        }
    }
    parents.resize(vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        parents[v].vertex[0] = std::int32_t(v);
        parents[v].weight[0] = 1;
    }
}

std::int32_t Draft::add_point(std::int32_t a, std::int32_t b, double t) {
    if (b < a) {
        std::swap(a, b);
        t = 1 - t;
    }
    VertexParents p;
    p.vertex = {a, b, -1, -1};
    p.weight = {1 - t, t, 0, 0};
    vertices.push_back((1 - t) * vertices[std::size_t(a)] + t * vertices[std::size_t(b)]);
    parents.push_back(p);
    return std::int32_t(vertices.size() - 1);
}

FaceKey Draft::face(std::int32_t element, int f) const {
    const DraftElement& e = elements[std::size_t(element)];
    FaceKey key{-1, -1, -1, -1};
    if (e.corners == 4) {
        for (std::size_t i = 0; i < 3; ++i) key[i] = e.vertex[std::size_t(kTetFaces[std::size_t(f)][i])];
        return ascending(key, 3);
    }
    for (std::size_t i = 0; i < 4; ++i) key[i] = e.vertex[std::size_t(kHexFaces[std::size_t(f)][i])];
    return ascending(key, 4);
}

double Draft::volume(std::int32_t element) const { return volume_of(vertices, elements[std::size_t(element)]); }

void Draft::index() {
    star_start_.assign(vertices.size() + 1, 0);
    for (const DraftElement& e : elements) {
        if (!e.alive) continue;
        for (std::int32_t a = 0; a < e.corners; ++a) ++star_start_[std::size_t(e.vertex[std::size_t(a)]) + 1];
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) star_start_[v + 1] += star_start_[v];
    star_.resize(std::size_t(star_start_.back()));
    std::vector<std::int32_t> next(star_start_.begin(), star_start_.end() - 1);
    for (std::size_t i = 0; i < elements.size(); ++i) {
        const DraftElement& e = elements[i];
        if (!e.alive) continue;
        for (std::int32_t a = 0; a < e.corners; ++a) star_[std::size_t(next[std::size_t(e.vertex[std::size_t(a)])]++)] = std::int32_t(i);
    }
}

std::span<const std::int32_t> Draft::star(std::int32_t v) const {
    return {star_.data() + star_start_[std::size_t(v)], std::size_t(star_start_[std::size_t(v) + 1] - star_start_[std::size_t(v)])};
}

/// Which of the sets at a vertex an element is in.
std::int32_t Draft::corner_name(std::int32_t element, std::int32_t vertex) const {
    const auto found = sets_.find(vertex);
    if (found == sets_.end() || found->second.size() < 2) return 0;
    for (std::size_t s = 0; s < found->second.size(); ++s)
        if (std::binary_search(found->second[s].begin(), found->second[s].end(), element)) return std::int32_t(s);
    return 0;
}

void Draft::label(const std::set<FaceKey>& torn, std::int32_t v) {
    const auto around = star(v);
    DisjointSets joined(around.size());
    std::map<FaceKey, std::size_t> first;
    for (std::size_t i = 0; i < around.size(); ++i) {
        for (int f = 0; f < faces(around[i]); ++f) {
            const FaceKey key = face(around[i], f);
            if (!holds(key, v) || torn.contains(key)) continue;
            const auto [other, is_new] = first.emplace(key, i);
            if (!is_new) joined.join(other->second, i);
        }
    }
    std::vector<std::vector<std::int32_t>> sets;
    std::map<std::size_t, std::size_t> number;
    for (std::size_t i = 0; i < around.size(); ++i) {  // stars ascend, so do the sets
        const auto [at, is_new] = number.emplace(joined.root(i), sets.size());
        if (is_new) sets.emplace_back();
        sets[at->second].push_back(around[i]);
    }
    sets_[v] = std::move(sets);
}

std::vector<std::int32_t> Draft::smallest_fan(std::span<const std::int32_t> part, std::int32_t v, std::int32_t other) const {
    std::vector<std::int32_t> ring;
    for (const std::int32_t e : part) {
        const auto& ids = elements[std::size_t(e)].vertex;
        if (std::find(ids.begin(), ids.end(), other) != ids.end()) ring.push_back(e);
    }
    DisjointSets joined(ring.size());
    std::map<FaceKey, std::size_t> first;
    for (std::size_t i = 0; i < ring.size(); ++i)
        for (int f = 0; f < faces(ring[i]); ++f) {
            const FaceKey key = face(ring[i], f);
            if (!holds(key, v) || !holds(key, other)) continue;
            const auto [at, is_new] = first.emplace(key, i);
            if (!is_new) joined.join(at->second, i);
        }
    std::map<std::size_t, double> size;
    for (std::size_t i = 0; i < ring.size(); ++i) size[joined.root(i)] += volume(ring[i]);
    const auto smallest = std::min_element(size.begin(), size.end(), [](const auto& a, const auto& b) { return a.second < b.second; })->first;
    std::vector<std::int32_t> fan;
    for (std::size_t i = 0; i < ring.size(); ++i)
        if (joined.root(i) == smallest) fan.push_back(ring[i]);
    return fan;
}

std::vector<std::int32_t> Draft::bridge(std::span<const std::int32_t> part, std::int32_t v, const std::map<std::int32_t, int>& fan_of_element) const {
    std::map<FaceKey, std::vector<std::int32_t>> by_face;
    for (const std::int32_t e : part)
        for (int f = 0; f < faces(e); ++f)
            if (const FaceKey key = face(e, f); holds(key, v)) by_face[key].push_back(e);
    std::map<std::int32_t, std::vector<std::int32_t>> next;
    for (const auto& [key, sides] : by_face)
        if (sides.size() == 2) {
            next[sides[0]].push_back(sides[1]);
            next[sides[1]].push_back(sides[0]);
        }
    std::map<std::int32_t, std::int32_t> from;
    std::vector<std::int32_t> queue;
    for (const auto& [e, fan] : fan_of_element) {
        if (fan == -2) return {e};  // it touches several fans
        if (fan == 0) {
            queue.push_back(e);
            from[e] = e;
        }
    }
    for (std::size_t head = 0; head < queue.size(); ++head) {
        std::int32_t e = queue[head];
        const auto fan = fan_of_element.find(e);
        if (fan != fan_of_element.end() && fan->second > 0) {
            std::vector<std::int32_t> chain{e};
            while (from[e] != e) chain.push_back(e = from[e]);
            return chain;
        }
        for (const std::int32_t n : next[e])
            if (from.emplace(n, e).second) queue.push_back(n);
    }
    return {};
}

void Draft::look_for_fault(std::int32_t v, std::vector<Fault>& faults) const {
    for (const std::vector<std::int32_t>& part : sets_.at(v)) {
        // Faces at v of this set, by the names of their vertices: a face that one element has alone is of the boundary.
        struct Side {
            std::int32_t element;
            int face, count;
        };
        using Name = std::array<std::array<std::int32_t, 2>, 4>;  // of each vertex: old number and set
        std::map<Name, Side> sides;
        for (const std::int32_t e : part)
            for (int f = 0; f < faces(e); ++f) {
                const FaceKey key = face(e, f);
                if (!holds(key, v)) continue;
                Name name{};
                for (std::size_t i = 0; i < 4; ++i) name[i] = {key[i], key[i] < 0 ? 0 : corner_name(e, key[i])};
                ++sides.try_emplace(name, Side{e, f, 0}).first->second.count;
            }
        // The edges from v of each boundary face, and the faces joined by them.
        std::map<std::array<std::int32_t, 2>, std::vector<std::int32_t>> spokes;
        std::vector<std::int32_t> element;
        for (const auto& [name, side] : sides) {
            if (side.count != 1) continue;
            const DraftElement& e = elements[std::size_t(side.element)];
            const std::size_t n = e.corners == 4 ? 3 : 4;
            const auto corner = [&](std::size_t i) {
                return e.vertex[std::size_t(e.corners == 4 ? kTetFaces[std::size_t(side.face)][i % n] : kHexFaces[std::size_t(side.face)][i % n])];
            };
            std::size_t at = 0;
            while (corner(at) != v) ++at;
            for (const std::int32_t u : {corner(at + 1), corner(at + n - 1)}) spokes[{u, corner_name(side.element, u)}].push_back(std::int32_t(element.size()));
            element.push_back(side.element);
        }
        bool edges_are_good = true;
        DisjointSets fans(element.size());
        for (const auto& [u, around] : spokes) {
            for (const std::int32_t f : around) fans.join(std::size_t(around[0]), std::size_t(f));
            if (around.size() == 2) continue;
            edges_are_good = false;
            faults.push_back({v, u[0], smallest_fan(part, v, u[0])});
        }
        if (!edges_are_good || element.empty()) continue;
        std::map<std::size_t, int> number;
        for (std::size_t i = 0; i < element.size(); ++i) number.emplace(fans.root(i), int(number.size()));
        if (number.size() == 1) continue;
        std::map<std::int32_t, int> fan_of_element;
        for (std::size_t i = 0; i < element.size(); ++i) {
            const int fan = number[fans.root(i)];
            const auto [known, is_new] = fan_of_element.emplace(element[i], fan);
            if (!is_new && known->second != fan) known->second = -2;
        }
        faults.push_back({v, -1, bridge(part, v, fan_of_element)});
    }
}

std::vector<ElementFace> Draft::at_face(const FaceKey& key) const {
    std::vector<ElementFace> sides;
    for (const std::int32_t e : star(key[0]))
        for (int f = 0; f < faces(e); ++f)
            if (face(e, f) == key) sides.push_back({e, f});
    return sides;
}

/// The two lips of a torn quad would share a diagonal: as triangles they would lie on one another.
bool Draft::folds(const FaceKey& key) const {
    if (key[3] < 0) return false;
    const auto sides = at_face(key);
    if (sides.size() != 2) return false;
    std::array<bool, 4> same{};
    for (std::size_t i = 0; i < 4; ++i) {
        const std::int32_t v = elements[std::size_t(sides[0].element)].vertex[std::size_t(kHexFaces[std::size_t(sides[0].face)][i])];
        same[i] = corner_name(sides[0].element, v) == corner_name(sides[1].element, v);
    }
    return ((same[0] && same[2]) || (same[1] && same[3])) && !(same[0] && same[1] && same[2] && same[3]);
}

void Draft::separate(std::set<FaceKey> torn, std::set<std::int32_t> affected, bool may_remove) {
    for (;;) {
        sets_.clear();
        index();
        for (const std::int32_t v : affected) label(torn, v);
        std::vector<Fault> faults;
        for (const std::int32_t v : affected) look_for_fault(v, faults);
        bool changed = false;
        const bool pinched_edge = std::any_of(faults.begin(), faults.end(), [](const Fault& f) { return f.other >= 0; });
        for (const Fault& fault : faults) {
            if (may_remove) {
                if (pinched_edge && fault.other < 0) continue;  // edges first: one fan less often mends the vertices as well
                const bool touched = std::any_of(fault.elements.begin(), fault.elements.end(), [&](std::int32_t e) { return !elements[std::size_t(e)].alive; });
                if (touched) continue;  // changed in this round: look again in the next
                for (const std::int32_t e : fault.elements) {
                    elements[std::size_t(e)].alive = false;
                    for (std::int32_t a = 0; a < elements[std::size_t(e)].corners; ++a) affected.insert(elements[std::size_t(e)].vertex[std::size_t(a)]);
                    changed = true;
                }
                continue;
            }
            for (auto key = torn.begin(); key != torn.end();) {
                const bool here = holds(*key, fault.vertex) && (fault.other < 0 || holds(*key, fault.other));
                key = here ? torn.erase(key) : std::next(key);
                changed = changed || here;
            }
        }
        for (auto key = torn.begin(); key != torn.end();) {
            const bool bad = folds(*key);
            key = bad ? torn.erase(key) : std::next(key);
            changed = changed || bad;
        }
        if (!changed) break;
    }
    open_ = 0;
    for (const FaceKey& key : torn) {
        const auto sides = at_face(key);
        if (sides.size() != 2) continue;
        open_ += std::any_of(key.begin(), key.end(), [&](std::int32_t v) { return v >= 0 && corner_name(sides[0].element, v) != corner_name(sides[1].element, v); });
    }
}

std::set<FaceKey> Draft::glue(std::set<FaceKey> glued, std::set<FaceKey> torn, const std::set<std::int32_t>& affected) {
    index();
    for (;;) {
        sets_.clear();
        for (const std::int32_t v : affected) label(torn, v);
        std::vector<Fault> faults;
        for (const std::int32_t v : affected) look_for_fault(v, faults);
        for (const FaceKey& key : torn)
            if (folds(key))
                for (const std::int32_t v : key) faults.push_back({v, -1, {}});
        bool changed = false;
        const auto tear = [&](auto&& is_here) {
            bool any = false;
            for (auto key = glued.begin(); key != glued.end();) {
                const bool here = is_here(*key);
                if (here) torn.insert(*key);
                key = here ? glued.erase(key) : std::next(key);
                any = any || here;
            }
            changed = changed || any;
            return any;
        };
        for (const Fault& fault : faults) {
            // An edge can be crowded by faces that are glued at its ends alone.
            if (fault.other >= 0 && tear([&](const FaceKey& key) { return holds(key, fault.vertex) && holds(key, fault.other); })) continue;
            const auto at_fault = [&](const FaceKey& key) { return holds(key, fault.vertex) || (fault.other >= 0 && holds(key, fault.other)); };
            if (tear(at_fault)) continue;
            // A torn face whose corners were all merged at its neighbours is shut as well: it is those that have to open.
            std::set<std::int32_t> near;
            for (const FaceKey& key : torn)
                if (at_fault(key)) near.insert(key.begin(), key.end());
            near.erase(-1);
            tear([&](const FaceKey& key) { return std::any_of(key.begin(), key.end(), [&](std::int32_t v) { return near.contains(v); }); });
        }
        if (!changed) return glued;
    }
}

std::vector<std::array<std::int32_t, 2>> Draft::pinches(const std::set<std::int32_t>& affected) {
    index();
    sets_.clear();
    for (const std::int32_t v : affected) label({}, v);
    std::vector<Fault> faults;
    for (const std::int32_t v : affected) look_for_fault(v, faults);
    std::vector<std::array<std::int32_t, 2>> out;
    for (const Fault& fault : faults) out.push_back({fault.vertex, fault.other});
    for (const auto& [v, sets] : sets_)
        if (sets.size() > 1) out.push_back({v, -1});
    return out;
}

MeshEdit Draft::finish() const {
    MeshEdit out;
    const std::size_t old_vertices = old.vertices.size(), old_elements = old.element_count();
    TopologyDelta& d = out.delta;
    VolumeMesh& m = out.mesh;

    // Vertices: old ones that any element still has (or that never had one), then points, then copies.
    std::vector<char> was_used(old_vertices, 0), used(vertices.size(), 0);
    for (const Tet& t : old.tets)
        for (const std::int32_t v : t) was_used[std::size_t(v)] = 1;
    for (const Hex& h : old.hexes)
        for (const std::int32_t v : h) was_used[std::size_t(v)] = 1;
    for (const DraftElement& e : elements) {
        if (!e.alive) continue;
        for (std::int32_t a = 0; a < e.corners; ++a) used[std::size_t(e.vertex[std::size_t(a)])] = 1;
    }
    d.vertex_to_new.assign(old_vertices, -1);
    std::vector<std::int32_t> number(vertices.size(), -1);
    const auto add = [&](std::size_t v) {
        m.vertices.push_back(vertices[v]);
        d.vertex_parents.push_back(parents[v]);
        return std::int32_t(m.vertices.size() - 1);
    };
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        if (!used[v] && (v >= old_vertices || was_used[v])) continue;
        number[v] = add(v);
        if (v < old_vertices) d.vertex_to_new[v] = number[v];
    }
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> copies;  // (element, vertex): its copy
    std::vector<char> has_copies(vertices.size(), 0);
    for (const auto& [v, sets] : sets_)
        for (std::size_t s = 1; s < sets.size(); ++s) {
            const std::int32_t copy = add(std::size_t(v));
            for (const std::int32_t e : sets[s]) copies[{e, v}] = copy;
            has_copies[std::size_t(v)] = 1;
        }

    d.element_to_new.assign(old_elements, -1);
    m.regions = old.regions;
    for (const std::int32_t corners : {4, 8}) {
        for (std::size_t i = 0; i < elements.size(); ++i) {
            const DraftElement& e = elements[i];
            if (!e.alive || e.corners != corners) continue;
            std::array<std::int32_t, 8> ids{};
            for (std::int32_t a = 0; a < corners; ++a) {
                const std::int32_t v = e.vertex[std::size_t(a)];
                const auto copy = has_copies[std::size_t(v)] == 0 ? copies.end() : copies.find({std::int32_t(i), v});
                ids[std::size_t(a)] = copy == copies.end() ? number[std::size_t(v)] : copy->second;
            }
            if (i < old_elements) d.element_to_new[i] = std::int32_t(m.element_count());
            if (corners == 4) {
                m.tets.push_back({ids[0], ids[1], ids[2], ids[3]});
            } else {
                m.hexes.push_back(ids);
            }
            d.element_parent.push_back(e.parent);
            d.element_share.push_back(e.share);
            if (!old.element_region.empty()) m.element_region.push_back(old.element_region[std::size_t(e.parent)]);
            if (!old.fill.empty()) m.fill.push_back(old.fill[std::size_t(e.parent)]);
        }
    }
    for (const VertexGroup& group : old.groups) {
        VertexGroup kept{group.name, {}};
        std::vector<char> in(old_vertices, 0);
        for (const std::int32_t v : group.vertices) in[std::size_t(v)] = 1;
        for (std::size_t v = 0; v < m.vertices.size(); ++v) {
            const VertexParents& p = d.vertex_parents[v];
            bool all = true;
            for (std::size_t k = 0; k < 4 && p.vertex[k] >= 0; ++k) all = all && in[std::size_t(p.vertex[k])];
            if (all) kept.vertices.push_back(std::int32_t(v));
        }
        m.groups.push_back(std::move(kept));
    }
    m.source = old.source;
    return out;
}

std::vector<std::array<std::int32_t, 2>> doubled_edges(const VolumeMesh& mesh) {
    std::vector<std::array<std::int32_t, 2>> edges, twice;
    for (const Triangle& t : extract_boundary(mesh).triangles)
        for (std::size_t k = 0; k < 3; ++k) edges.push_back({t[k], t[(k + 1) % 3]});
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 1; i < edges.size(); ++i)
        if (edges[i] == edges[i - 1]) twice.push_back(edges[i]);
    return twice;
}

}  // namespace supple::mesh
