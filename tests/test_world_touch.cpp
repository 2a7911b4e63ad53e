// Picking and dragging.
#include <gtest/gtest.h>

#include "support/bodies.h"

namespace supple {
namespace {

WorldDef weightless(double h = 1.0 / 120) {
    WorldDef def;
    def.gravity_m_s2 = Vec3::Zero();
    def.time_step_s = h;
    def.threads = 1;
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-10;
    return def;
}

const Ray kDown{{0.33, 0.057, 1}, {0, 0, -1}};  // onto the top face z = 0.1 of the bar

struct Bar {
    World world;
    BodyId body;
    explicit Bar(const WorldDef& def, double young_pa = 2e4, std::array<int, 3> cells = {8, 2, 2})
        : world(def), body(world.add_body({.shape = test::bar(cells), .material = Corotational{.young_pa = young_pa, .poisson = 0.4}})) {
        world.fix(body, test::at_x(0));
    }
    PickHit hit(const Ray& ray = kDown) const {
        const auto found = world.pick(ray);
        EXPECT_TRUE(found.has_value());
        return found.value_or(PickHit{});
    }
};

// -- picking -----------------------------------------------------------------------------------------

TEST(WorldPick, FindsTheFirstPointOfTheSurface) {
    Bar bar(weightless());
    const auto hit = bar.world.pick({{0.33, 0.057, 1}, {0, 0, -2}});
    ASSERT_TRUE(hit.has_value());
    EXPECT_EQ(hit->body, bar.body);
    EXPECT_LT((hit->position_m - Vec3(0.33, 0.057, 0.1)).norm(), 1e-12);
    EXPECT_NEAR(hit->distance, 0.45, 1e-12) << "in lengths of the direction";
    const BodyTemplate& shape = bar.world.shape(bar.body);
    const Triangle& t = shape.boundary().triangles[std::size_t(hit->triangle)];
    EXPECT_EQ(hit->element, shape.boundary().element[std::size_t(hit->triangle)]);
    Vec3 point = Vec3::Zero();
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        point += hit->barycentric[k] * shape.mesh().vertices[std::size_t(t[k])];
        sum += hit->barycentric[k];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_LT((point - hit->position_m).norm(), 1e-12);
}

TEST(WorldPick, TakesTheNearerBodyAndFollowsIt) {
    World world(weightless());
    const BodyId low = world.add_body({.shape = test::bar({4, 1, 1})});
    const BodyId high = world.add_body({.shape = test::bar({4, 1, 1}), .translation_m = {0, 0, 0.5}, .velocity_m_s = {0, 10, 0}});
    EXPECT_EQ(world.pick(kDown)->body, high);
    EXPECT_EQ(world.pick({{0.33, 0.057, -1}, {0, 0, 1}})->body, low);
    for (int n = 0; n < 12; ++n) world.step();
    EXPECT_EQ(world.pick(kDown)->body, low) << "the upper one has flown away";
    EXPECT_EQ(world.pick({{0.33, 1.057, 1}, {0, 0, -1}})->body, high);
    EXPECT_FALSE(world.pick({{0.33, 0.057, 1}, {0, 0, 1}}).has_value()) << "behind the eye";
    EXPECT_FALSE(world.pick({{5, 5, 1}, {0, 0, -1}}).has_value());
    EXPECT_FALSE(World().pick(kDown).has_value());
}

// -- dragging ----------------------------------------------------------------------------------------

TEST(WorldDrag, AtRestTheForceIsStiffnessTimesStretch) {
    for (const LineariseAt at : {LineariseAt::prediction, LineariseAt::current}) {
        WorldDef def = weightless(0.02);
        def.solver.rayleigh_mass_1_s = 20;
        def.solver.linearise_at = at;
        Bar bar(def);
        const PickHit hit = bar.hit();
        const DragId drag = bar.world.begin_drag(hit, {.radius_m = 0.06, .stiffness_n_m = 50});
        EXPECT_LT((bar.world.drag_state(drag).anchor_m - hit.position_m).norm(), 1e-12) << "it begins without a jerk";
        EXPECT_EQ(bar.world.drag_state(drag).force_n, Vec3::Zero());
        const Vec3 target = hit.position_m + Vec3(0, 0, 0.02);
        bar.world.move_drag(drag, target);
        ASSERT_TRUE(test::run_to_rest(bar.world, 1e-11, 4000));
        const DragState state = bar.world.drag_state(drag);
        EXPECT_EQ(state.target_m, target);
        EXPECT_GT(state.force_n.z(), 0.1);
        EXPECT_LT((state.force_n - 50 * (state.target_m - state.anchor_m)).norm(), 1e-6 * state.force_n.norm());
        EXPECT_LT((bar.world.reaction_n(bar.body) + state.force_n).norm(), 1e-5 * state.force_n.norm()) << "the supports hold against it";
    }
}

TEST(WorldDrag, TheDefaultSpringBringsASoftBodyToItsTarget) {
    // Without damping of its own a soft body swings a little past the target, whatever the spring does; with the damping of tissue it does not.
    for (const bool damped : {false, true}) {
        WorldDef def = weightless();
        if (damped) {
            def.solver.rayleigh_mass_1_s = 4;
            def.solver.rayleigh_stiffness_s = 0.02;
        }
        Bar bar(def, 5e3, {12, 3, 3});
        const PickHit hit = bar.hit();
        const DragId drag = bar.world.begin_drag(hit);
        bar.world.move_drag(drag, hit.position_m + Vec3(0, 0, 0.03));
        const auto reached = [&] { return (bar.world.drag_state(drag).anchor_m.z() - hit.position_m.z()) / 0.03; };
        double highest = 0;
        for (int n = 0; n < 240; ++n) {
            EXPECT_EQ(bar.world.step().flags, StepFlag::none);
            highest = std::max(highest, reached());
        }
        EXPECT_GT(reached(), 0.8);
        EXPECT_LT(highest, damped ? 1.07 : 1.2) << (damped ? "damped" : "undamped");
    }
}

TEST(WorldDrag, AFreePatchApproachesWithoutOvershoot) {
    // A tet that can only move along z: one mass on the spring. The patch is that whole mass when every vertex is pulled alike.
    for (const double stiffness : {0.0, 10.0, 1e3, 1e5}) {
        World world(weightless(1.0 / 240));
        const BodyId body = world.add_body({.shape = test::cube(1, 0.1), .material = Corotational{.young_pa = 1e3, .poisson = 0.3}});
        world.fix(body, Everything{}, {true, true, false});
        const auto hit = world.pick({{0.049, 0.05, 1}, {0, 0, -1}});
        ASSERT_TRUE(hit.has_value());
        const DragId drag = world.begin_drag(*hit, {.radius_m = 100, .stiffness_n_m = stiffness});
        world.move_drag(drag, hit->position_m + Vec3(0, 0, 0.05));
        double highest = 0, last = 0;
        for (int n = 0; n < 2000; ++n) {
            world.step();
            last = world.drag_state(drag).anchor_m.z() - 0.1;
            highest = std::max(highest, last);
        }
        EXPECT_LT(highest, 1.03 * 0.05) << "stiffness " << stiffness;
        EXPECT_NEAR(last, 0.05, 0.001) << "stiffness " << stiffness;
    }
}

TEST(WorldDrag, TheForceNeverExceedsItsCap) {
    for (const LineariseAt at : {LineariseAt::prediction, LineariseAt::current}) {
        for (const int newton : {1, 4}) {
            WorldDef def = weightless();
            def.solver.linearise_at = at;
            def.solver.newton_iterations = newton;
            Bar bar(def);
            const PickHit hit = bar.hit();
            const double cap = 0.5;
            const DragId drag = bar.world.begin_drag(hit, {.radius_m = 0.04, .max_force_n = cap});
            test::Random random(130);
            double strongest = 0;
            for (int n = 0; n < 200; ++n) {
                if (n % 7 == 0) bar.world.move_drag(drag, hit.position_m + random.vector(n % 3 == 0 ? 0.5 : 0.005));
                ASSERT_EQ(bar.world.step().flags, StepFlag::none) << "Newton " << newton << ", step " << n;
                const double force = bar.world.drag_state(drag).force_n.norm();
                ASSERT_LE(force, cap * (1 + 1e-9)) << "step " << n;
                strongest = std::max(strongest, force);
            }
            EXPECT_GT(strongest, 0.999 * cap) << "the cap was never reached: nothing was tested";
        }
    }
}

TEST(WorldDrag, TheForceThatIsReadIsTheForceThatActs) {
    // On a free body: momentum gained per step is h times the force read, below the cap and at it.
    for (const double cap : {0.0, 0.2}) {
        World world(weightless());
        const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = Corotational{.young_pa = 1e4, .poisson = 0.3}});
        const auto hit = world.pick(kDown);
        ASSERT_TRUE(hit.has_value());
        const DragId drag = world.begin_drag(*hit, {.max_force_n = cap});
        world.move_drag(drag, hit->position_m + Vec3(0.1, 0.2, 0.3));
        Vec3 before = Vec3::Zero();
        for (int n = 0; n < 30; ++n) {
            world.step();
            const Vec3 now = test::momentum(world, body), force = world.drag_state(drag).force_n;
            EXPECT_LT(((now - before) / world.def().time_step_s - force).norm(), 1e-6 * (force.norm() + 0.01)) << "step " << n;
            before = now;
        }
    }
}

