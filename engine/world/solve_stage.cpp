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
constexpr int kEarlySearches = 2;       // solves: the first ones go so far that other contacts are looked for at once
constexpr int kSettling = 4;            // solves that must be left: what is found anew may start open, and the next solve falls through it

/// How often a system may still be solved, contacts looked for anew, and deep ones made stiffer.
struct TouchRounds {
    int solves = 0, searches = 3, raises = 4;
    double loose = 1;      ///< the last solve left so many times what it may in the end
    bool agreed = false;   ///< after the last solve
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

/// The row of a spring in the system, and in the matrix of its body.
void append_spring(StepContext& ctx, const Island& island, Body& body, Drag& drag, const Mat3& K) {
    drag.own_row.resize(drag.vertex.size());
    drag.row.resize(drag.vertex.size());
    for (std::size_t i = 0; i < drag.row.size(); ++i) {
        drag.own_row[i] = body.row_of(drag.vertex[i]);
        drag.row[i] = drag.own_row[i] + std::int32_t(body.work.first_row);
    }
    ctx.scratch.appended.push_back({drag.row, drag.masked, K});
    if (!island.alone()) body.work.own_rows.push_back({drag.own_row, drag.masked, K});
}

/// The springs' forces with v0, and the rows of springs below their cap and of contacts.
void append_touch(StepContext& ctx, Island& island) {
    ctx.scratch.appended.clear();
    for (Member& member : island.members) {
        Body& body = *member.body;
        const double h = body.work.h;
        member.body->work.own_rows.clear();
        for_drags_of(ctx.world, member.id, [&](Drag& drag) {
            predict(ctx, body, drag);
            if (drag.capped) return;
            append_spring(ctx, island, body, drag, h * (h * drag.stiffness + damping(ctx, drag)) * Mat3::Identity());
        });
    }
    append_contacts(ctx, island);
}

/// field += h times the forces of springs and contacts: at the solution dv, or where v0 stands.
void add_touch(StepContext& ctx, Island& island, bool at_solution, std::vector<Vec3> Workspace::* field) {
    for (Member& member : island.members) {
        Workspace& w = member.body->work;
        std::vector<Vec3>& r = w.*field;
        for_drags_of(ctx.world, member.id, [&](Drag& drag) {
            Vec3 force = drag.predicted;
            if (at_solution && !drag.capped) force -= (w.h * drag.stiffness + damping(ctx, drag)) * drag.mean(w.dv);
            for (std::size_t i = 0; i < drag.vertex.size(); ++i) r[std::size_t(drag.vertex[i])] += w.h * drag.weight[i] * force;
        });
    }
    if (at_solution) solve_colliders(ctx);
    add_contact_forces(ctx, island, at_solution, field);
}

/// After a solve: a spring that ended above its cap becomes a load. True if one did, so that the solve must be repeated.
bool cap_drags(StepContext& ctx, Island& island) {
    bool changed = false;
    for (Member& member : island.members) {
        const Workspace& w = member.body->work;
        for_drags_of(ctx.world, member.id, [&](Drag& drag) {
            if (drag.capped) return;
            const Vec3 end = drag.predicted - (w.h * drag.stiffness + damping(ctx, drag)) * drag.mean(w.dv);
            if (!over_cap(drag, end)) return;
            drag.predicted = end * (drag.max_force / end.norm());
            drag.capped = changed = true;
        });
    }
    return changed;
}

/// residual = what the equation lacks at dv in float64, matrix-free, zero where held; what is left over there is the supports' reaction.
void true_residual(StepContext& ctx, Island& island) {
    for_members(ctx, island.members, [](StepContext& of, Body& body) {
        const double mass = mass_scale(of, body), stiffness = stiffness_scale(of, body);
        Workspace& w = body.work;
        tangent_product(of, body, w.dv);
        of.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) w.residual[i] = w.bare[i] = w.b[i] - mass * body.mass[i] * w.dv[i] - stiffness * w.product[i];
        });
    });
    add_touch(ctx, island, true, &Workspace::residual);
    for (Member& member : island.members) {
        Body& body = *member.body;
        Workspace& w = body.work;
        const double inv_h = 1 / w.h;
        ctx.team.for_range(body.vertices(), kRowChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Vec3 free = free_part(body, i, w.residual[i]);
                body.state.reaction[i] = -inv_h * (w.residual[i] - free);
                w.residual[i] = free;
            }
        });
    }
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

double free_norm(StepContext& ctx, Island& island, std::vector<Vec3> Workspace::* field) {
    return norm_of(island, [&](Body& body) { return free_norm(ctx, body, body.work.*field); });
}

