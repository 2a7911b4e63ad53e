#pragma once
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "supple/fem/elements.h"
#include "supple/solve/linear_solver.h"
#include "supple/solve/scalar_laplacian.h"
#include "supple/world/choice_timer.h"
#include "supple/world/contacts.h"
#include "supple/world/element_operator.h"
#include "supple/world/hierarchy_build.h"
#include "supple/world/prepared_loads.h"
#include "supple/world/template_data.h"
#include "supple/world/world.h"

namespace supple {

// Below this many elements the hand-over between threads costs about what it saves.
inline constexpr std::size_t kMinElementsForThreads = 4000;

/// Everything of one body that moves. Snapshot, restore, reset and hash iterate this list, so nothing is forgotten.
struct BodyState {
    std::vector<Vec3> x, v;           ///< positions [m], velocities [m/s]
    std::vector<Vec3> x_previous;     ///< positions before the last step
    std::vector<Vec3> dv1, dv2;       ///< velocity change of the last step and the one before: warm starts
    std::vector<Vec3> v_previous;     ///< velocities before the last step; bdf2 only [m/s]
    std::vector<Vec3> a;              ///< accelerations; newmark only [m/s^2]
    std::vector<std::uint8_t> moving; ///< one entry: 1 once v_previous or a stand for a step that was made
    std::vector<Vec3> reaction;       ///< of supports, last step [N]
    AlignedVector<double> quaternion; ///< [block][w x y z][lane] element rotations: warm start
    AlignedVector<double> plastic;    ///< [block][xx yy zz xy yz zx][lane] plastic strain, of elements that flow
    std::vector<std::uint8_t> frozen; ///< one entry: 1 after containment
    std::vector<Vec3> hierarchy_x, next_x;  ///< configurations that the frozen preconditioner was built from, and that the one under way is [m]
    std::vector<std::uint8_t> hierarchy_held, next_held;  ///< [vertex] bit c: coordinate c was held there
    std::vector<std::int32_t> solver; ///< choices of preconditioner: SolverMemory in precondition.h
    std::vector<ContactMemory> contacts;  ///< of the contacts that pressed in the last step; as many as there were

    template <class Self, class F>
    static void for_each_field(Self& s, F&& f) {
        f("positions", s.x);
        f("velocities", s.v);
        f("previous positions", s.x_previous);
        f("warm start", s.dv1);
        f("older warm start", s.dv2);
        f("older velocities", s.v_previous);
        f("accelerations", s.a);
        f("history flag", s.moving);
        f("reactions", s.reaction);
        f("element rotations", s.quaternion);
        f("plastic strains", s.plastic);
        f("frozen flag", s.frozen);
        f("positions of the frozen preconditioner", s.hierarchy_x);
        f("positions of the next preconditioner", s.next_x);
        f("supports of the frozen preconditioner", s.hierarchy_held);
        f("supports of the next preconditioner", s.next_held);
        f("solver choices", s.solver);
        f("contacts", s.contacts);
    }
};

struct Body;

/// The part of a body's tangent that is too wide for its matrix (fem::Elements::couple), on its free coordinates.
template <class Real>
class ElementCoupling final : public solve::Coupling<Real> {
public:
    explicit ElementCoupling(Body& body);
    double multiply_add(Team& team, const Real* x, Real* y) override;
    /// Diagonal blocks for the preconditioner [row], scaled; identity rows stay.
    std::span<const Mat3> update_diagonal(Team& team, double scale);

private:
    Body& body_;
    double scale_ = 0;
    AlignedVector<Real> field_, product_;  ///< [vertex]
    std::vector<Mat3> diagonal_, diagonal_by_row_;
    std::vector<double> partial_;
};

/// Matrix and solver of one body in one precision.
template <class Real>
struct System {
    using Scalar = Real;
    System(const TemplateData& data, Isa isa, PreconditionerKind kind);

