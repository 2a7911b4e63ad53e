// Pressures, moments and the energy of loads, against closed forms.
#include <gtest/gtest.h>

#include "supple/world/evaluate.h"
#include "supple/world/prepared_loads.h"
#include "support/bodies.h"

namespace supple {
namespace {

Load pressure(const Selection& where, double amount_pa, bool follower) {
    Load load;
    load.where = where;
    load.kind = LoadKind::pressure;
    load.amount.values = {amount_pa};
    load.follower = follower;
    return load;
}

Load moment(const Selection& where, double amount_nm, const Vec3& axis, bool follower = true) {
    Load load;
    load.where = where;
    load.kind = LoadKind::moment;
    load.amount.values = {amount_nm};
    load.axis = axis;
    load.follower = follower;
    return load;
}

/// Forces of one load with the body at x.
std::vector<Vec3> forces(const BodyTemplate& shape, const Load& load, const std::vector<Vec3>& x, double time_s = 0) {
    PreparedLoads loads;
    loads.add(shape.data(), "body", load);
    std::vector<Vec3> f(x.size(), Vec3::Zero());
    Team team;
    loads.add_dead(time_s, f);
    loads.add_followers(team, time_s, x, f);
    return f;
}

Vec3 sum(const std::vector<Vec3>& f) {
    Vec3 total = Vec3::Zero();
    for (const Vec3& v : f) total += v;
    return total;
}

Vec3 torque(const std::vector<Vec3>& f, const std::vector<Vec3>& x, const Vec3& about = Vec3::Zero()) {
    Vec3 total = Vec3::Zero();
    for (std::size_t i = 0; i < f.size(); ++i) total += (x[i] - about).cross(f[i]);
    return total;
}

double size_of(const std::vector<Vec3>& f) {
    double total = 0;
    for (const Vec3& v : f) total += v.norm();
    return total;
}

std::vector<Vec3> moved(const std::vector<Vec3>& x, const Mat3& A, const Vec3& t) {
    std::vector<Vec3> y = x;
    for (Vec3& p : y) p = A * p + t;
    return y;
}

// -- pressure ----------------------------------------------------------------------------------------

TEST(WorldPressure, OnAClosedSurfaceHasNoForceAndNoTorque) {
    test::Random random(1);
    const auto shape = test::irregular_cube(3, 0.3, 2);
    const auto& X = shape->mesh().vertices;
    std::vector<Vec3> x = moved(X, Mat3::Identity() + random.matrix(0.4), {5, -3, 2});
    for (Vec3& p : x) p += random.vector(0.05);
    for (const bool follower : {true, false}) {
        const auto f = forces(*shape, pressure(Everything{}, 700, follower), x);
        ASSERT_GT(size_of(f), 1000);
        EXPECT_LT(sum(f).norm(), 1e-12 * size_of(f));
        EXPECT_LT(torque(f, follower ? x : X).norm(), 1e-11 * size_of(f));
    }
}

TEST(WorldPressure, PositivePushesIntoTheBodyWithAreaTimesPressure) {
    const auto shape = test::bar({4, 2, 2});
    const auto& X = shape->mesh().vertices;
    for (const bool follower : {true, false}) {
        const auto f = forces(*shape, pressure(test::at_x(0.4), 1000, follower), X);
        EXPECT_LT((sum(f) - Vec3(-10, 0, 0)).norm(), 1e-12);
        for (std::size_t i = 0; i < X.size(); ++i) EXPECT_LE(f[i].x(), 0);
        EXPECT_LT((torque(f, X, {0.4, 0.05, 0.05})).norm(), 1e-13) << "uniform: through the middle of the face";
    }
}

TEST(WorldPressure, AFollowerTurnsWithTheBodyAndADeadPressureDoesNot) {
    test::Random random(3);
    const auto shape = test::bar({4, 2, 2});
    const auto& X = shape->mesh().vertices;
    const Mat3 R = random.rotation();
    const auto x = moved(X, R, {1, 2, 3});
    const auto rest = forces(*shape, pressure(test::at_x(0.4), 1000, true), X);
    const auto turned = forces(*shape, pressure(test::at_x(0.4), 1000, true), x);
    const auto dead = forces(*shape, pressure(test::at_x(0.4), 1000, false), x);
    for (std::size_t i = 0; i < X.size(); ++i) {
        EXPECT_LT((turned[i] - R * rest[i]).norm(), 1e-12);
        EXPECT_LT((dead[i] - rest[i]).norm(), 1e-12);
    }
}

TEST(WorldPressure, AFollowerActsOnThePresentArea) {
    const auto shape = test::bar({4, 2, 2});
    const Mat3 stretch = Vec3(5, 2, 3).asDiagonal();
    const auto x = moved(shape->mesh().vertices, stretch, Vec3::Zero());
    EXPECT_LT((sum(forces(*shape, pressure(test::at_x(0.4), 1000, true), x)) - 6 * Vec3(-10, 0, 0)).norm(), 1e-11);
    EXPECT_LT((sum(forces(*shape, pressure(test::at_x(0.4), 1000, false), x)) - Vec3(-10, 0, 0)).norm(), 1e-11);
}

TEST(WorldPressure, IsTheGradientOfPressureTimesVolume) {
    // A closed surface under follower pressure: f = -p dV/dx.
    test::Random random(4);
    const auto shape = test::irregular_cube(2, 0.2, 5);
    std::vector<Vec3> x = shape->mesh().vertices;
    for (Vec3& p : x) p += random.vector(0.05);
    const auto volume = [&](const std::vector<Vec3>& y) {
        double v = 0;
        for (const Triangle& t : shape->boundary().triangles) v += y[std::size_t(t[0])].dot(y[std::size_t(t[1])].cross(y[std::size_t(t[2])])) / 6;
        return v;
    };
    const auto f = forces(*shape, pressure(Everything{}, 40, true), x);
    for (std::size_t i = 0; i < x.size(); i += 3) {
        for (int c = 0; c < 3; ++c) {
            std::vector<Vec3> up = x, down = x;
            up[i][c] += 1e-5;
            down[i][c] -= 1e-5;
            EXPECT_NEAR(f[i][c], -40 * (volume(up) - volume(down)) / 2e-5, 1e-8);
        }
    }
}

TEST(WorldPressure, TrianglesByNumberAndTimeTables) {
    const auto shape = test::bar({4, 2, 2});
    const auto& X = shape->mesh().vertices;
    Load load = pressure(Everything{}, 0, true);
    for (std::size_t t = 0; t < shape->boundary().triangles.size(); ++t) {
        const Triangle& tri = shape->boundary().triangles[t];
        if (X[std::size_t(tri[0])].x() > 0.39 && X[std::size_t(tri[1])].x() > 0.39 && X[std::size_t(tri[2])].x() > 0.39) load.triangles.push_back(std::int32_t(t));
    }
    load.amount = {{1, 3}, {0, 1000}};
    for (const auto& [time, force] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {2.0, -5.0}, {3.0, -10.0}, {9.0, -10.0}}) {
        EXPECT_NEAR(sum(forces(*shape, load, X, time)).x(), force, 1e-12) << time;
    }
    load.triangles = {int(shape->boundary().triangles.size())};
    EXPECT_THROW(forces(*shape, load, X), Error);
}

TEST(WorldPressure, HydrostaticPressureSqueezesABodyByItsBulkModulus) {
    // Equilibrium of an unsupported block under follower pressure p all around: sigma = -p I.
    WorldDef def;
    def.threads = 1;
    def.gravity_m_s2 = Vec3::Zero();
    def.time_step_s = 0.05;
    def.solver.precision = Precision::double_;
    def.solver.rayleigh_mass_1_s = 20;
    def.solver.cg_relative_tolerance = 1e-12;
    World world(def);
    const BodyId body = world.add_body({.shape = test::irregular_cube(2, 0.2, 6), .material = NeoHookean{.mu_pa = 4e4, .lambda_pa = 6e4}});
    world.add_load(body, pressure(Everything{}, 5000, true));
    ASSERT_TRUE(test::run_to_rest(world, 1e-10, 2000));
    for (const Voigt& s : world.element_cauchy_stress(body)) {
        for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(s[c], c < 3 ? -5000 : 0, 0.01);
    }
}

// -- moment ------------------------------------------------------------------------------------------

TEST(WorldMoment, IsACoupleOfTheGivenTorqueHoweverTheBodyHasTurned) {
    test::Random random(7);
    const auto shape = test::bar({4, 2, 2});
    const Vec3 axis = Vec3(1, 2, -0.5);
    for (const Selection& where : {Selection(test::at_x(0.4)), Selection(Everything{}), Selection(VertexList{{0, 5, 9}})}) {
        for (const bool follower : {true, false}) {
            const Mat3 R = random.rotation();
            const auto x = moved(shape->mesh().vertices, R, {1, 2, 3});
            const auto f = forces(*shape, moment(where, 0.3, axis, follower), x);
            const Vec3 expected = 0.3 * (follower ? Vec3(R * axis.normalized()) : axis.normalized());
            EXPECT_LT(sum(f).norm(), 1e-12 * size_of(f));
            EXPECT_LT((torque(f, x) - expected).norm(), 1e-10 * size_of(f)) << torque(f, x).transpose();
            EXPECT_LT((torque(f, x, {-4, 7, 1}) - expected).norm(), 1e-10 * size_of(f)) << "the same about every point";
        }
    }
}

TEST(WorldMoment, HoldsItsTorqueOnADeformedSelection) {
    test::Random random(8);
    const auto shape = test::bar({4, 2, 2});
    std::vector<Vec3> x = shape->mesh().vertices;
    for (Vec3& p : x) p += random.vector(0.03);
    const auto f = forces(*shape, moment(test::at_x(0.4), 2, {0, 0, 1}, false), x);
    EXPECT_LT(sum(f).norm(), 1e-12 * size_of(f));
    EXPECT_LT((torque(f, x) - Vec3(0, 0, 2)).norm(), 1e-11);
}

TEST(WorldMoment, BendsABeamAsBeamTheoryDoes) {
    // Cantilever, nu = 0, end moment M about z: curvature M/(E I); the forces at the end vary linearly over its height.
    const auto shape = test::bar({4, 4, 4});
    const auto& X = shape->mesh().vertices;
    const auto f = forces(*shape, moment(test::at_x(0.4), 1, {0, 0, 1}), X);
    // Traction of the theory: sigma = -M y / I. Each vertex gets the integral of sigma times its hat function.
    const double I = std::pow(0.1, 4) / 12;
    std::vector<double> expected(X.size(), 0.0);
    for (const Triangle& t : shape->boundary().triangles) {
        const Vec3 &a = X[std::size_t(t[0])], &b = X[std::size_t(t[1])], &c = X[std::size_t(t[2])];
        if (a.x() + b.x() + c.x() < 1.2 - 1e-9) continue;
        const double area = 0.5 * (b - a).cross(c - a).norm();
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t l = 0; l < 3; ++l) expected[std::size_t(t[k])] -= area / 12 * (k == l ? 2 : 1) * (X[std::size_t(t[l])].y() - 0.05) / I;
    }
    for (std::size_t i = 0; i < X.size(); ++i) EXPECT_NEAR(f[i].x(), expected[i], 1e-9);
    EXPECT_GT(size_of(f), 10);
}

