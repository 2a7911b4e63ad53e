#include "supple/bindings/c/supple.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "supple/bindings/c/guard.h"
#include "supple/contact/distance_grid.h"

#ifndef SUPPLE_VERSION
#error "SUPPLE_VERSION comes from the build"
#endif

using namespace supple_c;
using supple::BodyId;
using supple::Error;
using supple::ErrorCode;
using supple::Vec3;

namespace {

/// The caller's struct, widened or narrowed to ours. Fields that we do not know must be zero: ignoring them would be silent.
template <class Def>
Def read_def(const Def* def, const Def& defaults, std::size_t first_size, const char* where) {
    const std::uint64_t size = required(def, where, "the definition").struct_size;
    if (size < first_size || size > 65536)
        refuse(std::string(where) + ".struct_size", std::to_string(size) + " is not a size of this struct (" + std::to_string(sizeof(Def)) +
                                                        " here); fill it with its _default() function first");
    Def copy = defaults;
    std::memcpy(&copy, def, std::min<std::size_t>(size, sizeof(Def)));
    const auto* bytes = reinterpret_cast<const unsigned char*>(def);
    if (std::any_of(bytes + std::min<std::size_t>(size, sizeof(Def)), bytes + size, [](unsigned char b) { return b != 0; }))
        refuse(where, "a field that this version of the library does not know is set; use a newer library");
    return copy;
}

/// Writes as much of `value` as the caller's struct has room for; struct_size stays the caller's.
template <class Struct>
void write_struct(Struct* out, std::size_t size, std::size_t first_size, Struct value, const char* where) {
    required(out, where, "the struct");
    if (size < first_size)
        refuse(where, "struct_size " + std::to_string(size) + " is below " + std::to_string(first_size) + ", that of the first version");
    value.struct_size = size;
    if (size > sizeof(Struct)) std::memset(reinterpret_cast<unsigned char*>(out) + sizeof(Struct), 0, size - sizeof(Struct));
    std::memcpy(out, &value, std::min(size, sizeof(Struct)));
}

// Sizes of the first versions. They never change: a later field comes after these.
constexpr std::size_t kWorldDefFirst = 88, kBodyDefFirst = 128, kStepReportFirst = 64;
static_assert(sizeof(SuppleWorldDef) == kWorldDefFirst && offsetof(SuppleBodyDef, touches_bodies) == kBodyDefFirst &&
              sizeof(SuppleStepReport) == kStepReportFirst);

SuppleWorldDef default_world_def() {
    const supple::WorldDef d;
    SuppleWorldDef c{};
    c.struct_size = sizeof c;
    for (int i = 0; i < 3; ++i) c.gravity_m_s2[i] = d.gravity_m_s2[i];
    c.time_step_s = d.time_step_s;
    c.threads = d.threads;
    c.max_catch_up_steps = d.max_catch_up_steps;
    c.newton_iterations = d.solver.newton_iterations;
    c.cg_max_iterations = d.solver.cg_max_iterations;
    c.cg_relative_tolerance = d.solver.cg_relative_tolerance;
    c.precision = d.solver.precision == supple::Precision::double_ ? SUPPLE_PRECISION_DOUBLE : SUPPLE_PRECISION_SINGLE;
    c.linearise_at = d.solver.linearise_at == supple::LineariseAt::current ? SUPPLE_LINEARISE_AT_CURRENT : SUPPLE_LINEARISE_AT_PREDICTION;
    c.rayleigh_mass_1_s = d.solver.rayleigh_mass_1_s;
    c.rayleigh_stiffness_s = d.solver.rayleigh_stiffness_s;
    return c;
}

supple::WorldDef world_def(const SuppleWorldDef& c) {
    if (c.precision != SUPPLE_PRECISION_SINGLE && c.precision != SUPPLE_PRECISION_DOUBLE)
        refuse("SuppleWorldDef.precision", std::to_string(c.precision) + " is not a SupplePrecision (0 or 1)");
    if (c.linearise_at != SUPPLE_LINEARISE_AT_PREDICTION && c.linearise_at != SUPPLE_LINEARISE_AT_CURRENT)
        refuse("SuppleWorldDef.linearise_at", std::to_string(c.linearise_at) + " is not a SuppleLineariseAt (0 or 1)");
    supple::WorldDef d;
    d.gravity_m_s2 = vec3(c.gravity_m_s2);
    d.time_step_s = c.time_step_s;
    d.threads = c.threads;
    d.max_catch_up_steps = c.max_catch_up_steps;
    d.solver.newton_iterations = c.newton_iterations;
    d.solver.cg_max_iterations = c.cg_max_iterations;
    d.solver.cg_relative_tolerance = c.cg_relative_tolerance;
    d.solver.precision = c.precision == SUPPLE_PRECISION_DOUBLE ? supple::Precision::double_ : supple::Precision::single;
    d.solver.linearise_at =
        c.linearise_at == SUPPLE_LINEARISE_AT_CURRENT ? supple::LineariseAt::current : supple::LineariseAt::prediction;
    d.solver.rayleigh_mass_1_s = c.rayleigh_mass_1_s;
    d.solver.rayleigh_stiffness_s = c.rayleigh_stiffness_s;
    return d;
}

SuppleBodyDef default_body_def() {
    const supple::BodyDef d;
    const supple::Corotational law;
    SuppleBodyDef c{};
    c.struct_size = sizeof c;
    c.law = SUPPLE_LAW_COROTATIONAL;
    c.young_pa = law.young_pa;
    c.poisson = law.poisson;
    c.density_kg_m3 = d.density_kg_m3;
    c.touches_bodies = d.touches_bodies;
    c.touches_itself = d.touches_itself;
    c.friction = d.friction;
    return c;
}

/// A truth value of a field: anything but 0 and 1 is a mistake.
bool truth(std::int32_t value, const char* where) {
    if (value != 0 && value != 1) refuse(where, std::to_string(value) + " is neither 0 nor 1");
    return value == 1;
}

supple::VolumeMesh mesh_of(const SuppleBodyDef& c) {
    constexpr std::uint64_t kMost = 1u << 30;  // indices are int32
    if (c.vertex_count == 0 || c.vertex_count > kMost)
        refuse("SuppleBodyDef.vertex_count", std::to_string(c.vertex_count) + " is outside [1, " + std::to_string(kMost) + "]");
    if (c.tet_count == 0 || c.tet_count > kMost)
        refuse("SuppleBodyDef.tet_count", std::to_string(c.tet_count) + " is outside [1, " + std::to_string(kMost) + "]");
    required(c.vertices_m, "SuppleBodyDef.vertices_m", "the array");
    required(c.tets, "SuppleBodyDef.tets", "the array");
    supple::VolumeMesh mesh;
    mesh.source = c.name != nullptr ? c.name : "SuppleBodyDef";
    mesh.vertices.reserve(c.vertex_count);
    for (std::uint64_t i = 0; i < c.vertex_count; ++i) mesh.vertices.push_back(vec3(c.vertices_m + 3 * i));
    mesh.tets.reserve(c.tet_count);
    for (std::uint64_t i = 0; i < c.tet_count; ++i) {
        const std::int32_t* t = c.tets + 4 * i;
        mesh.tets.push_back({t[0], t[1], t[2], t[3]});
    }
    return mesh;
}

supple::BodyDef body_def(const SuppleBodyDef& c) {
    if (c.law != SUPPLE_LAW_COROTATIONAL) refuse("SuppleBodyDef.law", std::to_string(c.law) + " is not a SuppleLaw (0)");
    if (c.reserved != 0) refuse("SuppleBodyDef.reserved", std::to_string(c.reserved) + " must be 0");
    supple::BodyDef d;
    if (c.name != nullptr) d.name = c.name;
    supple::Corotational law;
    law.young_pa = c.young_pa;
    law.poisson = c.poisson;
    d.material = law;
    d.density_kg_m3 = c.density_kg_m3;
    d.translation_m = vec3(c.translation_m);
    d.velocity_m_s = vec3(c.velocity_m_s);
    d.touches_bodies = truth(c.touches_bodies, "SuppleBodyDef.touches_bodies");
    d.touches_itself = truth(c.touches_itself, "SuppleBodyDef.touches_itself");
    d.friction = c.friction;
    d.shape = supple::BodyTemplate::build(mesh_of(c));
    return d;
}

void report_out(SuppleStepReport* out, const supple::StepReport& r, int steps, double alpha) {
    if (out == nullptr) return;
    SuppleStepReport c{};
    c.step = r.step;
    c.time_s = r.time_s;
    c.flags = static_cast<std::uint32_t>(r.flags);
    c.cg_iterations = r.cg_iterations;
    c.newton_iterations = r.newton_iterations;
    c.steps = steps;
    c.step_ms = r.step_ms;
    c.cg_relative_residual = r.cg_relative_residual;
    c.alpha = alpha;
    write_struct(out, static_cast<std::size_t>(out->struct_size), kStepReportFirst, c, "SuppleStepReport");
}

/// Refuses a report that cannot be filled before time moves on.
void check_report(const SuppleStepReport* out) {
    if (out != nullptr && out->struct_size < kStepReportFirst)
        refuse("SuppleStepReport.struct_size",
               std::to_string(out->struct_size) + " is too small; fill the struct with supple_step_report_default()");
}

void copy_out(std::span<const Vec3> values, double* out, std::size_t capacity, const char* where) {
    required(out, where, "the buffer");
    if (capacity < 3 * values.size())
        refuse(where, "the buffer holds " + std::to_string(capacity) + " doubles; " + std::to_string(3 * values.size()) + " are needed");
    for (const Vec3& v : values)
        for (int i = 0; i < 3; ++i) *out++ = v[i];
}

using VectorResult = std::span<const Vec3> (supple::World::*)(BodyId) const;

SuppleStatus copy_vectors(const SuppleWorld* world, SuppleBodyId body, VectorResult result, double* out, std::size_t capacity,
                          const char* where) noexcept {
    return guarded([&] { copy_out((required(world, where, "world").world.*result)(id(body)), out, capacity, where); });
}

const supple::StepFlag* find_flag(std::uint32_t bit) noexcept {
    const auto* end = std::end(supple::kAllStepFlags);
    const auto* found =
        std::find_if(std::begin(supple::kAllStepFlags), end, [&](supple::StepFlag f) { return static_cast<std::uint32_t>(f) == bit; });
    return found == end ? nullptr : found;
}

static_assert(SUPPLE_INVALID_ARGUMENT == int(ErrorCode::invalid_argument) && SUPPLE_STALE_ID == int(ErrorCode::stale_id) &&
              SUPPLE_FILE_UNREADABLE == int(ErrorCode::file_unreadable) && SUPPLE_PARSE == int(ErrorCode::parse) &&
              SUPPLE_UNSUPPORTED == int(ErrorCode::unsupported) && SUPPLE_SURFACE_MESH == int(ErrorCode::surface_mesh) &&
              SUPPLE_CORRUPT_SNAPSHOT == int(ErrorCode::corrupt_snapshot) && SUPPLE_NO_DISPLAY == int(ErrorCode::no_display) &&
              SUPPLE_EXTERNAL_TOOL == int(ErrorCode::external_tool));
static_assert(SUPPLE_FLAG_ITERATION_CAP == int(supple::StepFlag::iteration_cap) &&
              SUPPLE_FLAG_RESIDUAL_STALLED == int(supple::StepFlag::residual_stalled) &&
              SUPPLE_FLAG_NON_FINITE == int(supple::StepFlag::non_finite) && SUPPLE_FLAG_FROZEN == int(supple::StepFlag::frozen) &&
              SUPPLE_FLAG_NEWTON_CAP == int(supple::StepFlag::newton_cap) && SUPPLE_FLAG_CONTACT_CAP == int(supple::StepFlag::contact_cap));

// -- colliders -----------------------------------------------------------------------------------------

constexpr std::size_t kColliderDefFirst = 232, kColliderStateFirst = 184;
static_assert(sizeof(SuppleColliderDef) == kColliderDefFirst && sizeof(SuppleColliderState) == kColliderStateFirst && sizeof(SuppleContact) == 120);

void put(const Vec3& v, double* out) {
    for (int i = 0; i < 3; ++i) out[i] = v[i];
}

supple::ColliderId id(SuppleColliderId collider) {
    supple::ColliderId result;
    result.index = collider.index;
    result.generation = collider.generation;
    return result;
}

SuppleColliderDef default_collider_def() {
    const supple::ColliderDef d;
    SuppleColliderDef c{};
    c.struct_size = sizeof c;
    c.size[1] = 1;
    c.rotation_wxyz[0] = 1;
    c.friction = d.friction;
    c.tool_stiffness_n_m = d.coupling.stiffness_n_m;
    return c;
}

supple::Shape shape_of(const SuppleColliderDef& c) {
    switch (c.shape) {
        case SUPPLE_SHAPE_PLANE: return supple::PlaneShape{vec3(c.size), c.plane_offset_m};
        case SUPPLE_SHAPE_SPHERE: return supple::SphereShape{c.size[0]};
        case SUPPLE_SHAPE_CAPSULE: return supple::CapsuleShape{c.size[0], c.size[1]};
        case SUPPLE_SHAPE_BOX: return supple::BoxShape{vec3(c.size)};
        case SUPPLE_SHAPE_CYLINDER: return supple::CylinderShape{c.size[0], c.size[1]};
        case SUPPLE_SHAPE_MESH: break;
        default: refuse("SuppleColliderDef.shape", std::to_string(c.shape) + " is not a SuppleShape (0 to 5)");
    }
    constexpr std::uint64_t kMost = 1u << 28;
    if (c.vertex_count == 0 || c.vertex_count > kMost || c.triangle_count == 0 || c.triangle_count > kMost)
        refuse("SuppleColliderDef", "a mesh needs vertices_m and triangles, at most " + std::to_string(kMost) + " of each");
    required(c.vertices_m, "SuppleColliderDef.vertices_m", "the array");
    required(c.triangles, "SuppleColliderDef.triangles", "the array");
    std::vector<Vec3> vertices;
    std::vector<supple::Triangle> triangles;
    for (std::uint64_t i = 0; i < c.vertex_count; ++i) vertices.push_back(vec3(c.vertices_m + 3 * i));
    for (std::uint64_t i = 0; i < c.triangle_count; ++i) triangles.push_back({c.triangles[3 * i], c.triangles[3 * i + 1], c.triangles[3 * i + 2]});
    return supple::MeshShape{supple::contact::DistanceGrid::build(vertices, triangles, "SuppleColliderDef")};
}

supple::ColliderDef collider_def(const SuppleColliderDef& c) {
    if (c.motion < SUPPLE_COLLIDER_FIXED || c.motion > SUPPLE_COLLIDER_DYNAMIC)
        refuse("SuppleColliderDef.motion", std::to_string(c.motion) + " is not a SuppleColliderMotion (0 to 3)");
    supple::ColliderDef d;
    if (c.name != nullptr) d.name = c.name;
    d.shape = shape_of(c);
    d.motion = static_cast<supple::ColliderMotion>(c.motion);
    d.pose.position_m = vec3(c.position_m);
    std::copy(c.rotation_wxyz, c.rotation_wxyz + 4, d.pose.rotation_wxyz.begin());
    d.friction = c.friction;
    d.mass_kg = c.mass_kg;
    d.velocity_m_s = vec3(c.velocity_m_s);
    d.spin_rad_s = vec3(c.spin_rad_s);
    d.coupling.stiffness_n_m = c.tool_stiffness_n_m;
    d.coupling.damping_n_s_m = c.tool_damping_n_s_m;
    d.coupling.max_force_n = c.tool_max_force_n;
    return d;
}

}  // namespace

