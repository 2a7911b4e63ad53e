// Plastic flow: J2 hysteresis, independence of the time step, limits, state.
#include <gtest/gtest.h>

#include "support/bodies.h"

namespace supple {
namespace {

constexpr double kYoung = 1e5, kPoisson = 0.3;

/// A cube whose every vertex is moved: strain(t) in x, nothing across. Homogeneous, so each element sees the same.
struct Stretcher {
    World world;
    BodyId body;

    Stretcher(const Plasticity& plasticity, double h, const Timeline<Vec3>& end, bool small = false) : world([&] {
        WorldDef def;
        def.time_step_s = h;
        def.threads = 1;
        def.gravity_m_s2 = Vec3::Zero();
        def.solver.precision = Precision::double_;
        return def;
    }()) {
        BodyDef def;
        def.shape = test::cube(2, 1);
        if (small) {
            def.material.emplace<Linear>(Linear{kYoung, kPoisson, plasticity});
        } else {
            def.material.emplace<Corotational>(Corotational{.young_pa = kYoung, .poisson = kPoisson, .plasticity = plasticity});
        }
        body = world.add_body(def);
        Motion motion;
        for (const double t : end.times_s) motion.affine.times_s.push_back(t);
        for (const Vec3& u : end.values) {
            Mat34 A = Mat34::Zero();
            A.leftCols<3>() = Mat3::Identity();
            A(0, 0) += u.x();
            motion.affine.values.push_back(A);
        }
        motion.where = Everything{};
        world.prescribe(body, motion);
    }
    double stress() const { return world.element_cauchy_stress(body)[0][0]; }
};

/// Work per volume over a closed cycle of uniaxial strain +-a, second cycle.
double hysteresis(double h, double creep, double a, bool small) {
    const double T = 1;
    Stretcher s({.yield = 0.02, .creep_1_s = creep}, h, {{0, T / 4, 3 * T / 4, 5 * T / 4, 7 * T / 4, 2 * T}, {Vec3::Zero(), Vec3(a, 0, 0), Vec3(-a, 0, 0), Vec3(a, 0, 0), Vec3(-a, 0, 0), Vec3::Zero()}}, small);
    const int steps = int(std::lround(T / h));
    double work = 0, last_stress = 0, last_strain = 0;
    for (int k = 1; k <= 5 * steps / 4 + steps / 2; ++k) {
        s.world.step();
        const double strain = s.world.positions(s.body)[s.world.shape(s.body).mesh().vertices.size() - 1].x() - 1, stress = s.stress();
        if (k > 3 * steps / 4) work += 0.5 * (stress + last_stress) * (strain - last_strain);
        last_stress = stress;
        last_strain = strain;
    }
    return work;
}

TEST(Plasticity, Row25UniaxialStrainHasTheJ2Hysteresis) {
    // Uniaxial strain e: deviator norm e sqrt(2/3). Beyond yield y the deviator's norm is y, so sigma_xx = K e +- 2 mu y sqrt(2/3). The volumetric part does no net work. Over a
    // full cycle the plastic strain norm moves by 2 (2a sqrt(2/3) - 2y): area 2 mu y times that.
    const double mu = kYoung / (2 * (1 + kPoisson)), y = 0.02, a = 0.06;
    const double area = 2 * mu * y * 2 * (2 * a * std::sqrt(2.0 / 3) - 2 * y);
    for (const bool small : {false, true}) {
        EXPECT_NEAR(hysteresis(1.0 / 400, std::numeric_limits<double>::infinity(), a, small), area, 0.01 * area) << (small ? "linear" : "corotational");
    }
}

TEST(Plasticity, Row25AFiniteRateDoesNotDependOnTheTimeStep) {
    const double coarse = hysteresis(1.0 / 200, 5, 0.06, false), fine = hysteresis(1.0 / 1600, 5, 0.06, false);
    EXPECT_NEAR(coarse, fine, 0.02 * fine);
    EXPECT_GT(fine, 0);
}

TEST(Plasticity, BelowTheYieldStrainNothingFlows) {
    const Timeline<Vec3> ramp{{0, 1}, {Vec3::Zero(), Vec3(0.02, 0, 0)}};
    Stretcher plastic({.yield = 0.02}, 0.1, ramp), elastic({}, 0.1, ramp);
    for (int k = 0; k < 10; ++k) {
        plastic.world.step();
        elastic.world.step();
    }
    EXPECT_EQ(plastic.stress(), elastic.stress());
    EXPECT_GT(elastic.stress(), 0);
}

TEST(Plasticity, TheLimitEndsTheFlow) {
    const Timeline<Vec3> ramp{{0, 1}, {Vec3::Zero(), Vec3(0.3, 0, 0)}};
    const double mu = kYoung / (2 * (1 + kPoisson)), K = kYoung / (3 * (1 - 2 * kPoisson));
    Stretcher s({.yield = 0.02, .max = 0.05}, 0.1, ramp);
    for (int k = 0; k < 10; ++k) s.world.step();
    const double deviator = 0.3 * std::sqrt(2.0 / 3) - 0.05;
    EXPECT_NEAR(s.stress(), K * 0.3 + 2 * mu * deviator * std::sqrt(2.0 / 3), 1e-6 * s.stress());
}

TEST(Plasticity, ADentStaysAndIsPartOfTheState) {
    const auto make = [] {
        WorldDef def;
        def.time_step_s = 0.01;
        def.threads = 1;
        auto world = std::make_unique<World>(def);
        const BodyId body = world->add_body({.shape = test::bar({8, 2, 2}), .material = Corotational{.young_pa = 1e5, .poisson = 0.3, .plasticity = {.yield = 0.01, .creep_1_s = 20}}});
        world->fix(body, test::at_x(0));
        world->add_load(body, {.where = test::at_x(0.4), .kind = LoadKind::total_force, .value = {{0, 0.3, 0.31}, {Vec3(0, -20, 0), Vec3(0, -20, 0), Vec3::Zero()}}});
        return world;
    };
    auto a = make(), b = make();
    const BodyId body = a->bodies()[0];
    a->set_gravity(Vec3::Zero());
    b->set_gravity(Vec3::Zero());
    for (int k = 0; k < 30; ++k) {
        ASSERT_EQ(a->step().flags, StepFlag::none);
    }
    b->restore(a->save());
    for (int k = 0; k < 400; ++k) {
        a->step();
        b->step();
    }
    EXPECT_EQ(a->hash(), b->hash());
    EXPECT_LT(test::mean_position(*a, body, test::at_x(0.4)).y(), 0.04) << "bent for good (0.05 at rest)";
    a->reset();
    EXPECT_EQ(a->hash(), make()->hash());
}

TEST(Plasticity, BadParametersAreRefused) {
    for (const Plasticity p : {Plasticity{.yield = -1}, Plasticity{.yield = 0.1, .max = -1}, Plasticity{.yield = 0.1, .creep_1_s = std::nan("")}}) {
        World world;
        EXPECT_THROW(world.add_body({.shape = test::cube(1), .material = Corotational{.plasticity = p}}), Error);
    }
}

}  // namespace
}  // namespace supple
