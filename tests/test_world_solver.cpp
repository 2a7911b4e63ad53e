// Newton, linearisation, tolerances, flags; the whole range of stiffness, step and density; recovery from tangles.
#include <gtest/gtest.h>

#include "support/bodies.h"

namespace supple {
namespace {

WorldDef bar_world(double h = 0.01) {
    WorldDef def;
    def.time_step_s = h;
    def.threads = 1;
    return def;
}

struct Bar {
    World world;
    BodyId body;
    Bar(const WorldDef& def, std::array<int, 3> cells, double young_pa = 2e5)
        : world(def), body(world.add_body({.shape = test::bar(cells), .material = Corotational{.young_pa = young_pa, .poisson = 0.4}})) {
        world.fix(body, test::at_x(0));
    }
    Vec3 tip() const { return test::mean_position(world, body, test::at_x(0.4)); }
};

TEST(WorldNewton, BothLinearisationsConvergeToTheSameStep) {
    WorldDef def = bar_world(0.02);
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-12;
    def.solver.newton_iterations = 50;
    def.solver.newton_tolerance = 1e-11;
    Bar prediction(def, {8, 2, 2});
    def.solver.linearise_at = LineariseAt::current;
    Bar current(def, {8, 2, 2});
    for (int n = 0; n < 15; ++n) {
        for (Bar* bar : {&prediction, &current}) {
            const StepReport report = bar->world.step();
            EXPECT_EQ(report.flags, StepFlag::none);
            EXPECT_LT(report.newton_iterations, 50);
        }
        EXPECT_LT(test::relative_difference(prediction.world.positions(prediction.body), current.world.positions(current.body)), 1e-9) << "step " << n;
    }
    EXPECT_GT((prediction.tip() - Vec3(0.4, 0.05, 0.05)).norm(), 0.05) << "a small deflection would prove little";
}

TEST(WorldNewton, OneStepAtThePredictionIsCloserThanAtTheCurrentState) {
    WorldDef def = bar_world();
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-10;
    const auto tip_after = [&](int newton, LineariseAt at) {
        def.solver.newton_iterations = newton;
        def.solver.linearise_at = at;
        Bar bar(def, {8, 2, 2});
        for (int n = 0; n < 40; ++n) bar.world.step();
        return bar.tip();
    };
    const Vec3 converged = tip_after(8, LineariseAt::prediction);
    const double prediction = (tip_after(1, LineariseAt::prediction) - converged).norm(), current = (tip_after(1, LineariseAt::current) - converged).norm();
    EXPECT_LT(prediction, 0.5 * current);
    EXPECT_LT(prediction, 0.005 * 0.4);
}

TEST(WorldNewton, TheToleranceStopsEarlyAndTheCapIsReported) {
    WorldDef def = bar_world(0.02);
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-8;
    const auto run = [&](int iterations, double tolerance) {
        def.solver.newton_iterations = iterations;
        def.solver.newton_tolerance = tolerance;
        Bar bar(def, {8, 2, 2});
        StepReport report;
        for (int n = 0; n < 8; ++n) report = bar.world.step();
        return report;
    };
    EXPECT_EQ(run(7, 0).newton_iterations, 7);
    EXPECT_EQ(run(7, 0).flags, StepFlag::none);
    const StepReport loose = run(50, 0.3), tight = run(50, 1e-6);
    EXPECT_LT(loose.newton_iterations, tight.newton_iterations);
    EXPECT_LT(tight.newton_iterations, 50);
    EXPECT_EQ(tight.flags, StepFlag::none);
    const StepReport capped = run(1, 1e-9);
    EXPECT_EQ(capped.flags, StepFlag::newton_cap);
    EXPECT_EQ(capped.newton_iterations, 1);
}

TEST(WorldNewton, ARestingBodyRaisesNoFlagAndCostsNothing) {
    WorldDef def = bar_world(0.05);
    def.solver.rayleigh_mass_1_s = 15;
    def.solver.newton_iterations = 4;
    def.solver.newton_tolerance = 1e-3;
    for (const Precision precision : {Precision::single, Precision::double_}) {
        def.solver.precision = precision;
        Bar bar(def, {8, 2, 2});
        for (int n = 0; n < 400; ++n) bar.world.step();
        const StepReport report = bar.world.step();
        EXPECT_EQ(report.flags, StepFlag::none) << name(report.flags);
        EXPECT_EQ(report.cg_iterations, 0);
    }
}

TEST(WorldNewton, ADragCountsInTheResidualThatDecides) {
    WorldDef def = bar_world(0.02);
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-8;
    def.solver.newton_iterations = 30;
    def.solver.newton_tolerance = 1e-4;
    Bar bar(def, {8, 2, 2});
    const auto hit = bar.world.pick({{0.35, 0.05, 1}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    const DragId drag = bar.world.begin_drag(*hit);
    bar.world.move_drag(drag, hit->position_m + Vec3(0, 0.1, 0));
    for (int n = 0; n < 20; ++n) {
        const StepReport report = bar.world.step();
        EXPECT_EQ(report.flags, StepFlag::none) << name(report.flags) << " in step " << n;
        EXPECT_LT(report.newton_iterations, 30);
    }
}

// -- tolerance and flags -----------------------------------------------------------------------------

TEST(WorldSolver, SingleReachesATightTrueResidualOnAStiffSystem) {
    WorldDef def = bar_world(1.0 / 60);
    def.solver.precision = Precision::single;
    def.solver.cg_relative_tolerance = 1e-8;
    def.solver.cg_max_iterations = 20000;
    Bar bar(def, {16, 4, 4}, 1e6);
    for (int n = 0; n < 8; ++n) {
        const StepReport report = bar.world.step();
        EXPECT_EQ(report.flags, StepFlag::none);
        EXPECT_LE(report.cg_relative_residual, 1e-8);
        EXPECT_GT(report.cg_iterations, 0);
    }
}

TEST(WorldSolver, SingleAndDoubleAgree) {
    WorldDef def = bar_world();
    def.solver.cg_relative_tolerance = 1e-8;
    Bar single(def, {8, 2, 2});
    def.solver.precision = Precision::double_;
    Bar dbl(def, {8, 2, 2});
    for (int n = 0; n < 50; ++n) {
        single.world.step();
        dbl.world.step();
    }
    EXPECT_LT(test::relative_difference(single.world.positions(single.body), dbl.world.positions(dbl.body)), 1e-6);
}

TEST(WorldSolver, TheIterationCapIsReportedAndHonoured) {
    WorldDef def = bar_world();
    def.solver.cg_max_iterations = 3;
    Bar bar(def, {16, 4, 4});
    bar.world.step();
    const StepReport report = bar.world.step();
    EXPECT_EQ(report.flags, StepFlag::iteration_cap);
    EXPECT_LE(report.cg_iterations, 3);
    EXPECT_GT(report.cg_relative_residual, def.solver.cg_relative_tolerance);
    EXPECT_NE(cure(StepFlag::iteration_cap).find("cg_max_iterations"), std::string_view::npos);
}

TEST(WorldSolver, EveryFlagHasANameAndACure) {
    for (const StepFlag flag : kAllStepFlags) {
        EXPECT_NE(name(flag), "none");
        EXPECT_NE(cure(flag), "all is well");
    }
    EXPECT_EQ(name(StepFlag::none), "none");
    for (std::size_t s = 0; s < kStageCount; ++s) EXPECT_NE(name(Stage(s)), "unknown");
}

TEST(WorldSolver, TheReportAddsUp) {
    WorldDef def = bar_world();
    def.stress_each_step = true;
    Bar bar(def, {8, 2, 2});
    for (int n = 1; n <= 5; ++n) {
        const StepReport report = bar.world.step();
        EXPECT_EQ(report.step, std::uint64_t(n));
        EXPECT_NEAR(report.time_s, n * 0.01, 1e-15);
        EXPECT_NEAR(bar.world.time_s(), n * 0.01, 1e-15);
        double stages = 0;
        for (const double ms : report.stage_ms) {
            EXPECT_GE(ms, 0);
            stages += ms;
        }
        EXPECT_LE(stages, report.step_ms * (1 + 1e-9));
        EXPECT_GT(report.stage_ms[std::size_t(Stage::solve)], 0);
        EXPECT_GT(report.stage_ms[std::size_t(Stage::stress)], 0);
    }
}

TEST(WorldSolver, EveryStiffnessStepAndDensityStaysFinite) {
    const auto shape = test::bar({4, 2, 2});
    for (const double young : {1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9}) {
        for (const double h : {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 1000}) {
            for (const double density : {1.0, 10.0, 100.0, 1000.0, 10000.0}) {
                for (const Precision precision : {Precision::single, Precision::double_}) {
                    WorldDef def = bar_world(h);
                    def.solver.precision = precision;
                    World world(def);
                    const BodyId body = world.add_body({.shape = shape, .material = Corotational{.young_pa = young, .poisson = 0.45}, .density_kg_m3 = density});
                    world.fix(body, test::at_x(0));
                    for (int n = 0; n < 4; ++n) {
                        const StepReport report = world.step();
                        ASSERT_EQ(report.flags, StepFlag::none) << name(report.flags) << ": E " << young << ", h " << h << ", density " << density;
                    }
                    ASSERT_TRUE(test::all_finite(world.positions(body)));
                    for (const Vec3& v : world.velocities(body)) ASSERT_LT(v.norm(), 10 * 9.81 * 4 * h) << "E " << young << ", h " << h << ", density " << density;
                }
            }
        }
    }
}

// -- recovery ----------------------------------------------------------------------------------------

/// Starts from a distorted configuration and expects the rest shape back, up to a rigid motion.
void expect_recovery(const char* what, const std::shared_ptr<const BodyTemplate>& shape, const std::vector<Vec3>& distorted) {
    WorldDef def = bar_world(0.02);
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.rayleigh_stiffness_s = 0.05;
    World world(def);
    const BodyId body = world.add_body({.shape = shape, .material = Corotational{.young_pa = 1e5, .poisson = 0.3}});
    world.set_state(body, distorted, std::vector<Vec3>(distorted.size(), Vec3::Zero()));
    const double before = world.energy().elastic_j;
    ASSERT_GT(before, 0) << what;
    StepFlag flags = StepFlag::none;
    for (int n = 0; n < 600; ++n) flags |= world.step().flags & (StepFlag::non_finite | StepFlag::frozen);
    EXPECT_EQ(flags, StepFlag::none) << what;
    EXPECT_LT(world.energy().elastic_j, 1e-6 * before) << what;
    std::size_t inverted = 0;
    for (const Tet& t : shape->mesh().tets) {
        const auto x = [&](std::size_t a) { return world.positions(body)[std::size_t(t[a])]; };
        inverted += tet_volume(x(0), x(1), x(2), x(3)) <= 0;
    }
    EXPECT_EQ(inverted, 0u) << what;
}

TEST(WorldRecovery, FlattenedBodiesRiseAgain) {
    const auto shape = test::irregular_cube(2, 0.2, 100);
    auto flat = shape->mesh().vertices;
    for (Vec3& x : flat) x.y() = 0;
    expect_recovery("flat", shape, flat);
    for (Vec3& x : flat) x.z() = 0;
    expect_recovery("a line", shape, flat);
}

TEST(WorldRecovery, ABodyCollapsedToAPointRisesAgain) {
    const auto shape = test::irregular_cube(2, 0.2, 101);
    expect_recovery("a point", shape, std::vector<Vec3>(shape->mesh().vertices.size(), Vec3(1, 2, 3)));
}

TEST(WorldRecovery, AnInvertedBodyTurnsBack) {
    const auto shape = test::irregular_cube(2, 0.2, 102);
    auto mirrored = shape->mesh().vertices;
    for (Vec3& x : mirrored) x.z() = -x.z();
    expect_recovery("mirrored", shape, mirrored);
}

TEST(WorldRecovery, TangledBodiesUntangle) {
    const auto shape = test::irregular_cube(2, 0.2, 103);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        test::Random random(seed);
        auto tangled = shape->mesh().vertices;
        for (Vec3& x : tangled) x = random.vector(0.5);
        expect_recovery("random", shape, tangled);
    }
}

// -- the common workload -----------------------------------------------------------------------------

TEST(SlowWorldBar, TipsOfTheCommonWorkload) {
    // 12,288 tets, 100 steps of 10 ms: tips by two independent implementations, which agree to 0.3 % of the deflection.
    const auto tip = [](int newton, LineariseAt at) {
        WorldDef def = bar_world();
        def.threads = 2;
        def.solver.newton_iterations = newton;
        def.solver.linearise_at = at;
        Bar bar(def, {32, 8, 8});
        for (int n = 0; n < 100; ++n) EXPECT_EQ(bar.world.step().flags, StepFlag::none);
        return bar.tip();
    };
    const Vec3 start(0.4, 0.05, 0.05), converged(0.31701, -0.18241, 0.06271);
    const double deflection = (converged - start).norm();
    const Vec3 prediction = tip(1, LineariseAt::prediction), current = tip(1, LineariseAt::current), newton = tip(4, LineariseAt::prediction);
    EXPECT_LT((newton - converged).norm(), 0.003 * deflection) << newton.transpose();
    EXPECT_LT((prediction - Vec3(0.31650, -0.18301, 0.06266)).norm(), 0.005 * deflection) << prediction.transpose();
    EXPECT_LT((current - Vec3(0.31248, -0.18770, 0.06309)).norm(), 0.005 * deflection) << current.transpose();
    EXPECT_LT((prediction - converged).norm(), 0.2 * (current - converged).norm()) << "the prediction is the better place to linearise";
}

TEST(WorldSetSolver, GoesOnAsAWorldMadeThatWay) {
    WorldDef tight = bar_world();
    tight.solver.cg_relative_tolerance = 1e-9;
    tight.solver.newton_iterations = 3;
    tight.solver.rayleigh_mass_1_s = 2;
    tight.solver.rayleigh_stiffness_s = 0.001;
    tight.solver.precision = Precision::double_;
    for (const PreconditionerKind kind : {PreconditionerKind::block_jacobi, PreconditionerKind::lattice_multigrid, PreconditionerKind::direct}) {
        tight.solver.preconditioner = kind;
        WorldDef loose = bar_world();
        loose.solver.precision = Precision::double_;
        Bar made(tight, {12, 3, 3}), changed(loose, {12, 3, 3});
        changed.world.step();
        changed.world.reset();
        changed.world.set_solver(tight.solver);
        for (int n = 0; n < 5; ++n) {
            const StepReport report = changed.world.step();
            EXPECT_EQ(report.flags, StepFlag::none);
            EXPECT_LT(report.cg_relative_residual, 1e-9);
            made.world.step();
        }
        EXPECT_EQ(changed.world.hash(), made.world.hash()) << int(kind);
    }
}

TEST(WorldSetSolver, RefusesWhatAWorldCannotChange) {
    Bar bar(bar_world(), {4, 1, 1});
    const std::uint64_t before = bar.world.hash();
    SolverDef other = bar.world.def().solver;
    other.integrator = Integrator::newmark;
    EXPECT_THROW(bar.world.set_solver(other), Error);
    other = bar.world.def().solver;
    other.precision = Precision::double_;
    EXPECT_THROW(bar.world.set_solver(other), Error);
    other = bar.world.def().solver;
    other.cg_relative_tolerance = 2;
    EXPECT_THROW(bar.world.set_solver(other), Error);
    EXPECT_EQ(bar.world.def().solver.cg_relative_tolerance, 1e-5);
    other = bar.world.def().solver;
    other.precision = Precision::automatic;  // that at work
    other.tangent = Tangent::automatic;
    EXPECT_NO_THROW(bar.world.set_solver(other));
    EXPECT_EQ(bar.world.def().solver.precision, Precision::single);
    EXPECT_EQ(bar.world.hash(), before);
}

}  // namespace
}  // namespace supple
