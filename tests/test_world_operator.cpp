// Solves that multiply by the elements in place of a matrix: the same motion, the same bits for any team and after a snapshot, and the matrix still there for whoever asks.
#include <gtest/gtest.h>

#include "supple/world/response.h"
#include "support/bodies.h"

namespace supple {
namespace {

struct Options {
    OperatorKind operator_kind = OperatorKind::automatic;
    PreconditionerKind preconditioner = PreconditionerKind::automatic;
    std::array<int, 3> cells = {16, 4, 4};
    int threads = 1;
    double tolerance = 1e-9, young_pa = 1e5;
    Precision precision = Precision::single;
    Tangent tangent = Tangent::automatic;
    bool contact = false, irregular = false;
};

struct Bar {
    World world;
    BodyId body;

    static WorldDef make(const Options& o) {
        WorldDef def;
        def.time_step_s = 0.01;
        def.threads = o.threads;
        def.solver.preconditioner = o.preconditioner;
        def.solver.operator_kind = o.operator_kind;
        def.solver.cg_relative_tolerance = o.tolerance;
        def.solver.precision = o.precision;
        def.solver.tangent = o.tangent;
        def.solver.rayleigh_mass_1_s = 0.2;
        def.solver.rayleigh_stiffness_s = 1e-4;
        return def;
    }
    explicit Bar(const Options& o) : world(make(o)) {
        BodyDef def;
        def.shape = o.irregular ? test::irregular_hex_cube(5, 0.2, 3) : test::hex_bar(o.cells);
        def.material = Corotational{.young_pa = o.young_pa, .poisson = 0.4};
        body = world.add_body(def);
        world.fix(body, test::at_x(0));
        world.fix(body, VertexList{{o.cells[0]}}, {false, false, true});  // one coordinate alone
        if (o.contact) world.add_collider({.shape = BoxShape{Vec3(0.05, 0.05, 0.2)}, .pose = {Vec3(0.36, -0.06, 0.05), {1, 0, 0, 0}}});
    }
    /// Returns the contacts of the last step.
    int run(int steps) {
        StepReport report;
        for (int n = 0; n < steps; ++n) {
            report = world.step();
            EXPECT_EQ(report.flags, StepFlag::none);
        }
        return report.contacts;
    }
};

/// Motions of the same run by the elements and by the matrix agree as far as the solves go; that they are not the same bits shows that both were at work.
void expect_same_motion(Options o, int steps, double tolerance, bool both = true) {
    o.operator_kind = OperatorKind::matrix_free;
    Bar elements(o);
    o.operator_kind = OperatorKind::assembled;
    Bar matrix(o);
    EXPECT_EQ(elements.run(steps) > 0, o.contact);
    matrix.run(steps);
    EXPECT_LT(test::relative_difference(elements.world.positions(elements.body), matrix.world.positions(matrix.body)), tolerance);
    EXPECT_EQ(elements.world.hash() != matrix.world.hash(), both);
}

TEST(WorldOperator, MovesABodyAsItsMatrixDoesWithEveryPreconditioner) {
    for (const PreconditionerKind kind : {PreconditionerKind::block_jacobi, PreconditionerKind::lattice_multigrid, PreconditionerKind::scalar_laplacian}) {
        SCOPED_TRACE(int(kind));
        expect_same_motion({.preconditioner = kind}, 10, 1e-7);
        expect_same_motion({.preconditioner = kind, .contact = true}, 10, 3e-3);  // contacts agree to half a percent of their forces
        expect_same_motion({.preconditioner = kind, .tangent = Tangent::exact}, 10, 1e-7);
        expect_same_motion({.preconditioner = kind, .irregular = true}, 5, 1e-7);
    }
    expect_same_motion({.preconditioner = PreconditionerKind::block_jacobi, .precision = Precision::double_}, 10, 1e-8);
}

TEST(WorldOperator, LeavesTheMatrixToWhatNeedsItsEntries) {
    expect_same_motion({.preconditioner = PreconditionerKind::direct}, 5, 1e-12, false);
    expect_same_motion({.preconditioner = PreconditionerKind::lattice_multigrid, .precision = Precision::double_}, 5, 1e-12, false);
}

TEST(WorldOperator, LeavesIslandsOfSeveralToTheMatrix) {
    std::vector<std::uint64_t> hashes;
    for (const OperatorKind kind : {OperatorKind::matrix_free, OperatorKind::assembled}) {
        Bar bar({.operator_kind = kind, .tolerance = 1e-5});
        const BodyId hung = bar.world.add_body({.shape = test::hex_bar({8, 2, 2}), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}, .translation_m = Vec3(0, -0.2, 0)});
        bar.world.attach({.body = bar.body, .vertices = {16, -1, -1, -1}, .other = hung, .other_vertices = {8, -1, -1, -1}});
        bar.run(3);
        hashes.push_back(bar.world.hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(WorldOperator, IsChosenForLatticesOfHexesAndNotForFreeShapes) {
    const auto hash = [](OperatorKind kind, bool irregular) {
        Bar r({.operator_kind = kind, .irregular = irregular});
        r.run(5);
        return r.world.hash();
    };
    const bool wide = best_isa() == Isa::avx2 || best_isa() == Isa::avx512;
    EXPECT_EQ(hash(OperatorKind::automatic, false) == hash(OperatorKind::matrix_free, false), wide);
    EXPECT_EQ(hash(OperatorKind::automatic, false) == hash(OperatorKind::assembled, false), !wide);
    EXPECT_EQ(hash(OperatorKind::automatic, true), hash(OperatorKind::assembled, true));
}

TEST(WorldOperator, TakesAsManyIterationsAsTheMatrix) {
    int iterations[2] = {0, 0};
    for (const bool elements : {false, true}) {
        Bar r({.operator_kind = elements ? OperatorKind::matrix_free : OperatorKind::assembled, .preconditioner = PreconditionerKind::lattice_multigrid, .tolerance = 1e-5});
        for (int n = 0; n < 20; ++n) iterations[elements] += r.world.step().cg_iterations;
    }
    EXPECT_NEAR(iterations[1], iterations[0], 0.05 * iterations[0]) << "its smoother is not that of the matrix";
}

TEST(WorldOperator, GivesTheSameBitsWhateverTheTeamAndAfterASnapshot) {
    const Options o{.cells = {27, 13, 13}, .tolerance = 1e-4, .young_pa = 1e6, .contact = true};  // 4,563: large enough to share
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 3, 8}) {
        Options with = o;
        with.threads = threads;
        Bar first(with);
        EXPECT_GT(first.run(6), 0);
        const auto snapshot = first.world.save();
        first.run(2);
        Bar second(with);
        second.world.restore(snapshot);
        second.run(2);
        EXPECT_EQ(first.world.hash(), second.world.hash());
        hashes.push_back(first.world.hash());
    }
    for (const std::uint64_t h : hashes) EXPECT_EQ(h, hashes[0]);
}

TEST(WorldOperator, FollowsEditsMaterialsAndSupports) {
    std::vector<Vec3> end[2];
    for (const bool elements : {false, true}) {
        Bar r({.operator_kind = elements ? OperatorKind::matrix_free : OperatorKind::assembled, .preconditioner = PreconditionerKind::lattice_multigrid});
        r.run(4);
        r.world.remove_elements(r.body, std::vector<std::int32_t>{70, 71, 72, 200});
        r.run(8);
        r.world.fix(r.body, test::at_x(0.4), {false, false, true});
        r.run(4);
        r.world.set_material(r.body, Corotational{.young_pa = 3e5, .poisson = 0.3});
        r.run(4);
        r.world.release(r.body, test::at_x(0.4));
        r.run(20);
        r.world.undo_edit(r.body);
        r.run(3);
        end[elements] = test::copy(r.world.positions(r.body));
    }
    EXPECT_LT(test::relative_difference(end[1], end[0]), 1e-6);
}

TEST(WorldOperator, AResponseFindsTheMatrixOfTheLastStep) {
    Bar elements({.operator_kind = OperatorKind::matrix_free}), matrix({.operator_kind = OperatorKind::assembled});
    elements.run(4);
    matrix.run(4);
    const std::uint64_t before = elements.world.hash();
    const BodyResponse a(elements.world, elements.body), b(matrix.world, matrix.body);
    std::vector<Vec3> force(a.vertices(), Vec3::Zero()), u(force), v(force);
    force[std::size_t(16)] = Vec3(0.1, -1, 0.3);
    a.solve(force, u, 1e-8);
    b.solve(force, v, 1e-8);
    EXPECT_LT(test::relative_difference(u, v), 1e-5);
    MatX A, B;
    const auto patch = a.patch(std::vector<std::int32_t>{16, 40}, 20);
    a.submatrix(patch, A);
    b.submatrix(patch, B);
    EXPECT_LT((A - B).norm(), 1e-5 * B.norm());
    EXPECT_EQ(elements.world.hash(), before);
    elements.run(3);  // looking changes nothing
    Bar unseen({.operator_kind = OperatorKind::matrix_free});
    unseen.run(7);
    EXPECT_EQ(elements.world.hash(), unseen.world.hash());
}

}  // namespace
}  // namespace supple
