// Bodies at rest: equilibrium, reactions, the cost of resting.
#include <gtest/gtest.h>

#include "supple/math/polar.h"
#include "supple/world/evaluate.h"
#include "support/bodies.h"

namespace supple {
namespace {

WorldDef heavily_damped() {
    WorldDef def;
    def.time_step_s = 0.05;
    def.threads = 1;
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-10;
    def.solver.rayleigh_mass_1_s = 15;
    return def;
}

TEST(WorldStatics, ACantileverHangsFromItsSupports) {
    World world(heavily_damped());
    const BodyId body = world.add_body({.shape = test::bar({8, 2, 2}), .material = Corotational{.young_pa = 2e5, .poisson = 0.4}});
    world.fix(body, test::at_x(0));
    ASSERT_TRUE(test::run_to_rest(world, 1e-10, 2000));
    const Vec3 weight = test::total_mass(world, body) * world.def().gravity_m_s2;
    EXPECT_NEAR(weight.y(), -9.81 * 1000 * 0.004, 1e-9);
    EXPECT_LT((world.reaction_n(body) + weight).norm(), 1e-6 * weight.norm());
    EXPECT_LT((world.reaction_n() - world.reaction_n(body)).norm(), 1e-12);
    // Every free vertex is in balance with the internal force of the library's own evaluation, every held one through its reaction.
    const auto inner = evaluate(world.shape(body), Corotational{.young_pa = 2e5, .poisson = 0.4}, world.positions(body)).forces_n;
    for (std::size_t i = 0; i < inner.size(); ++i) {
        const Vec3 rest = inner[i] + world.masses(body)[i] * world.def().gravity_m_s2 + world.reactions(body)[i];
        EXPECT_LT(rest.norm(), 1e-6 * weight.norm()) << "vertex " << i;
        if (world.shape(body).mesh().vertices[i].x() > 1e-9) {
            EXPECT_EQ(world.reactions(body)[i], Vec3::Zero());
        }
    }
    // The moment about the clamp balances too.
    Vec3 moment = Vec3::Zero();
    for (std::size_t i = 0; i < inner.size(); ++i) {
        moment += world.positions(body)[i].cross(world.reactions(body)[i] + world.masses(body)[i] * world.def().gravity_m_s2);
    }
    EXPECT_LT(moment.norm(), 1e-6 * weight.norm());
    EXPECT_LT(test::mean_position(world, body, test::at_x(0.4)).y(), 0);
}

TEST(WorldStatics, AHangingBarStretchesByItsWeight) {
    WorldDef def = heavily_damped();
    def.gravity_m_s2 = Vec3(9.81, 0, 0);
    World world(def);
    const double E = 1e6;
    const BodyId body = world.add_body({.shape = test::bar({16, 2, 2}), .material = Corotational{.young_pa = E, .poisson = 0}});
    world.fix(body, test::at_x(0));
    ASSERT_TRUE(test::run_to_rest(world, 1e-10, 2000));
    const double stretch = 1000 * 9.81 * 0.4 * 0.4 / (2 * E);
    EXPECT_NEAR(test::mean_position(world, body, test::at_x(0.4)).x() - 0.4, stretch, 0.01 * stretch);
    EXPECT_NEAR(world.reaction_n(body).x(), -9.81 * 4, 1e-6 * 9.81 * 4);
    // Stress at the clamp: the weight over the area, less half an element; von Mises the same, for it is uniaxial.
    double largest = 0;
    for (const Voigt& s : world.element_cauchy_stress(body)) largest = std::max(largest, s[0]);
    EXPECT_NEAR(largest, 1000 * 9.81 * 0.4 * (1 - 0.5 / 16), 0.03 * 1000 * 9.81 * 0.4);
    for (std::size_t e = 0; e < world.element_von_mises(body).size(); ++e) {
        EXPECT_NEAR(world.element_von_mises(body)[e], von_mises(world.element_cauchy_stress(body)[e]), 1e-9);
    }
}

TEST(WorldStatics, ABodyAtRestCostsNoIterations) {
    for (const Precision precision : {Precision::single, Precision::double_}) {
        WorldDef def = heavily_damped();
        def.solver.precision = precision;
        def.solver.cg_relative_tolerance = 1e-5;
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar({8, 2, 2}), .material = Corotational{.young_pa = 2e5, .poisson = 0.4}});
        world.fix(body, test::at_x(0));
        int costly = 0;
        for (int n = 0; n < 400; ++n) costly = world.step().cg_iterations > 0 ? n + 1 : costly;
        EXPECT_LT(costly, 390) << "still iterating at the end";
        const auto before = test::copy(world.positions(body));
        const StepReport report = world.step();
        EXPECT_EQ(report.cg_iterations, 0);
        EXPECT_EQ(report.flags, StepFlag::none);
        EXPECT_LE(report.cg_relative_residual, 1e-5);
        EXPECT_LT(test::relative_difference(world.positions(body), before), 1e-9);
    }
}