/// Stops bodies whose forces balance to within `floor` even when they stand still: they would creep on at a speed that no solve is asked to
/// remove, and drift back above the floor. True if dv and its true residual are set so.
bool comes_to_rest(StepContext& ctx, Island& island, double rhs_norm, double floor) {
    if (!(rhs_norm <= 2 * floor) || is_static(ctx)) return false;
    for (Member& member : island.members) {
        Workspace& w = member.body->work;
        for (std::size_t i = 0; i < member.body->vertices(); ++i) w.dv[i] = -free_part(*member.body, i, w.v0[i]);
    }
    true_residual(ctx, island);
    if (free_norm(ctx, island, &Workspace::residual) <= floor) return true;
    for (Member& member : island.members) std::fill(member.body->work.dv.begin(), member.body->work.dv.end(), Vec3::Zero());
    return false;
}

void report_solve(StepContext& ctx, Island& island, const solve::LinearSolveResult& result, double scale) {
    // Below what rounding leaves of forces in balance there is nothing to be had by any precision.
    if (result.stalled && result.residual > rounding_residual(ctx, island)) ctx.report.flags |= StepFlag::residual_stalled;
    if (result.out_of_time) {
        ctx.report.flags |= StepFlag::budget;
    } else if (!result.converged && !result.stalled) {
        ctx.report.flags |= StepFlag::iteration_cap;
    }
    if (scale > 0) ctx.report.cg_relative_residual = std::max(ctx.report.cg_relative_residual, result.residual / scale);
}

}  // namespace

double resting_residual(StepContext& ctx, Island& island) {
    return std::min(1e-7, ctx.world.def.solver.cg_relative_tolerance) * norm_of(island, [&](Body& body) { return body.work.h * free_norm(ctx, body, body.work.f_ext); });
}

double static_scale(StepContext& ctx, Island& island) {
    const double held = norm_of(island, [&](Body& body) {
        const Workspace& w = body.work;
        return std::sqrt(solve::sum_over_rows(ctx.team, body.vertices(), body.work.partial, [&](std::size_t begin, std::size_t end) {
            double sum = 0;
            for (std::size_t i = begin; i < end; ++i) sum += (w.b[i] - free_part(body, i, w.b[i])).squaredNorm();
            return sum;
        }));
    });
    return std::max(held, norm_of(island, [&](Body& body) { return body.work.h * free_norm(ctx, body, body.work.f_ext); }));
}

double rounding_residual(StepContext& ctx, Island& island) {
    constexpr double kEpsilon = 2.3e-16;
    const bool inertia = !is_static(ctx);
    return kEpsilon * norm_of(island, [&](Body& body) {
               const Workspace& w = body.work;
               return std::sqrt(solve::sum_over_rows(ctx.team, body.vertices(), body.work.partial, [&](std::size_t begin, std::size_t end) {
                   double sum = 0;
                   for (std::size_t i = begin; i < end; ++i) {
                       Vec3 size = w.f_ext[i].cwiseAbs() + body.stiffness_trace[i] * w.base_x[i].cwiseAbs();
                       size *= w.h;
                       if (inertia) size += body.mass[i] * (w.v0[i].cwiseAbs() + w.base_v[i].cwiseAbs());
                       sum += free_part(body, i, size).squaredNorm();
                   }
                   return sum;
               }));
           });
}

double residual_with_touch(StepContext& ctx, Island& island) {
    for (Member& member : island.members) {
        for_drags_of(ctx.world, member.id, [&](Drag& drag) { predict(ctx, *member.body, drag); });
        member.body->work.rhs = member.body->work.b;
    }
    move_contacts(ctx, island);
    add_touch(ctx, island, false, &Workspace::rhs);
    return free_norm(ctx, island, &Workspace::rhs);
}

void begin_touch(StepContext& ctx, std::span<Member> members) {
    for (Member& member : members) {
        for_drags_of(ctx.world, member.id, [](Drag& drag) { drag.capped = false; });
        std::fill(member.body->work.dv.begin(), member.body->work.dv.end(), Vec3::Zero());
    }
    rest_colliders(ctx);
    find_contacts(ctx, members, false);
}

void drop_drags(World::Impl& world, BodyId id) {
    for_drags_of(world, id, [](Drag& drag) { drag.force = Vec3::Zero(); });
}

