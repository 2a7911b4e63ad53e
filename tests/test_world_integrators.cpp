// Integrators, Newton with its line search, the exact corotational tangent, the static solve. Row numbers: the verification table of the README.
#include <gtest/gtest.h>

#include "supple/world/evaluate.h"
#include "support/bodies.h"

namespace supple {
namespace {

using test::Random;

WorldDef precise(Integrator integrator, double h) {
    WorldDef def;
    def.time_step_s = h;
    def.threads = 1;
    def.solver.integrator = integrator;
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-10;
    def.solver.newton_iterations = 30;
    def.solver.newton_tolerance = 1e-9;
    return def;
}

constexpr Integrator kDynamic[] = {Integrator::implicit_euler, Integrator::bdf2, Integrator::newmark};

// -- the exact tangent ------------------------------------------------------------------------------

double tangent_error(const BodyTemplate& shape, const Material& m, const std::vector<Vec3>& x, const std::vector<Vec3>& d, Tangent tangent) {
    constexpr double h = 1e-6;
    std::vector<Vec3> up = x, down = x;
    for (std::size_t i = 0; i < x.size(); ++i) {
        up[i] += h * d[i];
        down[i] -= h * d[i];
    }
    const auto f1 = evaluate(shape, m, up).forces_n, f0 = evaluate(shape, m, down).forces_n;
    std::vector<Vec3> difference(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) difference[i] = (f1[i] - f0[i]) / (2 * h);
    return test::relative_difference(force_differential(shape, m, x, d, tangent), difference);
}

TEST(ExactTangent, Row3IsTheDerivativeOfTheForce) {
    const auto shape = test::irregular_cube(2, 0.2, 7);
    Random random(8);
    for (const Rotation rotation : {Rotation::polar, Rotation::svd}) {
        const Material m = Corotational{.rotation = rotation, .young_pa = 1e5, .poisson = 0.4};
        for (int k = 0; k < 5; ++k) {
            const Mat3 Q = random.rotation();
            std::vector<Vec3> x = shape->mesh().vertices, d;
            for (Vec3& v : x) {
                v = Q * (v + random.vector(0.1));
                d.push_back(random.vector(1));
            }
            EXPECT_LT(tangent_error(*shape, m, x, d, Tangent::exact), 1e-6);
            EXPECT_GT(tangent_error(*shape, m, x, d, Tangent::warped), 1e-3) << "the warped tangent should differ here";
            // Symmetric: d.K e = e.K d.
            std::vector<Vec3> e;
            for (std::size_t i = 0; i < x.size(); ++i) e.push_back(random.vector(1));
            const auto Kd = force_differential(*shape, m, x, d, Tangent::exact), Ke = force_differential(*shape, m, x, e, Tangent::exact);
            double a = 0, b = 0, size = 0;
            for (std::size_t i = 0; i < x.size(); ++i) {
                a += e[i].dot(Kd[i]);
                b += d[i].dot(Ke[i]);
                size += std::abs(e[i].dot(Kd[i]));
            }
            EXPECT_NEAR(a, b, 1e-12 * size);
        }
    }
}

TEST(ExactTangent, LargeFramesHaveNone) {
    const auto shape = test::unit_tet();
    const auto& x = shape->mesh().vertices;
    EXPECT_THROW(force_differential(*shape, Corotational{.rotation = Rotation::large}, x, x, Tangent::exact), Error);
}

/// Newton iterations of one step of a bar let fall with its end turned; exact against warped.
int iterations_of(Tangent tangent) {
    WorldDef def = precise(Integrator::implicit_euler, 0.1);
    def.solver.tangent = tangent;
    def.solver.newton_iterations = 200;
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({8, 2, 2}), .material = Corotational{.young_pa = 2e4, .poisson = 0.4}});
    world.fix(body, test::at_x(0));
    int sum = 0;
    for (int k = 0; k < 3; ++k) {
        const StepReport report = world.step();
        EXPECT_EQ(report.flags, StepFlag::none) << name(report.flags);
        sum += report.newton_iterations;
    }
    return sum;
}

TEST(ExactTangent, NewtonConvergesFasterWithIt) {
    const int exact = iterations_of(Tangent::exact), warped = iterations_of(Tangent::warped);
    EXPECT_LT(exact, 80);
    EXPECT_LT(exact, warped);
}

// -- order, damping and momentum of the integrators -----------------------------------------------------

/// Tip of a swinging cantilever after 0.08 s in steps of h.
Vec3 swing(Integrator integrator, double h) {
    World world(precise(integrator, h));
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = Corotational{.young_pa = 2e5, .poisson = 0.3}});
    world.fix(body, test::at_x(0));
    for (int k = 0; k < int(std::lround(0.08 / h)); ++k) EXPECT_EQ(world.step().flags, StepFlag::none);
    return test::mean_position(world, body, test::at_x(0.4));
}

