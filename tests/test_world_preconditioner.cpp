// Preconditioners in a world: the choice, the same bits whatever the team and after a snapshot, the step budget.
#include <gtest/gtest.h>

#include "supple/solve/scalar_laplacian.h"
#include "supple/world/choice_timer.h"
#include "support/elastic_problem.h"

namespace supple {
namespace {

struct Bar {
    World world;
    BodyId body;

    static WorldDef make(PreconditionerKind kind, int threads, double tolerance) {
        WorldDef def;
        def.time_step_s = 0.01;
        def.threads = threads;
        def.solver.preconditioner = kind;
        def.solver.cg_relative_tolerance = tolerance;
        return def;
    }
    Bar(PreconditionerKind kind, std::array<int, 3> cells = {24, 6, 6}, int threads = 2, double young_pa = 1e5, double tolerance = 1e-5)
        : Bar(make(kind, threads, tolerance), cells, young_pa) {}
    Bar(const WorldDef& def, std::array<int, 3> cells, double young_pa)
        : world(def), body(world.add_body({.shape = test::bar(cells), .material = Corotational{.young_pa = young_pa, .poisson = 0.4}})) {
        world.fix(body, test::at_x(0));
    }
    int run(int steps) {
        int iterations = 0;
        for (int n = 0; n < steps; ++n) {
            const StepReport report = world.step();
            EXPECT_EQ(report.flags, StepFlag::none);
            iterations += report.cg_iterations;
        }
        return iterations;
    }
};

TEST(WorldPreconditioner, NoneChangesTheMotion) {
    std::vector<std::vector<Vec3>> positions;
    std::vector<int> iterations;
    for (const PreconditionerKind kind : {PreconditionerKind::block_jacobi, PreconditionerKind::lattice_multigrid, PreconditionerKind::scalar_laplacian}) {
        Bar bar(kind, {16, 4, 4}, 1, 1e5, 1e-9);
        iterations.push_back(bar.run(20));
        positions.push_back(test::copy(bar.world.positions(bar.body)));
    }
    for (const auto& p : positions) EXPECT_LT(test::relative_difference(p, positions[0]), 1e-7);
    EXPECT_LT(4 * iterations[1], iterations[0]);
    EXPECT_LT(1.5 * iterations[2], iterations[0]);
}

TEST(WorldPreconditioner, TheScalarLaplacianSolvesWhatTheDirectSolverSolves) {
    const auto held = [](const Vec3& X) { return std::uint8_t(X.x() < 1e-9 ? 7 : X.x() > 1 - 1e-9 ? 2 : 0); };
    test::ElasticProblem<double> problem(test::irregular_cube(7, 0.2, 7), {.young_pa = 3e5}, held);
    solve::ScalarLaplacian<double> P(problem.rows());
    ASSERT_TRUE(P.build(problem.A, problem.held));
    std::vector<Vec3> x;
    EXPECT_TRUE(problem.solve(P, 1e-11, x).converged);
    EXPECT_LT(test::relative_difference(x, problem.direct()), 1e-9);
}

TEST(WorldPreconditioner, AutoTakesTheMultigridWhereItPays) {
    // Stiff: a few iterations whatever the size. Soft at a short step: block-Jacobi, which needs no hierarchy, is tried and kept.
    Bar stiff(PreconditionerKind::automatic, {32, 8, 8});
    stiff.run(5);
    EXPECT_LE(stiff.run(10), 10 * 16);
    WorldDef def = Bar::make(PreconditionerKind::automatic, 2, 1e-3);
    def.time_step_s = 1e-3;
    Bar soft(def, {32, 8, 8}, 1e5);
    const int multigrid = soft.run(20);
    soft.run(60);
    EXPECT_GT(soft.run(20), 1.5 * multigrid) << "still the multigrid";
    // Small and stiff: begins with block-Jacobi, and leaves it.
    Bar small(PreconditionerKind::automatic, {16, 4, 4});
    const int first = small.run(2);
    EXPECT_LT(small.run(8) / 8, first / 2);
}

TEST(WorldPreconditioner, AnyTeamGivesTheSameBits) {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 3, 8}) {
        Bar bar(PreconditionerKind::lattice_multigrid, {24, 6, 6}, threads);
        bar.run(6);
        hashes.push_back(bar.world.hash());
    }
    for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

TEST(WorldPreconditioner, ASnapshotGoesOnBitForBit) {
    for (const PreconditionerKind kind : {PreconditionerKind::automatic, PreconditionerKind::lattice_multigrid, PreconditionerKind::scalar_laplacian}) {
        Bar first(kind);
        first.run(4);
        // New supports in the middle of the motion: the hierarchy is built anew.
        first.world.fix(first.body, InsideBox{{0.39, -1, -1}, {1, 1, 1}}, {.x = false, .y = true, .z = false});
        first.run(4);
        const auto snapshot = first.world.save();
        first.run(12);
        Bar second(kind);
        second.world.fix(second.body, InsideBox{{0.39, -1, -1}, {1, 1, 1}}, {.x = false, .y = true, .z = false});
        second.world.restore(snapshot);
        second.run(12);
        EXPECT_EQ(first.world.hash(), second.world.hash());
        first.world.restore(snapshot);
        first.run(12);
        EXPECT_EQ(first.world.hash(), second.world.hash());
    }
}

TEST(WorldPreconditioner, ASnapshotBetweenNewSupportsAndTheNextStepGoesOnBitForBit) {
    for (const int before : {0, 4}) {
        Bar first(PreconditionerKind::lattice_multigrid);
        first.run(before);
        first.world.fix(first.body, InsideBox{{0.39, -1, -1}, {1, 1, 1}}, {.x = false, .y = true, .z = false});
        const auto snapshot = first.world.save();
        const int iterations = first.run(12);
        Bar second(PreconditionerKind::lattice_multigrid);
        second.world.fix(second.body, InsideBox{{0.39, -1, -1}, {1, 1, 1}}, {.x = false, .y = true, .z = false});
        second.world.restore(snapshot);
        EXPECT_EQ(second.run(12), iterations) << before;
        EXPECT_EQ(first.world.hash(), second.world.hash()) << before;
        first.world.restore(snapshot);
        EXPECT_EQ(first.run(12), iterations) << before;
        EXPECT_EQ(first.world.hash(), second.world.hash()) << before;
    }
}

/// The far end is held and the near one let go: all that the hierarchy was built with is wrong.
void swap_ends(Bar& bar) {
    bar.world.fix(bar.body, InsideBox{Vec3(0.39, -1, -1), Vec3(1, 1, 1)});
    bar.world.release(bar.body, test::at_x(0));
}

TEST(WorldPreconditioner, NewSupportsDoNotHaltTheBodyForAHierarchy) {
    Bar bar(PreconditionerKind::lattice_multigrid), plain(PreconditionerKind::block_jacobi);
    const int usual = bar.run(30);
    plain.run(30);
    swap_ends(bar);
    swap_ends(plain);
    const int meanwhile = bar.run(16), plain_meanwhile = plain.run(16);
    const int after = bar.run(30);
    plain.run(30);
    EXPECT_LT(after, 1.5 * usual);               // the new hierarchy knows the new supports
    EXPECT_LT(3 * meanwhile, plain_meanwhile);   // and until it came the old one was worth more than none
    EXPECT_LT(test::relative_difference(bar.world.positions(bar.body), plain.world.positions(plain.body)), 1e-3);
}

TEST(WorldPreconditioner, AHierarchyUnderWayGoesOnBitForBit) {
    for (const int steps : {1, 7, 15, 16}) {
        Bar bar(PreconditionerKind::lattice_multigrid, {24, 6, 6}, 2);
        bar.run(12);
        swap_ends(bar);
        bar.run(steps);
        const auto snapshot = bar.world.save();
        bar.run(20);
        Bar fresh(PreconditionerKind::lattice_multigrid, {24, 6, 6}, 1);
        swap_ends(fresh);
        fresh.world.restore(snapshot);
        fresh.run(20);
        EXPECT_EQ(fresh.world.hash(), bar.world.hash()) << "saved " << steps << " steps after the supports changed";
        bar.world.restore(snapshot);
        bar.run(20);
        EXPECT_EQ(fresh.world.hash(), bar.world.hash()) << "restored in place, " << steps;
    }
}

TEST(WorldPreconditioner, AnotherChangeWhileAHierarchyIsUnderWayIsBuiltAfterIt) {
    Bar bar(PreconditionerKind::lattice_multigrid), alike(PreconditionerKind::lattice_multigrid, {24, 6, 6}, 3);
    for (Bar* b : {&bar, &alike}) {
        b->run(20);
        swap_ends(*b);
        b->run(5);
        b->world.fix(b->body, test::at_x(0));
        b->run(40);
    }
    EXPECT_EQ(bar.world.hash(), alike.world.hash());
    Bar never(PreconditionerKind::lattice_multigrid);
    never.world.fix(never.body, InsideBox{Vec3(0.39, -1, -1), Vec3(1, 1, 1)});
    const int usual = never.run(20), now = bar.run(20);
    EXPECT_LT(now, 1.5 * usual);
}

TEST(WorldPreconditioner, ABodyMayGoWhileItsHierarchyIsUnderWay) {
    Bar bar(PreconditionerKind::lattice_multigrid);
    bar.run(3);
    swap_ends(bar);
    bar.run(1);
    bar.world.remove_body(bar.body);
    bar.world.step();
}

TEST(WorldPreconditioner, ResetReturnsToTheBeginning) {
    Bar bar(PreconditionerKind::lattice_multigrid);
    bar.run(8);
    const std::uint64_t once = bar.world.hash();
    bar.world.reset();
    bar.run(8);
    EXPECT_EQ(bar.world.hash(), once);
}

TEST(WorldPreconditioner, ABudgetEndsTheStepWithWhatItHas) {
    WorldDef def = Bar::make(PreconditionerKind::block_jacobi, 1, 1e-10);
    def.solver.step_budget_us = 1;  // over before the first iteration
    Bar bar(def, {16, 4, 4}, 1e6);
    const StepReport report = bar.world.step();
    EXPECT_NE(report.flags & StepFlag::budget, StepFlag::none);
    EXPECT_EQ(report.flags & StepFlag::iteration_cap, StepFlag::none);
    EXPECT_EQ(report.cg_iterations, 0);
    EXPECT_GT(report.cg_relative_residual, 1e-10);
    EXPECT_TRUE(test::all_finite(bar.world.positions(bar.body)));
    def.solver.step_budget_us = 1e8;
    Bar ample(def, {16, 4, 4}, 1e6);
    EXPECT_EQ(ample.world.step().flags, StepFlag::none);
    def.solver.step_budget_us = -1;
    EXPECT_THROW(World{def}, Error);
}

TEST(WorldPreconditioner, AnyInstructionSetCanBeAskedFor) {
    std::vector<std::vector<Vec3>> positions;
    for (const Isa isa : kAllIsas) {
        WorldDef def = Bar::make(PreconditionerKind::lattice_multigrid, 1, 1e-8);
        def.isa = isa;
        if (!is_supported(isa)) {
            EXPECT_THROW(World{def}, Error);
            continue;
        }
        Bar bar(def, {12, 3, 3}, 1e5);
        bar.run(5);
        positions.push_back(test::copy(bar.world.positions(bar.body)));
    }
    for (const auto& p : positions) EXPECT_LT(test::relative_difference(p, positions[0]), 1e-6);
}

TEST(WorldPreconditioner, TheTimerTriesTheOtherNowAndThenAndWantsThreeWins) {
    ChoiceTimer timer;
    for (int i = 0; i < ChoiceTimer::kFirstTrial; ++i) {
        EXPECT_FALSE(timer.trial_is_due()) << i;
        timer.note(10);
    }
    EXPECT_TRUE(timer.trial_is_due());
    EXPECT_NEAR(timer.trial_ms(), 8, 1e-9);
    EXPECT_FALSE(timer.won());
    EXPECT_FALSE(timer.won());
    EXPECT_TRUE(timer.trial_is_due());
    timer.lost();  // all was for nothing
    for (int i = 0; i < ChoiceTimer::kTrialEvery; ++i) {
        EXPECT_FALSE(timer.trial_is_due()) << i;
        timer.note(20);
    }
    EXPECT_NEAR(timer.trial_ms(), 16, 1e-3) << "the mean follows";
    EXPECT_FALSE(timer.won());
    EXPECT_FALSE(timer.won());
    EXPECT_TRUE(timer.won());
    EXPECT_FALSE(timer.trial_is_due()) << "the other is new at work";
    EXPECT_EQ(timer.trial_ms(), 0) << "and nothing is known of it";
}

// A stiff bar small enough to begin with block-Jacobi, which takes some twenty times as long as the multigrid: it has to be found however busy the machine is.
TEST(WorldPreconditioner, ByTheClockAStiffBarGetsTheMultigridAndTheSameMotion) {
    const std::array<int, 3> cells{20, 6, 6};
    Bar timed(PreconditionerKind::automatic_timed, cells, 2, 3e6, 1e-7), reference(PreconditionerKind::lattice_multigrid, cells, 2, 3e6, 1e-7);
    const int first = timed.run(1);
    int least = first;
    for (int n = 0; n < 60; ++n) least = std::min(least, timed.run(1));
    EXPECT_GT(first, 100);
    EXPECT_LT(least, 30) << "never tried";
    reference.run(61);
    EXPECT_LT(test::relative_difference(test::copy(timed.world.positions(timed.body)), test::copy(reference.world.positions(reference.body))), 1e-5);
    const std::vector<std::byte> snapshot = timed.world.save();
    timed.run(3);
    timed.world.restore(snapshot);
    timed.run(3);
}

}  // namespace
}  // namespace supple