const char* supple_version(void) { return SUPPLE_VERSION; }

const char* supple_last_error(void) { return last_error; }

const char* supple_status_name(SuppleStatus status) {
    switch (status) {
        case SUPPLE_OK: return "ok";
        case SUPPLE_OUT_OF_MEMORY: return "out_of_memory";
        case SUPPLE_INTERNAL_ERROR: return "internal_error";
        default: break;
    }
    if (status < SUPPLE_INVALID_ARGUMENT || status > SUPPLE_EXTERNAL_TOOL) return "unknown";
    return supple::to_string(static_cast<ErrorCode>(status)).data();  // literals: terminated
}

const char* supple_flag_name(uint32_t one_bit) {
    const supple::StepFlag* flag = find_flag(one_bit);
    return flag != nullptr ? supple::name(*flag).data() : "";
}

const char* supple_flag_cure(uint32_t one_bit) {
    const supple::StepFlag* flag = find_flag(one_bit);
    return flag != nullptr ? supple::cure(*flag).data() : "";
}

SuppleStatus supple_world_def_default(SuppleWorldDef* def, size_t struct_size) {
    return guarded([&] { write_struct(def, struct_size, kWorldDefFirst, default_world_def(), "supple_world_def_default"); });
}

SuppleStatus supple_body_def_default(SuppleBodyDef* def, size_t struct_size) {
    return guarded([&] { write_struct(def, struct_size, kBodyDefFirst, default_body_def(), "supple_body_def_default"); });
}