TEST(WorldMoment, RefusesWhatCannotTurn) {
    const auto shape = test::bar({4, 1, 1});
    const auto& X = shape->mesh().vertices;
    EXPECT_THROW(forces(*shape, moment(test::at_x(0.4), 1, Vec3::Zero()), X), Error);
    const Selection edge = InsideBox{{-1, -1e-9, -1e-9}, {1, 1e-9, 1e-9}};
    EXPECT_THROW(forces(*shape, moment(edge, 1, {0, 1, 0}), X), Error);
    EXPECT_THROW(forces(*shape, moment(VertexList{{0}}, 1, {0, 1, 0}), X), Error);
    Load both = moment(test::at_x(0.4), 1, {0, 0, 1});
    both.value.values = {Vec3::Zero()};
    EXPECT_THROW(forces(*shape, both, X), Error);
    both = moment(test::at_x(0.4), 1, {0, 0, 1});
    both.amount = {{0, 1}, {1}};
    EXPECT_THROW(forces(*shape, both, X), Error);
    both.amount = {{}, {HUGE_VAL}};
    EXPECT_THROW(forces(*shape, both, X), Error);
}

TEST(WorldMoment, SpinsAFreeBodyUp) {
    // Angular momentum after one step: M h.
    WorldDef def;
    def.threads = 1;
    def.gravity_m_s2 = Vec3::Zero();
    def.time_step_s = 1e-3;
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-12;
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = Corotational{.young_pa = 1e6, .poisson = 0.3}});
    world.add_load(body, moment(Everything{}, 0.01, {0, 0, 1}));
    world.step();
    Vec3 L = Vec3::Zero();
    for (std::size_t i = 0; i < world.masses(body).size(); ++i) L += world.masses(body)[i] * world.positions(body)[i].cross(world.velocities(body)[i]);
    EXPECT_LT((L - Vec3(0, 0, 1e-5)).norm(), 1e-9);
    EXPECT_LT(test::momentum(world, body).norm(), 1e-12);
}

