/// Newton's iteration on the equation of a step, its line search, and the load steps of the static integrator.
#include <algorithm>
#include <cmath>

#include "supple/base/clock.h"
#include "supple/solve/chunked_sum.h"
#include "supple/world/contact_stages.h"
#include "supple/world/stages.h"

namespace supple {

namespace {

using solve::kRowChunk;

constexpr double kOverflow = 1e300;       ///< a norm beyond it, or NaN: the body has blown up
constexpr int kMaxTrials = 12;            ///< of a line search
constexpr double kStagnation = 50;        ///< times the residual that rounding leaves: there a residual that no longer falls has come to its end
constexpr int kLongestWait = 8;           ///< iterations
constexpr double kFollowing = 1e-3;       ///< tolerance of the linear solve that takes a body along with its supports
constexpr double kSmallestLoadStep = 1.0 / 512;

enum class Outcome { converged, cap, not_finite };

/// dv . rhs
double work_along(StepContext& ctx, Island& island) {
    double total = 0;
    for (Member& member : island.members) {
        Workspace& w = member.body->work;
        total += solve::sum_over_rows(ctx.team, member.body->vertices(), w.partial, [&](std::size_t begin, std::size_t end) {
            double sum = 0;
            for (std::size_t i = begin; i < end; ++i) sum += w.dv[i].dot(w.rhs[i]);
            return sum;
        });
    }
    return total;
}

/// Forces and tangents at v0; the norm of b, not finite if a body has blown up.
double evaluate(StepContext& ctx, Island& island, bool at_current) {
    for_members(ctx, island.members, [&](StepContext& of, Body& body) { body.work.norm = evaluate_elements(of, body, at_current); });
    return norm_of(island, [](Body& body) { return body.work.norm; });
}

/// The whole of dv, unsearched.
void take_step(StepContext& ctx, Island& island) {
    take_contacts(ctx, island);
    for (Member& member : island.members) {
        Workspace& w = member.body->work;
        ctx.team.for_range(member.body->vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) w.v0[i] += w.dv[i];
        });
    }
}

/// v0 = v_start + s dv.
void move_to(StepContext& ctx, Island& island, double s) {
    for (Member& member : island.members) {
        Workspace& w = member.body->work;
        ctx.team.for_range(member.body->vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) w.v0[i] = w.v_start[i] + s * w.dv[i];
        });
    }
    advance_colliders(ctx, s);
}

/// Forces and tangent at v0, and the norm of the right-hand side with drag springs and contacts.
double look(StepContext& ctx, Watch& watch, Island& island) {
    const double norm = evaluate(ctx, island, false);
    const double with_touch = norm < kOverflow ? residual_with_touch(ctx, island) : norm;
    watch.lap(ctx, Stage::elements);
    return with_touch;
}

/// Goes along dv to where the right-hand side has no more than 0.8 of its first component along dv left against it (Matthies and Strang 1979: a
/// step that the potential energy agrees with, also where there is none), or where the residual itself has fallen. Returns the residual there.
double line_search(StepContext& ctx, Watch& watch, Island& island, double norm) {
    for (Member& member : island.members) member.body->work.v_start = member.body->work.v0;
    const double slope = work_along(ctx, island);
    double s = 1, low = 0, low_slope = slope;
    for (int trial = 0;; ++trial) {
        move_to(ctx, island, s);
        const double here = look(ctx, watch, island);
        const bool finite = here < kOverflow;
        const double g = finite ? work_along(ctx, island) : -HUGE_VAL;
        if ((finite && (slope <= 0 || g >= -0.8 * slope || here <= 0.9 * norm)) || trial == kMaxTrials) return here;
        const double secant = finite ? low_slope / (low_slope - g) : 0.2;
        s = low + (s - low) * std::clamp(secant, 0.1, 0.7);
    }
}

struct NewtonPlan {
    int iterations = 1;
    double tolerance = 0;
    bool is_static = false;
};

NewtonPlan plan_of(const SolverDef& def) {
    NewtonPlan plan;
    plan.is_static = def.integrator == Integrator::quasi_static;
    plan.iterations = def.newton_iterations > 0 ? def.newton_iterations : plan.is_static ? 100 : 1;
    plan.tolerance = plan.is_static && def.newton_tolerance == 0 ? 1e-6 : def.newton_tolerance;
    return plan;
}

bool projects(const Island& island) { return island.members[0].body->work.project; }
void set_projection(Island& island, bool project) {
    for (Member& member : island.members) member.body->work.project = project;
}