TEST(WorldDrag, FollowsAMovingTarget) {
    Bar bar(weightless());
    const PickHit hit = bar.hit();
    const DragId drag = bar.world.begin_drag(hit, {.stiffness_n_m = 500});
    for (int n = 0; n < 300; ++n) {
        const double t = n / 120.0;
        bar.world.move_drag(drag, hit.position_m + Vec3(0, 0.02 * std::sin(2 * t), 0.02 * (1 - std::cos(2 * t))));
        bar.world.step();
        const DragState state = bar.world.drag_state(drag);
        EXPECT_LT((state.anchor_m - state.target_m).norm(), 0.015);
    }
}

TEST(WorldDrag, EndingItLeavesNoTrace) {
    // Begun and ended between two steps: as if it had never been.
    Bar touched(weightless()), untouched(weightless());
    const DragId drag = touched.world.begin_drag(touched.hit());
    touched.world.move_drag(drag, {9, 9, 9});
    touched.world.end_drag(drag);
    for (int n = 0; n < 5; ++n) {
        touched.world.step();
        untouched.world.step();
    }
    EXPECT_EQ(touched.world.hash(), untouched.world.hash());
    // Held for some steps: from then on it moves like a body that was put into that state.
    const DragId pull = touched.world.begin_drag(touched.hit());
    touched.world.move_drag(pull, {0.3, 0, 0.2});
    for (int n = 0; n < 5; ++n) touched.world.step();
    touched.world.end_drag(pull);
    const std::vector<std::byte> saved = touched.world.save();
    untouched.world.restore(saved);
    for (int n = 0; n < 5; ++n) {
        touched.world.step();
        untouched.world.step();
    }
    EXPECT_EQ(touched.world.hash(), untouched.world.hash());
}

