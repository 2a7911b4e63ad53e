// Motion against what implicit Euler must give: exact discrete solutions, momentum, modes, damping.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "supple/world/evaluate.h"
#include "support/bodies.h"

namespace supple {
namespace {

using test::Random;

WorldDef exact(double time_step_s = 0.01) {
    WorldDef def;
    def.time_step_s = time_step_s;
    def.threads = 1;
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-13;
    return def;
}

TEST(WorldMotion, FreeFallIsTheDiscreteOne) {
    World world(exact());
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .translation_m = {0, 5, 0}, .velocity_m_s = {1, 0, 0}});
    const auto start = test::copy(world.positions(body));
    const Vec3 g = world.def().gravity_m_s2;
    const double h = world.def().time_step_s;
    for (int n = 1; n <= 100; ++n) {
        const StepReport report = world.step();
        EXPECT_EQ(report.flags, StepFlag::none);
        for (std::size_t i = 0; i < start.size(); ++i) {
            const Vec3 v = Vec3(1, 0, 0) + n * h * g;
            ASSERT_LT((world.velocities(body)[i] - v).norm(), 1e-10) << "step " << n;
            const Vec3 x = start[i] + n * h * Vec3(1, 0, 0) + h * h * g * (0.5 * n * (n + 1));
            ASSERT_LT((world.positions(body)[i] - x).norm(), 1e-10) << "step " << n;
        }
    }
    EXPECT_LT(world.energy().elastic_j, 1e-12);
}

TEST(WorldMotion, AFreeBodyKeepsItsMomentum) {
    WorldDef def = exact();
    def.gravity_m_s2 = Vec3::Zero();
    World world(def);
    const auto shape = test::irregular_cube(2, 0.2, 70);
    const BodyId body = world.add_body({.shape = shape, .material = Corotational{.young_pa = 1e4, .poisson = 0.4}});
    Random random(70);
    auto x = test::copy(world.positions(body)), v = test::copy(world.velocities(body));
    for (Vec3& p : x) p += random.vector(0.05);
    for (Vec3& u : v) u = Vec3(0.3, -0.2, 0.1) + random.vector(0.5);
    world.set_state(body, x, v);
    const Vec3 before = test::momentum(world, body);
    double size = 0;
    for (std::size_t i = 0; i < v.size(); ++i) size += world.masses(body)[i] * v[i].norm();
    for (int n = 0; n < 1000; ++n) world.step();
    EXPECT_LT((test::momentum(world, body) - before).norm(), 1e-11 * size);
    EXPECT_TRUE(test::all_finite(world.positions(body)));
}

TEST(WorldMotion, EnergyOfAFreeBodyNeverGrows) {
    WorldDef def = exact(1.0 / 60);
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.newton_iterations = 30;
    def.solver.newton_tolerance = 1e-10;
    World world(def);
    const BodyId body = world.add_body({.shape = test::irregular_cube(2, 0.2, 71), .material = Corotational{.young_pa = 5e3, .poisson = 0.3}});
    Random random(71);
    auto x = test::copy(world.positions(body)), v = test::copy(world.velocities(body));
    for (Vec3& p : x) p += random.vector(0.1);
    world.set_state(body, x, v);
    double energy = world.energy().total_j();
    const double first = energy;
    for (int n = 0; n < 200; ++n) {
        world.step();
        const double now = world.energy().total_j();
        EXPECT_LE(now, energy * (1 + 1e-9)) << "step " << n;
        energy = now;
    }
    EXPECT_LT(energy, 0.1 * first);
}

