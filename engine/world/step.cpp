#include <algorithm>

#include "supple/base/clock.h"
#include "supple/world/contact_stages.h"
#include "supple/world/precondition.h"
#include "supple/world/stages.h"

namespace supple {

namespace {

/// One step of an island, up to its new state. False if a body has blown up, and nothing has changed.
bool move_island(StepContext& ctx, Watch& watch, Island& island) {
    const double floor = resting_residual(ctx, island);
    watch.lap(ctx, Stage::loads);
    for (Member& member : island.members) prepare_preconditioner(ctx, *member.body);
    watch.lap(ctx, Stage::solve);
    return solve_step(ctx, watch, island, floor) && integrate(ctx, island);
}

void begin_body(StepContext& ctx, Member& member) {
    begin_scheme(ctx, *member.body);
    gather_loads(ctx, *member.body, ctx.time_s);  // after the trapezoidal rule has looked at the loads of the start
}

/// Each member by itself, as if it touched no other: the one that blew up is found so, and the others go on.
void part_island(StepContext& ctx, Watch& watch, Island& island) {
    for (Member& member : island.members) undo_contacts(ctx, *member.body);
    Island& lone = ctx.world.lone;
    lone.members.resize(1);
    for (Member& member : island.members) {
        fem::seed_rotations(ctx.team, member.body->layout(), member.body->state.x, member.body->state.quaternion);
        lone.members[0] = member;
        member.body->work.first_row = 0;
        lone.rows = member.body->vertices();
        begin_body(ctx, lone.members[0]);
        begin_touch(ctx, lone.members);
        if (!move_island(ctx, watch, lone)) contain(ctx, member.id, *member.body);
    }
}

void step_island(StepContext& ctx, Watch& watch, Island& island) {
    if (!move_island(ctx, watch, island)) {
        if (island.alone()) {
            contain(ctx, island.members[0].id, *island.members[0].body);
        } else {
            part_island(ctx, watch, island);
        }
    }
    watch.lap(ctx, Stage::integrate);
    bool plastic = false;
    for (Member& member : island.members) {
        Body& body = *member.body;
        if (body.frozen() || !body.elements->is_plastic()) continue;
        body.elements->flow(ctx.team, body.state.x.data()->data(), body.state.quaternion.data(), body.state.plastic.data(), ctx.world.def.time_step_s);
        plastic = true;
    }
    if (plastic) watch.lap(ctx, Stage::plasticity);
}

}  // namespace

StepReport do_step(World::Impl& world) noexcept {
    StepReport report;
    Watch watch;
    const std::int64_t start_ns = now_ns();
    double total = 0, done = 0;
    StepContext ctx{world.team_for(element_count(world)), world, report, double(world.step + 1) * world.def.time_step_s};
    begin_colliders(ctx);
    watch.lap(ctx, Stage::contact);
    world.active.clear();
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
        world.active.push_back({id, &body});
        begin_body(ctx, world.active.back());
        watch.lap(ctx, Stage::loads);
    }
    begin_touch(ctx, world.active);
    form_islands(world);
    watch.lap(ctx, Stage::contact);
    for (std::size_t i = 0; i < world.living_islands; ++i) total += double(world.islands[i].elements);
    for (std::size_t i = 0; i < world.living_islands; ++i) {
        done += double(world.islands[i].elements);
        StepContext of{world.team_for(world.islands[i].elements), world, report, ctx.time_s};
        if (world.def.solver.step_budget_us > 0) of.body_end_ns = start_ns + std::int64_t(world.def.solver.step_budget_us * 1e3 * done / total);
        step_island(of, watch, world.islands[i]);
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
