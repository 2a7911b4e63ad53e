#include <algorithm>

#include "supple/base/clock.h"
#include "supple/world/precondition.h"
#include "supple/world/stages.h"

namespace supple {

namespace {

/// Time since the last lap goes to `stage`.
void lap(StepContext& ctx, Stopwatch& watch, Stage stage) { ctx.report.stage_ms[std::size_t(stage)] += watch.lap_ms(); }

/// When the solves of a body must end: its part of the budget by elements, less what the residual and the integration will take - about
/// as long as the evaluation took.
std::int64_t deadline_of(const World::Impl& world, std::int64_t start_ns, double part_done, double evaluation_ms) {
    if (world.def.solver.step_budget_us == 0) return 0;
    return start_ns + std::int64_t(world.def.solver.step_budget_us * 1e3 * part_done - evaluation_ms * 1e6);
}

void step_body(StepContext& ctx, Stopwatch& watch, BodyId id, Body& body, std::int64_t start_ns, double part_done) {
    const SolverDef& def = ctx.world.def.solver;
    prepare_preconditioner(ctx, body);
    lap(ctx, watch, Stage::solve);
    prepare_step(ctx, body);
    begin_drags(ctx.world, id);
    const double floor = resting_residual(ctx, body);
    lap(ctx, watch, Stage::loads);

    double first_norm = 0;
    for (int k = 0;; ++k) {
        const std::int64_t before_ns = now_ns();
        double norm = evaluate_elements(ctx, body, k == 0 && def.linearise_at == LineariseAt::current);
        ctx.deadline_ns = deadline_of(ctx.world, start_ns, part_done, double(now_ns() - before_ns) * 1e-6);
        lap(ctx, watch, Stage::elements);
        if (!(norm < 1e300)) return contain(ctx, id, body);
        if (def.newton_tolerance > 0) norm = residual_with_drags(ctx, id, body);
        if (k == 0) first_norm = norm;
        if (k > 0 && norm <= std::max(def.newton_tolerance * first_norm, floor)) break;
        if (k == def.newton_iterations) {
            ctx.report.flags |= StepFlag::newton_cap;
            break;
        }
        if ((ctx.report.flags & StepFlag::budget) != StepFlag::none && k > 0) break;
        assemble(ctx, body);
        lap(ctx, watch, Stage::assemble);
        const bool finite = solve_system(ctx, id, body, floor, k == 0);
        lap(ctx, watch, Stage::solve);
        if (!finite) return contain(ctx, id, body);
        ctx.report.newton_iterations = std::max(ctx.report.newton_iterations, k + 1);
        if (def.newton_tolerance == 0 && k + 1 == def.newton_iterations) break;
    }
    const bool finite = integrate(ctx, id, body);
    if (!finite) contain(ctx, id, body);
    lap(ctx, watch, Stage::integrate);
}

}  // namespace

StepReport do_step(World::Impl& world) noexcept {
    StepReport report;
    Stopwatch watch;
    const std::int64_t start_ns = now_ns();
    std::size_t largest = 0;
    double total = 0, done = 0;
    for (const std::uint32_t slot : world.order) total += double(world.slots[slot].body->data().rest.elements);
    for (const std::uint32_t slot : world.order) largest = std::max(largest, world.slots[slot].body->data().rest.elements);

    StepContext ctx{world.team_for(largest), world, report, double(world.step + 1) * world.def.time_step_s};
    for (const std::uint32_t slot : world.order) {
        Body& body = *world.slots[slot].body;
        const BodyId id{slot, world.slots[slot].generation};
        if (body.supports_changed) refresh_supports(world, id, body);
        lap(ctx, watch, Stage::guard);
        if (body.frozen()) {
            report.flags |= StepFlag::frozen;
            continue;
        }
        done += double(body.data().rest.elements);
        step_body(ctx, watch, id, body, start_ns, done / total);
    }
    ++world.step;
    if (world.def.stress_each_step) {
        for (const std::uint32_t slot : world.order) update_stress(*world.slots[slot].body, world.team_for(world.slots[slot].body->data().rest.elements));
        report.stage_ms[std::size_t(Stage::stress)] = watch.lap_ms();
    }
    report.step = world.step;
    report.time_s = world.time_s();
    report.step_ms = watch.ms();
    return report;
}

}  // namespace supple
