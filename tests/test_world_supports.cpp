// What holds, moves and loads a body.
#include <gtest/gtest.h>

#include "support/bodies.h"

namespace supple {
namespace {

WorldDef exact() {
    WorldDef def;
    def.time_step_s = 0.01;
    def.threads = 1;
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-13;
    return def;
}

constexpr Corotational kSoft{.young_pa = 1e5, .poisson = 0.3};

// -- timelines ---------------------------------------------------------------------------------------

TEST(WorldTimeline, IsLinearBetweenItsEntriesAndConstantOutside) {
    const Timeline<Vec3> line{{1, 2, 4}, {Vec3(0, 0, 0), Vec3(10, 0, 0), Vec3(10, 20, 0)}};
    EXPECT_EQ(line.at(-5), Vec3(0, 0, 0));
    EXPECT_EQ(line.at(1), Vec3(0, 0, 0));
    EXPECT_EQ(line.at(1.5), Vec3(5, 0, 0));
    EXPECT_EQ(line.at(2), Vec3(10, 0, 0));
    EXPECT_EQ(line.at(3), Vec3(10, 10, 0));
    EXPECT_EQ(line.at(4), Vec3(10, 20, 0));
    EXPECT_EQ(line.at(100), Vec3(10, 20, 0));
    const Timeline<Vec3> always{{}, {Vec3(1, 2, 3)}};
    EXPECT_EQ(always.at(-1), Vec3(1, 2, 3));
    EXPECT_EQ(always.at(1e9), Vec3(1, 2, 3));
    const Timeline<Vec3> once{{5}, {Vec3(1, 2, 3)}};
    EXPECT_EQ(once.at(0), Vec3(1, 2, 3));
    EXPECT_EQ(once.at(9), Vec3(1, 2, 3));
}

// -- supports ----------------------------------------------------------------------------------------

TEST(WorldSupports, FixingAnAxisHoldsThatAxisAlone) {
    for (const Precision precision : {Precision::single, Precision::double_}) {
        WorldDef def = exact();
        def.gravity_m_s2 = Vec3(1, -9.81, 2);
        def.solver.precision = precision;
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = kSoft});
        EXPECT_EQ(world.fix(body, Everything{}, {false, true, true}), world.positions(body).size());
        const auto start = test::copy(world.positions(body));
        for (int n = 1; n <= 20; ++n) {
            world.step();
            for (std::size_t i = 0; i < start.size(); ++i) {
                EXPECT_EQ(world.positions(body)[i].y(), start[i].y());
                EXPECT_EQ(world.positions(body)[i].z(), start[i].z());
                EXPECT_NEAR(world.velocities(body)[i].x(), n * 0.01, 1e-9);
            }
        }
        const double m = test::total_mass(world, body);
        EXPECT_LT((world.reaction_n(body) - m * Vec3(0, 9.81, -2)).norm(), 1e-6 * m * 9.81);
    }
}

TEST(WorldSupports, FixHoldsWhereTheVerticesAreNowAndReleaseLetsGo) {
    WorldDef def = exact();
    def.gravity_m_s2 = Vec3(0, -9.81, 0);
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = kSoft});
    for (int n = 0; n < 10; ++n) world.step();
    const auto held = test::copy(world.positions(body));
    EXPECT_EQ(world.fix(body, test::at_x(0)), 4u);
    for (int n = 0; n < 10; ++n) world.step();
    std::size_t checked = 0;
    for (std::size_t i = 0; i < held.size(); ++i) {
        if (world.shape(body).mesh().vertices[i].x() > 1e-9) continue;
        EXPECT_EQ(world.positions(body)[i], held[i]);
        ++checked;
    }
    EXPECT_EQ(checked, 4u);
    EXPECT_GT(world.reaction_n(body).y(), 0);
    world.release(body, test::at_x(0));
    world.step();
    EXPECT_EQ(world.reaction_n(body), Vec3::Zero());
    const double m = test::total_mass(world, body);
    const Vec3 before = test::momentum(world, body);
    world.step();
    EXPECT_NEAR(test::momentum(world, body).y() - before.y(), -9.81 * 0.01 * m, 1e-9) << "a released body falls";
}

