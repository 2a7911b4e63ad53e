#include <algorithm>

#include "supple/base/clock.h"
#include "supple/world/precondition.h"
#include "supple/world/stages.h"

namespace supple {

namespace {

/// Time since the last lap goes to `stage`.
void lap(StepContext& ctx, Stopwatch& watch, Stage stage) { ctx.report.stage_ms[std::size_t(stage)] += watch.lap_ms(); }

void step_body(StepContext& ctx, Stopwatch& watch, BodyId id, Body& body) {
    const SolverDef& def = ctx.world.def.solver;
    prepare_preconditioner(ctx, body);
    lap(ctx, watch, Stage::solve);
    prepare_step(ctx, body);
    begin_drags(ctx.world, id);
    const double floor = resting_residual(ctx, body);
    lap(ctx, watch, Stage::loads);

    double first_norm = 0;
    for (int k = 0;; ++k) {
        double norm = evaluate_elements(ctx, body, k == 0 && def.linearise_at == LineariseAt::current);
        lap(ctx, watch, Stage::elements);
        if (!(norm < 1e300)) return contain(ctx, id, body);
        if (def.newton_tolerance > 0) norm = residual_with_drags(ctx, id, body);
        if (k == 0) first_norm = norm;
        if (k > 0 && norm <= std::max(def.newton_tolerance * first_norm, floor)) break;
        if (k == def.newton_iterations) {
            ctx.report.flags |= StepFlag::newton_cap;
            break;
        }
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
    std::size_t largest = 0;
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
        step_body(ctx, watch, id, body);
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
