#include "supple/mesh/manifold.h"

#include <algorithm>
#include <utility>

#include "supple/base/disjoint_sets.h"
#include "supple/mesh/surface.h"
#include "supple/mesh/topology.h"

namespace supple {
namespace {

/// For every vertex the items (tets or triangles) that use it, ascending.
class Stars {
public:
    template <std::size_t N>
    Stars(std::size_t vertices, const std::vector<std::array<std::int32_t, N>>& items) : start_(vertices + 1, 0) {
        for (const auto& item : items)
            for (const std::int32_t v : item) ++start_[v + 1];
        for (std::size_t v = 0; v < vertices; ++v) start_[v + 1] += start_[v];
        items_.resize(start_.back());
        std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
        for (std::size_t i = 0; i < items.size(); ++i)
            for (const std::int32_t v : items[i]) items_[next[v]++] = static_cast<std::int32_t>(i);
    }
    std::span<const std::int32_t> of(std::size_t v) const { return {items_.data() + start_[v], start_[v + 1] - start_[v]}; }

private:
    std::vector<std::size_t> start_;
    std::vector<std::int32_t> items_;
};

/// A facet of item `item` of a star: the other vertices by which two items of the star may be joined.
struct Joint {
    std::array<std::int32_t, 2> others;
    std::int32_t item;
    bool operator<(const Joint& o) const { return others != o.others ? others < o.others : item < o.item; }
};

/// Labels the items of a star, 0..count-1, by what hangs together across equal joints. Returns the number of sets; labels are
/// numbered in the order of their first item.
int label_sets(std::size_t items, std::vector<Joint>& joints, std::vector<int>& label) {
    std::sort(joints.begin(), joints.end());
    DisjointSets sets(items);
    for (std::size_t i = 1; i < joints.size(); ++i)
        if (joints[i].others == joints[i - 1].others) sets.join(std::size_t(joints[i].item), std::size_t(joints[i - 1].item));
    label.assign(items, -1);
    int count = 0;
    for (std::size_t i = 0; i < items; ++i) {
        const std::size_t root = sets.root(i);  // the smallest member
        label[i] = root == i ? count++ : label[root];
    }
    return count;
}

/// Joints of the tets `star` across the faces that hold all of the vertices in `core` (one vertex or two).
void tet_joints(const std::vector<Tet>& tets, std::span<const std::int32_t> star, std::span<const std::int32_t> core,
                std::vector<Joint>& joints) {
    joints.clear();
    for (std::size_t i = 0; i < star.size(); ++i) {
        std::array<std::int32_t, 4> others{};
        int n = 0;
        for (const std::int32_t v : tets[star[i]])
            if (std::find(core.begin(), core.end(), v) == core.end()) others[n++] = v;
        for (int a = 1; a < n; ++a)  // three at most: no library sort
            for (int b = a; b > 0 && others[b] < others[b - 1]; --b) std::swap(others[b], others[b - 1]);
        const auto item = static_cast<std::int32_t>(i);
        if (n == 2) {
            joints.push_back({{others[0], -1}, item});
            joints.push_back({{others[1], -1}, item});
        } else {
            joints.push_back({{others[0], others[1]}, item});
            joints.push_back({{others[0], others[2]}, item});
            joints.push_back({{others[1], others[2]}, item});
        }
    }
}

/// Gives every face-connected part of a vertex's tets its own copy of the vertex.
std::size_t split_vertices(VolumeMesh& mesh, const std::vector<char>& on_boundary) {
    const Stars stars(mesh.vertices.size(), mesh.tets);
    std::vector<Joint> joints;
    std::vector<int> label;
    std::size_t added = 0;
    // Copies of other vertices never join tets that were apart, so the stars of the start stay valid: only vertex names in tets
    // change, and each vertex is looked at once, with names that are equal exactly where the parts are joined.
    for (std::size_t v = 0; v < on_boundary.size(); ++v) {
        if (!on_boundary[v]) continue;
        const auto star = stars.of(v);
        const std::int32_t core = static_cast<std::int32_t>(v);
        tet_joints(mesh.tets, star, {&core, 1}, joints);
        const int parts = label_sets(star.size(), joints, label);
        for (int part = 1; part < parts; ++part) {
            const auto copy = static_cast<std::int32_t>(mesh.vertices.size());
            mesh.vertices.push_back(Vec3(mesh.vertices[v]));
            ++added;
            for (std::size_t i = 0; i < star.size(); ++i)
                if (label[i] == part) std::replace(mesh.tets[star[i]].begin(), mesh.tets[star[i]].end(), core, copy);
        }
    }
    return added;
}

double volume(const VolumeMesh& mesh, const Tet& t) {
    return tet_volume(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], mesh.vertices[t[3]]);
}

bool any_marked(std::span<const std::int32_t> tets, const std::vector<char>& removed) {
    return std::any_of(tets.begin(), tets.end(), [&](std::int32_t t) { return removed[t] != 0; });
}

/// Marks the smallest fan of tets around every edge with more than two boundary triangles.
bool mark_edge_fans(const VolumeMesh& mesh, const std::vector<Triangle>& boundary, const Stars& stars, std::vector<char>& removed) {
    std::vector<std::array<std::int32_t, 2>> edges;
    for (const Triangle& t : boundary)
        for (int i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(t[i], t[(i + 1) % 3]);
            edges.push_back({low, high});
        }
    std::sort(edges.begin(), edges.end());
    bool any = false;
    std::vector<Joint> joints;
    std::vector<int> label;
    std::vector<std::int32_t> ring;
    for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
        while (next < edges.size() && edges[next] == edges[i]) ++next;
        if (next - i <= 2) continue;
        any = true;
        ring.clear();
        for (const std::int32_t t : stars.of(edges[i][0]))
            if (std::find(mesh.tets[t].begin(), mesh.tets[t].end(), edges[i][1]) != mesh.tets[t].end()) ring.push_back(t);
        if (any_marked(ring, removed)) continue;  // changed in this round: look again in the next
        tet_joints(mesh.tets, ring, edges[i], joints);
        std::vector<double> fan_volume(label_sets(ring.size(), joints, label), 0);
        for (std::size_t k = 0; k < ring.size(); ++k) fan_volume[label[k]] += volume(mesh, mesh.tets[ring[k]]);
        const auto smallest = std::min_element(fan_volume.begin(), fan_volume.end()) - fan_volume.begin();
        for (std::size_t k = 0; k < ring.size(); ++k)
            if (label[k] == smallest) removed[ring[k]] = 1;
    }
    return any;
}

