// Same bits for any number of threads, for worlds side by side, and for readers who only look.
#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "support/bodies.h"

namespace supple {
namespace {

/// Three bodies (one small, one large enough for several chunks of every loop), one of them dragged, after some steps.
std::uint64_t hash_after(int threads, Precision precision, int steps, bool look = false) {
    WorldDef def;
    def.time_step_s = 0.01;
    def.threads = threads;
    def.solver.precision = precision;
    World world(def);
    const BodyId large = world.add_body({.shape = test::bar({20, 6, 6}), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
    const BodyId middle = world.add_body({.shape = test::bar({16, 4, 4}), .translation_m = {0, 1, 0}});
    world.add_body({.shape = test::unit_tet(), .translation_m = {0, 3, 0}, .velocity_m_s = {0.1, 0.2, 0.3}});
    world.fix(large, test::at_x(0));
    world.fix(middle, test::at_x(0), {true, true, false});
    const auto hit = world.pick({{0.39, 0.05, 1}, {0, 0, -1}});
    EXPECT_TRUE(hit && hit->body == large);
    const DragId drag = world.begin_drag(*hit, {.radius_m = 0.03});
    for (int n = 0; n < steps; ++n) {
        world.move_drag(drag, hit->position_m + Vec3(0, 0.002 * n, 0.01));
        EXPECT_EQ(world.step().flags, StepFlag::none);
        if (look) {
            (void)world.von_mises(large);
            (void)world.energy();
            (void)world.pick({{0.1, 0.05, 1}, {0, 0, -1}});
            (void)world.save();
        }
    }
    return world.hash();
}

TEST(WorldDeterminism, TheNumberOfThreadsDoesNotMatterInSingle) {
    const std::uint64_t one = hash_after(1, Precision::single, 5);
    for (const int threads : {2, 3, 8}) EXPECT_EQ(hash_after(threads, Precision::single, 5), one) << threads << " threads";
    EXPECT_NE(hash_after(1, Precision::single, 4), one);
}

TEST(WorldDeterminism, TheNumberOfThreadsDoesNotMatterInDouble) {
    const std::uint64_t one = hash_after(1, Precision::double_, 5);
    for (const int threads : {2, 3, 8}) EXPECT_EQ(hash_after(threads, Precision::double_, 5), one) << threads << " threads";
    EXPECT_NE(hash_after(1, Precision::single, 5), one);
}

TEST(WorldDeterminism, LookingChangesNothing) {
    EXPECT_EQ(hash_after(2, Precision::single, 4, true), hash_after(2, Precision::single, 4, false));
}

TEST(WorldDeterminism, StressInEveryStepChangesNothing) {
    const auto run = [](bool stress_each_step) {
        WorldDef def;
        def.threads = 2;
        def.stress_each_step = stress_each_step;
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar({16, 4, 4}), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
        world.fix(body, test::at_x(0));
        for (int n = 0; n < 10; ++n) world.step();
        return world.hash();
    };
    EXPECT_EQ(run(true), run(false));
}

TEST(WorldDeterminism, TwoWorldsOnTwoThreadsDoNotDisturbEachOther) {
    const std::uint64_t alone = hash_after(2, Precision::single, 4);
    std::uint64_t hashes[2] = {0, 0};
    std::thread first([&] { hashes[0] = hash_after(2, Precision::single, 4); });
    std::thread second([&] { hashes[1] = hash_after(2, Precision::single, 4); });
    first.join();
    second.join();
    EXPECT_EQ(hashes[0], alone);
    EXPECT_EQ(hashes[1], alone);
}

TEST(WorldDeterminism, ABodyDoesNotNoticeItsNeighbours) {
    const auto positions = [](bool neighbour) {
        WorldDef def;
        def.threads = 1;
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar({4, 2, 2})});
        world.fix(body, test::at_x(0));
        if (neighbour) world.add_body({.shape = test::bar({6, 2, 2}), .translation_m = {0, 1, 0}});
        for (int n = 0; n < 10; ++n) world.step();
        return test::copy(world.positions(body));
    };
    EXPECT_EQ(positions(true), positions(false));
}

// -- small bodies, side by side --

struct Crowd {
    std::uint64_t hash = 0;
    StepFlag flags = StepFlag::none;
    int iterations = 0, contacts = 0;
    Vec3 plane_force = Vec3::Zero();
    std::size_t frozen = 0;
};

/// Bodies that are each too small for a team, of all kinds: some lie on a plane, two on one another, one hangs on a drag, one flows, one blows up. With stress in every step.
Crowd crowd_after(int threads, int steps) {
    WorldDef def;
    def.time_step_s = 0.01;
    def.threads = threads;
    def.stress_each_step = true;
    World world(def);
    const ColliderId plane = world.add_collider({.shape = PlaneShape{}, .friction = 0.5});
    std::vector<BodyId> bodies;
    const auto add = [&](std::shared_ptr<const BodyTemplate> shape, const Material& material, const Vec3& at) {
        bodies.push_back(world.add_body({.shape = std::move(shape), .material = material, .translation_m = at, .velocity_m_s = {0.1, 0, -0.2}}));
    };
    const auto bar = test::bar({16, 4, 4});
    const Corotational soft{.young_pa = 1e5, .poisson = 0.4};
    for (int i = 0; i < 3; ++i) add(bar, soft, {0, double(i), 0.001});
    add(bar, soft, {0.02, 0, 0.102});  // on the first
    add(test::hex_bar(), soft, {0, 3, 0.001});
    add(test::bar({8, 3, 3}), NeoHookean{}, {0, 4, 0.001});
    add(bar, soft, {0, 5, 1});
    add(bar, soft, {0, 6, 1});
    add(test::bar({8, 3, 3}), soft, {0, 7, 1});
    world.fix(bodies[6], test::at_x(0));
    const auto hit = world.pick({{0.39, 5.05, 3}, {0, 0, -1}});
    EXPECT_TRUE(hit && hit->body == bodies[6]);
    const DragId drag = world.begin_drag(*hit, {.radius_m = 0.03});
    Crowd crowd;
    for (int n = 0; n < steps; ++n) {
        world.move_drag(drag, hit->position_m + Vec3(0, 0, 0.002 * n));
        if (n == 2) world.add_load(bodies[8], {Everything{}, LoadKind::total_force, {{}, {Vec3(1e300, 0, 0)}}});
        const StepReport report = world.step();
        crowd.flags |= report.flags;
        crowd.iterations += report.cg_iterations;
        crowd.contacts = report.contacts;
    }
    crowd.hash = world.hash();
    crowd.plane_force = world.collider_state(plane).force_n;
    for (const BodyId body : bodies) crowd.frozen += world.is_frozen(body);
    return crowd;
}

TEST(WorldDeterminism, SmallBodiesSideBySideMoveAsOneAfterTheOther) {
    const Crowd one = crowd_after(1, 6);
    EXPECT_EQ(one.frozen, 1u);
    EXPECT_GT(one.contacts, 20);
    EXPECT_GT(one.plane_force.norm(), 1);
    for (const int threads : {2, 3, 8}) {
        const Crowd many = crowd_after(threads, 6);
        EXPECT_EQ(many.hash, one.hash) << threads << " threads";
        EXPECT_EQ(many.flags, one.flags);
        EXPECT_EQ(many.iterations, one.iterations);
        EXPECT_EQ(many.contacts, one.contacts);
        EXPECT_EQ(many.plane_force, one.plane_force);
        EXPECT_EQ(many.frozen, one.frozen);
    }
}

// Each stage is given its part of the wall clock, not the sum of what all threads had: parts do not add up to more than the whole.
TEST(WorldDeterminism, TheStagesOfBodiesSideBySideAddUpToTheStep) {
    WorldDef def;
    def.threads = 2;
    World world(def);
    for (int i = 0; i < 6; ++i) world.add_body({.shape = test::bar({16, 4, 4}), .translation_m = {0, double(i), 0}, .velocity_m_s = {0, 0, 0.1 * i}});
    double most = 0;  // of the step; in single ones the machine may have been elsewhere
    for (int n = 0; n < 10; ++n) {
        const StepReport report = world.step();
        double sum = 0;
        for (const double ms : report.stage_ms) sum += ms;
        EXPECT_LE(sum, report.step_ms * 1.0001);
        most = std::max(most, sum / report.step_ms);
        EXPECT_GT(report.stage_ms[std::size_t(Stage::elements)], 0);
    }
    EXPECT_GT(most, 0.5);
}

TEST(WorldDeterminism, TheHashSeesEveryBitOfMotion) {
    World world;
    const BodyId body = world.add_body({.shape = test::unit_tet()});
    const std::uint64_t plain = world.hash();
    auto x = test::copy(world.positions(body)), v = test::copy(world.velocities(body));
    v[3].z() = 5e-324;
    world.set_state(body, x, v);
    EXPECT_NE(world.hash(), plain);
    world.set_state(body, x, std::vector<Vec3>(4, Vec3::Zero()));
    EXPECT_EQ(world.hash(), plain);
}

}  // namespace
}  // namespace supple