    solve::Bsr3<Real> A;
    std::unique_ptr<solve::Preconditioner<Real>> preconditioner;  ///< block-Jacobi, always at hand; the factor where `direct` is asked for
    std::unique_ptr<solve::LatticeMultigrid<Real>> multigrid;     ///< null until it is wanted
    std::unique_ptr<HierarchyBuild<Real>> next;                   ///< the one that will take its place, or null
    std::unique_ptr<solve::ScalarLaplacian<Real>> laplacian;      ///< null until it is wanted
    solve::LinearSolver<Real> solver;
    std::unique_ptr<ElementCoupling<Real>> coupling;  ///< null: the matrix is the whole tangent
    ElementOperator<Real> element_operator;  ///< of the last evaluation, where by_elements
    bool by_elements = false;                ///< the operator is at work, and A is that of an earlier step
};

/// What the stages of a step write into; sized once, never part of the state.
struct Workspace {
    AlignedVector<double> force_parts;  ///< [place][x y z 0] (fem::ElementLayout)
    double mass_scale = 0, stiffness_scale = 0;  ///< factors of M and K in the matrix of the last solve
    double h = 0;                     ///< the scheme's x = base_x + h v, M (v - base_v)/h = forces (world/time_scheme.cpp)
    std::vector<Vec3> base_x, base_v;
    std::vector<Vec3> y;              ///< where forces are evaluated
    std::vector<Vec3> v0;             ///< velocity that the linear solve corrects
    std::vector<Vec3> v_start;        ///< v0 at the start of a line search
    std::vector<Vec3> v_good, target_v, unbalance, jump;  ///< static: v0 of the last equilibrium, of the supports at their target; the forces not yet let in; what the supports move in a part
    bool project = true;              ///< evaluate_elements() makes the tangent positive semidefinite
    double withheld = 0;              ///< static: part of `unbalance` that is held back
    std::vector<Vec3> f_ext;          ///< gravity and loads
    std::vector<Vec3> f_dead;         ///< of these, what does not follow the body; kept only where something does
    std::vector<Vec3> b, rhs, free_rhs;  ///< right-hand side; with drag springs; with held coordinates zeroed
    std::vector<Vec3> dv, residual, product;
    std::vector<Vec3> bare;           ///< b - A dv of the body itself: without drag springs and contacts
    std::vector<Vec3> dv_from, bare_from;  ///< the same where the solve at work began
    double norm = 0;                  ///< of this body, where a loop over members asks for it
    std::vector<solve::AppendedRow> own_rows;  ///< in an island of several: the body's part of the rows beside the matrices, in its own matrix, for its preconditioner
    std::size_t place = 0;            ///< of the body among those of the step
    std::size_t first_row = 0;        ///< of its vertices in the system of its island
    std::vector<double> diagonal;     ///< [row] mass part of the matrix
    std::vector<double> partial;
};

/// Stress of the current positions, made on request.
struct StressCache {
    bool valid = false;
    std::vector<Voigt> element, vertex, scratch;
    std::vector<double> element_von_mises, vertex_von_mises, element_energy;
    AlignedVector<double> quaternion, block_stress, block_energy;
    double energy_j = 0;
};

inline constexpr std::int32_t kFree = -1;  ///< owner of a free coordinate
inline constexpr std::int32_t kHeld = -2;  ///< owner of a coordinate fixed in place; 0.. are prescribed motions

/// How the elements of a body of several families of laws lie.
struct GroupedLayout {
    fem::ElementLayout layout;
    std::vector<solve::GatherMap> gather;  ///< [group]
};

struct BodyEdits;  // world/edits.h

struct Body {
    Body();
    ~Body();

    BodyDef def;
    std::string name;
    std::shared_ptr<const BodyTemplate> shape;
    std::unique_ptr<const GroupedLayout> own_layout;  ///< of a body of several families of laws; null: that of its template

