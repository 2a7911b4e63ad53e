#include <algorithm>
#include <cmath>

#include "supple/solve/chunked_sum.h"
#include "supple/world/contact_stages.h"
#include "supple/world/precondition.h"
#include "supple/world/stages.h"

namespace supple {

namespace {

using solve::kRowChunk;

constexpr double kWorstContacts = 0.1;  // of their force: what contacts may disagree in without a flag

/// How often a system may still be solved, contacts looked for anew, and deep ones made stiffer.
struct TouchRounds {
    int solves = 0, searches = 3, raises = 4;
};

/// Force of a drag spring whose patch is at x and moves with v.
Vec3 drag_force(const Drag& drag, const Vec3& x, const Vec3& v) {
    return drag.stiffness * (drag.target - (x + drag.offset)) - drag.damping * v;
}

/// A spring at rest has nothing to damp.
double damping(const StepContext& ctx, const Drag& drag) { return is_static(ctx) ? 0 : drag.damping; }

bool over_cap(const Drag& drag, const Vec3& force) { return drag.max_force > 0 && force.norm() > drag.max_force; }

template <class Visit>
void for_drags_of(World::Impl& world, BodyId id, Visit&& visit) {
    for (Drag& drag : world.drags) {
        if (drag.generation != 0 && drag.body == id) visit(drag);
    }
}

/// Force of a spring with the velocity v0 that Newton has reached: at the end of the step, wherever the elements are linearised.
void predict(StepContext& ctx, const Body& body, Drag& drag) {
    if (drag.capped) return;
    const Vec3 v = drag.mean(body.work.v0);
    drag.predicted = drag_force(drag, drag.mean(body.work.base_x) + body.work.h * v, is_static(ctx) ? Vec3(Vec3::Zero()) : v);
    drag.capped = over_cap(drag, drag.predicted);
    if (drag.capped) drag.predicted *= drag.max_force / drag.predicted.norm();
}

/// The springs' forces with v0, and the rows of springs below their cap and of contacts.
void append_touch(StepContext& ctx, BodyId id, Body& body) {
    const double h = body.work.h;
    ctx.world.appended.clear();
    for_drags_of(ctx.world, id, [&](Drag& drag) {
        predict(ctx, body, drag);
        if (!drag.capped) ctx.world.appended.push_back({drag.vertex, drag.masked, h * (h * drag.stiffness + damping(ctx, drag)) * Mat3::Identity()});
    });
    append_contacts(ctx, body);
}

/// r += h times the forces of springs and contacts: at the solution dv, or where v0 stands.
void add_touch(StepContext& ctx, BodyId id, Body& body, bool at_solution, Vec3* r) {
    const double h = body.work.h;
    for_drags_of(ctx.world, id, [&](Drag& drag) {
        Vec3 force = drag.predicted;
        if (at_solution && !drag.capped) force -= (h * drag.stiffness + damping(ctx, drag)) * drag.mean(body.work.dv);
        for (std::size_t i = 0; i < drag.vertex.size(); ++i) r[std::size_t(drag.vertex[i])] += h * drag.weight[i] * force;
    });
    if (at_solution) solve_colliders(ctx, body);
    add_contact_forces(ctx, body, at_solution, r);
}

/// After a solve: a spring that ended above its cap becomes a load. True if one did, so that the solve must be repeated.
bool cap_drags(StepContext& ctx, BodyId id, Body& body) {
    const double h = body.work.h;
    bool changed = false;
    for_drags_of(ctx.world, id, [&](Drag& drag) {
        if (drag.capped) return;
        const Vec3 end = drag.predicted - (h * drag.stiffness + damping(ctx, drag)) * drag.mean(body.work.dv);
        if (!over_cap(drag, end)) return;
        drag.predicted = end * (drag.max_force / end.norm());
        drag.capped = changed = true;
    });
    return changed;
}

/// r = what the equation lacks at dv in float64, matrix-free, zero where held; what is left over there is the supports' reaction.
void true_residual(StepContext& ctx, BodyId id, Body& body, Vec3* r) {
    const double mass = mass_scale(ctx, body), stiffness = stiffness_scale(ctx, body), inv_h = 1 / body.work.h;
    Workspace& w = body.work;
    tangent_product(ctx, body, w.dv);
    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) r[i] = w.bare[i] = w.b[i] - mass * body.mass[i] * w.dv[i] - stiffness * w.product[i];
    });
    add_touch(ctx, id, body, true, r);
    ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 free = free_part(body, i, r[i]);
            body.state.reaction[i] = -inv_h * (r[i] - free);
            r[i] = free;
        }
    });
}

