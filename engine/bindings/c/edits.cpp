#include <algorithm>
#include <memory>
#include <vector>

#include "supple/bindings/c/guard.h"

using supple::BodyId;
using supple::Vec3;
using namespace supple_c;

namespace {

std::vector<Vec3> points(const double* xyz, std::size_t count) {
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < count; ++i) out.push_back(vec3(xyz + 3 * i));
    return out;
}

std::size_t touched(const supple::TopologyDelta& delta) { return delta.removed_elements().size() + delta.cut_elements().size(); }

}  // namespace

SuppleStatus supple_world_remove_elements(SuppleWorld* world, SuppleBodyId body, const int32_t* elements, size_t count, size_t* out_count) {
    return guarded([&] {
        required(world, "supple_world_remove_elements", "world");
        if (count > 0) required(elements, "supple_world_remove_elements", "elements");
        const std::size_t done = touched(world->world.remove_elements(id(body), {elements, count}));
        if (out_count != nullptr) *out_count = done;
    });
}

SuppleStatus supple_world_cut(SuppleWorld* world, SuppleBodyId body, const double* from_m, const double* to_m, size_t point_count, size_t* out_count) {
    return guarded([&] {
        required(world, "supple_world_cut", "world");
        if (point_count > 0) required(from_m, "supple_world_cut", "from_m");
        if (point_count > 0) required(to_m, "supple_world_cut", "to_m");
        const std::size_t before = world->world.shape(id(body)).mesh().vertices.size();
        const auto delta = world->world.cut(id(body), supple::swept_blade(points(from_m, point_count), points(to_m, point_count)));
        if (out_count != nullptr) *out_count = std::max(touched(delta), delta.vertex_parents.size() - before);  // hexes are parted, not cut
    });
}

SuppleStatus supple_world_heal(SuppleWorld* world, SuppleBodyId body, double gap_m, size_t* out_count) {
    return guarded([&] {
        supple::HealReport report;
        required(world, "supple_world_heal", "world").world.heal(id(body), {.gap_m = gap_m}, &report);
        if (out_count != nullptr) *out_count = report.merged;
    });
}

SuppleStatus supple_world_add_tets(SuppleWorld* world, SuppleBodyId body, const double* vertices_m, size_t vertex_count, const int32_t* tets, size_t tet_count, int32_t source) {
    return guarded([&] {
        required(world, "supple_world_add_tets", "world");
        if (vertex_count > 0) required(vertices_m, "supple_world_add_tets", "vertices_m");
        if (tet_count > 0) required(tets, "supple_world_add_tets", "tets");
        supple::AddedElements added;
        added.vertices = points(vertices_m, vertex_count);
        for (std::size_t i = 0; i < tet_count; ++i) added.tets.push_back({tets[4 * i], tets[4 * i + 1], tets[4 * i + 2], tets[4 * i + 3]});
        added.source = {source};
        world->world.add_elements(id(body), added);
    });
}

SuppleStatus supple_world_undo_edit(SuppleWorld* world, SuppleBodyId body, int32_t* out_undone) {
    return guarded([&] {
        const bool undone = required(world, "supple_world_undo_edit", "world").world.undo_edit(id(body));
        if (out_undone != nullptr) *out_undone = undone ? 1 : 0;
    });
}

SuppleStatus supple_world_split_off_pieces(SuppleWorld* world, SuppleBodyId body, SuppleBodyId* bodies, size_t capacity, size_t* out_count) {
    return guarded([&] {
        required(world, "supple_world_split_off_pieces", "world");
        if (capacity > 0) required(bodies, "supple_world_split_off_pieces", "bodies");
        const std::vector<BodyId> made = world->world.split_off_pieces(id(body));
        for (std::size_t i = 0; i < std::min(capacity, made.size()); ++i) bodies[i] = SuppleBodyId{made[i].index, made[i].generation};
        if (out_count != nullptr) *out_count = made.size();
    });
}

SuppleStatus supple_world_piece_count(const SuppleWorld* world, SuppleBodyId body, size_t* out_count) {
    return guarded([&] {
        required(world, "supple_world_piece_count", "world");
        required(out_count, "supple_world_piece_count", "out_count") = world->world.pieces(id(body)).size();
    });
}

SuppleStatus supple_world_element_count(const SuppleWorld* world, SuppleBodyId body, size_t* out_count) {
    return guarded([&] {
        required(world, "supple_world_element_count", "world");
        required(out_count, "supple_world_element_count", "out_count") = world->world.shape(id(body)).mesh().element_count();
    });
}

SuppleStatus supple_world_triangle_count(const SuppleWorld* world, SuppleBodyId body, size_t* out_count) {
    return guarded([&] {
        required(world, "supple_world_triangle_count", "world");
        required(out_count, "supple_world_triangle_count", "out_count") = world->world.shape(id(body)).boundary().triangles.size();
    });
}

SuppleStatus supple_world_triangles(const SuppleWorld* world, SuppleBodyId body, int32_t* vertices, size_t capacity) {
    return guarded([&] {
        required(world, "supple_world_triangles", "world");
        const auto& triangles = world->world.shape(id(body)).boundary().triangles;
        required(vertices, "supple_world_triangles", "the buffer");
        if (capacity < 3 * triangles.size())
            refuse("supple_world_triangles", "the buffer holds " + std::to_string(capacity) + " integers, " + std::to_string(3 * triangles.size()) + " are needed");
        for (const supple::Triangle& t : triangles) vertices = std::copy(t.begin(), t.end(), vertices);
    });
}
