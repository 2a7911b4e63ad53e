// A face of an element that is the same as before, with a vertex at which nothing has changed, has the same neighbour or none as before. So only faces whose vertices are all
// touched by the edit have to be matched anew.
#include "supple/mesh/edit_trace.h"

#include <algorithm>

#include "supple/mesh/edit_draft.h"
#include "supple/mesh/topology.h"

namespace supple {

namespace {

bool ascending(const std::vector<std::int32_t>& to_new) {
    std::int32_t last = -1;
    for (const std::int32_t i : to_new) {
        if (i < 0) continue;
        if (i <= last) return false;
        last = i;
    }
    return true;
}

/// Which half-face of the element has these three corners.
HalfFace find_half_face(const VolumeMesh& mesh, std::size_t element, const Triangle& t) {
    const std::span<const std::int32_t> ids = element_vertices(mesh, element);
    const auto has = [&](std::int32_t v) { return v == t[0] || v == t[1] || v == t[2]; };
    if (ids.size() == 4) {
        std::size_t opposite = 0;
        while (opposite < 3 && has(ids[opposite])) ++opposite;
        return HalfFace(4 * element + opposite);
    }
    for (std::size_t f = 0; f < 6; ++f) {
        int found = 0;
        for (const int a : kHexFaces[f]) found += has(ids[std::size_t(a)]);
        if (found == 3) return HalfFace(4 * mesh.tets.size() + 6 * (element - mesh.tets.size()) + f);
    }
    return 0;
}

}  // namespace

EditTrace trace_edit(const VolumeMesh& before, const VolumeMesh& after, const TopologyDelta& delta) {
    EditTrace trace;
    trace.new_vertex = delta.vertex_to_new;
    trace.old_vertex.assign(after.vertices.size(), -1);
    trace.old_element.assign(after.element_count(), -1);
    trace.new_element.assign(before.element_count(), -1);
    std::vector<char> moved(after.vertices.size(), 0);
    for (std::size_t v = 0; v < before.vertices.size(); ++v) {
        const std::int32_t now = delta.vertex_to_new[v];
        if (now < 0) continue;
        if (trace.old_vertex[std::size_t(now)] >= 0) {  // merged into another: no longer itself
            trace.new_vertex[v] = -1;
            continue;
        }
        trace.old_vertex[std::size_t(now)] = std::int32_t(v);
        moved[std::size_t(now)] = after.vertices[std::size_t(now)] != before.vertices[v];
    }
    trace.ordered = ascending(trace.new_vertex) && ascending(delta.element_to_new);
    const auto touch = [&](std::int32_t v) {
        if (v >= 0) trace.old_vertex[std::size_t(v)] = -1;
    };
    for (std::size_t e = 0; e < before.element_count(); ++e) {
        const std::span<const std::int32_t> was = element_vertices(before, e);
        const std::int32_t now = delta.element_to_new[e];
        bool same = now >= 0 && (std::size_t(now) < after.tets.size()) == (e < before.tets.size());
        if (same) {
            const std::span<const std::int32_t> is = element_vertices(after, std::size_t(now));
            for (std::size_t a = 0; a < was.size(); ++a) same = same && is[a] == trace.new_vertex[std::size_t(was[a])] && !moved[std::size_t(is[a])];
        }
        if (!same) {
            for (const std::int32_t v : was) touch(delta.vertex_to_new[std::size_t(v)]);
            continue;
        }
        trace.new_element[e] = now;
        trace.old_element[std::size_t(now)] = std::int32_t(e);
    }
    for (std::size_t e = 0; e < after.element_count(); ++e)
        if (trace.old_element[e] < 0)
            for (const std::int32_t v : element_vertices(after, e)) touch(v);
    return trace;
}

BoundarySurface follow_boundary(const BoundarySurface& was, const VolumeMesh& after, const EditTrace& trace) {
    const auto touched = [&](std::int32_t v) { return trace.old_vertex[std::size_t(v)] < 0; };
    const auto all_touched = [&](const Face& f) { return std::all_of(f.vertices.begin(), f.vertices.begin() + f.corners, touched); };
    std::vector<HalfFace> kept, matched, open;
    for (std::size_t t = 0; t < was.triangles.size(); ++t) {
        const std::int32_t now = trace.new_element[std::size_t(was.element[t])];
        if (now < 0) continue;
        Triangle corners = was.triangles[t];
        for (std::int32_t& v : corners) v = trace.new_vertex[std::size_t(v)];
        const HalfFace h = find_half_face(after, std::size_t(now), corners);
        if ((kept.empty() || kept.back() != h) && !all_touched(half_face(after, h))) kept.push_back(h);  // the two halves of a quad follow one another
    }
    std::vector<std::pair<mesh::FaceKey, HalfFace>> sides;
    for (std::size_t e = 0; e < after.element_count(); ++e) {
        const std::span<const std::int32_t> ids = element_vertices(after, e);
        if (std::count_if(ids.begin(), ids.end(), touched) < 3) continue;
        const bool is_tet = e < after.tets.size();
        const HalfFace first = HalfFace(is_tet ? 4 * e : 4 * after.tets.size() + 6 * (e - after.tets.size()));
        for (HalfFace f = 0; f < (is_tet ? 4u : 6u); ++f) {
            const Face face = half_face(after, first + f);
            if (all_touched(face)) sides.emplace_back(mesh::ascending(face.vertices, std::size_t(face.corners)), first + f);
        }
    }
    std::sort(sides.begin(), sides.end());
    for (std::size_t i = 0; i < sides.size();) {
        std::size_t end = i + 1;
        while (end < sides.size() && sides[end].first == sides[i].first) ++end;
        if (end == i + 1) matched.push_back(sides[i].second);
        i = end;
    }
    std::sort(matched.begin(), matched.end());
    open.resize(kept.size() + matched.size());
    std::merge(kept.begin(), kept.end(), matched.begin(), matched.end(), open.begin());
    return boundary_of(after, open);
}

}  // namespace supple
