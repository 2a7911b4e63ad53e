// Plastic flow: J2 hysteresis, independence of the time step, limits, state.
#include <gtest/gtest.h>

#include "support/bodies.h"

namespace supple {
namespace {

constexpr double kYoung = 1e5, kPoisson = 0.3;

/// Hexahedra below, tetrahedra above, and an irregular inside.
std::shared_ptr<const BodyTemplate> mixed_cube() {
    VolumeMesh mesh = make_hex_box({.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {3, 3, 3}});
    const VolumeMesh tets = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {3, 3, 3}});
    mesh.hexes.resize(18);
    mesh.tets.assign(tets.tets.begin() + 18 * 6, tets.tets.end());
    return BodyTemplate::build(std::move(mesh));
}

/// A shape and the way its elements are strained.
struct Kind {
    const char* name;
    std::shared_ptr<const BodyTemplate> shape;
    bool small = false;
    Rotation rotation = Rotation::polar;
    Integration integration = Integration::incompatible;

    Material material(const Plasticity& plasticity) const {
        if (small) return Linear{.young_pa = kYoung, .poisson = kPoisson, .plasticity = plasticity, .integration = integration};
        return Corotational{.rotation = rotation, .young_pa = kYoung, .poisson = kPoisson, .plasticity = plasticity, .integration = integration};
    }
};

const std::vector<Kind>& kinds() {
    const auto hexes = [](int n) { return BodyTemplate::build(make_hex_box({.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {n, n, n}})); };
    static const std::vector<Kind> all{{"corotational tets", test::cube(2, 1)},
                                       {"linear tets", test::cube(2, 1), true},
                                       {"corotational hexes", hexes(2)},
                                       {"one corotational hex", hexes(1)},
                                       {"linear hexes", hexes(2), true},
                                       {"hexes with edge frames", hexes(2), false, Rotation::large},
                                       {"hexes with singular value frames", hexes(2), false, Rotation::svd},
                                       {"fully integrated hexes", hexes(2), false, Rotation::polar, Integration::full},
                                       {"irregular hexes", test::irregular_hex_cube(3, 0.25, 5)},
                                       {"tets on hexes", mixed_cube()}};
    return all;
}

/// A cube whose every vertex is moved: strain(t) in x, nothing across. Homogeneous, so each element sees the same.
struct Stretcher {
    World world;
    BodyId body;

