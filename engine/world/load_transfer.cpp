#include <algorithm>

#include "supple/world/prepared_loads.h"
#include "supple/world/template_data.h"

namespace supple {

namespace {

/// New vertices that are an old one or a copy of it.
std::vector<std::vector<std::int32_t>> copies_of(const TopologyDelta& delta) {
    std::vector<std::vector<std::int32_t>> copies(delta.vertex_to_new.size());
    for (std::size_t v = 0; v < delta.vertex_parents.size(); ++v) {
        const VertexParents& p = delta.vertex_parents[v];
        const std::size_t parents = p.vertex[1] < 0 ? 1 : delta.is_merged(v) ? 4 : 0;
        for (std::size_t k = 0; k < parents && p.vertex[k] >= 0; ++k) copies[std::size_t(p.vertex[k])].push_back(std::int32_t(v));
    }
    return copies;
}

std::vector<char> chosen_triangles(const TemplateData& data, const Load& load) {
    std::vector<char> chosen(data.boundary.triangles.size(), 0);
    if (!load.triangles.empty()) {
        for (const std::int32_t t : load.triangles) chosen[std::size_t(t)] = 1;
        return chosen;
    }
    std::vector<char> in(data.mesh.vertices.size(), 0);
    for (const std::int32_t v : select_vertices(data.mesh, load.where)) in[std::size_t(v)] = 1;
    for (std::size_t t = 0; t < chosen.size(); ++t) {
        const Triangle& corners = data.boundary.triangles[t];
        chosen[t] = std::all_of(corners.begin(), corners.end(), [&](std::int32_t v) { return in[std::size_t(v)] != 0; });
    }
    return chosen;
}

}  // namespace

PreparedLoads PreparedLoads::followed(const TemplateData& before, const TemplateData& after, const TopologyDelta& delta, const std::string& name) const {
    PreparedLoads out;
    if (dead_.empty() && pressure_.empty() && moment_.empty()) return out;
    const auto copies = copies_of(delta);
    const std::vector<std::int32_t> parent = boundary_parents(before.mesh, {after.mesh, delta});
    const auto on_triangles = [&](Load load) {
        const std::vector<char> chosen = chosen_triangles(before, load);
        load.triangles.clear();
        for (std::size_t t = 0; t < parent.size(); ++t)
            if (parent[t] >= 0 && chosen[std::size_t(parent[t])] != 0) load.triangles.push_back(std::int32_t(t));
        return load;
    };
    for (const DeadLoad& load : dead_) {
        const LoadKind kind = load.definition.kind;
        if (kind == LoadKind::traction) {
            const Load moved = on_triangles(load.definition);
            if (!moved.triangles.empty()) out.add(after, name, moved);
            continue;
        }
        if (kind == LoadKind::body_force) {
            std::vector<char> chosen(delta.element_to_new.size(), 0);
            for (const std::int32_t e : select_elements(before.mesh, load.definition.where)) chosen[std::size_t(e)] = 1;
            ElementList list;
            for (std::size_t e = 0; e < delta.element_parent.size(); ++e)
                if (chosen[std::size_t(delta.element_parent[e])] != 0) list.elements.push_back(std::int32_t(e));
            Load moved = load.definition;
            moved.where = list;
            if (!list.elements.empty()) out.add(after, name, moved);
            continue;
        }
        std::vector<double> weight(delta.vertex_parents.size(), 0.0);
        for (std::size_t i = 0; i < load.vertex.size(); ++i) {
            const auto& to = copies[std::size_t(load.vertex[i])];
            for (const std::int32_t v : to) weight[std::size_t(v)] += load.weight[i] / double(to.size());
        }
        DeadLoad moved{{}, {}, load.value, load.definition};
        VertexList where;
        for (std::size_t v = 0; v < weight.size(); ++v) {
            if (weight[v] == 0) continue;
            moved.vertex.push_back(std::int32_t(v));
            moved.weight.push_back(weight[v]);
        }
        where.vertices = moved.vertex;
        moved.definition.where = where;
        if (!moved.vertex.empty()) out.dead_.push_back(std::move(moved));
    }
    for (const PressureLoad& load : pressure_) {
        const Load moved = on_triangles(load.definition);
        if (!moved.triangles.empty()) out.add(after, name, moved);
    }
    for (const MomentLoad& load : moment_) {
        Load moved = on_triangles(load.definition);
        if (moved.triangles.empty()) {
            VertexList list;
            if (load.definition.triangles.empty())
                for (const std::int32_t old : select_vertices(before.mesh, load.definition.where))
                    list.vertices.insert(list.vertices.end(), copies[std::size_t(old)].begin(), copies[std::size_t(old)].end());
            std::sort(list.vertices.begin(), list.vertices.end());
            list.vertices.erase(std::unique(list.vertices.begin(), list.vertices.end()), list.vertices.end());
            moved.where = list;
            if (list.vertices.size() < 3) continue;
        }
        out.add(after, name, moved);
    }
    return out;
}

}  // namespace supple