/// The linear system of this iterate, with the tangent as it is or made positive. The last evaluation stands at v0, one way or the other.
Solved solve_linearised(StepContext& ctx, Watch& watch, Island& island, bool project, double floor, double tolerance, bool first) {
    if (projects(island) != project) {
        set_projection(island, project);
        evaluate(ctx, island, false);
        watch.lap(ctx, Stage::elements);
    }
    for_members(ctx, island.members, [&](StepContext& of, Body& body) { assemble(of, body, island); });
    island.same_matrices = false;
    watch.lap(ctx, Stage::assemble);
    const Solved solved = solve_system(ctx, island, floor, tolerance, first);
    watch.lap(ctx, Stage::solve);
    if (solved == Solved::yes && !project && work_along(ctx, island) < 0) return Solved::indefinite;  // dv.A dv
    return solved;
}

/// From v0 to a solution. v0 and the element pass stand at the last iterate.
Outcome iterate(StepContext& ctx, Watch& watch, Island& island, const NewtonPlan& plan, double floor) {
    const SolverDef& def = ctx.world.def.solver;
    const bool to_tolerance = plan.tolerance > 0;
    const std::int64_t before_ns = now_ns();
    double norm = evaluate(ctx, island, def.linearise_at == LineariseAt::current && !plan.is_static);
    // The solves must leave time for the residual and the integration: about as long as the evaluation took.
    ctx.deadline_ns = ctx.body_end_ns == 0 ? 0 : ctx.body_end_ns - (now_ns() - before_ns);
    watch.lap(ctx, Stage::elements);
    if (!(norm < kOverflow)) return Outcome::not_finite;
    if (to_tolerance) norm = residual_with_touch(ctx, island);
    double first = norm, previous = norm, eta = 0.1;
    int wait = 0, next_wait = 1;  // iterations before the exact tangent gets its next chance
    for (int k = 0;; ++k) {
        if (to_tolerance) {
            const double scale = plan.is_static ? static_scale(ctx, island) : first;
            if ((k > 0 || plan.is_static) && norm <= std::max(plan.tolerance * scale, floor)) return Outcome::converged;
            if (k > 0 || plan.is_static) {
                const double rounding = rounding_residual(ctx, island);
                if (norm <= rounding || (norm > 0.5 * previous && k > 0 && norm <= kStagnation * rounding)) return Outcome::converged;
            }
            if (k == plan.iterations) return Outcome::cap;
            if (k > 0) {
                const double memory = 0.9 * eta * eta, ratio = norm / previous;
                eta = std::min(0.1, std::max(0.9 * ratio * ratio, memory > 0.1 ? memory : 0.0));
                eta = std::max(eta, 0.3 * std::max(plan.tolerance * scale, floor) / norm);  // no finer than Newton will ask for
            }
        }
        const double tolerance = to_tolerance ? std::clamp(eta, def.cg_relative_tolerance, 0.1) : def.cg_relative_tolerance;
        // Rayleigh's damping has the stiffness in its force: there the tangent must stay of one kind.
        const bool exact = to_tolerance && (plan.is_static || (k > 0 && def.rayleigh_stiffness_s == 0)) && wait-- <= 0;
        Solved solved = solve_linearised(ctx, watch, island, !exact, floor, tolerance, k == 0);
        if (solved == Solved::indefinite) {
            wait = next_wait;
            next_wait = std::min(2 * next_wait, kLongestWait);
            solved = solve_linearised(ctx, watch, island, true, floor, tolerance, k == 0);
        }
        if (solved == Solved::not_finite) return Outcome::not_finite;
        ctx.report.newton_iterations = std::max(ctx.report.newton_iterations, k + 1);
        previous = norm;
        if ((ctx.report.flags & StepFlag::budget) != StepFlag::none) {  // no time for more: what there is counts
            take_step(ctx, island);
            return Outcome::converged;
        }
        if (to_tolerance) {
            norm = line_search(ctx, watch, island, norm);
        } else {
            take_step(ctx, island);
            if (k + 1 == plan.iterations) return Outcome::converged;
            norm = evaluate(ctx, island, false);
            watch.lap(ctx, Stage::elements);
        }
        if (!(norm < kOverflow)) return Outcome::not_finite;
    }
}

/// v0 of the held coordinates when `part` of the step's prescribed motion is done.
void move_supports(Body& body, double part) {
    Workspace& w = body.work;
    for (std::size_t i = 0; i < body.vertices(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (body.is_held(i, axis)) w.v0[i][Eigen::Index(axis)] = part * w.target_v[i][Eigen::Index(axis)];
        }
    }
}