SuppleStatus supple_step_report_default(SuppleStepReport* report, size_t struct_size) {
    return guarded([&] { write_struct(report, struct_size, kStepReportFirst, SuppleStepReport{}, "supple_step_report_default"); });
}

SuppleStatus supple_world_create(const SuppleWorldDef* def, SuppleWorld** out_world) {
    return guarded([&] {
        required(out_world, "supple_world_create", "out_world") = nullptr;
        const SuppleWorldDef c = read_def(def, default_world_def(), kWorldDefFirst, "SuppleWorldDef");
        *out_world = new SuppleWorld{supple::World(world_def(c))};
    });
}

void supple_world_destroy(SuppleWorld* world) { delete world; }

SuppleStatus supple_world_add_body(SuppleWorld* world, const SuppleBodyDef* def, SuppleBodyId* out_body) {
    return guarded([&] {
        required(out_body, "supple_world_add_body", "out_body") = SuppleBodyId{0, 0};
        required(world, "supple_world_add_body", "world");
        const SuppleBodyDef c = read_def(def, default_body_def(), kBodyDefFirst, "SuppleBodyDef");
        const BodyId body = world->world.add_body(body_def(c));
        *out_body = SuppleBodyId{body.index, body.generation};
    });
}

SuppleStatus supple_world_remove_body(SuppleWorld* world, SuppleBodyId body) {
    return guarded([&] { required(world, "supple_world_remove_body", "world").world.remove_body(id(body)); });
}