TEST(WorldSupports, VerticesOfNoElementStayWhereTheyAre) {
    VolumeMesh mesh = test::unit_tet()->mesh();
    mesh.vertices.insert(mesh.vertices.begin(), Vec3(9, 9, 9));
    mesh.tets = {{1, 2, 3, 4}};
    World world(exact());
    world.set_gravity({0, -9.81, 0});
    const BodyId body = world.add_body({.shape = BodyTemplate::build(mesh), .material = kSoft});
    world.release(body, Everything{});
    for (int n = 0; n < 5; ++n) EXPECT_EQ(world.step().flags, StepFlag::none);
    EXPECT_EQ(world.positions(body)[0], Vec3(9, 9, 9));
    EXPECT_LT(world.positions(body)[1].y(), 0);
    EXPECT_EQ(world.masses(body)[0], 0);
    EXPECT_EQ(world.von_mises(body)[0], 0);
}

// -- prescribed motion -------------------------------------------------------------------------------

template <class Expected>
void check_motion(const Motion& motion, const Vec3& translation, int steps, Expected&& expected) {
    for (const LineariseAt at : {LineariseAt::prediction, LineariseAt::current}) {
        WorldDef def = exact();
        def.solver.linearise_at = at;
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = kSoft, .translation_m = translation});
        const auto start = test::copy(world.positions(body));
        ASSERT_EQ(world.prescribe(body, motion), 4u);
        for (int n = 1; n <= steps; ++n) {
            ASSERT_EQ(world.step().flags, StepFlag::none);
            for (std::size_t i = 0; i < start.size(); ++i) {
                if (world.shape(body).mesh().vertices[i].x() > 1e-9) continue;
                ASSERT_LT((world.positions(body)[i] - expected(start[i], n * 0.01)).norm(), 1e-14) << "step " << n << ", vertex " << i;
            }
        }
        EXPECT_TRUE(test::all_finite(world.positions(body)));
    }
}

TEST(WorldPrescribed, DisplacementsArriveExactlyAndOnTime) {
    Motion motion;
    motion.where = test::at_x(0);
    motion.displacement_m = {{0, 0.1, 0.2}, {Vec3(0, 0, 0), Vec3(0, 0.05, 0), Vec3(0.02, 0.05, -0.01)}};
    check_motion(motion, {0.1, 0.2, 0.3}, 30, [&](const Vec3& X, double t) { return Vec3(X + motion.displacement_m.at(t)); });
}

TEST(WorldPrescribed, ADisplacementFromTheFirstStepJumps) {
    Motion motion;
    motion.where = test::at_x(0);
    motion.displacement_m = {{}, {Vec3(0, 0.05, 0)}};
    check_motion(motion, Vec3::Zero(), 3, [&](const Vec3& X, double) { return Vec3(X + Vec3(0, 0.05, 0)); });
}

TEST(WorldPrescribed, AffineMapsActOnTheStartPositions) {
    Motion motion;
    motion.where = test::at_x(0);
    motion.affine.times_s = {0, 0.1, 0.2, 0.3};
    for (int k = 0; k < 4; ++k) {
        Mat34 A;
        A << Eigen::AngleAxisd(0.3 * k, Vec3::UnitX()).toRotationMatrix(), Vec3(0.01 * k, 0, 0);
        motion.affine.values.push_back(A);
    }
    check_motion(motion, {0.1, 0.2, 0.3}, 40, [&](const Vec3& X, double t) {
        const Mat34 A = motion.affine.at(t);
        return Vec3(A.leftCols<3>() * X + A.col(3));
    });
}

TEST(WorldPrescribed, VelocitiesAreKeptAndAddUp) {
    Motion motion;
    motion.where = test::at_x(0);
    motion.velocity_m_s = {{0, 0.1}, {Vec3(0, 0, 0), Vec3(0, 1, 0.5)}};
    World world(exact());
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = kSoft});
    world.prescribe(body, motion);
    Vec3 travelled = Vec3::Zero();
    for (int n = 1; n <= 20; ++n) {
        world.step();
        const Vec3 v = motion.velocity_m_s.at(n * 0.01);
        travelled += 0.01 * v;
        EXPECT_EQ(world.velocities(body)[0], v);
        EXPECT_LT((world.positions(body)[0] - travelled).norm(), 1e-14);
    }
}

TEST(WorldPrescribed, OneAxisFollowsWhileTheOthersAreFree) {
    WorldDef def = exact();
    def.gravity_m_s2 = Vec3(0, 0, -1);
    World world(def);
    const BodyId body = world.add_body({.shape = test::unit_tet(), .material = kSoft});
    Motion motion;
    motion.where = Everything{};
    motion.axes = {true, false, false};
    motion.velocity_m_s = {{}, {Vec3(2, 7, 7)}};
    world.prescribe(body, motion);
    for (int n = 1; n <= 10; ++n) world.step();
    for (const Vec3& v : world.velocities(body)) EXPECT_LT((v - Vec3(2, 0, -0.1)).norm(), 1e-10);
}

