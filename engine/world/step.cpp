#include <algorithm>
#include <numeric>

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

void begin_body(StepContext& ctx, Body& body) {
    begin_scheme(ctx, body);
    gather_loads(ctx, body, ctx.time_s);  // after the trapezoidal rule has looked at the loads of the start
}

/// The forces of an island's contacts, where all islands may be told.
void read_island(StepContext& ctx, Island& island) {
    for (const Member& member : island.members) read_contacts(ctx, member.id, *member.body);
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
        begin_body(ctx, *member.body);
        begin_touch(ctx, lone.members);
        if (move_island(ctx, watch, lone)) {
            read_island(ctx, lone);
        } else {
            contain(ctx, member.id, *member.body);
        }
    }
}

void flow(StepContext& ctx, Watch& watch, Island& island) {
    bool plastic = false;
    for (Member& member : island.members) {
        Body& body = *member.body;
        if (body.frozen() || !body.elements->is_plastic()) continue;
        body.elements->flow(ctx.team, body.state.x.data()->data(), body.state.quaternion.data(), body.state.plastic.data(), ctx.world.def.time_step_s);
        plastic = true;
    }
    if (plastic) watch.lap(ctx, Stage::plasticity);
}

/// What the world has to know of an island that has moved, or what is to be done where it could not.
void end_island(StepContext& ctx, Watch& watch, Island& island, bool moved) {
    if (moved) {
        read_island(ctx, island);
    } else if (island.alone()) {
        contain(ctx, island.members[0].id, *island.members[0].body);
    } else {
        part_island(ctx, watch, island);
    }
    watch.lap(ctx, Stage::integrate);
    flow(ctx, watch, island);
}

/// What the solver has for a step, dealt out by elements.
struct Budget {
    std::int64_t start_ns = 0;
    double ns = 0;  ///< 0: as long as it takes
    double elements = 0, done = 0;

    /// When those who are next must be done; 0 = never.
    std::int64_t end_of(double next) {
        done += next;
        return ns > 0 ? start_ns + std::int64_t(ns * done / elements) : 0;
    }
};

bool is_small(const Island& island) { return island.elements < kMinElementsForThreads; }

/// Islands too small for a team have one thread each, side by side; not where a collider yields, for it hears of one after the other.
std::span<Island*> find_small(World::Impl& world) {
    world.small.clear();
    for (std::size_t i = 0; i < world.living_islands; ++i) {
        if (is_small(world.islands[i])) world.small.push_back(&world.islands[i]);
    }
    const bool yields = std::any_of(world.colliders.begin(), world.colliders.end(), [](const Collider& c) { return c.generation != 0 && c.unknown(); });
    if (yields || world.small.size() < 2) world.small.clear();
    while (world.aside.size() < world.small.size()) world.aside.push_back(std::make_unique<Scratch>());
    for (std::size_t i = 0; i < world.small.size(); ++i) world.aside[i]->make_room(*world.small[i], world.drags.size());
    return world.small;
}

void step_side_by_side(StepContext& ctx, Watch& watch, std::span<Island*> islands, Budget& budget) {
    double elements = 0;
    for (const Island* island : islands) elements += double(island->elements);
    Team& team = ctx.world.team_for(std::size_t(elements));
    const std::int64_t begin_ns = now_ns(), end_ns = budget.end_of(elements);
    team.for_chunks(islands.size(), [&](std::size_t i) {
        Island& island = *islands[i];
        island.report = {};
        StepContext own{ctx.world.alone, ctx.world, *ctx.world.aside[i], island.report, ctx.time_s};
        if (end_ns != 0) own.body_end_ns = now_ns() + std::int64_t(double(std::max<std::int64_t>(end_ns - begin_ns, 1)) * double(island.elements) / elements * team.size());
        Watch own_watch;
        island.moved = move_island(own, own_watch, island);
        own_watch.lap(own, Stage::integrate);
    });
    double busy_ms = 0;
    for (const Island* island : islands) busy_ms += std::accumulate(island->report.stage_ms.begin(), island->report.stage_ms.end(), 0.0);
    const double wall_ms = watch.stopwatch.lap_ms();
    for (Island* island : islands) {
        for (double& ms : island->report.stage_ms) ms *= busy_ms > 0 ? wall_ms / busy_ms : 0;
        ctx.report.include(island->report);
        end_island(ctx, watch, *island, island->moved);
    }
}

}  // namespace

StepReport do_step(World::Impl& world) noexcept {
    StepReport report;
    Watch watch;
    Budget budget{now_ns(), world.def.solver.step_budget_us * 1e3};
    StepContext ctx{world.team_for(element_count(world)), world, world.scratch, report, double(world.step + 1) * world.def.time_step_s};
    begin_colliders(ctx);
    watch.lap(ctx, Stage::contact);
    world.active.clear();
    for (const std::uint32_t slot : world.order) {
        Body& body = *world.slots[slot].body;
        const BodyId id{slot, world.slots[slot].generation};
        if (body.supports_changed) refresh_supports(world, id, body);
        if (body.frozen()) {
            report.flags |= StepFlag::frozen;
            drop_contacts(body);
            continue;
        }
        world.active.push_back({id, &body});
    }
    watch.lap(ctx, Stage::guard);
    for_members(ctx, world.active, begin_body);
    watch.lap(ctx, Stage::loads);
    begin_touch(ctx, world.active);
    form_islands(world);
    watch.lap(ctx, Stage::contact);
    for (std::size_t i = 0; i < world.living_islands; ++i) budget.elements += double(world.islands[i].elements);
    const std::span<Island*> small = find_small(world);
    if (!small.empty()) step_side_by_side(ctx, watch, small, budget);
    for (std::size_t i = 0; i < world.living_islands; ++i) {
        Island& island = world.islands[i];
        if (!small.empty() && is_small(island)) continue;
        StepContext of{world.team_for(island.elements), world, world.scratch, report, ctx.time_s};
        of.body_end_ns = budget.end_of(double(island.elements));
        const bool moved = move_island(of, watch, island);
        end_island(of, watch, island, moved);
    }
    end_colliders(ctx);
    watch.lap(ctx, Stage::contact);
    ++world.step;
    if (world.def.stress_each_step) {
        world.active.clear();  // the frozen ones, too
        for (const std::uint32_t slot : world.order) world.active.push_back({{slot, world.slots[slot].generation}, world.slots[slot].body.get()});
        for_members(ctx, world.active, [](StepContext& of, Body& body) { update_stress(body, of.team); });
        watch.lap(ctx, Stage::stress);
    }
    report.step = world.step;
    report.time_s = world.time_s();
    report.step_ms = watch.stopwatch.ms();
    return report;
}

}  // namespace supple