/// Takes the free vertices along where supports move, as the tangent at v0 has it: were they to stay behind, the elements at a support that moves far would be turned inside
/// out before the first iteration. `part` as in move_supports().
bool follow_supports(StepContext& ctx, Watch& watch, Island& island, double part, double floor) {
    double moved = 0;
    for (Member& member : island.members) {
        Workspace& w = member.body->work;
        w.v_start = w.v0;
        w.jump.resize(w.v0.size());
        move_supports(*member.body, part);
        for (std::size_t i = 0; i < w.v0.size(); ++i) {
            w.jump[i] = w.v0[i] - w.v_start[i];
            moved = std::max(moved, w.jump[i].squaredNorm());
        }
    }
    if (moved == 0) return true;
    for (Member& member : island.members) member.body->work.v0 = member.body->work.v_start;
    const auto linearised = [&](bool project) {
        set_projection(island, project);
        if (!(evaluate(ctx, island, false) < kOverflow)) return Solved::not_finite;
        for (Member& member : island.members) {
            Body& body = *member.body;
            Workspace& w = body.work;
            tangent_product(ctx, body, w.jump);
            const double scale = stiffness_scale(ctx, body);
            for (std::size_t i = 0; i < body.vertices(); ++i) w.b[i] -= scale * w.product[i];
            assemble(ctx, body, island);
        }
        island.same_matrices = false;
        watch.lap(ctx, Stage::assemble);
        const Solved solved = solve_system(ctx, island, floor, kFollowing, false);
        watch.lap(ctx, Stage::solve);
        return solved;
    };
    Solved solved = linearised(false);
    if (solved == Solved::indefinite) solved = linearised(true);
    if (solved != Solved::yes) return false;
    for (Member& member : island.members) {
        Workspace& w = member.body->work;
        for (std::size_t i = 0; i < w.v0.size(); ++i) w.v0[i] += w.jump[i] + w.dv[i];
    }
    return true;
}

/// Equilibrium by load steps: what the start lacks to balance is let in part by part, with the motion of the supports. The whole at once is tried
/// first; a part that Newton does not manage is halved.
bool find_equilibrium(StepContext& ctx, Watch& watch, Island& island, const NewtonPlan& plan, double floor) {
    const auto withhold = [&](double part) {
        for (Member& member : island.members) member.body->work.withheld = part;
    };
    withhold(0);
    for (Member& member : island.members) {
        member.body->work.target_v = member.body->work.v0;
        move_supports(*member.body, 0);
    }
    if (!(evaluate(ctx, island, false) < kOverflow)) return false;
    for (Member& member : island.members) member.body->work.unbalance = member.body->work.b;
    double left = 1, part = 1;
    while (left > 0) {
        for (Member& member : island.members) member.body->work.v_good = member.body->work.v0;
        const StepFlag flags = ctx.report.flags;
        const double next = std::max(0.0, left - part);
        withhold(next);
        Outcome outcome = Outcome::not_finite;
        if (follow_supports(ctx, watch, island, 1 - next, floor)) outcome = iterate(ctx, watch, island, plan, floor);
        if (outcome == Outcome::converged) {
            left = next;
            part = std::min(2 * part, left);
            continue;
        }
        for (Member& member : island.members) {
            Body& body = *member.body;
            body.work.v0 = body.work.v_good;
            fem::seed_rotations(ctx.team, body.layout(), body.state.x, body.state.quaternion);
        }
        ctx.report.flags = flags;  // what the solves of an attempt met with is of no account
        part /= 2;
        if (part < kSmallestLoadStep) {
            ctx.report.flags |= StepFlag::no_equilibrium;
            withhold(0);
            return evaluate(ctx, island, false) < kOverflow;
        }
    }
    return true;
}

}  // namespace

bool solve_step(StepContext& ctx, Watch& watch, Island& island, double floor) {
    const NewtonPlan plan = plan_of(ctx.world.def.solver);
    set_projection(island, !plan.is_static);  // elsewhere than at rest the tangent of a prediction may be anything
    if (plan.is_static) return find_equilibrium(ctx, watch, island, plan, floor);
    const Outcome outcome = iterate(ctx, watch, island, plan, floor);
    if (outcome == Outcome::cap) ctx.report.flags |= StepFlag::newton_cap;
    return outcome != Outcome::not_finite;
}

}  // namespace supple