TEST(WorldPrescribed, TheReactionDrivesTheBody) {
    // A rigid push: all vertices prescribed, so the reaction is m a.
    World world(exact());
    const BodyId body = world.add_body({.shape = test::unit_tet(), .material = kSoft});
    Motion motion;
    motion.where = Everything{};
    motion.velocity_m_s = {{0, 1}, {Vec3::Zero(), Vec3(3, 0, 0)}};
    world.prescribe(body, motion);
    for (int n = 0; n < 5; ++n) world.step();
    EXPECT_LT((world.reaction_n(body) - test::total_mass(world, body) * Vec3(3, 0, 0)).norm(), 1e-8);
}

TEST(WorldPrescribed, FixedAndPrescribedEndsStretchABarUniformly) {
    WorldDef def = exact();
    def.time_step_s = 0.05;
    def.solver.rayleigh_mass_1_s = 50;
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({8, 2, 2}), .material = Corotational{.young_pa = 1e5, .poisson = 0}});
    world.fix(body, test::at_x(0));
    Motion motion;
    motion.where = test::at_x(0.4);
    motion.displacement_m = {{0, 0.5}, {Vec3::Zero(), Vec3(0.04, 0, 0)}};
    world.prescribe(body, motion);
    ASSERT_TRUE(test::run_to_rest(world, 1e-11, 3000) && world.time_s() > 0.5);
    for (const Voigt& s : world.element_cauchy_stress(body)) {
        EXPECT_NEAR(s[0], 1e4, 1);
        EXPECT_NEAR(s[1], 0, 1);
    }
    EXPECT_NEAR(world.reaction_n(body).norm(), 0, 1e-3) << "both ends pull alike";
    double pull = 0;
    for (std::size_t i = 0; i < world.reactions(body).size(); ++i) pull += std::max(0.0, world.reactions(body)[i].x());
    EXPECT_NEAR(pull, 1e4 * 0.01, 0.1);
}

// -- loads -------------------------------------------------------------------------------------------

/// Momentum that one step gives a free body, over h: the total force of its loads.
Vec3 force_in_one_step(const Load& load, double time_before_s = 0) {
    World world(exact());
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = kSoft});
    while (world.time_s() < time_before_s - 1e-9) world.step();
    world.add_load(body, load);
    const Vec3 before = test::momentum(world, body);
    EXPECT_EQ(world.step().flags, StepFlag::none);
    return (test::momentum(world, body) - before) / 0.01;
}

TEST(WorldLoads, EachKindAddsUpToItsTotal) {
    const Timeline<Vec3> f{{}, {Vec3(1, -2, 3)}};
    const auto near_to = [](const Vec3& got, const Vec3& expected) { EXPECT_LT((got - expected).norm(), 1e-9 * expected.norm()) << got.transpose(); };
    near_to(force_in_one_step({test::at_x(0.4), LoadKind::total_force, f}), Vec3(1, -2, 3));
    near_to(force_in_one_step({Everything{}, LoadKind::total_force, f}), Vec3(1, -2, 3));
    near_to(force_in_one_step({test::at_x(0.4), LoadKind::force_per_vertex, f}), 4 * Vec3(1, -2, 3));
    near_to(force_in_one_step({test::at_x(0.4), LoadKind::traction, f}), 0.01 * Vec3(1, -2, 3));
    near_to(force_in_one_step({Everything{}, LoadKind::traction, f}), (2 * 0.01 + 4 * 0.04) * Vec3(1, -2, 3));
    near_to(force_in_one_step({Everything{}, LoadKind::body_force, f}), 0.004 * Vec3(1, -2, 3));
    near_to(force_in_one_step({InsideBox{{-1, -1, -1}, {0.2001, 1, 1}}, LoadKind::body_force, f}), 0.002 * Vec3(1, -2, 3));
}

TEST(WorldLoads, FollowTheirTimelineAtTheEndOfTheStep) {
    const Load ramp{Everything{}, LoadKind::total_force, {{0, 0.1}, {Vec3::Zero(), Vec3(10, 0, 0)}}};
    EXPECT_NEAR(force_in_one_step(ramp).x(), 1, 1e-8);
    EXPECT_NEAR(force_in_one_step(ramp, 0.04).x(), 5, 1e-8);
    EXPECT_NEAR(force_in_one_step(ramp, 0.5).x(), 10, 1e-8);
}