SuppleStatus supple_world_fix_vertices(SuppleWorld* world, SuppleBodyId body, const int32_t* vertices, size_t count) {
    return guarded([&] {
        required(world, "supple_world_fix_vertices", "world");
        if (count > 0) required(vertices, "supple_world_fix_vertices", "vertices");
        world->world.fix(id(body), supple::VertexList{{vertices, vertices + count}});
    });
}

SuppleStatus supple_world_fix_box(SuppleWorld* world, SuppleBodyId body, const double min_m[3], const double max_m[3],
                                  size_t* out_count) {
    return guarded([&] {
        required(world, "supple_world_fix_box", "world");
        required(min_m, "supple_world_fix_box", "min_m");
        required(max_m, "supple_world_fix_box", "max_m");
        const std::size_t count = world->world.fix(id(body), supple::InsideBox{vec3(min_m), vec3(max_m)});
        if (out_count != nullptr) *out_count = count;
    });
}

SuppleStatus supple_world_step(SuppleWorld* world, SuppleStepReport* out_report) {
    return guarded([&] {
        required(world, "supple_world_step", "world");
        check_report(out_report);
        report_out(out_report, world->world.step(), 1, 1.0);
    });
}

SuppleStatus supple_world_advance(SuppleWorld* world, double real_seconds, SuppleStepReport* out_report) {
    return guarded([&] {
        required(world, "supple_world_advance", "world");
        check_report(out_report);
        supple::require_in_range(real_seconds, 0, 1e9, "supple_world_advance.real_seconds", "pass the time since the last call");
        const supple::AdvanceReport r = world->world.advance(real_seconds);
        report_out(out_report, r.last, r.steps, r.alpha);
    });
}