TEST(WorldStatics, AnUntouchedBodyWithoutGravityNeverMoves) {
    for (const Precision precision : {Precision::single, Precision::double_}) {
        WorldDef def;
        def.gravity_m_s2 = Vec3::Zero();
        def.threads = 1;
        def.solver.precision = precision;
        World world(def);
        const BodyId body = world.add_body({.shape = test::irregular_cube(2, 0.2, 80)});
        const auto before = test::copy(world.positions(body));
        for (int n = 0; n < 20; ++n) {
            const StepReport report = world.step();
            EXPECT_EQ(report.flags, StepFlag::none);
        }
        EXPECT_LT(test::relative_difference(world.positions(body), before), 1e-14);
    }
}

TEST(WorldStatics, PatchTestSolvedByTheWorld) {
    const auto shape = test::irregular_cube(3, 0.25, 81);
    WorldDef def;
    def.gravity_m_s2 = Vec3::Zero();
    def.time_step_s = 1;
    def.threads = 1;
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-13;
    def.solver.newton_iterations = 20;
    World world(def);
    const Corotational soft{.young_pa = 1e5, .poisson = 0.35};
    const BodyId body = world.add_body({.shape = shape, .material = soft, .density_kg_m3 = 1e-3});
    VertexList boundary;
    for (std::size_t i = 0; i < shape->mesh().vertices.size(); ++i) {
        const Vec3& X = shape->mesh().vertices[i];
        if (X.minCoeff() < 1e-9 || X.maxCoeff() > 1 - 1e-9) boundary.vertices.push_back(std::int32_t(i));
    }
    ASSERT_LT(boundary.vertices.size(), shape->mesh().vertices.size());
    test::Random random(81);
    const Mat3 F = Eigen::AngleAxisd(0.6, Vec3(1, 2, 3).normalized()).toRotationMatrix() * (Mat3::Identity() + 0.1 * random.matrix(1));
    Mat34 none, affine;
    none << Mat3::Identity(), Vec3::Zero();
    affine << F, Vec3(0.1, 0.2, 0.3);
    Motion motion;
    motion.where = boundary;
    motion.affine = {{0, 5}, {none, affine}};
    world.prescribe(body, motion);
    for (int n = 0; n < 15; ++n) world.step();
    for (std::size_t i = 0; i < shape->mesh().vertices.size(); ++i) {
        const Vec3 x = F * shape->mesh().vertices[i] + Vec3(0.1, 0.2, 0.3);
        EXPECT_LT((world.positions(body)[i] - x).norm(), 1e-10) << "vertex " << i;
    }
    const Mat3 R = rotation_matrix(polar_quaternion(F)), G = R.transpose() * F, e = 0.5 * (G + G.transpose()) - Mat3::Identity();
    const Lame l = lame_parameters(soft.young_pa, soft.poisson, "");
    const Mat3 sigma = R * (2 * l.mu_pa * e + l.lambda_pa * e.trace() * Mat3::Identity()) * R.transpose();
    const Voigt expected{sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(2, 0)};
    for (const Voigt& s : world.element_cauchy_stress(body))
        for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(s[c], expected[c], 1e-8 * soft.young_pa);
}

}  // namespace
}  // namespace supple
