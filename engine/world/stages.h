#pragma once
#include "supple/fem/element_passes.h"
#include "supple/world/impl.h"

namespace supple {

/// The stages of a step, on one body. Implicit Euler for the velocity: with v0 the velocity that Newton has reached (at first: v, held
/// coordinates at their target) and y = x + h v0,
///     [(1 + h alpha) M + (h^2 + h beta) K(y)] dv = h (f(y) + f_ext - C v0) - M (v0 - v),      C = alpha M + beta K(y),
/// then v = v0 + dv, x = x + h v. Held coordinates have dv = 0; what the equation lacks there is the support's reaction times h.
/// LineariseAt::current evaluates at x instead: f(x) - h K(x) v0 takes the place of f(y) in the first iteration.

/// Loads at the end of the step, and v0.
void prepare_step(StepContext& ctx, Body& body);
/// Element rotations, forces, records; then the right-hand side b. Returns |b| over free coordinates; not finite if the body has blown up.
double evaluate_elements(StepContext& ctx, Body& body, bool at_current);
void assemble(StepContext& ctx, Body& body);
/// Norm of the right-hand side below which a body rests: a ten-millionth of its loads needs no solving, less where the tolerance asks for less.
double resting_residual(StepContext& ctx, Body& body);
/// Norm over free coordinates of the right-hand side with the forces of the drag springs.
double residual_with_drags(StepContext& ctx, BodyId id, Body& body);
/// Drag springs and dv; v0 += dv. False if the solution is not finite.
bool solve_system(StepContext& ctx, BodyId id, Body& body, double floor, bool first);
/// Velocities and positions, history. False (and nothing changed) if they are not finite.
bool integrate(StepContext& ctx, BodyId id, Body& body);
/// The body stays where the step found it, takes no further part, and is reported.
void contain(StepContext& ctx, BodyId id, Body& body);

/// The drag springs of a body: none at its cap at the start of a step; their forces at the new positions; no force on a body that is contained.
void begin_drags(World::Impl& world, BodyId id);
void read_drags(World::Impl& world, BodyId id, Body& body);
void drop_drags(World::Impl& world, BodyId id);

/// Rebuilds what depends on which coordinates are held. Allocates: the first step after an edit.
void refresh_supports(World::Impl& world, BodyId id, Body& body);

// -- shared by the stages ---------------------------------------------------------------------------

/// v with the held coordinates zeroed.
inline Vec3 free_part(const Body& body, std::size_t vertex, const Vec3& v) {
    const std::int32_t* owner = body.owner.data() + vertex * 3;
    return {owner[0] == kFree ? v[0] : 0.0, owner[1] == kFree ? v[1] : 0.0, owner[2] == kFree ? v[2] : 0.0};
}

inline double stiffness_scale(const WorldDef& def) { return def.time_step_s * (def.time_step_s + def.solver.rayleigh_stiffness_s); }
inline double mass_scale(const WorldDef& def) { return 1 + def.time_step_s * def.solver.rayleigh_mass_1_s; }

/// work.product = K field, with the rotations of the last element pass; float64, matrix-free.
void stiffness_product(StepContext& ctx, Body& body, const std::vector<Vec3>& field);

/// Calls visit(System<Real>&) for the precision that the body has.
template <class Visit>
void with_system(Body& body, Visit&& visit) {
    if (auto* single = std::get_if<System<float>>(&body.system)) visit(*single);
    if (auto* dbl = std::get_if<System<double>>(&body.system)) visit(*dbl);
}

}  // namespace supple
