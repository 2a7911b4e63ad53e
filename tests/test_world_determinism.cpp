// Same bits for any number of threads, for worlds side by side, and for readers who only look.
#include <gtest/gtest.h>

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