/// Norm of the free part of a vertex field; `also(i)` runs for each vertex on the way.
template <class Also>
double free_norm(StepContext& ctx, Body& body, const std::vector<Vec3>& field, Also&& also) {
    return std::sqrt(solve::sum_over_rows(ctx.team, body.vertices(), body.work.partial, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 free = free_part(body, i, field[i]);
            also(i, free);
            sum += free.squaredNorm();
        }
        return sum;
    }));
}

double free_norm(StepContext& ctx, Body& body, const std::vector<Vec3>& field) {
    return free_norm(ctx, body, field, [](std::size_t, const Vec3&) {});
}

/// Stops a body whose forces balance to within `floor` even when it stands still: it would creep on at a speed that no solve is asked to
/// remove, and drift back above the floor. True if dv and its true residual are set so.
bool comes_to_rest(StepContext& ctx, BodyId id, Body& body, double rhs_norm, double floor) {
    if (!(rhs_norm <= 2 * floor) || is_static(ctx)) return false;
    Workspace& w = body.work;
    for (std::size_t i = 0; i < body.vertices(); ++i) w.dv[i] = -free_part(body, i, w.v0[i]);
    true_residual(ctx, id, body, w.residual.data());
    if (free_norm(ctx, body, w.residual) <= floor) return true;
    std::fill(w.dv.begin(), w.dv.end(), Vec3::Zero());
    return false;
}

void report_solve(StepContext& ctx, Body& body, const solve::LinearSolveResult& result, double scale) {
    // Below what rounding leaves of forces in balance there is nothing to be had by any precision.
    if (result.stalled && result.residual > rounding_residual(ctx, body)) ctx.report.flags |= StepFlag::residual_stalled;
    if (result.out_of_time) {
        ctx.report.flags |= StepFlag::budget;
    } else if (!result.converged && !result.stalled) {
        ctx.report.flags |= StepFlag::iteration_cap;
    }
    if (scale > 0) ctx.report.cg_relative_residual = std::max(ctx.report.cg_relative_residual, result.residual / scale);
}

}  // namespace

double resting_residual(StepContext& ctx, Body& body) {
    return std::min(1e-7, ctx.world.def.solver.cg_relative_tolerance) * body.work.h * free_norm(ctx, body, body.work.f_ext);
}

double static_scale(StepContext& ctx, Body& body) {
    Workspace& w = body.work;
    const double held = std::sqrt(solve::sum_over_rows(ctx.team, body.vertices(), w.partial, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) sum += (w.b[i] - free_part(body, i, w.b[i])).squaredNorm();
        return sum;
    }));
    return std::max(held, w.h * free_norm(ctx, body, w.f_ext));
}

double rounding_residual(StepContext& ctx, Body& body) {
    constexpr double kEpsilon = 2.3e-16;
    Workspace& w = body.work;
    const bool inertia = !is_static(ctx);
    return kEpsilon * std::sqrt(solve::sum_over_rows(ctx.team, body.vertices(), w.partial, [&](std::size_t begin, std::size_t end) {
               double sum = 0;
               for (std::size_t i = begin; i < end; ++i) {
                   Vec3 size = w.f_ext[i].cwiseAbs() + body.stiffness_trace[i] * w.base_x[i].cwiseAbs();
                   size *= w.h;
                   if (inertia) size += body.mass[i] * (w.v0[i].cwiseAbs() + w.base_v[i].cwiseAbs());
                   sum += free_part(body, i, size).squaredNorm();
               }
               return sum;
           }));
}

double residual_with_touch(StepContext& ctx, BodyId id, Body& body) {
    for_drags_of(ctx.world, id, [&](Drag& drag) { predict(ctx, body, drag); });
    move_contacts(ctx, body);
    body.work.rhs = body.work.b;
    add_touch(ctx, id, body, false, body.work.rhs.data());
    return free_norm(ctx, body, body.work.rhs);
}