TEST(WorldDrag, HeldCoordinatesStayHeld) {
    for (const Precision precision : {Precision::single, Precision::double_}) {
        WorldDef def = weightless();
        def.solver.precision = precision;
        def.solver.cg_relative_tolerance = 1e-6;
        Bar bar(def);
        bar.world.fix(bar.body, InsideBox{{-1, -1, 0.1 - 1e-9}, {1, 1, 1}}, {false, true, false});
        const auto start = test::copy(bar.world.positions(bar.body));
        const PickHit hit = bar.hit({{0.02, 0.057, 1}, {0, 0, -1}});  // between held and free vertices
        const DragId drag = bar.world.begin_drag(hit, {.radius_m = 0.09});
        bar.world.move_drag(drag, hit.position_m + Vec3(0.01, 0.02, 0.03));
        for (int n = 0; n < 50; ++n) ASSERT_EQ(bar.world.step().flags, StepFlag::none);
        double moved = 0;
        for (std::size_t i = 0; i < start.size(); ++i) {
            const Vec3& X = bar.world.shape(bar.body).mesh().vertices[i];
            if (X.x() < 1e-9) {
                EXPECT_EQ(bar.world.positions(bar.body)[i], start[i]);
            } else if (X.z() > 0.1 - 1e-9) {
                EXPECT_EQ(bar.world.positions(bar.body)[i].y(), start[i].y());
            }
            moved = std::max(moved, (bar.world.positions(bar.body)[i] - start[i]).norm());
        }
        EXPECT_GT(moved, 1e-3);
    }
}

TEST(WorldDrag, AnImmovablePatchTakesTheForceIntoItsSupports) {
    Bar bar(weightless());
    bar.world.fix(bar.body, Everything{});
    const PickHit hit = bar.hit();
    const DragId drag = bar.world.begin_drag(hit, {.stiffness_n_m = 100});
    bar.world.move_drag(drag, hit.position_m + Vec3(0, 0, 0.1));
    EXPECT_EQ(bar.world.step().flags, StepFlag::none);
    EXPECT_LT((bar.world.drag_state(drag).force_n - Vec3(0, 0, 10)).norm(), 1e-9);
    EXPECT_LT((bar.world.reaction_n(bar.body) + Vec3(0, 0, 10)).norm(), 1e-8);
}

TEST(WorldDrag, SeveralDragsOnOneBodyAddUp) {
    World world(weightless());
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = Corotational{.young_pa = 1e5, .poisson = 0.3}});
    const auto a = world.pick(kDown), b = world.pick({{0.05, 0.057, 1}, {0, 0, -1}});
    ASSERT_TRUE(a && b);
    const DragId one = world.begin_drag(*a), two = world.begin_drag(*b, {.max_force_n = 0.1});
    world.move_drag(one, a->position_m + Vec3(0, 0, 0.1));
    world.move_drag(two, b->position_m + Vec3(0, 0.1, 0));
    Vec3 before = Vec3::Zero();
    for (int n = 0; n < 20; ++n) {
        ASSERT_EQ(world.step().flags, StepFlag::none);
        const Vec3 now = test::momentum(world, body), force = world.drag_state(one).force_n + world.drag_state(two).force_n;
        EXPECT_LT(((now - before) / world.def().time_step_s - force).norm(), 1e-6 * (force.norm() + 0.01));
        before = now;
    }
    world.end_drag(one);
    world.step();
    EXPECT_LT(((test::momentum(world, body) - before) / world.def().time_step_s - world.drag_state(two).force_n).norm(), 1e-6);
}

}  // namespace
}  // namespace supple