    Stretcher(const Kind& kind, const Plasticity& plasticity, double h, const Timeline<Vec3>& end) : world([&] {
        WorldDef def;
        def.time_step_s = h;
        def.threads = 1;
        def.gravity_m_s2 = Vec3::Zero();
        def.solver.precision = Precision::double_;
        return def;
    }()) {
        BodyDef def;
        def.shape = kind.shape;
        def.material = kind.material(plasticity);
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
    /// Of the first element; every other one has the same.
    double stress() const {
        const auto all = world.element_cauchy_stress(body);
        for (const auto& s : all) EXPECT_NEAR(s[0], all[0][0], 1e-9 * kYoung);
        return all[0][0];
    }
};

/// Work per volume over a closed cycle of uniaxial strain +-a, second cycle.
double hysteresis(const Kind& kind, double h, double creep, double a) {
    const double T = 1;
    Stretcher s(kind, {.yield = 0.02, .creep_1_s = creep}, h, {{0, T / 4, 3 * T / 4, 5 * T / 4, 7 * T / 4, 2 * T}, {Vec3::Zero(), Vec3(a, 0, 0), Vec3(-a, 0, 0), Vec3(a, 0, 0), Vec3(-a, 0, 0), Vec3::Zero()}});
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
    for (const Kind& kind : kinds()) {
        EXPECT_NEAR(hysteresis(kind, 1.0 / 400, std::numeric_limits<double>::infinity(), a), area, 0.01 * area) << kind.name;
    }
}

TEST(Plasticity, Row25AFiniteRateDoesNotDependOnTheTimeStep) {
    for (const Kind& kind : kinds()) {
        const double coarse = hysteresis(kind, 1.0 / 200, 5, 0.06), fine = hysteresis(kind, 1.0 / 1600, 5, 0.06);
        EXPECT_NEAR(coarse, fine, 0.02 * fine) << kind.name;
        EXPECT_GT(fine, 0) << kind.name;
    }
}

TEST(Plasticity, TetsAndHexesOfAnySizeAndShapeFlowAlike) {
    const Timeline<Vec3> path{{0, 0.5, 1}, {Vec3::Zero(), Vec3(0.08, 0, 0), Vec3(-0.05, 0, 0)}};
    std::vector<double> first;
    for (const Kind& kind : kinds()) {
        Stretcher s(kind, {.yield = 0.02, .max = 0.03, .creep_1_s = 9}, 0.05, path);
        for (std::size_t k = 0; k < 20; ++k) {
            s.world.step();
            if (&kind == &kinds()[0]) first.push_back(s.stress());
            EXPECT_NEAR(s.stress(), first[k], 1e-9 * kYoung) << kind.name << " step " << k;
        }
    }
}

TEST(Plasticity, StrainThatIsHeldCreepsAtItsRate) {
    // |e'| - y decays as exp(-c t), whatever the step: here after the step at which the strain arrives, and 0.4 s of rest.
    const double y = 0.02, c = 6, e = 0.08, norm = e * std::sqrt(2.0 / 3), mu = kYoung / (2 * (1 + kPoisson)), K = kYoung / (3 * (1 - 2 * kPoisson));
    for (const Kind& kind : kinds()) {
        for (const double h : {0.1, 0.01}) {
            Stretcher s(kind, {.yield = y, .creep_1_s = c}, h, {{0, 1e-6}, {Vec3::Zero(), Vec3(e, 0, 0)}});
            for (int k = 0; k < int(std::lround(0.4 / h)); ++k) s.world.step();
            const double left = y + (norm - y) * std::exp(-c * 0.4);
            EXPECT_NEAR(s.stress(), K * e + 2 * mu * left * std::sqrt(2.0 / 3), 1e-9 * s.stress()) << kind.name << " h " << h;
        }
    }
}

TEST(Plasticity, BelowTheYieldStrainNothingFlows) {
    const Timeline<Vec3> ramp{{0, 1}, {Vec3::Zero(), Vec3(0.02, 0, 0)}};
    for (const Kind& kind : kinds()) {
        Stretcher plastic(kind, {.yield = 0.02}, 0.1, ramp), elastic(kind, {}, 0.1, ramp);
        for (int k = 0; k < 10; ++k) {
            plastic.world.step();
            elastic.world.step();
        }
        EXPECT_EQ(plastic.stress(), elastic.stress()) << kind.name;
        EXPECT_GT(elastic.stress(), 0) << kind.name;
    }
}

TEST(Plasticity, TheLimitEndsTheFlow) {
    const Timeline<Vec3> ramp{{0, 1}, {Vec3::Zero(), Vec3(0.3, 0, 0)}};
    const double mu = kYoung / (2 * (1 + kPoisson)), K = kYoung / (3 * (1 - 2 * kPoisson));
    for (const Kind& kind : kinds()) {
        Stretcher s(kind, {.yield = 0.02, .max = 0.05}, 0.1, ramp);
        for (int k = 0; k < 10; ++k) s.world.step();
        const double deviator = 0.3 * std::sqrt(2.0 / 3) - 0.05;
        EXPECT_NEAR(s.stress(), K * 0.3 + 2 * mu * deviator * std::sqrt(2.0 / 3), 1e-6 * s.stress()) << kind.name;
    }
}

TEST(Plasticity, AStretchedBarKeepsTheLengthItFlowedTo) {
    // Pulled by a dead load until the limit of the flow is reached. Let go, it keeps the plastic strain: e_p in the pull and -e_p/2 across.
    for (const auto& shape : {test::bar({8, 2, 2}), test::hex_bar({8, 2, 2})}) {
        WorldDef def;
        def.time_step_s = 0.05;
        def.threads = 1;
        def.gravity_m_s2 = Vec3::Zero();
        def.solver.precision = Precision::double_;
        World world(def);
        const BodyId body = world.add_body({.shape = shape, .material = Corotational{.young_pa = 1e5, .poisson = 0, .plasticity = {.yield = 0.02, .max = 0.06, .creep_1_s = 50}}});
        world.fix(body, test::at_x(0), {true, false, false});
        world.fix(body, VertexList{{0}});
        world.fix(body, VertexList{{9}}, {true, true, true});
        world.add_load(body, {.where = test::at_x(0.4), .kind = LoadKind::total_force, .value = {{0, 2, 6}, {Vec3(80, 0, 0), Vec3(80, 0, 0), Vec3::Zero()}}});  // let go slowly: it must not swing back past the yield strain
        for (int k = 0; k < 160; ++k) ASSERT_EQ(world.step().flags, StepFlag::none);
        // The limit |e_p| = 0.06 in the shape (1, -1/2, -1/2) sqrt(2/3).
        EXPECT_NEAR(test::mean_position(world, body, test::at_x(0.4)).x(), 0.4 * (1 + 0.06 * std::sqrt(2.0 / 3)), 0.4 * 0.002);
    }
}

void check_dent(const std::shared_ptr<const BodyTemplate>& shape) {
    const auto make = [&] {
        WorldDef def;
        def.time_step_s = 0.01;
        def.threads = 1;
        auto world = std::make_unique<World>(def);
        const BodyId body = world->add_body({.shape = shape, .material = Corotational{.young_pa = 1e5, .poisson = 0.3, .plasticity = {.yield = 0.01, .creep_1_s = 20}}});
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

TEST(Plasticity, ADentStaysAndIsPartOfTheState) { check_dent(test::bar({8, 2, 2})); }
TEST(Plasticity, ADentInHexesStaysAndIsPartOfTheState) { check_dent(test::hex_bar({8, 4, 2})); }

TEST(Plasticity, BadParametersAreRefused) {
    for (const Plasticity p : {Plasticity{.yield = -1}, Plasticity{.yield = 0.1, .max = -1}, Plasticity{.yield = 0.1, .creep_1_s = std::nan("")}}) {
        World world;
        EXPECT_THROW(world.add_body({.shape = test::cube(1), .material = Corotational{.plasticity = p}}), Error);
    }
}

}  // namespace
}  // namespace supple
