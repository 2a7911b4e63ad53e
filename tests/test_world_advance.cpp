// Real time in, fixed steps out.
#include <gtest/gtest.h>

#include <limits>

#include "support/bodies.h"

namespace supple {
namespace {

WorldDef hundredths() {
    WorldDef def;
    def.time_step_s = 0.01;
    def.threads = 1;
    return def;
}

TEST(WorldAdvance, StepsWhenAStepIsDueAndKeepsTheRest) {
    World world(hundredths());
    AdvanceReport report = world.advance(0.005);
    EXPECT_EQ(report.steps, 0);
    EXPECT_NEAR(report.alpha, 0.5, 1e-9);
    report = world.advance(0.007);
    EXPECT_EQ(report.steps, 1);
    EXPECT_NEAR(report.alpha, 0.2, 1e-9);
    EXPECT_EQ(report.dropped_s, 0);
    report = world.advance(0.028);
    EXPECT_EQ(report.steps, 3);
    EXPECT_NEAR(report.alpha, 0.0, 1e-9);
    EXPECT_EQ(world.step_count(), 4u);
    EXPECT_EQ(report.last.step, 4u);
}

TEST(WorldAdvance, FramesOfExactlyOneStepNeverSlip) {
    for (const double h : {0.01, 1.0 / 60, 1.0 / 120, 1.0 / 1000, 0.1}) {
        WorldDef def = hundredths();
        def.time_step_s = h;
        World world(def);
        for (int n = 0; n < 5000; ++n) ASSERT_EQ(world.advance(h).steps, 1) << "h = " << h << ", frame " << n;
    }
}

TEST(WorldAdvance, RealTimeIsAccountedFor) {
    World world(hundredths());
    test::Random random(110);
    double given = 0, dropped = 0, alpha = 0;
    for (int n = 0; n < 2000; ++n) {
        const double frame = random.uniform(0, n % 50 == 0 ? 0.2 : 0.03);
        given += frame;
        const AdvanceReport report = world.advance(frame);
        dropped += report.dropped_s;
        alpha = report.alpha;
        ASSERT_GE(alpha, 0);
        ASSERT_LE(alpha, 1);
        ASSERT_LE(report.steps, 4);
        ASSERT_GE(report.dropped_s, 0);
    }
    EXPECT_NEAR(double(world.step_count()) * 0.01 + dropped + alpha * 0.01, given, 1e-6);
    EXPECT_GT(dropped, 0);
}

TEST(WorldAdvance, CatchesUpOnlySoFarAndSaysWhatItGaveUp) {
    WorldDef def = hundredths();
    def.max_catch_up_steps = 3;
    World world(def);
    const AdvanceReport report = world.advance(1.005);
    EXPECT_EQ(report.steps, 3);
    EXPECT_NEAR(report.dropped_s, 0.97, 1e-9);
    EXPECT_NEAR(report.alpha, 0.5, 1e-6);
    EXPECT_EQ(world.advance(0.005).steps, 1) << "no debt is left behind";
    EXPECT_EQ(world.step_count(), 4u);
}

TEST(WorldAdvance, BadClocksDoNoHarm) {
    World world(hundredths());
    world.advance(0.004);
    for (const double bad : {std::nan(""), -1.0, 0.0, -HUGE_VAL, HUGE_VAL}) {
        const AdvanceReport report = world.advance(bad);
        EXPECT_EQ(report.steps, 0) << bad;
        EXPECT_NEAR(report.alpha, 0.4, 1e-9) << bad;
        EXPECT_EQ(report.dropped_s, 0) << bad;
    }
    const AdvanceReport huge = world.advance(std::numeric_limits<double>::max());
    EXPECT_EQ(huge.steps, 4);
    EXPECT_TRUE(std::isfinite(huge.dropped_s));
    EXPECT_TRUE(huge.alpha >= 0 && huge.alpha <= 1);
    EXPECT_EQ(world.advance(0.01).steps, 1);
}

TEST(WorldAdvance, FlagsOfAllTheStepsAreReported) {
    World world(hundredths());
    const BodyId body = world.add_body({.shape = test::unit_tet()});
    world.add_load(body, {Everything{}, LoadKind::total_force, {{0.015, 0.02}, {Vec3::Zero(), Vec3(1e300, 0, 0)}}});
    const AdvanceReport report = world.advance(0.04);
    EXPECT_EQ(report.steps, 4);
    EXPECT_EQ(report.last.flags, StepFlag::non_finite | StepFlag::frozen);
}

TEST(WorldAdvance, PreviousPositionsServeTheInterpolation) {
    World world(hundredths());
    const BodyId body = world.add_body({.shape = test::unit_tet(), .velocity_m_s = {1, 0, 0}});
    EXPECT_EQ(test::copy(world.previous_positions(body)), test::copy(world.positions(body)));
    const auto before = test::copy(world.positions(body));
    world.step();
    EXPECT_EQ(test::copy(world.previous_positions(body)), before);
    EXPECT_NEAR(world.positions(body)[0].x() - before[0].x(), 0.01, 1e-9);
}

}  // namespace
}  // namespace supple
