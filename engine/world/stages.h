#pragma once
#include <cmath>

#include "supple/base/clock.h"
#include "supple/fem/element_passes.h"
#include "supple/world/impl.h"

namespace supple {

/// The stages of a step, on one body or on an island of them, whose system is one. With the scheme x = base_x + h v of time_scheme.cpp and v0 the velocity that Newton has reached (at first that of
/// the last step, held coordinates at their target), y = base_x + h v0:
///     [(1 + h alpha) M + (h^2 + h beta) K(y)] dv = h (f(y) + f_ext - C v0) - M (v0 - base_v),      C = alpha M + beta K(y),
/// then v0 += dv. Held coordinates have dv = 0; what the equation lacks there is the support's reaction times h.
/// LineariseAt::current evaluates at x instead: f(x) - K(x)(y - x) takes the place of f(y) in the first iteration. Static: without M and C.

/// Times the stages: what has passed since the last lap goes to `stage`.
struct Watch {
    Stopwatch stopwatch;
    void lap(StepContext& ctx, Stage stage) { ctx.report.stage_ms[std::size_t(stage)] += stopwatch.lap_ms(); }
};

/// f_ext: gravity and loads of a moment; what follows the body as it stands (evaluate_elements() does that anew).
void gather_loads(StepContext& ctx, Body& body, double time_s);
/// The integrator's bases for this step, and v0.
void begin_scheme(StepContext& ctx, Body& body);
/// Velocities and positions at the end of the step, history.
void end_scheme(StepContext& ctx, Body& body);
/// Newton's iteration from v0 to the step's solution, or to where its limits end it (reported). False if a body has blown up.
bool solve_step(StepContext& ctx, Watch& watch, Island& island, double floor);

/// Element rotations, forces, records; then the right-hand side b. Returns |b| over free coordinates; not finite if the body has blown up.
double evaluate_elements(StepContext& ctx, Body& body, bool at_current);
/// The tangent of the last evaluation as the solve wants it: the operator of the elements (solves_by_elements), or the matrix.
void assemble(StepContext& ctx, Body& body, const Island& island);
/// Norm of the right-hand side below which a body rests: a ten-millionth of its loads needs no solving, less where the tolerance asks for less.
double resting_residual(StepContext& ctx, Island& island);
/// Right-hand side rhs at v0 with the forces of drag springs and contacts; its norm over free coordinates.
double residual_with_touch(StepContext& ctx, Island& island);
/// What a static residual is compared with: the loads, or the reactions where they are larger (times h).
double static_scale(StepContext& ctx, Island& island);
/// Norm over free coordinates that rounding alone leaves of a right-hand side in balance: of the positions that forces are made from (an error of eps |x| in x is one of eps K |x|), of loads and momenta.
double rounding_residual(StepContext& ctx, Island& island);
enum class Solved { yes, not_finite, indefinite };
/// Drag springs, contacts and dv, to `tolerance` of the right-hand side. A tangent that was not projected (work.project) may turn out to be indefinite.
/// @param first  of the step: with warm starts, and remembered by the choice of preconditioner
Solved solve_system(StepContext& ctx, Island& island, double floor, double tolerance, bool first);
/// The new state of all members, if it is finite; if not, false and nothing has changed. read_contacts() follows.
bool integrate(StepContext& ctx, Island& island);
/// The body stays where the step found it, takes no further part, and is reported.
void contain(StepContext& ctx, BodyId id, Body& body);

/// The touch at the start of a step: no drag spring at its cap, the contacts around v0 with colliders and with one another.
void begin_touch(StepContext& ctx, std::span<Member> members);
/// The drag springs' forces at the new positions; no force on a body that is contained.
void read_drags(World::Impl& world, BodyId id, Body& body);
void drop_drags(World::Impl& world, BodyId id);

/// Rebuilds what depends on which coordinates are held. Allocates: the first step after an edit.
void refresh_supports(World::Impl& world, BodyId id, Body& body);

/// Norm of what has a norm in every body.
template <class Of>
double norm_of(Island& island, Of&& of) {
    if (island.alone()) return of(*island.members[0].body);
    double square = 0;
    for (Member& member : island.members) {
        const double norm = of(*member.body);
        square += norm * norm;
    }
    return std::sqrt(square);
}

/// Runs visit(context, body) for all members: those that a team shares one after the other, then the others side by side, each by one thread.
template <class Visit>
void for_members(StepContext& ctx, std::span<Member> members, Visit&& visit) {
    const auto large = [&](std::size_t i) { return members.size() == 1 || members[i].body->element_count() >= kMinElementsForThreads; };
    for (std::size_t i = 0; i < members.size(); ++i)
        if (large(i)) visit(ctx, *members[i].body);
    ctx.team.for_chunks(members.size(), [&](std::size_t i) {
        if (large(i)) return;
        StepContext lone{ctx.world.alone, ctx.world, ctx.scratch, ctx.report, ctx.time_s};
        visit(lone, *members[i].body);
    });
}

// -- shared by the stages ---------------------------------------------------------------------------

/// v with the held coordinates zeroed.
inline Vec3 free_part(const Body& body, std::size_t vertex, const Vec3& v) {
    const std::int32_t* owner = body.owner.data() + vertex * 3;
    return {owner[0] == kFree ? v[0] : 0.0, owner[1] == kFree ? v[1] : 0.0, owner[2] == kFree ? v[2] : 0.0};
}

inline bool is_static(const StepContext& ctx) { return ctx.world.def.solver.integrator == Integrator::quasi_static; }

/// h' of a scheme once it is under way (time_scheme.cpp).
inline double scheme_step(const WorldDef& def) {
    const double h = def.time_step_s;
    return def.solver.integrator == Integrator::newmark ? h / 2 : def.solver.integrator == Integrator::bdf2 ? 2 * h / 3 : h;
}

/// Factors of K and M in the matrix.
inline double stiffness_scale(const StepContext& ctx, const Body& body) {
    const double h = body.work.h;
    return is_static(ctx) ? h * h : h * (h + ctx.world.def.solver.rayleigh_stiffness_s);
}
inline double mass_scale(const StepContext& ctx, const Body& body) {
    return is_static(ctx) ? 0 : 1 + body.work.h * ctx.world.def.solver.rayleigh_mass_1_s;
}

/// work.product = K field, with the rotations of the last element pass; float64, matrix-free.
void stiffness_product(StepContext& ctx, Body& body, const std::vector<Vec3>& field);
/// The same, with the stiffness of followers where the tangent is taken as it is (work.project): what the matrix of a solve holds.
void tangent_product(StepContext& ctx, Body& body, const std::vector<Vec3>& field);

/// Calls visit(System<Real>&) for the precision that the body has.
template <class Visit>
void with_system(Body& body, Visit&& visit) {
    if (auto* single = std::get_if<System<float>>(&body.system)) visit(*single);
    if (auto* dbl = std::get_if<System<double>>(&body.system)) visit(*dbl);
}

}  // namespace supple
