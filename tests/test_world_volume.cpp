// Nearly incompressible tetrahedra: nodal volumetric stiffness against the locking of plain elements.
#include <gtest/gtest.h>

#include "supple/fem/elements.h"
#include "supple/world/evaluate.h"
#include "support/bodies.h"

namespace supple {
namespace {

using test::Random;

Material material(double poisson, Volumetric volumetric, bool small = false) {
    if (small) return Linear{1e5, poisson, {}, volumetric};
    return Corotational{.young_pa = 1e5, .poisson = poisson, .volumetric = volumetric};
}

TEST(NodalVolume, ForceIsTheGradientOfTheEnergyAndTheTangentThatOfTheForce) {
    const auto shape = test::irregular_cube(2, 0.2, 3);
    Random random(4);
    const Material m = material(0.49, Volumetric::nodal);
    const Mat3 Q = random.rotation();
    std::vector<Vec3> x = shape->mesh().vertices, d;
    for (Vec3& v : x) {
        v = Q * (v + random.vector(0.05));
        d.push_back(random.vector(1));
    }
    constexpr double h = 1e-6;
    std::vector<Vec3> up = x, down = x, difference(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        up[i] += h * d[i];
        down[i] -= h * d[i];
    }
    const Evaluation here = evaluate(*shape, m, x), above = evaluate(*shape, m, up), below = evaluate(*shape, m, down);
    double slope = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        slope -= here.forces_n[i].dot(d[i]);
        difference[i] = (above.forces_n[i] - below.forces_n[i]) / (2 * h);
    }
    EXPECT_NEAR((above.energy_j - below.energy_j) / (2 * h), slope, 1e-7 * std::abs(slope));
    EXPECT_LT(test::relative_difference(force_differential(*shape, m, x, d, Tangent::exact), difference), 1e-6);
}

TEST(NodalVolume, AHomogeneousStrainIsThatOfPlainElements) {
    const auto shape = test::irregular_cube(3, 0.2, 5);
    Random random(6);
    const Mat3 F = random.rotation() * (Mat3::Identity() + random.matrix(0.1));
    std::vector<Vec3> x = shape->mesh().vertices;
    for (Vec3& v : x) v = F * v;
    const Evaluation nodal = evaluate(*shape, material(0.49, Volumetric::nodal), x), plain = evaluate(*shape, material(0.49, Volumetric::element), x);
    EXPECT_NEAR(nodal.energy_j, plain.energy_j, 1e-10 * plain.energy_j);
    for (std::size_t e = 0; e < nodal.element_stress_pa.size(); ++e) {
        for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(nodal.element_stress_pa[e][c], plain.element_stress_pa[e][c], 1e-9 * 1e6);
    }
    EXPECT_LT(test::relative_difference(nodal.forces_n, plain.forces_n), 1e-9);
}

/// Droop of the tip of a cantilever under a load.
double droop(double poisson, Volumetric volumetric, Precision precision = Precision::automatic, PreconditionerKind kind = PreconditionerKind::automatic) {
    WorldDef def;
    def.threads = 1;
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.integrator = Integrator::quasi_static;
    def.solver.precision = precision;
    def.solver.preconditioner = kind;
    def.solver.cg_max_iterations = 20000;
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({16, 4, 4}), .material = material(poisson, volumetric, true)});
    world.fix(body, test::at_x(0));
    world.add_load(body, {.where = test::at_x(0.4), .kind = LoadKind::total_force, .value = {{}, {Vec3(0, -0.1, 0)}}});
    const StepReport report = world.step();
    EXPECT_EQ(report.flags, StepFlag::none) << name(report.flags);
    return 0.05 - test::mean_position(world, body, test::at_x(0.4)).y();
}

TEST(NodalVolume, PlainElementsLockAndTheseDoNot) {
    // The Young's modulus decides a slender beam; Poisson's ratio hardly does, the held end apart.
    const double soft = droop(0.3, Volumetric::element);
    EXPECT_LT(droop(0.49, Volumetric::element), 0.45 * soft) << "plain tets should lock: this is what the option is for";
    EXPECT_GT(droop(0.499, Volumetric::nodal), 0.87 * soft);
    EXPECT_GT(droop(0.4999, Volumetric::nodal), 0.85 * soft);
    EXPECT_LT(droop(0.4999, Volumetric::nodal), 1.1 * soft);
    EXPECT_NEAR(droop(0.499, Volumetric::nodal, Precision::automatic, PreconditionerKind::direct), droop(0.499, Volumetric::nodal), 1e-4 * soft);
}

TEST(NodalVolume, AFallingBarKeepsItsVolume) {
    for (const Precision precision : {Precision::single, Precision::double_}) {
        WorldDef def;
        def.time_step_s = 0.01;
        def.threads = 2;
        def.solver.precision = precision;
        def.solver.cg_relative_tolerance = 1e-4;
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar({16, 4, 4}), .material = material(0.495, Volumetric::nodal)});
        world.fix(body, test::at_x(0));
        for (int k = 0; k < 60; ++k) ASSERT_EQ(world.step().flags, StepFlag::none) << "step " << k;
        double volume = 0;
        const auto x = world.positions(body);
        for (const Tet& t : world.shape(body).mesh().tets) volume += tet_volume(x[std::size_t(t[0])], x[std::size_t(t[1])], x[std::size_t(t[2])], x[std::size_t(t[3])]);
        EXPECT_NEAR(volume, 0.004, 0.01 * 0.004);
        EXPECT_LT(test::mean_position(world, body, test::at_x(0.4)).y(), 0);
    }
}

TEST(NodalVolume, SameBitsForAnyNumberOfThreads) {
    std::uint64_t hash = 0;
    for (const int threads : {1, 2, 3}) {
        WorldDef def;
        def.time_step_s = 0.01;
        def.threads = threads;
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar({24, 6, 6}), .material = material(0.49, Volumetric::nodal)});
        world.fix(body, test::at_x(0));
        for (int k = 0; k < 3; ++k) world.step();
        if (threads == 1) hash = world.hash();
        EXPECT_EQ(world.hash(), hash) << threads << " threads";
    }
}

}  // namespace
}  // namespace supple