    // Model: constant during a step.
    fem::ElementMaterials materials;  ///< of the definition, resolved
    std::unique_ptr<fem::Elements> elements;  ///< the law at work; holds the tangent of the current step
    std::vector<double> mass;         ///< [vertex]
    std::vector<double> young_pa;     ///< [element] at small strain: for pictures
    std::vector<double> stiffness_trace;  ///< of each vertex's diagonal block at rest [N/m]
    std::vector<std::int32_t> owner;  ///< [vertex * 3 + axis] kFree, kHeld, or an index into motions
    std::vector<Motion> motions;
    PreparedLoads loads;
    std::vector<std::int32_t> held_rows;    ///< matrix rows with a held coordinate of their own or of a neighbour
    bool supports_changed = true;           ///< what depends on them must be made anew
    ChoiceTimer timer;                 ///< of automatic_timed
    bool preconditioner_fits = false;  ///< the frozen one was built from state.hierarchy_x and state.hierarchy_held

    BodyState state, start;
    std::unique_ptr<BodyEdits> edits;  ///< null: the mesh is that of the definition it was added with
    Workspace work;
    std::variant<std::monostate, System<float>, System<double>> system;
    mutable StressCache stress;
    ContactSet contacts;

    void need_contact_surface() {
        if (!contacts.surface) contacts.surface = std::make_unique<ContactSurface>(data());
    }
    const TemplateData& data() const { return shape->data(); }
    const fem::ElementLayout& layout() const { return own_layout ? own_layout->layout : data().layout; }
    std::size_t element_count() const { return layout().elements; }
    std::size_t vertices() const { return mass.size(); }
    std::int32_t row_of(std::int32_t vertex) const { return data().pattern.row[std::size_t(vertex)]; }  ///< in its matrix
    bool is_held(std::size_t vertex, std::size_t axis) const { return owner[vertex * 3 + axis] != kFree; }
    bool frozen() const { return state.frozen[0] != 0; }
};

/// A drag spring at work. The weighted mean of a few vertices follows a target.
struct Drag {
    std::uint32_t generation = 0;  ///< 0: this slot is empty
    BodyId body;
    double stiffness = 0, damping = 0, max_force = 0;
    std::vector<std::int32_t> vertex;
    std::vector<double> weight;    ///< sums to one
    std::vector<Vec3> masked;      ///< weight per coordinate, zero where held; rebuilt with the supports
    std::vector<std::int32_t> row, own_row;  ///< in the system of the island, in the matrix of the body
    Vec3 offset = Vec3::Zero();    ///< from the weighted mean to the picked point
    Vec3 target = Vec3::Zero();
    Vec3 force = Vec3::Zero();
    // During a step: the row in the system, and what it adds.
    bool capped = false;
    Vec3 predicted = Vec3::Zero();

    template <class Points>
    Vec3 mean(const Points& p) const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < vertex.size(); ++i) sum += weight[i] * p[std::size_t(vertex[i])];
        return sum;
    }
};

/// Plastic strains as the elements want them: null where none flows.
inline const double* plastic_strain(const Body& body) { return body.state.plastic.empty() ? nullptr : body.state.plastic.data(); }

/// @error Error(invalid_argument) naming the field of BodyDef
std::unique_ptr<Body> make_body(const BodyDef& def, const WorldDef& world, std::size_t index, Isa isa);
/// The body without its history of edits, moved to the mesh of an edit with all that is on it: definition, supports, loads, state. Nothing of `from` changes.
std::unique_ptr<Body> make_edited(const Body& from, const MeshEdit& edit, const WorldDef& world, Isa isa);
/// Makes what depends on the materials of a definition: elements, mass, stiffness. Strong guarantee: where it throws, the body is as it was.
void apply_materials(Body& body, const BodyDef& def, const WorldDef& world, Isa isa);
/// Another preconditioner from the next step on; what the old one learned is forgotten.
void change_preconditioner(Body& body, PreconditionerKind kind, Isa isa);
/// The elements of a body's law and moduli, afresh.
std::unique_ptr<fem::Elements> make_body_elements(const Body& body, fem::MatrixPrecision precision, Tangent tangent, Isa isa, bool project);
/// body.system's matrix from the tangent of the last evaluation, with the factors of the last solve.
void assemble_matrix(Team& team, Body& body, double time_s);
/// Fills body.stress from the current positions, unless it is valid.
void update_stress(const Body& body, Team& team);

}  // namespace supple