SuppleStatus supple_world_vertex_count(const SuppleWorld* world, SuppleBodyId body, size_t* out_count) {
    return guarded([&] {
        required(out_count, "supple_world_vertex_count", "out_count") = 0;
        *out_count = required(world, "supple_world_vertex_count", "world").world.positions(id(body)).size();
    });
}

SuppleStatus supple_world_positions(const SuppleWorld* world, SuppleBodyId body, double* xyz_m, size_t capacity) {
    return copy_vectors(world, body, &supple::World::positions, xyz_m, capacity, "supple_world_positions");
}

SuppleStatus supple_world_previous_positions(const SuppleWorld* world, SuppleBodyId body, double* xyz_m, size_t capacity) {
    return copy_vectors(world, body, &supple::World::previous_positions, xyz_m, capacity, "supple_world_previous_positions");
}

SuppleStatus supple_world_velocities(const SuppleWorld* world, SuppleBodyId body, double* xyz_m_s, size_t capacity) {
    return copy_vectors(world, body, &supple::World::velocities, xyz_m_s, capacity, "supple_world_velocities");
}

SuppleStatus supple_world_von_mises(const SuppleWorld* world, SuppleBodyId body, double* stress_pa, size_t capacity) {
    return guarded([&] {
        const auto values = required(world, "supple_world_von_mises", "world").world.von_mises(id(body));
        required(stress_pa, "supple_world_von_mises", "the buffer");
        if (capacity < values.size())
            refuse("supple_world_von_mises",
                   "the buffer holds " + std::to_string(capacity) + " doubles; " + std::to_string(values.size()) + " are needed");
        std::copy(values.begin(), values.end(), stress_pa);
    });
}