// -- in the step -------------------------------------------------------------------------------------

TEST(WorldFollowers, SameBitsForAnyNumberOfThreads) {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 3}) {
        WorldDef def;
        def.threads = threads;
        def.time_step_s = 0.01;
        def.solver.newton_iterations = 2;
        World world(def);
        const BodyId body = world.add_body({.shape = test::cube(10, 0.1), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
        world.fix(body, test::at_x(0));
        world.add_load(body, pressure(Everything{}, 2000, true));
        world.add_load(body, moment(test::at_x(0.1), 0.05, {1, 0, 0}));
        for (int n = 0; n < 3; ++n) EXPECT_EQ(world.step().flags, StepFlag::none);
        hashes.push_back(world.hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(WorldFollowers, TheStaticIntegratorFindsTheirEquilibrium) {
    WorldDef def;
    def.threads = 1;
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.integrator = Integrator::quasi_static;
    def.solver.newton_tolerance = 1e-8;
    def.solver.precision = Precision::double_;
    World world(def);
    const Material law = NeoHookean{};
    const BodyId body = world.add_body({.shape = test::bar({8, 2, 2}), .material = law});
    world.fix(body, test::at_x(0));
    const Load push = pressure(InsideBox{{-1, 0.1 - 1e-9, -1}, {1, 1, 1}}, 200, true);
    world.add_load(body, push);
    ASSERT_EQ(world.step().flags, StepFlag::none);
    const std::vector<Vec3> x = test::copy(world.positions(body));
    EXPECT_LT(x.back().y(), 0.08) << "it bends a long way";
    const auto outer = forces(world.shape(body), push, x), inner = evaluate(world.shape(body), law, x).forces_n;
    double left = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (world.shape(body).mesh().vertices[i].x() > 1e-9) left += (outer[i] + inner[i]).norm();
    }
    EXPECT_LT(left, 1e-5 * size_of(outer));
}

TEST(WorldFollowers, ClearingTheLoadsEndsThem) {
    WorldDef def;
    def.threads = 1;
    def.gravity_m_s2 = Vec3::Zero();
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1})});
    world.add_load(body, pressure(test::at_x(0.4), 1000, true));
    world.step();
    const Vec3 p = test::momentum(world, body);
    EXPECT_NEAR(p.x(), -10 * def.time_step_s, 1e-6);
    world.clear_loads(body);
    world.step();
    EXPECT_LT((test::momentum(world, body) - p).norm(), 1e-6);
}

