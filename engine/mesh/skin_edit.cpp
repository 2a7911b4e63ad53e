// A skin after its mesh was edited. Every triangle gets a host, the new element that its middle lies in or nearest to, among the parts of the elements that moved its
// corners. A corner stays with an element of its own if that element hangs together with the host across few neighbours; otherwise it lies across a cut, and a copy of it is
// bound to the host, whose map goes on beyond it. At rest nothing shows; opened, the skin ends within a triangle of the cut.
#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "supple/mesh/skin.h"
#include "supple/mesh/surface.h"

namespace supple {

namespace {

constexpr int kHops = 3;  // elements between a corner and its host that are still one side

class Hosts {
public:
    Hosts(const VolumeMesh& before, const MeshEdit& edit) : mesh_(edit.mesh), delta_(edit.delta), parts_(before.element_count()) {
        for (std::size_t e = 0; e < delta_.element_parent.size(); ++e) parts_[std::size_t(delta_.element_parent[e])].push_back(std::int32_t(e));
        // Elements at a vertex that was made or lost its neighbours: elsewhere nothing can be torn.
        std::vector<char> torn(mesh_.vertices.size(), 0);
        for (const std::int32_t v : delta_.added_vertices()) torn[std::size_t(v)] = 1;
        for (const std::int32_t v : delta_.added_vertices()) {
            const VertexParents& p = delta_.vertex_parents[std::size_t(v)];
            if (p.vertex[1] < 0 && delta_.vertex_to_new[std::size_t(p.vertex[0])] >= 0) torn[std::size_t(delta_.vertex_to_new[std::size_t(p.vertex[0])])] = 1;
        }
        near_cut_.resize(mesh_.element_count(), 0);
        around_.resize(mesh_.vertices.size());
        for (std::size_t e = 0; e < mesh_.element_count(); ++e)
            for (const std::int32_t v : element_vertices(mesh_, e)) {
                near_cut_[e] = char(near_cut_[e] | torn[std::size_t(v)]);
                around_[std::size_t(v)].push_back(std::int32_t(e));
            }
        for (int ring = 0; ring < kHops; ++ring) {  // a triangle may reach across from elements that the cut did not touch
            for (std::size_t e = 0; e < near_cut_.size(); ++e)
                if (near_cut_[e])
                    for (const std::int32_t v : element_vertices(mesh_, e)) torn[std::size_t(v)] = 1;
            for (std::size_t v = 0; v < torn.size(); ++v)
                if (torn[v])
                    for (const std::int32_t e : around_[v]) near_cut_[std::size_t(e)] = 1;
        }
    }

    bool lives(std::int32_t old) const { return !parts_[std::size_t(old)].empty(); }
    bool near_cut(std::int32_t element) const { return near_cut_[std::size_t(element)] != 0; }

    /// The element that a rest point lies in, or that of host() where it lies in none.
    std::int32_t holding(std::span<const std::int32_t> old, const Vec3& x) {
        if (!locator_) locator_.emplace(mesh_);
        const std::int32_t e = locator_->holding(x);
        return e >= 0 ? e : host(old, x);
    }

    /// The part of one of some old elements that a rest point lies in, or is least outside of; -1 where none lives.
    std::int32_t host(std::span<const std::int32_t> old, const Vec3& x) const {
        std::int32_t best = -1;
        double best_weight = 0;
        for (const std::int32_t o : old)
            for (const std::int32_t e : parts_[std::size_t(o)]) {
                std::array<double, Embedding::kMaxCorners> w{};
                shape_weights(mesh_, e, x, w);
                const double least = *std::min_element(w.begin(), w.begin() + std::ptrdiff_t(element_vertices(mesh_, e).size()));
                if (best >= 0 && least <= best_weight) continue;
                best = e;
                best_weight = least;
            }
        return best;
    }