void begin_touch(StepContext& ctx, BodyId id, Body& body) {
    for_drags_of(ctx.world, id, [](Drag& drag) { drag.capped = false; });
    std::fill(body.work.dv.begin(), body.work.dv.end(), Vec3::Zero());
    rest_colliders(ctx);
    find_contacts(ctx, id, body);
}

void drop_drags(World::Impl& world, BodyId id) {
    for_drags_of(world, id, [](Drag& drag) { drag.force = Vec3::Zero(); });
}

namespace {

/// After a solve: what it has led to is what it was told. If not, contacts and springs have been told anew, and it must be repeated from where it is.
bool touch_agrees(StepContext& ctx, BodyId id, Body& body, TouchRounds& rounds) {
    const bool last = ++rounds.solves >= ctx.world.def.solver.contact_iterations;
    const bool capped = cap_drags(ctx, id, body);
    const ContactCheck check = update_contacts(ctx, body, rounds.raises > 0, last && !capped);
    if (check.raised) --rounds.raises;
    if (last && !capped) {
        if (check.error > kWorstContacts) ctx.report.flags |= StepFlag::contact_cap;
        return true;
    }
    if (capped || !check.agrees) return false;
    if (rounds.searches == 0 || !contacts_are_stale(ctx, body)) return true;
    --rounds.searches;
    find_contacts(ctx, id, body);
    return false;
}

}  // namespace

Solved solve_system(StepContext& ctx, BodyId id, Body& body, double floor, double tolerance, bool first) {
    const SolverDef& def = ctx.world.def.solver;
    Workspace& w = body.work;
    std::fill(w.dv.begin(), w.dv.end(), Vec3::Zero());
    rest_colliders(ctx);
    if (!first || is_static(ctx)) find_contacts(ctx, id, body);  // begin_touch did, and v0 stands there still
    TouchRounds rounds;
    solve::LinearSolveDef solve_def;
    double rhs_norm = 0;
    for (bool again = false;; again = true) {
        append_touch(ctx, id, body);
        std::vector<Vec3>& missing = again ? w.residual : w.rhs;  // rhs stays that of v0: line searches ask for it
        missing = again ? w.bare : w.b;
        add_touch(ctx, id, body, true, missing.data());
        const double norm = free_norm(ctx, body, missing, [&](std::size_t i, const Vec3& free) { w.free_rhs[i] = free; });
        if (!again) {
            rhs_norm = norm;
            // Once above the floor, well below it: or the next step would be above it again.
            solve_def.target = std::max(tolerance * rhs_norm, rhs_norm > floor ? 0.3 * floor : floor);
            solve_def.max_iterations = def.cg_max_iterations;
            solve_def.deadline_ns = ctx.deadline_ns;
            solve_def.only_definite = !w.project;
        }
        const std::span<const Vec3> guesses[2] = {body.state.dv1, body.state.dv2};
        const bool warm = first && !again && !is_static(ctx);
        solve::LinearSolveResult result;
        if (!again && comes_to_rest(ctx, id, body, rhs_norm, floor)) {
            result.converged = true;
            result.residual = free_norm(ctx, body, w.residual);
        } else {
            result = solve_preconditioned(ctx, body, std::span(guesses, warm ? 2 : 0), solve_def, first && !again,
                                          [&](const Vec3*, Vec3* r) { true_residual(ctx, id, body, r); });
        }
        ctx.report.cg_iterations += result.iterations;
        if (result.indefinite) return Solved::indefinite;
        if (!std::isfinite(result.residual)) return Solved::not_finite;
        report_solve(ctx, body, result, std::max(rhs_norm, floor / tolerance));
        if (result.out_of_time || touch_agrees(ctx, id, body, rounds)) return Solved::yes;
        ++ctx.report.contact_iterations;
    }
}

void read_drags(World::Impl& world, BodyId id, Body& body) {
    for_drags_of(world, id, [&](Drag& drag) {
        drag.force = drag.capped ? drag.predicted : drag_force(drag, drag.mean(body.state.x), drag.mean(body.state.v));
    });
}

}  // namespace supple