TEST(WorldMotion, ASpinningBodyFollowsTheLawOfImplicitEuler) {
    WorldDef def = exact(0.01);
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.newton_iterations = 20;
    def.solver.newton_tolerance = 1e-9;
    World world(def);
    const BodyId body = world.add_body({.shape = test::cube(2), .material = Corotational{.young_pa = 1e9, .poisson = 0.3}, .translation_m = Vec3::Constant(-0.5)});
    const double spin = 5;
    auto x = test::copy(world.positions(body)), v = x;
    // About a principal axis, or the body would tumble: the lumped masses of a box cut into tets are not quite symmetric.
    Mat3 inertia = Mat3::Zero();
    for (std::size_t i = 0; i < x.size(); ++i) inertia += world.masses(body)[i] * (x[i].squaredNorm() * Mat3::Identity() - x[i] * x[i].transpose());
    const Vec3 axis = Eigen::SelfAdjointEigenSolver<Mat3>(inertia).eigenvectors().col(2);
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = (spin * axis).cross(x[i]);
    world.set_state(body, x, v);
    const auto angular = [&] {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < x.size(); ++i) sum += world.masses(body)[i] * world.positions(body)[i].cross(world.velocities(body)[i]);
        return sum;
    };
    const double first = angular().norm();
    for (int n = 1; n <= 100; ++n) {
        world.step();
        const double law = 1 / std::sqrt(1 + 2 * n * std::pow(spin * def.time_step_s, 2));
        EXPECT_NEAR(angular().norm() / first, law, 0.01) << "step " << n;
        EXPECT_NEAR(angular().dot(axis), angular().norm(), 1e-6 * first) << "the axis of the spin stays";
    }
}

// -- modes -------------------------------------------------------------------------------------------

/// A bar that can only move along x, clamped at x = 0: its longitudinal modes, from the stiffness of the library and its masses.
struct Longitudinal {
    std::shared_ptr<const BodyTemplate> shape = test::bar({16, 1, 1});
    Corotational material{.young_pa = 1e6, .poisson = 0};
    std::vector<std::size_t> free;  ///< vertices that move
    Eigen::VectorXd mass, mode;
    double omega = 0;

    Longitudinal() {
        const auto& X = shape->mesh().vertices;
        World world;
        const BodyId body = world.add_body({.shape = shape});
        for (std::size_t i = 0; i < X.size(); ++i) {
            if (X[i].x() > 1e-9) free.push_back(i);
        }
        const auto n = Eigen::Index(free.size());
        Eigen::MatrixXd K(n, n);
        mass.resize(n);
        for (Eigen::Index j = 0; j < n; ++j) {
            mass[j] = world.masses(body)[free[std::size_t(j)]];
            std::vector<Vec3> d(X.size(), Vec3::Zero());
            d[free[std::size_t(j)]].x() = 1;
            const auto df = force_differential(*shape, material, X, d);
            for (Eigen::Index i = 0; i < n; ++i) K(i, j) = -df[free[std::size_t(i)]].x();
        }
        const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, Eigen::MatrixXd(mass.asDiagonal()));
        omega = std::sqrt(solver.eigenvalues()[0]);
        mode = solver.eigenvectors().col(0);
        mode /= mode.cwiseAbs().maxCoeff();
    }

    double project(std::span<const Vec3> field, std::span<const Vec3> origin) const {
        double sum = 0;
        for (std::size_t j = 0; j < free.size(); ++j) {
            const double u = field[free[j]].x() - (origin.empty() ? 0 : origin[free[j]].x());
            sum += mode[Eigen::Index(j)] * mass[Eigen::Index(j)] * u;
        }
        return sum / (mode.array().square() * mass.array()).sum();
    }
};

const Longitudinal& longitudinal() {
    static const Longitudinal mode;
    return mode;
}

TEST(WorldModes, TheLongitudinalFrequencyIsThatOfARod) {
    const double rod = EIGEN_PI / 2 / 0.4 * std::sqrt(1e6 / 1000);
    EXPECT_NEAR(longitudinal().omega, rod, 0.005 * rod);
}