    bool joined(std::int32_t a, std::int32_t b) {
        if (a == b || (!near_cut(a) && !near_cut(b))) return true;
        const auto [known, is_new] = joined_.try_emplace(std::minmax(a, b), false);
        if (!is_new) return known->second;
        std::set<std::int32_t> seen{a};
        std::vector<std::int32_t> front{a};
        for (int hop = 0; hop < kHops && !seen.contains(b); ++hop) {
            std::vector<std::int32_t> next;
            for (const std::int32_t e : front)
                for (const std::int32_t v : element_vertices(mesh_, e))
                    for (const std::int32_t n : around_[std::size_t(v)])
                        if (seen.insert(n).second) next.push_back(n);
            front = std::move(next);
        }
        return known->second = seen.contains(b);
    }

private:
    const VolumeMesh& mesh_;
    const TopologyDelta& delta_;
    std::vector<std::vector<std::int32_t>> parts_, around_;
    std::vector<char> near_cut_;
    std::map<std::pair<std::int32_t, std::int32_t>, bool> joined_;
    std::optional<ElementLocator> locator_;
};

}  // namespace

std::shared_ptr<const Skin> Skin::follow(const VolumeMesh& before, const MeshEdit& edit) const {
    Hosts hosts(before, edit);
    const std::span<const std::int32_t> was = embedding_.elements();
    mesh::TriangleMesh out;
    std::vector<std::int32_t> element;
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> number;  // (old point, element it is bound to)
    std::vector<std::int32_t> own(was.size());
    for (std::size_t p = 0; p < was.size(); ++p) own[p] = hosts.host({&was[p], 1}, surface_.vertices[p]);
    const auto add = [&](std::int32_t p, std::int32_t e) {
        const auto [known, is_new] = number.try_emplace({p, e}, std::int32_t(out.vertices.size()));
        if (is_new) {
            out.vertices.push_back(surface_.vertices[std::size_t(p)]);
            element.push_back(e);
        }
        return known->second;
    };
    for (const Triangle& t : surface_.triangles) {
        const std::array<std::int32_t, 3> old{was[std::size_t(t[0])], was[std::size_t(t[1])], was[std::size_t(t[2])]};
        if (std::count_if(old.begin(), old.end(), [&](std::int32_t e) { return hosts.lives(e); }) < 2) continue;  // gone with its elements
        const Vec3 middle = (surface_.vertices[std::size_t(t[0])] + surface_.vertices[std::size_t(t[1])] + surface_.vertices[std::size_t(t[2])]) / 3;
        const bool near = std::any_of(t.begin(), t.end(), [&](std::int32_t p) { return own[std::size_t(p)] < 0 || hosts.near_cut(own[std::size_t(p)]); });
        const std::int32_t host = near ? hosts.holding(old, middle) : hosts.host(old, middle);
        Triangle now{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t e = own[std::size_t(t[k])];
            now[k] = add(t[k], e >= 0 && hosts.joined(e, host) ? e : host);
        }
        out.triangles.push_back(now);
    }
    const std::vector<std::int32_t> parent = boundary_parents(before, edit);
    const BoundarySurface boundary = extract_boundary(edit.mesh);
    std::map<std::int32_t, std::int32_t> corner;
    for (std::size_t t = 0; t < parent.size(); ++t) {
        if (parent[t] >= 0) continue;
        Triangle now{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t v = boundary.triangles[t][k];
            const auto [known, is_new] = corner.try_emplace(v, std::int32_t(out.vertices.size()));
            if (is_new) {
                out.vertices.push_back(edit.mesh.vertices[std::size_t(v)]);
                element.push_back(boundary.element[t]);
            }
            now[k] = known->second;
        }
        out.triangles.push_back(now);
    }
    Embedding embedding = Embedding::bound(edit.mesh, out.vertices, std::move(element));
    return std::shared_ptr<const Skin>(new Skin(std::move(out), std::move(embedding), edit.mesh.vertices.size()));
}

}  // namespace supple
