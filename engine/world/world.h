#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/id.h"
#include "supple/base/log.h"
#include "supple/material/material.h"
#include "supple/math/isa.h"
#include "supple/mesh/mesh_grow.h"
#include "supple/mesh/skin.h"
#include "supple/world/attachment.h"
#include "supple/world/body_template.h"
#include "supple/world/collider.h"
#include "supple/world/loads.h"
#include "supple/world/step_report.h"
#include "supple/world/stress.h"

namespace supple {

enum class Precision {
    automatic,  ///< double_ for the static integrator, single for the others
    single,   ///< float32 matrix and CG vectors, float64 forces, positions, dot products and residual
    double_,  ///< everything float64
};

enum class LineariseAt {
    prediction,  ///< x + h v: ten times closer to the converged step at the same cost
    current,     ///< x
};

enum class Integrator {
    implicit_euler,  ///< first order; damps by itself, the more the longer the step: amplitude x (1 + w^2 h^2)^-1/2 a step. Never blows up
    bdf2,            ///< second order backward differences (the first step is implicit Euler); damps far less
    newmark,         ///< trapezoidal rule (beta 1/4, gamma 1/2): second order, keeps the energy of small vibrations; no damping but Rayleigh's
    quasi_static,    ///< scene key "static": no inertia; each step finds the equilibrium under the loads and supports of its end
};

/// How the linear solves are sped up. None changes the answer beyond the tolerance.
enum class PreconditionerKind {
    automatic,          ///< by size and iteration counts, never by the clock: block-Jacobi where that takes few iterations, else the multigrid
    block_jacobi,       ///< inverse of each vertex's own block: best for soft bodies and short steps
    lattice_multigrid,  ///< a frozen hierarchy of lattices that turns with the body: iterations that hardly grow with size and stiffness
    scalar_laplacian,   ///< Cholesky factor of a scalar matrix, made once: for small meshes full of slivers
    direct,             ///< Cholesky factor of every matrix: robust and slow; memory and time grow fast beyond some thousand vertices
    automatic_timed,    ///< as automatic, but block-Jacobi or the multigrid by which took less time on this machine: a run is no longer the same every time
};

/// What the solves multiply by. The answer is the same to within the tolerance.
enum class OperatorKind {
    automatic,    ///< elements where that is faster: corotational and linear hexahedra most of which share their shape (lattices); else the matrix
    assembled,    ///< a sparse matrix, made in every step
    matrix_free,  ///< the elements wherever they can: hexahedra of linear elasticity in a frame; others have a matrix still, and so do islands of several bodies, factors and Newton's exact tangents
};

struct SolverDef {
    Integrator integrator = Integrator::implicit_euler;
    Tangent tangent = Tangent::automatic;
    int newton_iterations = 0;             ///< most linear solves per step (static: per load step), 0..1000; 0 = 1, for the static integrator 100
    /// Stop Newton when the residual has fallen to this part of the step's first (static: of the loads and reactions), [0, 1).
    /// 0 = always all iterations; for the static integrator 1e-6. Where it is set, a line search guards each iteration and linear solves are only as exact as
    /// the iteration deserves (Eisenstat and Walker 1996, choice 2), never finer than cg_relative_tolerance.
    double newton_tolerance = 0;
    double cg_relative_tolerance = 1e-5;   ///< on the true float64 residual, (0, 1)
    int cg_max_iterations = 2000;          ///< 1..1e6, per linear solve
    int contact_iterations = 12;           ///< most solves in place of each for contacts that open, close, stick or slip in it, 1..1000
    PreconditionerKind preconditioner = PreconditionerKind::automatic;
    OperatorKind operator_kind = OperatorKind::automatic;
    Precision precision = Precision::automatic;
    LineariseAt linearise_at = LineariseAt::prediction;
    double step_budget_us = 0;             ///< time that a step may take, [0, 1e9]; 0 = as long as it needs. With it results depend on the clock
    double rayleigh_mass_1_s = 0;          ///< alpha of C = alpha M + beta K, [0, 1e6]
    double rayleigh_stiffness_s = 0;       ///< beta, [0, 1e3]
};

struct WorldDef {
    Vec3 gravity_m_s2 = Vec3(0, -9.81, 0);
    double time_step_s = 1.0 / 120;   ///< (0, 1]
    int threads = 0;                  ///< 0 = all cores; at most 256
    int max_catch_up_steps = 4;       ///< advance() does at most so many steps per call, 1..1000
    bool stress_each_step = false;    ///< compute stress inside step() (Stage::stress); otherwise on the first request after it
    SolverDef solver{};
    std::optional<Isa> isa{};         ///< instruction set of the kernels; empty = the widest that this processor has
    LogSink log{};
};

/// A part of a body whose matter differs. Regions apply in their order.
struct MaterialRegion {
    Selection where{};                    ///< selects at least one element
    ElementRule rule = ElementRule::all_vertices;  ///< which elements these are
    std::optional<Material> material{};   ///< in place of the body's, of any law; empty: only the factor and the density change
    double stiffness_factor = 1;          ///< multiplies every modulus of the elements, > 0; those of several regions multiply
    double density_kg_m3 = 0;             ///< > 0; 0 keeps the body's
};

struct BodyDef {
    std::string name{};                                ///< for messages; "body <index>" if empty
    std::shared_ptr<const BodyTemplate> shape{};       ///< required
    Material material = Corotational{};
    double density_kg_m3 = 1000;                       ///< > 0
    std::vector<double> young_pa_per_element{};        ///< empty, or one per element: overrides material
    std::vector<double> poisson_per_element{};         ///< empty, or one per element: overrides material
    std::vector<Material> material_per_element{};      ///< empty, or one per element in place of material, of any laws
    std::vector<double> stiffness_factor_per_element{};///< empty, or one per element, > 0: multiplies every modulus
    std::vector<double> density_kg_m3_per_element{};   ///< empty, or one per element, > 0: overrides density_kg_m3
    std::vector<MaterialRegion> regions{};             ///< applied after the above
    std::shared_ptr<const Skin> skin{};                ///< drawn and picked in place of the boundary; made for shape->mesh(). Null: none
    Vec3 translation_m = Vec3::Zero();                 ///< of the start position; the rest shape stays where the mesh is
    Vec3 velocity_m_s = Vec3::Zero();                  ///< at the start
    bool touches_bodies = true;                        ///< contact with the other bodies that have this set too; World::set_contact() decides pair by pair
    bool touches_itself = false;                       ///< contact of its surface with itself
    double friction = 0.3;                             ///< Coulomb's coefficient against bodies, [0, 10]; of a pair the geometric mean
};

struct Energy {
    double kinetic_j = 0, elastic_j = 0, gravity_j = 0;  ///< gravity: -sum m g.x, zero at the origin
    double loads_j = 0;  ///< dead loads: -sum f.(x - start position), zero at the start; what follows the body has no potential here
    double total_j() const { return kinetic_j + elastic_j + gravity_j + loads_j; }
};

/// A part of a body that shares no vertex with the rest.
struct Piece {
    std::vector<std::int32_t> elements;  ///< ascending
    double volume_m3 = 0;                ///< at rest
    double mass_kg = 0;
    bool supported = false;              ///< a coordinate of it is fixed or prescribed
};

struct PickHit {
    BodyId body;
    std::int32_t triangle = -1, element = -1;  ///< boundary triangle and the element it bounds; of a body with a skin: -1, and the element that moves the point
    std::int32_t skin_triangle = -1;           ///< of the body's skin; -1 where it has none
    std::array<double, 3> barycentric{};       ///< in that triangle
    std::array<double, 8> element_weights{};   ///< of the element's vertices (4 or 8): the point is their weighted sum
    Vec3 position_m = Vec3::Zero();
    double distance = 0;                       ///< in lengths of the ray's direction
};

/// An implicit, critically damped spring between a patch of the surface and a target point.
struct DragDef {
    double radius_m = 0;        ///< surface vertices within this distance (rest shape) of the point share the force; 0 = its triangle alone
    double stiffness_n_m = 0;   ///< 0 = from the local effective mass of the patch (inertia and elasticity over one step)
    double max_force_n = 0;     ///< 0 = no cap; the force never exceeds it
};

struct DragState {
    Vec3 anchor_m = Vec3::Zero();  ///< where the patch is
    Vec3 target_m = Vec3::Zero();
    Vec3 force_n = Vec3::Zero();   ///< on the body, in the last step
};

/// Soft bodies under implicit time integration with a fixed step. Independent of every other World; one thread at a time may use it.
/// Spans stay valid until the next call that is not const. All vertex and element data are in the order of the mesh.
class World {
public:
    /// @error Error(invalid_argument) naming the field, its legal range and the fix
    explicit World(const WorldDef& def = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    // -- bodies: between steps; may throw and allocate ------------------------------------------------
    BodyId add_body(const BodyDef& def);
    void remove_body(BodyId body);
    std::vector<BodyId> bodies() const;                  ///< living bodies, in the order they were added
    const BodyTemplate& shape(BodyId body) const;
    const std::string& name(BodyId body) const;
    std::shared_ptr<const Skin> skin(BodyId body) const; ///< null: none
    std::vector<Vec3> skin_positions(BodyId body) const; ///< [m]; empty: none. In a loop: skin()->embedding().deform(positions(), kept array)
    const BodyDef& definition(BodyId body) const;        ///< as it was added, with the changes of matter since

    /// Holds the selected vertices where they are now (in the given axes). Returns how many; nothing selected is an Error.
    std::size_t fix(BodyId body, const Selection& where, Axes axes = {});
    void release(BodyId body, const Selection& where);   ///< undoes fix() and prescribe() for these vertices
    std::size_t prescribe(BodyId body, const Motion& motion);
    void add_load(BodyId body, const Load& load);
    void clear_loads(BodyId body);
    void set_state(BodyId body, std::span<const Vec3> positions_m, std::span<const Vec3> velocities_m_s);

    // Changes of matter between steps. Positions, velocities, history, supports and loads stay; so does the world if anything is out of range
    // (@error Error(invalid_argument) as add_body). reset() goes back to the start with the materials of the moment; snapshots hold no materials.
    void set_material(BodyId body, const Material& material);  ///< replaces material and every array per element of it; regions and factors stay
    void set_regions(BodyId body, std::vector<MaterialRegion> regions);  ///< in place of all regions; may be empty
    void set_stiffness_factor(BodyId body, std::span<const double> per_element);  ///< in place of those per element; empty: 1

    // -- topology: edits of a body's mesh between steps -----------------------------------------------
    // Vertices and elements are renumbered as the TopologyDelta says; their public ids stay. Positions, velocities, mass and momenta are kept (of each piece; a cut gives its
    // parts the spin that lumping masses anew would lose), so are materials, plastic strain, supports, loads, drags, attachments, contact and the skin; shape() is the new
    // one. Copies and points of a cut are held where all their parents were. Drags and attachments let go of vertices that went, and end with their last one. A multigrid goes on
    // with its coarse levels of before, and a new one is built beside the steps once the edits pause. An edit that changes nothing gives the identity. reset() keeps the mesh as it is. Strong guarantee.
    TopologyDelta remove_elements(BodyId body, std::span<const std::int32_t> elements);  ///< @error as supple::remove_elements()
    TopologyDelta tear(BodyId body, std::span<const ElementFace> faces);                 ///< @error as supple::separate_faces()
    TopologyDelta cut(BodyId body, const mesh::TriangleMesh& blade, const CutDef& def = {}, CutReport* report = nullptr);  ///< blade in the world, now. @error as supple::cut()
    /// Glues lips of cuts and tears that are within a gap now. Mass and momenta are kept; a vertex glued to a held one is held. @error as supple::heal()
    TopologyDelta heal(BodyId body, const HealDef& def = {}, HealReport* report = nullptr);
    /// New matter on the body, rest positions in the frame of shape(). New vertices move with what they are continued from, so momenta grow by those of the new mass. @error as supple::add_elements()
    TopologyDelta add_elements(BodyId body, const AddedElements& added);
    bool undo_edit(BodyId body);                                    ///< the body as it stood before its last edit, eight at most; false: there is none
    std::uint64_t edit_count(BodyId body) const;                    ///< grows with every edit and undo: whoever keeps indices looks here
    std::vector<std::uint32_t> vertex_ids(BodyId body) const;       ///< stable, per vertex; never given twice
    std::vector<std::uint32_t> element_ids(BodyId body) const;
    std::vector<char> inner_boundary(BodyId body) const;            ///< per boundary triangle of shape(), 1: edits laid it open; empty: the body was never edited. O(n): ask again when edit_count() has changed
    std::vector<Piece> pieces(BodyId body) const;                   ///< by first element
    TopologyDelta remove_pieces(BodyId body, double below_m3);      ///< pieces of less rest volume go, the largest one stays
    /// Makes a body of its own of every piece without support; where none has any, the largest stays. Drags and attachments go with the vertices that most of them holds.
    std::vector<BodyId> split_off_pieces(BodyId body);

    // -- colliders: rigid things that the bodies touch ------------------------------------------------
    ColliderId add_collider(const ColliderDef& def);     ///< @error Error(invalid_argument / unsupported) naming the field of ColliderDef
    void remove_collider(ColliderId collider);
    std::vector<ColliderId> colliders() const;           ///< living colliders by index
    const ColliderDef& collider(ColliderId collider) const;
    /// A kinematic collider gets there by the end of the next step, evenly; a tool is drawn there from now on; others are put there at once, at rest.
    void move_collider(ColliderId collider, const Pose& pose);
    ColliderState collider_state(ColliderId collider) const;

    /// Contact of two bodies, or of one with itself (a = b), from the next step on; until then their definitions decide.
    void set_contact(BodyId a, BodyId b, bool on);

    AttachmentId attach(const AttachmentDef& def);       ///< @error Error(invalid_argument) naming the field of AttachmentDef
    void move_attachment(AttachmentId attachment, const Vec3& anchor_m);  ///< ties it to another place in the world or on its collider
    AttachmentState attachment_state(AttachmentId attachment) const;
    void detach(AttachmentId attachment);
    /// Glues surfaces: attaches each vertex of `body`'s boundary that is within `gap_m` of that of `other` (now) to the nearest place on it, by the stiffness
    /// and force of `def`, and ends the contact of the two. May be empty: nothing is so near.
    /// @error Error(invalid_argument) for a gap that is not in (0, 1e6], or one body twice
    std::vector<AttachmentId> tie(BodyId body, BodyId other, double gap_m, const AttachmentDef& def = {});

    // -- time -----------------------------------------------------------------------------------------
    StepReport step() noexcept;                          ///< one fixed step
    AdvanceReport advance(double real_seconds) noexcept; ///< as many fixed steps as real time asks for
    double time_s() const;
    std::uint64_t step_count() const;
    const WorldDef& def() const;
    void set_gravity(const Vec3& gravity_m_s2);
    /// Other tolerances, iterations, damping, preconditioner ... from the next step on, as if the world had been made with them and brought to its present
    /// state. integrator, precision and tangent stay (`automatic` means those at work): another one is Error(unsupported); ranges are those of the constructor.
    void set_solver(const SolverDef& solver);

    // -- results --------------------------------------------------------------------------------------
    std::span<const Vec3> positions(BodyId body) const;           ///< [m]
    std::vector<Vec3> start_positions(BodyId body) const;         ///< where reset() puts it [m]
    std::span<const Vec3> previous_positions(BodyId body) const;  ///< before the last step: for interpolation [m]
    std::span<const Vec3> velocities(BodyId body) const;          ///< [m/s]
    std::span<const double> masses(BodyId body) const;            ///< lumped [kg]
    std::span<const double> element_young_pa(BodyId body) const;  ///< per element, at small strain, factors included
    std::span<const double> von_mises(BodyId body) const;         ///< per vertex, of the volume-weighted Cauchy tensor [Pa]
    std::span<const Voigt> cauchy_stress(BodyId body) const;      ///< per vertex [Pa]
    std::span<const double> element_von_mises(BodyId body) const; ///< per element [Pa]
    std::span<const Voigt> element_cauchy_stress(BodyId body) const;
    /// Plastic strain per element, in its own frame, engineering shears; empty for a body that cannot flow.
    std::vector<Voigt> plastic_strain(BodyId body) const;
    /// Tensor, von Mises and principal stresses at vertices or elements by the strain and the recovery of `def`: any element, any law.
    StressField stress(BodyId body, const StressDef& def = {}) const;
    void stress(BodyId body, const StressDef& def, StressField& out) const;  ///< the same into arrays that are kept: allocates only to grow
    Energy energy() const;
    Vec3 reaction_n(BodyId body) const;      ///< force of the supports and prescribed motions on the body in the last step [N]
    Vec3 reaction_n() const;                 ///< the same, all bodies
    Vec3 reaction_n(BodyId body, const Selection& where) const;  ///< the same of a set of its vertices: of one support [N]
    std::span<const Vec3> reactions(BodyId body) const;  ///< per vertex, zero where free [N]
    std::span<const ContactPoint> contacts() const;      ///< that pressed in the last step, body by body
    Vec3 contact_force_n() const;                        ///< of all colliders on all bodies in the last step [N]
    bool is_frozen(BodyId body) const;
    void unfreeze(BodyId body);              ///< lets a contained body go on from where it stands, at rest
    std::uint64_t hash() const;              ///< of the whole state: equal hashes, equal bits

    // -- touch ----------------------------------------------------------------------------------------
    std::optional<PickHit> pick(const Ray& ray) const;    ///< first surface point hit, any body
    DragId begin_drag(const PickHit& hit, const DragDef& def = {});
    void move_drag(DragId drag, const Vec3& target_m);
    DragState drag_state(DragId drag) const;
    void end_drag(DragId drag);

    // -- history --------------------------------------------------------------------------------------
    std::vector<std::byte> save() const;                 ///< everything that moves, warm starts included
    /// Continues bit for bit, also in a fresh process, in a world built by the same calls. Edits of meshes come with the snapshot: the world may have made them, others or none.
    /// (Split-off pieces are bodies: they must be there. Loads added and matter changed between edits come back only where the edits are those of the world.)
    /// @error Error(corrupt_snapshot) saying what differs; the world is then unchanged
    void restore(std::span<const std::byte> snapshot);
    void reset();                                        ///< every body and collider back to its start, time to 0, drags and attachments ended

    struct Impl;  ///< private to world/

private:
    friend class Inspector;
    std::unique_ptr<Impl> impl_;
};

}  // namespace supple
