#include "supple/fem/element_layout.h"

#include <algorithm>
#include <numeric>

#include "supple/base/assert.h"
#include "supple/fem/element_passes.h"
#include "supple/fem/hex8_geometry.h"
#include "supple/fem/rest.h"
#include "supple/math/polar.h"

namespace supple::fem {

namespace {

/// The elements [first, last) of the mesh, one group per family in the order in which the families appear.
void add_groups(ElementKind kind, std::size_t first, std::size_t last, std::span<const std::int32_t> family, std::vector<ElementGroup>& groups) {
    const std::size_t begin = groups.size();
    if (family.empty() && first < last) {
        groups.emplace_back();
        groups.back().kind = kind;
        groups.back().element.resize(last - first);
        std::iota(groups.back().element.begin(), groups.back().element.end(), std::int32_t(first));
        return;
    }
    for (std::size_t e = first; e < last; ++e) {
        const std::int32_t f = family[e];
        auto group = std::find_if(groups.begin() + std::ptrdiff_t(begin), groups.end(), [&](const ElementGroup& g) { return g.family == f; });
        if (group == groups.end()) {
            groups.emplace_back();
            groups.back().kind = kind;
            groups.back().family = f;
            group = groups.end() - 1;
        }
        group->element.push_back(std::int32_t(e));
    }
}

/// Elements by the first of their corners, those with the same one in the order of the mesh.
void sort_by_place(const VolumeMesh& mesh, std::span<const std::int32_t> place, std::vector<std::int32_t>& elements) {
    std::vector<std::pair<std::int32_t, std::int32_t>> keyed;
    keyed.reserve(elements.size());
    for (const std::int32_t e : elements) {
        std::int32_t first = INT32_MAX;
        for (const std::int32_t v : element_vertices(mesh, std::size_t(e))) first = std::min(first, place[std::size_t(v)]);
        keyed.emplace_back(first, e);
    }
    std::sort(keyed.begin(), keyed.end());
    for (std::size_t i = 0; i < elements.size(); ++i) elements[i] = keyed[i].second;
}

/// What a layout can take over from the one before an edit.
struct Before {
    const ElementLayout* layout = nullptr;  ///< null: nothing
    std::span<const std::int32_t> old_element;

    const ElementGroup* group(ElementKind kind) const {
        if (layout == nullptr) return nullptr;
        const auto found = std::find_if(layout->groups.begin(), layout->groups.end(), [&](const ElementGroup& g) { return g.kind == kind; });
        return found == layout->groups.end() ? nullptr : &*found;
    }
};

void fill_rest(const VolumeMesh& mesh, ElementGroup& group, const Before& before) {
    const ElementGroup* was = before.group(group.kind);
    std::vector<std::int32_t> old;  // in the group
    if (was != nullptr) {
        old.reserve(group.element.size());
        for (const std::int32_t e : group.element) {
            const std::int32_t one = before.old_element[std::size_t(e)];
            old.push_back(one < 0 ? -1 : std::int32_t(before.layout->slot[std::size_t(one)] - was->first_block * kBlock));
        }
    }
    if (group.kind == ElementKind::tet) {
        std::vector<Tet> tets;
        for (const std::int32_t e : group.element) tets.push_back(mesh.tets[std::size_t(e)]);
        group.tets = make_rest(mesh.vertices, tets, was == nullptr ? nullptr : &was->tets, old);
        return;
    }
    std::vector<Hex> hexes;
    std::vector<std::int32_t> numbers;
    for (const std::int32_t e : group.element) {
        numbers.push_back(e - std::int32_t(mesh.tets.size()));
        hexes.push_back(mesh.hexes[std::size_t(numbers.back())]);
    }
    group.hexes = make_hex_rest(mesh.vertices, hexes, numbers, mesh.source.empty() ? "mesh" : mesh.source, was == nullptr ? nullptr : &was->hexes, old);
}

/// Calls visit(vertex, place) for every value that is summed at a vertex, group by group.
template <class Visit>
void for_each_place(const VolumeMesh& mesh, const ElementLayout& layout, Visit&& visit) {
    for (const ElementGroup& group : layout.groups) {
        if (group.kind == ElementKind::tet) {
            for (std::size_t k = 0; k < group.sums.vertex.size(); ++k) visit(std::size_t(group.sums.vertex[k]), group.first_place + k);
            continue;
        }
        for (std::size_t i = 0; i < group.element.size(); ++i) {
            const std::span<const std::int32_t> vertices = element_vertices(mesh, std::size_t(group.element[i]));
            for (std::size_t a = 0; a < 8; ++a) visit(std::size_t(vertices[a]), group.first_place + i * 8 + a);
        }
    }
}

PlaceMap make_places(const VolumeMesh& mesh, const ElementLayout& layout) {
    PlaceMap map;
    map.start.assign(mesh.vertices.size() + 1, 0);
    for_each_place(mesh, layout, [&](std::size_t v, std::size_t) { ++map.start[v + 1]; });
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) map.start[v + 1] += map.start[v];
    map.place.resize(std::size_t(map.start.back()));
    std::vector<std::int64_t> next(map.start.begin(), map.start.end() - 1);
    for_each_place(mesh, layout, [&](std::size_t v, std::size_t place) { map.place[std::size_t(next[v]++)] = std::uint32_t(place); });
    return map;
}

ElementLayout lay_out(const VolumeMesh& mesh, std::span<const std::int32_t> family, std::span<const std::int32_t> place, const Before& before) {
    ElementLayout layout;
    layout.elements = mesh.element_count();
    layout.vertices = mesh.vertices.size();
    add_groups(ElementKind::tet, 0, mesh.tets.size(), family, layout.groups);
    add_groups(ElementKind::hex, mesh.tets.size(), layout.elements, family, layout.groups);
    layout.slot.resize(layout.elements);
    layout.volume.resize(layout.elements);
    for (ElementGroup& group : layout.groups) {
        if (!place.empty()) sort_by_place(mesh, place, group.element);
        fill_rest(mesh, group, before);
        group.first_block = layout.blocks;
        group.first_place = layout.places;
        layout.blocks += group.blocks();
        if (group.kind == ElementKind::tet) group.sums = make_corner_sums(group.tets, kBlockChunk);
        layout.places += group.kind == ElementKind::tet ? group.sums.vertex.size() : group.blocks() * kBlock * 8;
        const AlignedVector<double>& volume = group.kind == ElementKind::tet ? group.tets.volume : group.hexes.volume;
        for (std::size_t i = 0; i < group.element.size(); ++i) {
            layout.slot[std::size_t(group.element[i])] = std::uint32_t(group.first_block * kBlock + i);
            layout.volume[std::size_t(group.element[i])] = volume[i];
        }
    }
    layout.around = make_element_map(mesh);
    layout.forces = make_places(mesh, layout);
    return layout;
}

}  // namespace