TEST(Integrators, ConvergeAtTheirOrder) {
    const Vec3 truth = swing(Integrator::newmark, 0.08 / 1024);
    for (const Integrator integrator : kDynamic) {
        const double coarse = (swing(integrator, 0.08 / 32) - truth).norm(), fine = (swing(integrator, 0.08 / 64) - truth).norm();
        const double order = std::log2(coarse / fine);
        EXPECT_NEAR(order, integrator == Integrator::implicit_euler ? 1 : 2, 0.2) << "integrator " << int(integrator);
        if (integrator != Integrator::implicit_euler) {
            EXPECT_LT(fine, 1e-4);
        }
    }
}

TEST(Integrators, Row24TheTrapezoidalRuleKeepsTheEnergy) {
    World world(precise(Integrator::newmark, 2e-4));
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = Corotational{.young_pa = 2e5, .poisson = 0.3}});
    world.fix(body, test::at_x(0));
    const double start = world.energy().total_j();
    double swing = 0;
    for (int k = 0; k < 500; ++k) {
        world.step();
        swing = std::max(swing, world.energy().kinetic_j + world.energy().elastic_j);
        ASSERT_LT(std::abs(world.energy().total_j() - start), 1e-3 * swing + 1e-12) << "step " << k;
    }
    EXPECT_GT(swing, 1e-3);
}

TEST(Integrators, Row24ImplicitEulerNeverGainsEnergy) {
    World world(precise(Integrator::implicit_euler, 0.005));
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = Corotational{.young_pa = 2e5, .poisson = 0.3}});
    world.fix(body, test::at_x(0));
    double last = world.energy().total_j();
    for (int k = 0; k < 200; ++k) {
        world.step();
        const double now = world.energy().total_j();
        ASSERT_LE(now, last + 1e-9) << "step " << k;
        last = now;
    }
}

/// A cube that spins about z without gravity, w0 radians a second.
struct Spinner {
    World world;
    BodyId body;
    Vec3 centre;

    Spinner(WorldDef def, double w0) : world([&] {
        def.gravity_m_s2 = Vec3::Zero();
        return def;
    }()) {
        body = world.add_body({.shape = test::cube(2, 0.1), .material = Corotational{.young_pa = 1e7, .poisson = 0.3}});
        std::vector<Vec3> x(world.positions(body).begin(), world.positions(body).end()), v;
        centre = test::mean_position(world, body, Everything{});
        for (const Vec3& p : x) v.push_back(Vec3(0, 0, w0).cross(p - centre));
        world.set_state(body, x, v);
    }
    double momentum() const {
        Vec3 L = Vec3::Zero();
        const auto x = world.positions(body), v = world.velocities(body);
        for (std::size_t i = 0; i < x.size(); ++i) L += world.masses(body)[i] * (x[i] - centre).cross(v[i]);
        return L.z();
    }
};

TEST(Integrators, Row24ASpinningBodyFollowsTheLawOfEach) {
    const double w0 = 5;
    {
        Spinner s(precise(Integrator::implicit_euler, 0.01), w0);
        const double start = s.momentum();
        for (int n = 0; n < 200; ++n) s.world.step();
        EXPECT_NEAR(s.momentum() / start, 1 / std::sqrt(1 + 2 * 200 * (w0 * 0.01) * (w0 * 0.01)), 0.01);
    }
    {
        Spinner s(precise(Integrator::newmark, 0.001), w0);
        const double start = s.momentum();
        for (int n = 0; n < 1000; ++n) s.world.step();
        EXPECT_NEAR(s.momentum() / start, 1, 1e-4);
    }
}

TEST(Integrators, SupportsArriveOnTimeInEveryScheme) {
    for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2, Integrator::newmark, Integrator::quasi_static}) {
        World world(precise(integrator, 0.01));
        const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = Corotational{.young_pa = 2e5, .poisson = 0.3}});
        world.fix(body, test::at_x(0));
        Motion motion;
        motion.where = test::at_x(0.4);
        motion.displacement_m = {{0, 0.1, 0.2}, {Vec3::Zero(), Vec3(0.04, 0, 0), Vec3(0.04, 0, 0)}};
        world.prescribe(body, motion);
        for (int k = 1; k <= 20; ++k) {
            ASSERT_EQ(world.step().flags, StepFlag::none);
            const double expected = 0.4 + 0.04 * std::min(1.0, k / 10.0);
            ASSERT_NEAR(test::mean_position(world, body, test::at_x(0.4)).x(), expected, 1e-12) << "integrator " << int(integrator) << " step " << k;
        }
    }
}

TEST(Integrators, SnapshotsContinueBitForBit) {
    for (const Integrator integrator : {Integrator::bdf2, Integrator::newmark, Integrator::quasi_static}) {
        const auto make = [&] {
            auto world = std::make_unique<World>(precise(integrator, 0.01));
            const BodyId body = world->add_body({.shape = test::bar({4, 1, 1}), .material = Corotational{.young_pa = 2e5, .poisson = 0.3}});
            world->fix(body, test::at_x(0));
            return world;
        };
        auto a = make(), b = make();
        for (int k = 0; k < 5; ++k) a->step();
        b->restore(a->save());
        for (int k = 0; k < 5; ++k) {
            a->step();
            b->step();
            EXPECT_EQ(a->hash(), b->hash());
        }
        a->reset();
        EXPECT_EQ(a->hash(), make()->hash());
    }
}