namespace {

/// After a solve: what it has led to is what it was told. If not, contacts and springs have been told anew, and it must be repeated from where it is.
///
/// The solves are a semismooth Newton iteration, whose full steps cycle where a stiff contact opens and another shuts: a step ends where it no longer does work.
bool touch_agrees(StepContext& ctx, Island& island, const Unsolved& may_leave, TouchRounds& rounds) {
    const bool last = ++rounds.solves >= ctx.world.def.solver.contact_iterations;
    const bool capped = cap_drags(ctx, island), at_end = last && !capped;
    const bool time_to_settle = rounds.solves + kSettling <= ctx.world.def.solver.contact_iterations;
    const ContactCheck check = check_contacts(ctx, island, may_leave, rounds.raises > 0 && !at_end);
    if (at_end) {  // the forces stay those that the solution was found with
        if (check.error > kWorstContacts) ctx.report.flags |= StepFlag::contact_cap;
        return true;
    }
    if (check.raised) --rounds.raises;
    const bool changed = cap_colliders(ctx) || check.raised || capped;
    rounds.agreed = check.agrees && !changed;
    const bool search = island.alone() ? rounds.agreed : time_to_settle && (check.nearly || rounds.solves <= kEarlySearches);
    if (rounds.searches > 0 && search && contacts_are_stale(ctx, island)) {
        --rounds.searches;
        rounds.agreed = false;
        find_contacts(ctx, island.members, true);
        return false;
    }
    if (rounds.agreed) return rounds.loose == 1;  // if not, on with the same models
    const double part = changed ? 1 : part_of_way(ctx, island);
    model_contacts(ctx, island, part, rounds.solves + 1 < ctx.world.def.solver.contact_iterations);
    if (part < 1) go_back(island, part);
    return false;
}

/// Of attachments the model is the truth.
bool any_contacts(const Island& island) {
    return std::any_of(island.members.begin(), island.members.end(), [](const Member& member) {
        const std::vector<Contact>& list = member.body->contacts.list;
        return std::any_of(list.begin(), list.end(), [](const Contact& c) { return c.attachment < 0; });
    });
}

}  // namespace

Solved solve_system(StepContext& ctx, Island& island, double floor, double tolerance, bool first) {
    const SolverDef& def = ctx.world.def.solver;
    for (Member& member : island.members) std::fill(member.body->work.dv.begin(), member.body->work.dv.end(), Vec3::Zero());
    rest_colliders(ctx);
    if (!first || is_static(ctx)) find_contacts(ctx, island.members, !first);  // begin_touch did, and v0 stands there still
    TouchRounds rounds;
    solve::LinearSolveDef solve_def;
    solve_def.max_iterations = def.cg_max_iterations;
    solve_def.deadline_ns = ctx.deadline_ns;
    solve_def.only_definite = !island.members[0].body->work.project;
    double rhs_norm = 0;
    Unsolved may_leave;
    for (bool again = false;; again = true) {
        append_touch(ctx, island);
        const auto missing = again ? &Workspace::residual : &Workspace::rhs;  // rhs stays that of v0: line searches ask for it
        const bool touching = std::any_of(island.members.begin(), island.members.end(), [](const Member& member) { return !member.body->contacts.list.empty(); });
        for (Member& member : island.members) {
            Workspace& w = member.body->work;
            if (!again && touching) w.bare = w.b;
            w.*missing = again ? w.bare : w.b;
        }
        add_touch(ctx, island, true, missing);
        if (touching) begin_way(ctx, island);
        const double norm = norm_of(island, [&](Body& body) {
            Workspace& w = body.work;
            return free_norm(ctx, body, w.*missing, [&](std::size_t i, const Vec3& free) { w.free_rhs[i] = free; });
        });
        if (!again) {
            rhs_norm = norm;
            // Once above the floor, well below it: or the next step would be above it again.
            may_leave.residual = std::max(tolerance * rhs_norm, rhs_norm > floor ? 0.3 * floor : floor);
        }
        const bool warm = first && !again && !is_static(ctx);
        solve::LinearSolveResult result;
        if (!again && comes_to_rest(ctx, island, rhs_norm, floor)) {
            result.converged = true;
            result.residual = free_norm(ctx, island, &Workspace::residual);
        } else {
            // Of the first right-hand side, in its energy: later rounds go as far, not as far in proportion.
            // The first solve of a lone body tells what its preconditioner is worth.
            const bool settled = rounds.agreed || rounds.solves + 2 >= def.contact_iterations || (island.alone() && !again) || !any_contacts(island);
            // While contacts still change, half of the digits will do.
            rounds.loose = settled ? 1 : std::max(1.0, std::sqrt(tolerance) * norm / may_leave.residual);
            solve_def.target = rounds.loose * may_leave.residual;
            solve_def.energy_target = rounds.loose * may_leave.energy;
            solve_def.energy_tolerance = !again && norm > 0 ? solve_def.target / norm : 0;
            result = solve_preconditioned(ctx, island, warm, solve_def, first && !again, again, [&] { true_residual(ctx, island); });
            if (!again) may_leave.energy = result.energy_target / rounds.loose;
        }
        ctx.report.cg_iterations += result.iterations;
        ctx.report.solve_bytes += result.bytes;
        if (result.indefinite) return Solved::indefinite;
        if (!std::isfinite(result.residual)) return Solved::not_finite;
        const bool done = touch_agrees(ctx, island, may_leave, rounds);
        if (rounds.loose == 1 || result.out_of_time) report_solve(ctx, island, result, std::max(rhs_norm, floor / tolerance));
        if (result.out_of_time || done) return Solved::yes;
        ++ctx.report.contact_iterations;
    }
}

void read_drags(World::Impl& world, BodyId id, Body& body) {
    for_drags_of(world, id, [&](Drag& drag) {
        drag.force = drag.capped ? drag.predicted : drag_force(drag, drag.mean(body.state.x), drag.mean(body.state.v));
    });
}

}  // namespace supple
