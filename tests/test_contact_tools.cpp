// Moving colliders: tools, dynamic bodies, nothing passes through, the same bits again.
#include <gtest/gtest.h>

#include <functional>

#include "support/bodies.h"

namespace supple {
namespace {

constexpr StepFlag kContained = StepFlag::non_finite | StepFlag::frozen | StepFlag::contact_cap | StepFlag::iteration_cap | StepFlag::residual_stalled;

Pose at(const Vec3& p) { return {p, {1, 0, 0, 0}}; }

/// A slab 0.1 x 0.02 x 0.1 m, its top at y = 0.02, held at its rim.
struct Slab {
    World world;
    BodyId body;
    explicit Slab(WorldDef def, double young_pa = 2e4, std::array<int, 3> cells = {12, 3, 12}) : world(def) {
        body = world.add_body({.shape = BodyTemplate::build(make_tet_box({.min_m = Vec3(-0.05, 0, -0.05), .max_m = Vec3(0.05, 0.02, 0.05), .cells = cells})),
                               .material = Corotational{.young_pa = young_pa, .poisson = 0.4}});
        world.fix(body, test::at_x(-0.05));
        world.fix(body, test::at_x(0.05));
        world.fix(body, InsideBox{{-1, -1, -0.05 - 1e-9}, {1, 1, -0.05 + 1e-9}});
        world.fix(body, InsideBox{{-1, -1, 0.05 - 1e-9}, {1, 1, 0.05 + 1e-9}});
    }
    /// Height of the lower or the upper face at a point.
    double face(const Vec3& p, double height) const {
        double y = -1e9, nearest = 1e9;
        const auto& X = world.shape(body).mesh().vertices;
        for (std::size_t i = 0; i < X.size(); ++i) {
            if (std::abs(X[i].y() - height) > 1e-9) continue;
            const Vec3& x = world.positions(body)[i];
            const double d = std::hypot(x.x() - p.x(), x.z() - p.z());
            if (d < nearest) {
                nearest = d;
                y = x.y();
            }
        }
        return y;
    }
};

WorldDef quick(int threads = 1) {
    WorldDef def;
    def.threads = threads;
    return def;
}

TEST(SlowContactTools, AFastForceLimitedToolDoesNotFallThroughASoftSlab) {
    for (const double young : {2e4}) {
        for (const double x : {0.0, 0.0021, 0.0042}) {  // onto a vertex, an edge, the inside of a triangle
            Slab slab(quick(), young);
            const ColliderId tool = slab.world.add_collider({.shape = SphereShape{0.0025}, .pose = at({x, 0.06, 0.3 * x}), .motion = ColliderMotion::tool, .mass_kg = 0.05,
                                                             .velocity_m_s = Vec3(0, -5, 0), .coupling = {.stiffness_n_m = 500, .max_force_n = 5}});
            bool touched = false;
            for (int n = 0; n < 60; ++n) {
                slab.world.move_collider(tool, at({x, 0.06 - 5 * (n + 1) / 120.0, 0.3 * x}));
                const StepReport report = slab.world.step();
                EXPECT_EQ(report.flags & StepFlag::non_finite, StepFlag::none) << "step " << n;
                touched = touched || report.contacts > 0;
                // Its target is far below. What holds it is the slab, pressed together under it: at 20 kPa 5 N on so small a ball press far more than the matter can bear.
                ASSERT_GT(slab.world.collider_state(tool).pose.position_m.y(), -0.1) << "E " << young << " x " << x << " step " << n;
                EXPECT_LE(slab.world.collider_state(tool).coupling_force_n.norm(), 5 * (1 + 1e-9));
            }
            EXPECT_TRUE(touched);
            EXPECT_GT(slab.world.collider_state(tool).pose.position_m.y(), -0.03) << "E " << young << " x " << x;
            EXPECT_GT(slab.world.collider_state(tool).force_n.y(), 1) << "E " << young << " x " << x << ": the slab bears it";
        }
    }
}

TEST(ContactTools, ANeedleThatMeetsNoVertexIsFelt) {
    Slab slab(quick(), 2e4, {4, 1, 4});  // edges ten times the tool
    const Vec3 p(0.011, 0, 0.006);
    const ColliderId tool = slab.world.add_collider({.shape = CapsuleShape{0.001, 0.02}, .pose = at(p + Vec3(0, 0.045, 0)), .motion = ColliderMotion::kinematic});
    for (int n = 0; n < 60; ++n) {
        slab.world.move_collider(tool, at(p + Vec3(0, 0.045 - 0.012 * std::min(1.0, n / 40.0), 0)));
        EXPECT_EQ(slab.world.step().flags, StepFlag::none);
    }
    ASSERT_EQ(slab.world.contacts().size(), 1u);
    const ContactPoint& c = slab.world.contacts()[0];
    EXPECT_LT((c.position_m - (p + Vec3(0, 0.045 - 0.012 - 0.021, 0))).norm(), 5e-4) << c.position_m.transpose();
    EXPECT_LT(*std::max_element(c.barycentric.begin(), c.barycentric.end()), 0.95);
    EXPECT_GT(slab.world.collider_state(tool).force_n.y(), 0.01);
    EXPECT_LT(c.normal.y(), -0.9);
}

TEST(ContactTools, WhatTheToolFeelsTheSupportsBear) {
    WorldDef def = quick();
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.rayleigh_mass_1_s = 20;
    Slab slab(def);
    const ColliderId tool = slab.world.add_collider({.shape = SphereShape{0.01}, .pose = at({0.003, 0.031, 0}), .motion = ColliderMotion::tool, .mass_kg = 0.1,
                                                     .coupling = {.stiffness_n_m = 200}});
    slab.world.move_collider(tool, at({0.003, 0.02, 0}));
    for (int n = 0; n < 600; ++n) slab.world.step();
    const ColliderState state = slab.world.collider_state(tool);
    EXPECT_LT((state.force_n + state.coupling_force_n).norm(), 1e-4 * state.force_n.norm()) << "the spring holds against the slab";
    EXPECT_LT((slab.world.reaction_n() - state.force_n).norm(), 1e-4 * state.force_n.norm());
    EXPECT_LT((state.coupling_force_n - 200 * (state.target.position_m - state.pose.position_m)).norm(), 1e-6 + 1e-3 * state.coupling_force_n.norm());
    EXPECT_GT(state.force_n.y(), 0.1);
}

void random_paths(int paths, int steps, std::uint64_t seed) {
    test::Random random(seed);
    StepFlag seen = StepFlag::none;
    int touched = 0, frozen = 0;
    for (int path = 0; path < paths; ++path) {
        WorldDef def = quick();
        Slab slab(def, std::pow(10, random.uniform(2.5, 6)), {4, 2, 4});
        const double size = random.uniform(0.001, 0.02);
        const std::vector<Shape> shapes = {SphereShape{size}, CapsuleShape{size, 0.02}, BoxShape{Vec3(size, 0.01, 0.01)}, CylinderShape{size, 0.01}};
        ColliderDef tool{.shape = shapes[std::size_t(random.uniform(0, 3.999))], .pose = at({0, 0.1, 0})};
        tool.friction = random.uniform(0, 1);
        const double kind = random.uniform(0, 3);
        tool.motion = kind < 1 ? ColliderMotion::kinematic : kind < 2 ? ColliderMotion::tool : ColliderMotion::dynamic;
        if (kind >= 1) tool.mass_kg = std::pow(10, random.uniform(-3, 1));
        tool.coupling.max_force_n = random.uniform(0, 20);
        if (kind >= 2) tool.velocity_m_s = Vec3(0, -random.uniform(0, 10), 0);
        const ColliderId id = slab.world.add_collider(tool);
        Vec3 p(0, 0.06, 0);
        for (int n = 0; n < steps; ++n) {
            p = 0.8 * p + random.vector(0.03);
            const auto q = random.quaternion();
            if (kind < 2) slab.world.move_collider(id, {p, {q.w(), q.x(), q.y(), q.z()}});
            const StepReport report = slab.world.step();
            seen |= report.flags;
            touched += report.contacts > 0;
            ASSERT_TRUE(test::all_finite(slab.world.positions(slab.body))) << "path " << path;
            ASSERT_TRUE(slab.world.collider_state(id).pose.position_m.allFinite()) << "path " << path;
        }
        frozen += slab.world.is_frozen(slab.body);
    }
    std::printf("%d paths: %d steps in contact, %d bodies contained, flags %u\n", paths, touched, frozen, unsigned(seen));
    EXPECT_EQ(std::uint32_t(seen) & ~std::uint32_t(kContained), 0u);
    EXPECT_GT(touched, paths);
}

TEST(ContactTools, RandomPathsLeaveNothingUnfinite) { random_paths(60, 20, 1); }
TEST(ContactTools, SlowTenThousandRandomPaths) { random_paths(10000, 12, 2); }

TEST(ContactDynamic, MomentumGoesFromOneToTheOther) {
    for (const Precision precision : {Precision::single, Precision::double_}) {
        WorldDef def = quick();
        def.gravity_m_s2 = Vec3::Zero();
        def.solver.precision = precision;
        def.solver.cg_relative_tolerance = precision == Precision::double_ ? 1e-10 : 1e-6;
        World world(def);
        const BodyId body = world.add_body({.shape = test::cube(4, 0.1), .material = Corotational{.young_pa = 5e4, .poisson = 0.4}});
        const ColliderId ball = world.add_collider({.shape = SphereShape{0.03}, .pose = at({0.04, 0.16, 0.055}), .motion = ColliderMotion::dynamic, .mass_kg = 0.5,
                                                    .velocity_m_s = Vec3(0.2, -2, 0), .spin_rad_s = Vec3(0, 0, 20)});
        const Vec3 before = 0.5 * Vec3(0.2, -2, 0);
        bool touched = false;
        for (int n = 0; n < 60; ++n) {
            const StepReport report = world.step();
            EXPECT_EQ(report.flags, StepFlag::none) << n;
            touched = touched || report.contacts > 0;
            const Vec3 now = test::momentum(world, body) + 0.5 * world.collider_state(ball).velocity_m_s;
            ASSERT_LT((now - before).norm(), (precision == Precision::double_ ? 1e-8 : 1e-4) * before.norm()) << "step " << n;
        }
        EXPECT_TRUE(touched);
        EXPECT_GT(test::momentum(world, body).norm(), 0.3) << "the cube moves on";
        EXPECT_LT(std::abs(world.collider_state(ball).spin_rad_s.z()), 20) << "friction slows the spin";
    }
}

TEST(ContactDynamic, ARigidBoxRestsOnASoftBlock) {
    WorldDef def = quick();
    def.solver.rayleigh_mass_1_s = 5;
    World world(def);
    const BodyId body = world.add_body({.shape = test::cube(4, 0.1), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
    world.add_collider({.shape = PlaneShape{}});
    const ColliderId box = world.add_collider({.shape = BoxShape{Vec3(0.03, 0.02, 0.03)}, .pose = at({0.05, 0.125, 0.05}), .motion = ColliderMotion::dynamic, .mass_kg = 1});
    for (int n = 0; n < 600; ++n) world.step();
    const ColliderState state = world.collider_state(box);
    EXPECT_LT(state.velocity_m_s.norm(), 1e-4);
    EXPECT_LT(state.spin_rad_s.norm(), 1e-2);
    EXPECT_NEAR(state.force_n.y(), 9.81, 1e-3 * 9.81);
    EXPECT_LT(std::abs(state.torque_nm.norm()), 1e-3);
    EXPECT_NEAR(state.pose.position_m.y(), 0.12 - 0.003, 0.003);
    EXPECT_GT(state.pose.position_m.y() - 0.02, 0.09) << "on the block, not in it";
    EXPECT_LT(test::total_mass(world, body), 10);
}

TEST(ContactDynamic, AFreeBodyFallsAndTurnsAsItShould) {
    World world(quick());
    const ColliderId box = world.add_collider({.shape = BoxShape{Vec3(0.1, 0.2, 0.3)}, .pose = at({0, 1, 0}), .motion = ColliderMotion::dynamic, .mass_kg = 2,
                                               .velocity_m_s = Vec3(1, 0, 0), .spin_rad_s = Vec3(0, 5, 0)});
    for (int n = 0; n < 60; ++n) world.step();
    const ColliderState state = world.collider_state(box);
    EXPECT_NEAR(state.velocity_m_s.y(), -9.81 / 2, 1e-9);
    EXPECT_NEAR(state.pose.position_m.x(), 0.5, 1e-9);
    EXPECT_NEAR(state.spin_rad_s.y(), 5, 1e-6) << "about a principal axis nothing changes";
    EXPECT_NEAR(std::abs(state.pose.rotation_wxyz[0]), std::abs(std::cos(1.25)), 1e-6);
}

TEST(ContactMotion, KeyframesAreInterpolatedOverTheStep) {
    World world(quick());
    ColliderDef def{.shape = SphereShape{0.1}, .motion = ColliderMotion::kinematic};
    def.keys.times_s = {0, 0.5, 1};
    def.keys.positions_m = {Vec3::Zero(), Vec3(1, 0, 0), Vec3(1, 2, 0)};
    def.keys.rotations_wxyz = {{1, 0, 0, 0}, {1, 0, 0, 0}, {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}};
    const ColliderId id = world.add_collider(def);
    for (int n = 0; n < 30; ++n) world.step();
    EXPECT_LT((world.collider_state(id).pose.position_m - Vec3(0.5, 0, 0)).norm(), 1e-9);
    EXPECT_LT((world.collider_state(id).velocity_m_s - Vec3(2, 0, 0)).norm(), 1e-9);
    for (int n = 0; n < 60; ++n) world.step();
    EXPECT_LT((world.collider_state(id).pose.position_m - Vec3(1, 1, 0)).norm(), 1e-9);
    EXPECT_NEAR(world.collider_state(id).pose.rotation_wxyz[0], std::cos(M_PI / 8), 1e-9);
    EXPECT_NEAR(world.collider_state(id).spin_rad_s.z(), M_PI, 1e-6);
}

TEST(ContactMotion, ABeltCarriesWhatSticksToIt) {
    WorldDef def = quick();
    World world(def);
    const BodyId body = world.add_body({.shape = test::cube(3, 0.1), .material = Corotational{.young_pa = 1e5, .poisson = 0.3}, .translation_m = {0, 0.001, 0}});
    const ColliderId belt = world.add_collider({.shape = BoxShape{Vec3(2, 0.05, 1)}, .pose = at({0, -0.05, 0}), .friction = 0.8, .motion = ColliderMotion::kinematic});
    for (int n = 0; n < 240; ++n) {
        const double t = (n + 1) / 120.0;
        world.move_collider(belt, at({0.5 * t * t * 0.5, -0.05, 0}));
        world.step();
    }
    EXPECT_NEAR(test::momentum(world, body).x() / test::total_mass(world, body), 1.0, 0.02) << "0.5 m/s^2 over 2 s";
}

struct Pressed {
    World world;
    BodyId body;
    ColliderId tool, ball;
    explicit Pressed(WorldDef def) : world(def) {
        body = world.add_body({.shape = test::cube(10, 0.1), .material = Corotational{.young_pa = 3e4, .poisson = 0.4}});  // 6,000 tets: several threads take part
        world.add_collider({.shape = PlaneShape{}});
        tool = world.add_collider({.shape = CapsuleShape{0.01, 0.03}, .pose = at({0.05, 0.16, 0.05}), .motion = ColliderMotion::kinematic});
        ball = world.add_collider({.shape = SphereShape{0.02}, .pose = at({0.03, 0.13, 0.02}), .motion = ColliderMotion::dynamic, .mass_kg = 0.1});
    }
    void run(int from, int to) {
        for (int n = from; n < to; ++n) {
            world.move_collider(tool, at({0.05 + 0.02 * std::sin(0.1 * n), 0.16 - 0.04 * std::min(1.0, n / 20.0), 0.05}));
            world.step();
        }
    }
};

TEST(ContactBits, TheSameForAnyNumberOfThreads) {
    std::uint64_t hash = 0;
    for (const int threads : {1, 2, 3}) {
        Pressed pressed(quick(threads));
        pressed.run(0, 25);
        EXPECT_GT(pressed.world.contacts().size(), 10u);
        if (threads == 1) hash = pressed.world.hash();
        EXPECT_EQ(pressed.world.hash(), hash) << threads << " threads";
    }
}

TEST(ContactBits, ASnapshotGoesOnBitForBitInContact) {
    Pressed one(quick()), other(quick());
    one.run(0, 25);
    const auto saved = one.world.save();
    one.run(25, 40);
    other.run(0, 3);
    other.world.restore(saved);
    other.run(25, 40);
    EXPECT_EQ(one.world.hash(), other.world.hash());
    const auto cut = std::span(saved).first(saved.size() - 9);
    EXPECT_THROW(other.world.restore(cut), Error);
    EXPECT_EQ(one.world.hash(), other.world.hash());
    one.world.reset();
    Pressed fresh(quick());
    EXPECT_EQ(one.world.hash(), fresh.world.hash()) << "reset leaves no trace";
    fresh.run(0, 20);
    one.run(0, 20);
    EXPECT_EQ(one.world.hash(), fresh.world.hash());
    World smaller(quick());
    EXPECT_THROW(smaller.restore(saved), Error);
}

TEST(ContactEdits, IdsGoStaleAndRemovedCollidersLeaveNoTrace) {
    World world(quick());
    const BodyId body = world.add_body({.shape = test::cube(2, 0.1)});
    const ColliderId plane = world.add_collider({.name = "floor"});
    EXPECT_EQ(world.collider(plane).name, "floor");
    world.remove_collider(plane);
    for (const auto& use : std::vector<std::function<void()>>{[&] { world.remove_collider(plane); }, [&] { world.move_collider(plane, {}); },
                                                             [&] { (void)world.collider_state(plane); }, [&] { (void)world.collider({}); }}) {
        try {
            use();
            ADD_FAILURE();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::stale_id);
        }
    }
    const ColliderId again = world.add_collider({});
    EXPECT_EQ(again.index, plane.index);
    EXPECT_NE(again.generation, plane.generation);
    EXPECT_EQ(world.colliders().size(), 1u);
    world.remove_collider(again);
    World untouched(quick());
    untouched.add_body({.shape = test::cube(2, 0.1)});
    for (int n = 0; n < 5; ++n) {
        world.step();
        untouched.step();
    }
    EXPECT_EQ(world.hash(), untouched.hash());
    EXPECT_TRUE(world.contacts().empty());
    (void)body;
}

TEST(ContactEdits, BadDefinitionsAreRefusedByTheirField) {
    World world(quick());
    const auto refused = [&](const ColliderDef& def, const std::string& field, ErrorCode code = ErrorCode::invalid_argument) {
        try {
            world.add_collider(def);
            ADD_FAILURE() << field;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), code);
            EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
        }
    };
    refused({.shape = SphereShape{-1}}, "radius_m");
    refused({.shape = PlaneShape{Vec3::Zero(), 0}}, "normal");
    refused({.shape = MeshShape{}}, "grid");
    refused({.friction = -0.1}, "friction");
    refused({.friction = std::nan("")}, "friction");
    refused({.pose = {Vec3::Zero(), {0, 0, 0, 0}}}, "rotation_wxyz");
    refused({.pose = {Vec3(std::nan(""), 0, 0), {1, 0, 0, 0}}}, "position_m");
    refused({.shape = SphereShape{1}, .motion = ColliderMotion::dynamic}, "mass_kg");
    refused({.shape = SphereShape{1}, .mass_kg = 1}, "mass_kg");
    refused({.shape = PlaneShape{}, .motion = ColliderMotion::dynamic, .mass_kg = 1}, "shape", ErrorCode::unsupported);
    refused({.shape = SphereShape{1}, .keys = {{0, 1}, {Vec3::Zero(), Vec3::Ones()}, {}}}, "keys");
    refused({.shape = SphereShape{1}, .motion = ColliderMotion::kinematic, .keys = {{0, 0}, {Vec3::Zero(), Vec3::Ones()}, {}}}, "times_s");
    refused({.shape = SphereShape{1}, .motion = ColliderMotion::kinematic, .keys = {{0, 1}, {Vec3::Zero()}, {}}}, "keys");
    WorldDef def = quick();
    def.solver.integrator = Integrator::quasi_static;
    World still(def);
    EXPECT_THROW(still.add_collider({.shape = SphereShape{1}, .motion = ColliderMotion::dynamic, .mass_kg = 1}), Error);
    EXPECT_TRUE(world.colliders().empty());
}

TEST(ContactIntegrators, EveryOneLandsAndRests) {
    for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2, Integrator::newmark}) {
        for (const int newton : {1, 3}) {
            WorldDef def = quick();
            def.solver.integrator = integrator;
            def.solver.newton_iterations = newton;
            def.solver.rayleigh_mass_1_s = 5;
            def.solver.rayleigh_stiffness_s = 0.002;
            World world(def);
            const BodyId body = world.add_body({.shape = test::cube(4, 0.1), .material = Corotational{.young_pa = 5e4, .poisson = 0.4}, .translation_m = {0, 0.05, 0}});
            world.add_collider({});
            for (int n = 0; n < 480; ++n) world.step();
            const double weight = test::total_mass(world, body) * 9.81;
            EXPECT_NEAR(world.contact_force_n().y(), weight, 0.01 * weight) << int(integrator) << " " << newton;
            for (const Vec3& x : world.positions(body)) EXPECT_GT(x.y(), -1e-3);
        }
    }
}

TEST(ContactIntegrators, NewtonToATolerance) {
    WorldDef def = quick();
    def.solver.newton_iterations = 120;  // where contacts slip, the secant of their friction takes off a tenth in each
    def.solver.newton_tolerance = 1e-6;
    def.solver.cg_relative_tolerance = 1e-8;
    def.solver.precision = Precision::double_;
    World world(def);
    const BodyId body = world.add_body({.shape = test::cube(4, 0.1), .material = StableNeoHookean{}, .translation_m = {0, 0.01, 0}});
    world.add_collider({});
    int capped = 0;
    for (int n = 0; n < 60; ++n) capped += world.step().flags != StepFlag::none;
    EXPECT_LE(capped, 2);
    for (const Vec3& x : world.positions(body)) EXPECT_GT(x.y(), -1e-3);
}

}  // namespace
}  // namespace supple
