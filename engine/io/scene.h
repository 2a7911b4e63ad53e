#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "supple/world/edit_events.h"
#include "supple/world/probe.h"
#include "supple/world/world.h"

namespace supple::io {

struct SceneCamera {
    Vec3 eye_m, target_m;
    double fov_deg = 40;  ///< vertical opening angle, [1, 170]
};

struct SceneBody {
    BodyDef def;  ///< shape is built; bodies with the same mesh file and scale share it
    struct Support {
        Selection where;
        Axes axes;
    };
    std::vector<Support> fixed;
    std::vector<Motion> prescribed;
    std::vector<Load> loads;
    std::vector<ProbeDef> probes;
    std::optional<std::array<float, 3>> color, inner_color;  ///< sRGB 0..1, where no number is drawn
};

/// Contact of two bodies by their places in Scene::bodies, or of one with itself.
struct ScenePair {
    std::size_t a = 0, b = 0;
    bool on = true;
};

/// Surfaces that World::tie() glues.
struct SceneTie {
    std::size_t body = 0, other = 0;
    double gap_m = 0;
    AttachmentDef def;
};

/// Edits on a timeline, by the number of the body in the file.
struct SceneEdits {
    struct Cut {
        std::size_t body = 0;
        CutEvent event;
    };
    struct Erase {
        std::size_t body = 0;
        EraseEvent event;
    };
    struct Heal {
        std::size_t body = 0;
        HealEvent event;
    };
    std::vector<Cut> cuts;
    std::vector<Erase> erasures;
    struct Add {
        std::size_t body = 0;
        AddEvent event;
    };
    std::vector<Heal> heals;
    std::vector<Add> additions;
};

/// A scene file, read and validated.
struct Scene {
    WorldDef world;
    std::vector<SceneBody> bodies;
    std::vector<ScenePair> contacts;
    std::vector<SceneTie> ties;
    std::vector<ColliderDef> colliders;
    std::optional<SceneCamera> camera;
    SceneEdits events;
};

/// Reads a scene file: JSON, // and /* */ comments allowed; mesh paths are relative to it. Keys (defaults are those of WorldDef, SolverDef,
/// BodyDef):
///
///   supple_scene: 1 (required)   time_step_s   gravity_m_s2   threads
///   solver   {integrator, newton_iterations, newton_tolerance, cg_relative_tolerance, cg_max_iterations, preconditioner, precision,
///             linearise_at, tangent, operator, contact_iterations, step_budget_us, rayleigh_mass_1_s, rayleigh_stiffness_s}
///   camera   {eye_m, target_m, fov_deg}
///   colliders [{one of plane {normal, offset_m}, sphere {radius_m, centre_m}, capsule {radius_m, half_length_m}, cylinder {radius_m, half_length_m},
///             box {half_extents_m or min_m, max_m}, mesh {file, scale, cells}; name, position_m, rotation_wxyz, friction; fixed, or
///             motion {times_s, positions_m, rotations_wxyz}: follows them; mass_kg, velocity_m_s, spin_rad_s: moved by what it touches and by gravity;
///             mass_kg and tool {stiffness_n_m, damping_n_s_m, max_force_n, torsion_nm_rad, max_torque_nm}: drawn along `motion`}]
///   events   [{cut: {body, from_m: [points of a blade], to_m, times_s: [begin, end], stride_m, snap}} | {erase: {body, from_m, to_m, radius_m, times_s}} |
///             {heal: {body, gap_m, centre_m, radius_m, time_s}} | {add: {body, vertices_m, tets or hexes, source, time_s}}]: a blade, or a ball that removes elements, goes evenly from one place to another while the body moves; lips within
///             a gap are glued, in a ball or everywhere; elements of old and new vertices join the body (world/edit_events.h); body is its name or number, 0 if left out
///   contacts [{bodies: [name, name], on}]: of these two, or of one with itself, whatever the bodies say
///   ties     [{bodies: [name, name], gap_m, stiffness_n_m, max_force_n}]: glues the surface of the first to that of the second where they are so near
///   bodies   [{touches_bodies, touches_itself, friction: contact with soft bodies; name, mesh: "file" or box: {min_m, max_m, cells: [nx, ny, nz], elements: "tets"}, scale, units, up, refine, skin: "surface file", color: [r, g, b], inner_color, translation_m, velocity_m_s,
///   density_kg_m3,
///             material {law, rotation, young_pa, poisson}, or of a hyperelastic law {law, its parameters, fibre, sheet, fibre_stiffness_pa,
///             fibre_exponent, sheet_stiffness_pa, sheet_exponent, matrix_regularization},
///             regions [{<selection>, elements: "all_vertices" | "centre", material, stiffness_factor, density_kg_m3}],
///             fixed [{<selection>, axes}], prescribed [{<selection>, axes, displacement_m | velocity_m_s | affine, times_s}],
///             loads [{<selection>, force_n | force_per_vertex_n | traction_pa | pressure_pa (follower: true) | moment_nm
///                    (axis: [x, y, z], follower: true) | body_force_n_m3, times_s}],
///             probes [{<selection>, name, threshold_pa, threshold_m, strain}]}]
///
/// units ("m", "dm", "cm", "mm", "um", "km", "in", "ft") are those of the mesh file's lengths and go beside scale; up ("y", "z", "x", "-y", "-z",
/// "-x") is the file's axis that becomes +y. Everything else in the scene is in metres and in the turned axes.
///
/// <selection> is one of "box": {min_m, max_m}, "sphere": {centre_m, radius_m}, "capsule": {a_m, b_m, radius_m}, "vertices": [ids from 0], "group": "name", "all": true, or
/// "selection": one of these or "all"; an entry of `fixed` may be the word "all" alone. Boxes, spheres and capsules are closed and look at the scaled
/// rest shape, before translation_m. A selection that selects nothing is an error.
///
/// color is that of the body, inner_color that of what cuts lay open: sRGB, 0 to 1, where no stress is drawn; without them tissue and raw flesh.
///
/// refine cuts every element into eight, so many times. skin is a surface in the mesh file's coordinates (any surface file, or a .skin file) that is drawn and
/// picked in place of the mesh's boundary. A region holds the elements that have all their vertices in its selection, or their centre ("elements": "centre").
///
/// Loads are those of world/loads.h: traction_pa (a vector), pressure_pa and moment_nm also take "triangles": [numbers of boundary triangles from 0] in
/// place of a selection. pressure_pa and moment_nm are numbers; a positive pressure pushes into the body.
///
/// The numbers of a material may be lists with one number per element, in the order of the mesh (tets, then hexes), but for b and terms; fibre and
/// sheet are one direction, or a list of one per element. Regions are applied in their order: `material` takes the place of the body's, keeping what it
/// does not name where the law is the same; stiffness factors multiply all moduli, each other's too.
///
/// times_s: without it the value is constant. With n times and a list of n values the value is linear between them, constant before the
/// first and after the last. With two times [t0, t1] and a single value it ramps from zero (for `affine`: from the identity) at t0 to the
/// value at t1. affine: three rows of four numbers [A | t]; position = A X + t of the rest position X.
///
/// Keys and words of the scene format that this build does not do (other laws, integrators, ...) are
/// refused with Error(unsupported), never ignored.
/// @error Error(parse) "file:line" for syntax, "file:/json/pointer" for meaning; an unknown key names the nearest known one
/// @param refine  times that every mesh is refined (1 -> 8), besides the "refine" of its body
Scene read_scene(const std::filesystem::path& file, int refine = 0);

/// The same from memory; `name` stands for the file in messages.
Scene parse_scene(const std::string& text, const std::filesystem::path& folder, const std::string& name, int refine = 0);

/// Builds the world: bodies in the order of the file, with their supports, motions and loads.
World build_world(const Scene& scene, const LogSink& log = {});

/// The edits of a scene for the world that build_world() made of it: call before_step() before each step.
EditScript make_edits(const Scene& scene, const World& world);

}  // namespace supple::io