SuppleStatus supple_collider_def_default(SuppleColliderDef* def, size_t struct_size) {
    return guarded([&] { write_struct(def, struct_size, kColliderDefFirst, default_collider_def(), "supple_collider_def_default"); });
}

SuppleStatus supple_collider_state_default(SuppleColliderState* state, size_t struct_size) {
    return guarded([&] { write_struct(state, struct_size, kColliderStateFirst, SuppleColliderState{}, "supple_collider_state_default"); });
}

SuppleStatus supple_world_add_collider(SuppleWorld* world, const SuppleColliderDef* def, SuppleColliderId* out_collider) {
    return guarded([&] {
        required(out_collider, "supple_world_add_collider", "out_collider") = SuppleColliderId{0, 0};
        required(world, "supple_world_add_collider", "world");
        const SuppleColliderDef c = read_def(def, default_collider_def(), kColliderDefFirst, "SuppleColliderDef");
        const supple::ColliderId collider = world->world.add_collider(collider_def(c));
        *out_collider = SuppleColliderId{collider.index, collider.generation};
    });
}

SuppleStatus supple_world_remove_collider(SuppleWorld* world, SuppleColliderId collider) {
    return guarded([&] { required(world, "supple_world_remove_collider", "world").world.remove_collider(id(collider)); });
}