TEST(WorldLoads, AddUpAndCanBeCleared) {
    World world(exact());
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = kSoft});
    world.add_load(body, {Everything{}, LoadKind::total_force, {{}, {Vec3(1, 0, 0)}}});
    world.add_load(body, {Everything{}, LoadKind::total_force, {{}, {Vec3(0, 2, 0)}}});
    world.step();
    const Vec3 p = test::momentum(world, body);
    EXPECT_LT((p - 0.01 * Vec3(1, 2, 0)).norm(), 1e-10);
    world.clear_loads(body);
    world.step();
    EXPECT_LT((test::momentum(world, body) - p).norm(), 1e-10);
}

TEST(WorldLoads, ATractionOnTheEndIsAreaTimesStress) {
    WorldDef def = exact();
    def.time_step_s = 0.05;
    def.solver.rayleigh_mass_1_s = 50;
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({8, 2, 2}), .material = Corotational{.young_pa = 1e5, .poisson = 0}});
    world.fix(body, test::at_x(0));
    world.add_load(body, {test::at_x(0.4), LoadKind::traction, {{}, {Vec3(1000, 0, 0)}}});
    ASSERT_TRUE(test::run_to_rest(world, 1e-11, 3000));
    for (const Voigt& s : world.element_cauchy_stress(body)) EXPECT_NEAR(s[0], 1000, 0.01);
    EXPECT_NEAR(test::mean_position(world, body, test::at_x(0.4)).x(), 0.4 * 1.01, 1e-7);
    EXPECT_LT((world.reaction_n(body) + Vec3(10, 0, 0)).norm(), 1e-6);
}

// -- material and density ----------------------------------------------------------------------------

TEST(WorldMaterial, DensityScalesTheMass) {
    World world(exact());
    const BodyId light = world.add_body({.shape = test::bar(), .density_kg_m3 = 10});
    const BodyId heavy = world.add_body({.shape = test::bar(), .density_kg_m3 = 7800});
    EXPECT_NEAR(test::total_mass(world, light), 0.04, 1e-12);
    EXPECT_NEAR(test::total_mass(world, heavy), 31.2, 1e-9);
}

TEST(WorldMaterial, EachElementHasItsOwnModuli) {
    World world(exact());
    const auto shape = test::irregular_cube(2, 0.2, 90);
    const std::size_t n = shape->mesh().tets.size();
    BodyDef def{.shape = shape};
    test::Random random(90);
    for (std::size_t e = 0; e < n; ++e) {
        def.young_pa_per_element.push_back(random.uniform(1e4, 1e6));
        def.poisson_per_element.push_back(random.uniform(-0.2, 0.45));
    }
    const BodyId body = world.add_body(def);
    std::vector<Vec3> x = shape->mesh().vertices, v(x.size(), Vec3::Zero());
    for (Vec3& p : x) p.x() *= 1.1;
    world.set_state(body, x, v);
    for (std::size_t e = 0; e < n; ++e) {
        const Lame l = lame_parameters(def.young_pa_per_element[e], def.poisson_per_element[e], "");
        EXPECT_NEAR(world.element_cauchy_stress(body)[e][0], (l.lambda_pa + 2 * l.mu_pa) * 0.1, 1e-6);
        EXPECT_NEAR(world.element_cauchy_stress(body)[e][1], l.lambda_pa * 0.1, 1e-6);
    }
}

TEST(WorldMaterial, OneArrayOverridesTheMaterialAndLeavesTheOther) {
    const auto hash_with = [](const BodyDef& def) {
        World world(exact());
        world.set_gravity({0, -9.81, 0});
        const BodyId body = world.add_body(def);
        world.fix(body, test::at_x(0));
        for (int n = 0; n < 10; ++n) world.step();
        return world.hash();
    };
    const auto shape = test::bar({4, 1, 1});
    const std::size_t n = shape->mesh().tets.size();
    const auto plain = hash_with({.shape = shape, .material = Corotational{.young_pa = 3e5, .poisson = 0.2}});
    EXPECT_EQ(hash_with({.shape = shape, .material = Corotational{.young_pa = 1, .poisson = 0.2}, .young_pa_per_element = std::vector<double>(n, 3e5)}), plain);
    EXPECT_EQ(hash_with({.shape = shape, .material = Corotational{.young_pa = 3e5, .poisson = 0}, .poisson_per_element = std::vector<double>(n, 0.2)}), plain);
    EXPECT_NE(hash_with({.shape = shape, .material = Corotational{.young_pa = 3.001e5, .poisson = 0.2}}), plain);
}

}  // namespace
}  // namespace supple