/// Marks the shortest chain of tets around v, each joined to the next by a face with v, from one fan of boundary triangles at v to
/// another. fan[i] is the fan of the tet star[i], -1 where it has no boundary triangle at v, -2 where it touches several.
void mark_bridge(const VolumeMesh& mesh, std::int32_t v, std::span<const std::int32_t> star, const std::vector<int>& fan,
                 std::vector<char>& removed) {
    std::vector<Joint> joints;
    tet_joints(mesh.tets, star, {&v, 1}, joints);
    std::sort(joints.begin(), joints.end());
    std::vector<std::vector<std::int32_t>> next(star.size());
    for (std::size_t i = 1; i < joints.size(); ++i)
        if (joints[i].others == joints[i - 1].others) {
            next[joints[i].item].push_back(joints[i - 1].item);
            next[joints[i - 1].item].push_back(joints[i].item);
        }
    std::vector<std::int32_t> queue, from(star.size(), -1);
    for (std::size_t i = 0; i < star.size(); ++i) {
        if (fan[i] == -2) {
            removed[star[i]] = 1;
            return;
        }
        if (fan[i] == 0) {
            queue.push_back(static_cast<std::int32_t>(i));
            from[i] = static_cast<std::int32_t>(i);
        }
    }
    for (std::size_t head = 0; head < queue.size(); ++head) {
        std::int32_t i = queue[head];
        if (fan[i] > 0) {
            for (removed[star[i]] = 1; from[i] != i; removed[star[i]] = 1) i = from[i];
            return;
        }
        for (const std::int32_t k : next[i])
            if (from[k] < 0) {
                from[k] = i;
                queue.push_back(k);
            }
    }
}

/// Where the boundary triangles of a vertex form several fans, the outside pinches the mesh there: marks a bridge of tets between two.
bool mark_pinched_vertices(const VolumeMesh& mesh, const BoundarySurface& boundary, const Stars& stars, std::vector<char>& removed) {
    const Stars fans(mesh.vertices.size(), boundary.triangles);
    std::vector<Joint> joints;
    std::vector<int> label, fan;
    bool any = false;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const auto triangles = fans.of(v);
        joints.clear();
        for (std::size_t i = 0; i < triangles.size(); ++i)
            for (const std::int32_t w : boundary.triangles[triangles[i]])
                if (w != static_cast<std::int32_t>(v)) joints.push_back({{w, -1}, static_cast<std::int32_t>(i)});
        if (triangles.empty() || label_sets(triangles.size(), joints, label) == 1) continue;
        any = true;
        const auto star = stars.of(v);
        if (any_marked(star, removed)) continue;
        fan.assign(star.size(), -1);
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const auto tet = std::lower_bound(star.begin(), star.end(), boundary.element[triangles[i]]) - star.begin();
            fan[tet] = fan[tet] == -1 || fan[tet] == label[i] ? label[i] : -2;
        }
        mark_bridge(mesh, static_cast<std::int32_t>(v), star, fan, removed);
    }
    return any;
}

}  // namespace

ManifoldReport make_boundary_manifold(VolumeMesh& mesh) {
    ManifoldReport report;
    for (;;) {
        std::vector<char> on_boundary(mesh.vertices.size(), 0);
        for (const Triangle& t : extract_boundary(mesh).triangles)
            for (const std::int32_t v : t) on_boundary[v] = 1;
        report.split_vertices += split_vertices(mesh, on_boundary);
        const BoundarySurface boundary = extract_boundary(mesh);
        const Stars stars(mesh.vertices.size(), mesh.tets);
        std::vector<char> removed(mesh.tets.size(), 0);
        // Edges first: one fan less often mends the vertices as well.
        if (!mark_edge_fans(mesh, boundary.triangles, stars, removed) && !mark_pinched_vertices(mesh, boundary, stars, removed)) break;
        std::size_t kept = 0;
        for (std::size_t t = 0; t < mesh.tets.size(); ++t)
            if (!removed[t]) mesh.tets[kept++] = mesh.tets[t];
        report.removed_tets += mesh.tets.size() - kept;
        mesh.tets.resize(kept);
    }
    drop_unused_vertices(mesh);
    return report;
}

void drop_unused_vertices(VolumeMesh& mesh) {
    std::vector<std::int32_t> number(mesh.vertices.size(), -1);
    for (const Tet& t : mesh.tets)
        for (const std::int32_t v : t) number[v] = 0;
    std::int32_t kept = 0;
    for (std::size_t v = 0; v < number.size(); ++v)
        if (number[v] == 0) {
            mesh.vertices[kept] = Vec3(mesh.vertices[v]);
            number[v] = kept++;
        }
    mesh.vertices.resize(kept);
    for (Tet& t : mesh.tets)
        for (std::int32_t& v : t) v = number[v];
}

}  // namespace supple