ElementLayout make_layout(const VolumeMesh& mesh, std::span<const std::int32_t> family, std::span<const std::int32_t> place) { return lay_out(mesh, family, place, {}); }

ElementLayout follow_layout(const VolumeMesh& mesh, std::span<const std::int32_t> place, const ElementLayout& before, std::span<const std::int32_t> old_element) {
    return lay_out(mesh, {}, place, {&before, old_element});
}

std::size_t corner_volumes(const VolumeMesh& mesh, std::size_t element, double share[8]) {
    if (element < mesh.tets.size()) {
        const Tet& t = mesh.tets[element];
        const auto x = [&](std::size_t a) -> const Vec3& { return mesh.vertices[std::size_t(t[a])]; };
        std::fill_n(share, 4, tet_volume(x(0), x(1), x(2), x(3)) / 4);
        return 4;
    }
    std::fill_n(share, 8, 0.0);
    const HexShape X = hex_shape(mesh.vertices, mesh.hexes[element - mesh.tets.size()]);
    for (std::size_t q = 0; q < kHexPoints; ++q) {
        const Vec3 xi = hex_gauss_point(q);
        const double weight = hex_point(X, xi).determinant;
        for (std::size_t a = 0; a < 8; ++a) share[a] += weight * hex_shape_function(a, xi);
    }
    return 8;
}

std::vector<double> lumped_mass(const VolumeMesh& mesh, std::span<const double> density_kg_m3) {
    SUPPLE_ASSERT(density_kg_m3.size() == 1 || density_kg_m3.size() == mesh.element_count());
    std::vector<double> mass(mesh.vertices.size(), 0.0);
    double share[8];
    for (std::size_t e = 0; e < mesh.element_count(); ++e) {
        const std::size_t corners = corner_volumes(mesh, e, share);
        const double density = density_kg_m3[density_kg_m3.size() == 1 ? 0 : e];
        for (std::size_t a = 0; a < corners; ++a) mass[std::size_t(element_vertices(mesh, e)[a])] += density * share[a];
    }
    return mass;
}

std::vector<double> stiffness_trace(const ElementLayout& layout, std::span<const Lame> lame) {
    std::vector<double> trace(layout.vertices, 0.0);
    for (const ElementGroup& group : layout.groups) {
        std::vector<Lame> own;
        for (const std::int32_t e : group.element) own.push_back(lame[std::size_t(e)]);
        if (group.kind == ElementKind::tet) {
            add_stiffness_trace(group.tets, make_moduli(group.blocks(), own), trace);
        } else {
            add_stiffness_trace(group.hexes, own, trace);
        }
    }
    return trace;
}

void seed_rotations(Team& team, const ElementLayout& layout, std::span<const Vec3> positions, AlignedVector<double>& quaternion) {
    for (const ElementGroup& group : layout.groups) {
        const bool tets = group.kind == ElementKind::tet;
        const std::size_t corners = group.corners();
        const std::int32_t* vertices = tets ? group.tets.vertex.data() : group.hexes.vertex.data();
        const double* gradients = tets ? group.tets.gradient.data() : group.hexes.gradient.data();
        team.for_range(group.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin * kBlock; i < end * kBlock; ++i) {
                const std::size_t block = i / kBlock, lane = i % kBlock;
                const auto vertex = [&](std::size_t a) -> const Vec3& {
                    return positions[std::size_t(vertices[(block * corners + a) * kBlock + lane])];
                };
                Mat3 F = Mat3::Zero();
                for (std::size_t k = 0; k + 1 < corners; ++k) {
                    const double* g = gradients + (block * 3 * (corners - 1) + 3 * k) * kBlock + lane;
                    F += (vertex(k + 1) - vertex(0)) * Vec3(g[0], g[kBlock], g[2 * kBlock]).transpose();
                }
                const std::array<double, 4> q = polar_quaternion(F);
                for (std::size_t c = 0; c < 4; ++c) quaternion[((group.first_block + block) * 4 + c) * kBlock + lane] = q[c];
            }
        });
    }
}

}  // namespace supple::fem
