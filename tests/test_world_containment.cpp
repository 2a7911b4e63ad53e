// Numbers that overflow: the body is put back, frozen and reported, the others go on.
#include <gtest/gtest.h>

#include "support/bodies.h"

namespace supple {
namespace {

WorldDef plain(Precision precision) {
    WorldDef def;
    def.time_step_s = 0.01;
    def.threads = 1;
    def.solver.precision = precision;
    return def;
}

constexpr Precision kBoth[] = {Precision::single, Precision::double_};

TEST(WorldContainment, OneBodyIsFrozenWhileTheOtherGoesOn) {
    for (const Precision precision : kBoth) {
        World world(plain(precision)), reference(plain(precision));
        const BodyId bad = world.add_body({.shape = test::bar({4, 2, 2}), .velocity_m_s = {1, 0, 0}});
        const BodyId good = world.add_body({.shape = test::bar({4, 2, 2}), .translation_m = {0, 1, 0}});
        const BodyId alone = reference.add_body({.shape = test::bar({4, 2, 2}), .translation_m = {0, 1, 0}});
        world.fix(good, test::at_x(0));
        reference.fix(alone, test::at_x(0));
        world.step();
        reference.step();
        const auto x = test::copy(world.positions(bad));
        world.add_load(bad, {Everything{}, LoadKind::total_force, {{}, {Vec3(1e300, 1e300, 0)}}});
        EXPECT_EQ(world.step().flags, StepFlag::non_finite);
        reference.step();
        EXPECT_TRUE(world.is_frozen(bad));
        EXPECT_FALSE(world.is_frozen(good));
        EXPECT_EQ(test::copy(world.positions(bad)), x) << "back at the start of the step";
        EXPECT_EQ(test::copy(world.previous_positions(bad)), x);
        for (const Vec3& v : world.velocities(bad)) EXPECT_EQ(v, Vec3::Zero());
        for (int n = 0; n < 5; ++n) {
            EXPECT_EQ(world.step().flags, StepFlag::frozen);
            reference.step();
        }
        EXPECT_EQ(test::copy(world.positions(bad)), x);
        EXPECT_EQ(test::copy(world.positions(good)), test::copy(reference.positions(alone)));
        EXPECT_TRUE(std::isfinite(world.energy().total_j()));
        for (const double s : world.von_mises(bad)) EXPECT_TRUE(std::isfinite(s));
    }
}

TEST(WorldContainment, UnfreezeGoesOnFromRestAndResetFromTheStart) {
    for (const Precision precision : kBoth) {
        World world(plain(precision));
        const BodyId body = world.add_body({.shape = test::bar({4, 2, 2}), .velocity_m_s = {1, 0, 0}});
        world.add_load(body, {Everything{}, LoadKind::total_force, {{}, {Vec3(1e300, 0, 0)}}});
        world.step();
        ASSERT_TRUE(world.is_frozen(body));
        world.unfreeze(body);
        EXPECT_EQ(world.step().flags, StepFlag::non_finite) << "the cause is still there";
        world.clear_loads(body);
        world.unfreeze(body);
        EXPECT_EQ(world.step().flags, StepFlag::none);
        for (const Vec3& v : world.velocities(body)) EXPECT_LT((v - Vec3(0, -0.0981, 0)).norm(), 1e-5);
        world.add_load(body, {Everything{}, LoadKind::total_force, {{}, {Vec3(1e300, 0, 0)}}});
        world.step();
        world.clear_loads(body);
        world.reset();
        EXPECT_FALSE(world.is_frozen(body));
        EXPECT_EQ(world.step().flags, StepFlag::none);
        for (const Vec3& v : world.velocities(body)) EXPECT_LT((v - Vec3(1, -0.0981, 0)).norm(), 1e-5);
    }
}

/// Whatever happens, it happens finitely; and afterwards a sane scene works again.
template <class Spoil>
void expect_contained(const char* what, Spoil&& spoil) {
    for (const Precision precision : kBoth) {
        for (const LineariseAt at : {LineariseAt::prediction, LineariseAt::current}) {
            WorldDef def = plain(precision);
            def.solver.linearise_at = at;
            World world(def);
            const BodyId body = world.add_body({.shape = test::bar({4, 2, 2})});
            world.fix(body, test::at_x(0));
            world.step();
            const auto before = test::copy(world.positions(body));
            spoil(world, body);
            const StepReport report = world.step();
            EXPECT_TRUE(test::all_finite(world.positions(body))) << what;
            EXPECT_TRUE(test::all_finite(world.velocities(body))) << what;
            EXPECT_TRUE(test::all_finite(world.reactions(body))) << what;
            EXPECT_NE(report.flags, StepFlag::none) << what << " went by without a word";
            if (world.is_frozen(body)) {
                EXPECT_EQ(report.flags & StepFlag::non_finite, StepFlag::non_finite) << what;
                EXPECT_EQ(test::copy(world.positions(body)), before) << what;
            }
        }
    }
}

TEST(WorldContainment, AbsurdLoads) {
    for (const double force : {1e300, 1e200, -1e165, 1.7e308}) {
        expect_contained("a load", [&](World& world, BodyId body) {
            world.add_load(body, {Everything{}, LoadKind::force_per_vertex, {{}, {Vec3(force, 0, force)}}});
        });
    }
}

TEST(WorldContainment, AbsurdMotions) {
    for (const double far : {1e300, 1e160, 1.7e308}) {
        expect_contained("a motion", [&](World& world, BodyId body) {
            Motion motion;
            motion.where = test::at_x(0.4);
            motion.displacement_m = {{}, {Vec3(far, 0, 0)}};
            world.prescribe(body, motion);
        });
        expect_contained("a velocity", [&](World& world, BodyId body) {
            Motion motion;
            motion.where = test::at_x(0.4);
            motion.velocity_m_s = {{}, {Vec3(0, far, 0)}};
            world.prescribe(body, motion);
        });
    }
}

TEST(WorldContainment, AbsurdGravityAndStates) {
    expect_contained("gravity", [](World& world, BodyId) { world.set_gravity({0, 1e305, 0}); });
    expect_contained("velocities", [](World& world, BodyId body) {
        auto v = test::copy(world.velocities(body));
        test::Random random(120);
        for (Vec3& u : v) u = random.vector(1e250);
        world.set_state(body, world.positions(body), v);
    });
}

TEST(WorldContainment, AbsurdPositionsAreHeldWithoutACrash) {
    for (const double size : {1e100, 1e200, 1e300}) {
        World world(plain(Precision::single));
        const BodyId body = world.add_body({.shape = test::bar({4, 2, 2})});
        auto x = test::copy(world.positions(body));
        const auto v = test::copy(world.velocities(body));
        test::Random random(121);
        for (Vec3& p : x) p = random.vector(size);
        world.set_state(body, x, v);
        world.step();
        (void)world.von_mises(body);
        EXPECT_TRUE(test::all_finite(world.positions(body)));
        world.reset();
        EXPECT_EQ(world.step().flags, StepFlag::none);
    }
}

TEST(WorldContainment, AbsurdDrags) {
    for (const double far : {1e300, 1e155}) {
        expect_contained("a drag", [&](World& world, BodyId) {
            const auto hit = world.pick({{0.35, 0.05, 1}, {0, 0, -1}});
            ASSERT_TRUE(hit.has_value());
            world.move_drag(world.begin_drag(*hit), {far, 0, 0});
        });
    }
}

TEST(WorldContainment, ACappedDragIsHarmlessHoweverFarItsTarget) {
    for (const Precision precision : kBoth) {
        World world(plain(precision));
        const BodyId body = world.add_body({.shape = test::bar({4, 2, 2})});
        world.fix(body, test::at_x(0));
        const auto hit = world.pick({{0.35, 0.05, 1}, {0, 0, -1}});
        ASSERT_TRUE(hit.has_value());
        const DragId drag = world.begin_drag(*hit, {.max_force_n = 1});
        world.move_drag(drag, {1e12, 0, 0});
        for (int n = 0; n < 20; ++n) {
            EXPECT_EQ(world.step().flags, StepFlag::none);
            EXPECT_LE(world.drag_state(drag).force_n.norm(), 1 + 1e-9);
        }
        EXPECT_FALSE(world.is_frozen(body));
    }
}

TEST(WorldContainment, ABodyThatFliesApartIsPutBackThoughItsNumbersAreFinite) {
    World world(plain(Precision::double_));
    const BodyId body = world.add_body({.shape = test::bar({4, 2, 2})});
    std::vector<Vec3> x = test::copy(world.positions(body)), v(x.size(), Vec3::Zero());
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = 1e12 * x[i];
    world.set_state(body, x, v);
    EXPECT_EQ(world.step().flags, StepFlag::non_finite);
    EXPECT_TRUE(world.is_frozen(body));
    EXPECT_LT(test::relative_difference(world.positions(body), x), 1e-15);
    // A body that merely travels far does not.
    for (Vec3& p : x) p += Vec3(1e9, 0, 0);
    world.unfreeze(body);
    world.set_state(body, x, std::vector<Vec3>(x.size(), Vec3(1e6, 0, 0)));
    EXPECT_EQ(world.step().flags & StepFlag::non_finite, StepFlag::none);
}

TEST(WorldContainment, ADragOnAFrozenBodyPullsNoMore) {
    World world(plain(Precision::single));
    const BodyId body = world.add_body({.shape = test::bar({4, 2, 2})});
    world.fix(body, test::at_x(0));
    const auto hit = world.pick({{0.35, 0.05, 1}, {0, 0, -1}});
    ASSERT_TRUE(hit.has_value());
    const DragId drag = world.begin_drag(*hit);
    world.move_drag(drag, hit->position_m + Vec3(0, 0.02, 0));
    world.step();
    EXPECT_GT(world.drag_state(drag).force_n.norm(), 0);
    world.add_load(body, {Everything{}, LoadKind::total_force, {{}, {Vec3(1e300, 0, 0)}}});
    world.step();
    ASSERT_TRUE(world.is_frozen(body));
    EXPECT_EQ(world.drag_state(drag).force_n, Vec3::Zero());
    EXPECT_EQ(world.reaction_n(body), Vec3::Zero());
}

}  // namespace
}  // namespace supple