// -- statics --------------------------------------------------------------------------------------------

World static_cantilever(const Material& material, BodyId& body, double load_n, PreconditionerKind kind = PreconditionerKind::automatic) {
    WorldDef def;
    def.threads = 1;
    def.solver.integrator = Integrator::quasi_static;
    def.solver.preconditioner = kind;
    def.gravity_m_s2 = Vec3::Zero();
    World world(def);
    body = world.add_body({.shape = test::bar({8, 2, 2}), .material = material});
    world.fix(body, test::at_x(0));
    world.add_load(body, {.where = test::at_x(0.4), .kind = LoadKind::total_force, .value = {{}, {Vec3(0, -load_n, 0)}}});
    return world;
}

TEST(Static, OneStepIsTheEquilibrium) {
    const Material laws[] = {Linear{1e5, 0.3, {}}, Corotational{.young_pa = 1e5, .poisson = 0.3}, Corotational{.rotation = Rotation::svd, .young_pa = 1e5, .poisson = 0.3},
                             Corotational{.rotation = Rotation::large, .young_pa = 1e5, .poisson = 0.3}, StableNeoHookean{4e4, 6e4}, NeoHookean{4e4, 6e4},
                             StVenantKirchhoff{4e4, 6e4}, MooneyRivlin{1.6e4, 4e3, 1e5}};
    for (const Material& m : laws) {
        for (const double load : {0.1, 5.0, 20.0}) {
            SCOPED_TRACE(testing::Message() << "law " << m.index() << ", " << load << " N");
            BodyId body;
            World world = static_cantilever(m, body, load);
            const StepReport report = world.step();
            EXPECT_EQ(report.flags, StepFlag::none) << name(report.flags);
            EXPECT_LT((world.reaction_n() - Vec3(0, load, 0)).norm(), 1e-5 * load);
            const auto inner = evaluate(world.shape(body), m, world.positions(body)).forces_n;
            Vec3 outer = Vec3::Zero();
            double worst = 0;
            for (std::size_t i = 0; i < inner.size(); ++i) {
                const double x = world.shape(body).mesh().vertices[i].x();
                if (x > 1e-9 && x < 0.4 - 1e-9) worst = std::max(worst, inner[i].norm());
                if (x > 0.4 - 1e-9) outer += inner[i];
            }
            EXPECT_LT(worst, 2e-6 * load);
            EXPECT_LT((outer - Vec3(0, load, 0)).norm(), 1e-5 * load);
            EXPECT_EQ(world.energy().kinetic_j, 0);
            // A second step finds it in place.
            const auto before = world.positions(body)[5];
            world.step();
            EXPECT_LT((world.positions(body)[5] - before).norm(), 1e-5);
        }
    }
}

TEST(Static, EveryPreconditionerFindsTheSame) {
    BodyId a, b;
    World jacobi = static_cantilever(StableNeoHookean{4e4, 6e4}, a, 5, PreconditionerKind::block_jacobi);
    World direct = static_cantilever(StableNeoHookean{4e4, 6e4}, b, 5, PreconditionerKind::direct);
    const StepReport iterative = jacobi.step(), factored = direct.step();
    EXPECT_LT(test::relative_difference(jacobi.positions(a), direct.positions(b)), 1e-5);
    EXPECT_LT(factored.cg_iterations, 4 * factored.newton_iterations);
    EXPECT_GT(iterative.cg_iterations, 10 * factored.cg_iterations);
}

TEST(Static, StretchedToTwiceItsLengthAndTurned) {
    for (const Material& m : {Material(Corotational{.young_pa = 1e5, .poisson = 0.3}), Material(StableNeoHookean{4e4, 6e4}), Material(NeoHookean{4e4, 6e4})}) {
        WorldDef def;
        def.threads = 1;
        def.solver.integrator = Integrator::quasi_static;
        def.gravity_m_s2 = Vec3::Zero();
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar({8, 2, 2}), .material = m});
        world.fix(body, test::at_x(0));
        Motion motion;
        motion.where = test::at_x(0.4);
        Mat34 A;
        A << Eigen::AngleAxisd(1.0, Vec3::UnitX()).toRotationMatrix(), Vec3(0.4, 0, 0);
        motion.affine = {{}, {A}};
        world.prescribe(body, motion);
        EXPECT_EQ(world.step().flags, StepFlag::none) << "law " << m.index();
        const Vec3 middle = test::mean_position(world, body, test::at_x(0.2));
        EXPECT_NEAR(middle.x(), 0.4, 0.01);
        EXPECT_GT(world.energy().elastic_j, 0);
    }
}

TEST(Static, ABodyThatNothingHoldsIsReported) {
    WorldDef def;
    def.threads = 1;
    def.solver.integrator = Integrator::quasi_static;
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1})});
    const StepReport report = world.step();
    EXPECT_NE(report.flags & StepFlag::no_equilibrium, StepFlag::none);
    for (const Vec3& x : world.positions(body)) EXPECT_TRUE(x.allFinite());
}

}  // namespace
}  // namespace supple