// -- energy ------------------------------------------------------------------------------------------

TEST(WorldEnergy, OfDeadLoadsIsMinusTheirWork) {
    WorldDef def;
    def.threads = 1;
    def.gravity_m_s2 = Vec3::Zero();
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .translation_m = {1, 0, 0}});
    world.add_load(body, {Everything{}, LoadKind::total_force, {{}, {Vec3(3, 0, 0)}}});
    world.add_load(body, pressure(test::at_x(0.4), 1000, false));
    EXPECT_EQ(world.energy().loads_j, 0);
    std::vector<Vec3> x = test::copy(world.positions(body)), v(x.size(), Vec3::Zero());
    for (Vec3& p : x) p.x() += 0.5;
    world.set_state(body, x, v);
    EXPECT_NEAR(world.energy().loads_j, -0.5 * (3 - 10), 1e-12);
    EXPECT_NEAR(world.energy().total_j(), 3.5, 1e-9);
}

TEST(WorldEnergy, IsThereForEveryLaw) {
    // Uniaxial strain by e: W close to (lambda/2 + mu) e^2 per volume, whatever the law.
    const double e = 1e-4, volume = 0.004;
    const std::vector<Material> laws = {Linear{}, Corotational{}, Corotational{.rotation = Rotation::svd}, StVenantKirchhoff{}, NeoHookean{},
                                        StableNeoHookean{}, MooneyRivlin{}, ArrudaBoyce{}, VerondaWestman{}, Ogden{}};
    for (const Material& material : laws) {
        SCOPED_TRACE(material.index());
        WorldDef def;
        def.threads = 1;
        def.gravity_m_s2 = Vec3(0, 0, -10);
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = material});
        std::vector<Vec3> x = test::copy(world.positions(body)), v(x.size(), Vec3(0, 2, 0));
        for (Vec3& p : x) p.x() *= 1 + e;
        world.set_state(body, x, v);
        const Lame lame = small_strain(material);
        const double expected = (lame.lambda_pa / 2 + lame.mu_pa) * e * e * volume;
        EXPECT_NEAR(world.energy().elastic_j, expected, 1e-3 * expected);
        EXPECT_NEAR(world.energy().kinetic_j, 0.5 * 4 * 4, 1e-9);
        EXPECT_NEAR(world.energy().gravity_j, 4 * 10 * 0.05, 1e-9);
    }
}

}  // namespace
}  // namespace supple
