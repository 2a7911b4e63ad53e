#include <algorithm>

#include "supple/base/clock.h"
#include "supple/world/contact_stages.h"
#include "supple/world/precondition.h"
#include "supple/world/stages.h"

namespace supple {

namespace {

void step_body(StepContext& ctx, Watch& watch, BodyId id, Body& body) {
    begin_scheme(ctx, body);
    gather_loads(ctx, body, ctx.time_s);  // after the trapezoidal rule has looked at the loads of the start
    const double floor = resting_residual(ctx, body);
    watch.lap(ctx, Stage::loads);
    begin_touch(ctx, id, body);
    watch.lap(ctx, Stage::contact);
    prepare_preconditioner(ctx, body);
    watch.lap(ctx, Stage::solve);
    const bool finite = solve_step(ctx, watch, id, body, floor) && integrate(ctx, id, body);
    if (!finite) contain(ctx, id, body);
    watch.lap(ctx, Stage::integrate);
    if (finite && body.elements->is_plastic()) {
        body.elements->flow(ctx.team, body.state.x.data()->data(), body.state.quaternion.data(), body.state.plastic.data(), ctx.world.def.time_step_s);
        watch.lap(ctx, Stage::plasticity);
    }
}

}  // namespace

StepReport do_step(World::Impl& world) noexcept {
    StepReport report;
    Watch watch;
    const std::int64_t start_ns = now_ns();
    std::size_t largest = 0;
    double total = 0, done = 0;
    for (const std::uint32_t slot : world.order) {
        const std::size_t elements = world.slots[slot].body->element_count();
        total += double(elements);
        largest = std::max(largest, elements);
    }

    StepContext ctx{world.team_for(largest), world, report, double(world.step + 1) * world.def.time_step_s};
    begin_colliders(ctx);
    watch.lap(ctx, Stage::contact);
    for (const std::uint32_t slot : world.order) {
        Body& body = *world.slots[slot].body;
        const BodyId id{slot, world.slots[slot].generation};
        if (body.supports_changed) refresh_supports(world, id, body);
        watch.lap(ctx, Stage::guard);
        if (body.frozen()) {
            report.flags |= StepFlag::frozen;
            drop_contacts(body);
            continue;
        }
        done += double(body.element_count());
        if (world.def.solver.step_budget_us > 0) ctx.body_end_ns = start_ns + std::int64_t(world.def.solver.step_budget_us * 1e3 * done / total);
        step_body(ctx, watch, id, body);
    }
    end_colliders(ctx);
    watch.lap(ctx, Stage::contact);
    ++world.step;
    if (world.def.stress_each_step) {
        for (const std::uint32_t slot : world.order) update_stress(*world.slots[slot].body, world.team_for(world.slots[slot].body->element_count()));
        watch.lap(ctx, Stage::stress);
    }
    report.step = world.step;
    report.time_s = world.time_s();
    report.step_ms = watch.stopwatch.ms();
    return report;
}

}  // namespace supple