/// Compares a small free vibration with the recurrence of implicit Euler for one mode under Rayleigh damping.
void check_mode(double h, double alpha, double beta, LineariseAt at) {
    const Longitudinal& rod = longitudinal();
    WorldDef def = exact(h);
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.rayleigh_mass_1_s = alpha;
    def.solver.rayleigh_stiffness_s = beta;
    def.solver.linearise_at = at;
    World world(def);
    const BodyId body = world.add_body({.shape = rod.shape, .material = rod.material});
    world.fix(body, Everything{}, {false, true, true});
    world.fix(body, test::at_x(0));
    const auto& X = rod.shape->mesh().vertices;
    const double amplitude = 1e-7;
    auto x = X, v = std::vector<Vec3>(X.size(), Vec3::Zero());
    for (std::size_t j = 0; j < rod.free.size(); ++j) x[rod.free[j]].x() += amplitude * rod.mode[Eigen::Index(j)];
    world.set_state(body, x, v);
    double q = amplitude, p = 0;
    const double w2 = rod.omega * rod.omega;
    for (int n = 1; n <= 50; ++n) {
        world.step();
        p = (p - h * w2 * q) / (1 + h * alpha + (h * h + h * beta) * w2);
        q += h * p;
        ASSERT_NEAR(rod.project(world.positions(body), X), q, 1e-5 * amplitude) << "step " << n;
        ASSERT_NEAR(rod.project(world.velocities(body), {}), p, 1e-5 * amplitude * rod.omega) << "step " << n;
        if (alpha == 0 && beta == 0) {
            // What the recurrence means: the amplitude shrinks by (1 + w^2 h^2)^(-1/2) per step.
            const double size = std::sqrt(q * q + p * p / w2);
            ASSERT_NEAR(size, amplitude * std::pow(1 + w2 * h * h, -0.5 * n), 1e-9 * amplitude);
        }
    }
}

/// A small vibration is linear: one iteration is exact wherever it is linearised.
constexpr LineariseAt kEverywhere[] = {LineariseAt::prediction, LineariseAt::current};

TEST(WorldModes, AmplitudeShrinksAsImplicitEulerMust) {
    for (const LineariseAt at : kEverywhere) {
        for (const double h : {0.0002, 0.002, 0.05}) check_mode(h, 0, 0, at);
    }
}

TEST(WorldModes, RayleighDampingIsThatOfItsTwoTerms) {
    for (const LineariseAt at : kEverywhere) {
        check_mode(0.002, 20, 0, at);
        check_mode(0.002, 0, 0.003, at);
        check_mode(0.001, 5, 0.001, at);
    }
}

TEST(WorldModes, RayleighDampingDecaysAsTheContinuousLaw) {
    // With a step small against the period the discrete decay is exp(-(alpha + beta w^2)/2 t) times implicit Euler's own exp(-w^2 h/2 t).
    const Longitudinal& rod = longitudinal();
    const double h = 2e-5, alpha = 30, beta = 5e-4, w2 = rod.omega * rod.omega;
    WorldDef def = exact(h);
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.rayleigh_mass_1_s = alpha;
    def.solver.rayleigh_stiffness_s = beta;
    World world(def);
    const BodyId body = world.add_body({.shape = rod.shape, .material = rod.material});
    world.fix(body, Everything{}, {false, true, true});
    world.fix(body, test::at_x(0));
    const auto& X = rod.shape->mesh().vertices;
    auto x = X, v = std::vector<Vec3>(X.size(), Vec3::Zero());
    for (std::size_t j = 0; j < rod.free.size(); ++j) x[rod.free[j]].x() += 1e-7 * rod.mode[Eigen::Index(j)];
    world.set_state(body, x, v);
    const double decay = 0.5 * (alpha + beta * w2 + h * w2), wd = std::sqrt(w2 - std::pow(0.5 * (alpha + beta * w2), 2));
    for (int n = 1; n <= 1000; ++n) world.step();
    const double t = world.time_s();
    const double expected = 1e-7 * std::exp(-decay * t) * (std::cos(wd * t) + 0.5 * (alpha + beta * w2) / wd * std::sin(wd * t));
    EXPECT_NEAR(rod.project(world.positions(body), X), expected, 0.01e-7);
}

}  // namespace
}  // namespace supple