SuppleStatus supple_world_move_collider(SuppleWorld* world, SuppleColliderId collider, const double position_m[3], const double rotation_wxyz[4]) {
    return guarded([&] {
        required(world, "supple_world_move_collider", "world");
        required(position_m, "supple_world_move_collider", "position_m");
        required(rotation_wxyz, "supple_world_move_collider", "rotation_wxyz");
        world->world.move_collider(id(collider), {vec3(position_m), {rotation_wxyz[0], rotation_wxyz[1], rotation_wxyz[2], rotation_wxyz[3]}});
    });
}

SuppleStatus supple_world_collider_state(const SuppleWorld* world, SuppleColliderId collider, SuppleColliderState* out_state) {
    return guarded([&] {
        const supple::ColliderState s = required(world, "supple_world_collider_state", "world").world.collider_state(id(collider));
        required(out_state, "supple_world_collider_state", "out_state");
        SuppleColliderState c{};
        put(s.pose.position_m, c.position_m);
        std::copy(s.pose.rotation_wxyz.begin(), s.pose.rotation_wxyz.end(), c.rotation_wxyz);
        put(s.velocity_m_s, c.velocity_m_s);
        put(s.spin_rad_s, c.spin_rad_s);
        put(s.force_n, c.force_n);
        put(s.torque_nm, c.torque_nm);
        put(s.coupling_force_n, c.coupling_force_n);
        write_struct(out_state, static_cast<std::size_t>(out_state->struct_size), kColliderStateFirst, c, "SuppleColliderState");
    });
}

SuppleStatus supple_world_contact_count(const SuppleWorld* world, size_t* out_count) {
    return guarded([&] {
        required(out_count, "supple_world_contact_count", "out_count") = 0;
        *out_count = required(world, "supple_world_contact_count", "world").world.contacts().size();
    });
}

SuppleStatus supple_world_contacts(const SuppleWorld* world, SuppleContact* contacts, size_t capacity) {
    return guarded([&] {
        const auto points = required(world, "supple_world_contacts", "world").world.contacts();
        if (capacity < points.size())
            refuse("supple_world_contacts", "the buffer holds " + std::to_string(capacity) + " contacts; " + std::to_string(points.size()) + " are needed");
        if (!points.empty()) required(contacts, "supple_world_contacts", "the buffer");
        for (const supple::ContactPoint& p : points) {
            SuppleContact c{};
            c.body = {p.body.index, p.body.generation};
            c.collider = {p.collider.index, p.collider.generation};
            c.other = {p.other.index, p.other.generation};
            c.triangle = p.triangle;
            c.other_triangle = p.other_triangle;
            put(p.position_m, c.position_m);
            put(p.normal, c.normal);
            c.depth_m = p.depth_m;
            c.normal_force_n = p.normal_force_n;
            put(p.friction_force_n, c.friction_force_n);
            *contacts++ = c;
        }
    });
}

SuppleStatus supple_world_set_contact(SuppleWorld* world, SuppleBodyId a, SuppleBodyId b, int32_t on) {
    return guarded([&] { required(world, "supple_world_set_contact", "world").world.set_contact(id(a), id(b), truth(on, "supple_world_set_contact, on")); });
}

SuppleStatus supple_world_tie(SuppleWorld* world, SuppleBodyId body, SuppleBodyId other, double gap_m, double stiffness_n_m, double max_force_n, size_t* out_count) {
    return guarded([&] {
        supple::AttachmentDef def;
        def.stiffness_n_m = stiffness_n_m;
        def.max_force_n = max_force_n;
        const auto made = required(world, "supple_world_tie", "world").world.tie(id(body), id(other), gap_m, def);
        if (out_count != nullptr) *out_count = made.size();
    });
}

SuppleStatus supple_world_hash(const SuppleWorld* world, uint64_t* out_hash) {
    return guarded([&] {
        required(out_hash, "supple_world_hash", "out_hash") = 0;
        *out_hash = required(world, "supple_world_hash", "world").world.hash();
    });
}
