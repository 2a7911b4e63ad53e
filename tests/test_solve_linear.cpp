// Preconditioned conjugate gradients inside iterative refinement, against a sparse direct solver.
#include <gtest/gtest.h>

#include <array>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "supple/solve/linear_solver.h"
#include "support/bodies.h"

namespace supple {
namespace {

using solve::AppendedRow;
using solve::Bsr3;
using solve::LinearSolveDef;
using solve::LinearSolver;
using solve::LinearSolveResult;
using Sparse = Eigen::SparseMatrix<double>;

/// A stiffness-like matrix on the pattern of a mesh, M + s L with random symmetric blocks, held in double, in Real and in Eigen's form.
template <class Real>
struct Problem {
    std::shared_ptr<const BodyTemplate> shape;
    solve::Bsr3Pattern pattern;
    Bsr3<Real> A;
    Sparse matrix;
    std::vector<Vec3> b;
    Team team;

    /// @param stiffness  weight of the Laplacian-like part against a mass of one: the condition number grows with it
    explicit Problem(double stiffness, int cells = 6) : shape(test::irregular_cube(cells, 0.2, 60)) {
        const auto& mesh = shape->mesh();
        const std::size_t n = mesh.vertices.size();
        pattern = solve::make_pattern(n, mesh.tets);
        A = {&pattern, AlignedVector<Real>(pattern.blocks() * 12, Real(0))};
        test::Random random(61);
        std::vector<Mat3> block(pattern.blocks(), Mat3::Zero());
        for (std::size_t i = 0; i < n; ++i) {
            for (std::int32_t k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k) {
                if (pattern.column[std::size_t(k)] <= std::int32_t(i)) continue;
                const Mat3 Q = random.matrix(1), S = stiffness * (0.1 * Mat3::Identity() + Q * Q.transpose());
                block[std::size_t(k)] -= S;
                block[std::size_t(pattern.mirror[std::size_t(k)])] -= S;
                block[std::size_t(pattern.diagonal[i])] += S;
                block[std::size_t(pattern.diagonal[std::size_t(pattern.column[std::size_t(k)])])] += S;
            }
            block[std::size_t(pattern.diagonal[i])] += Mat3::Identity();
        }
        std::vector<Eigen::Triplet<double>> triplets;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::int32_t k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k) {
                for (int r = 0; r < 3; ++r) {
                    for (int c = 0; c < 3; ++c) {
                        const double v = block[std::size_t(k)](r, c);
                        A.value[std::size_t(k) * 12 + std::size_t(4 * c + r)] = Real(v);
                        triplets.emplace_back(int(3 * i) + r, int(3 * pattern.column[std::size_t(k)]) + c, v);
                    }
                }
            }
        }
        matrix.resize(Eigen::Index(3 * n), Eigen::Index(3 * n));
        matrix.setFromTriplets(triplets.begin(), triplets.end());
        b.resize(n);
        for (Vec3& v : b) v = random.vector(1);
    }

    static Eigen::Map<const Eigen::VectorXd> flat(const std::vector<Vec3>& v) { return {v.data()->data(), Eigen::Index(3 * v.size())}; }

    std::vector<Vec3> direct() const {
        const Eigen::SimplicialLDLT<Sparse> solver(matrix);
        const Eigen::VectorXd x = solver.solve(flat(b));
        std::vector<Vec3> out(b.size());
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = x.segment<3>(Eigen::Index(3 * i));
        return out;
    }

    double residual(const std::vector<Vec3>& x) const { return (flat(b) - matrix * flat(x)).norm(); }
    double norm_b() const { return flat(b).norm(); }

    LinearSolveResult solve(std::vector<Vec3>& x, LinearSolveDef def, std::span<const std::span<const Vec3>> guesses = {},
                            std::span<const AppendedRow> appended = {}, Isa isa = best_isa()) {
        LinearSolver<Real> solver(pattern.rows, isa);
        solve::BlockJacobi<Real> preconditioner(pattern.rows, isa);
        preconditioner.update(team, A, appended);
        x.resize(b.size(), Vec3::Zero());
        std::vector<Vec3> r(b.size());
        const solve::SystemPart<Real> part{&A, &preconditioner};
        return solver.solve(
            team, {&part, 1}, appended, b, guesses, def,
            [&](const Vec3* at, Vec3* out) {
                const Eigen::Map<const Eigen::VectorXd> v(at->data(), matrix.rows());
                Eigen::Map<Eigen::VectorXd>(out->data(), matrix.rows()) = flat(b) - matrix * v;
            },
            x, r);
    }
};

TEST(SolveLinear, DoubleEqualsTheDirectSolution) {
    Problem<double> problem(1e3);
    for (const Isa isa : {Isa::scalar, Isa::baseline, best_isa()}) {
        std::vector<Vec3> x;
        const auto result = problem.solve(x, {.target = 1e-12 * problem.norm_b()}, {}, {}, isa);
        EXPECT_TRUE(result.converged);
        EXPECT_FALSE(result.stalled);
        EXPECT_GT(result.iterations, 5);
        EXPECT_LT(test::relative_difference(x, problem.direct()), 1e-10);
    }
}

TEST(SolveLinear, SingleEqualsTheDirectSolution) {
    Problem<float> problem(1e3);
    for (const Isa isa : {Isa::scalar, Isa::baseline, best_isa()}) {
        std::vector<Vec3> x;
        const auto result = problem.solve(x, {.target = 1e-8 * problem.norm_b()}, {}, {}, isa);
        EXPECT_TRUE(result.converged);
        EXPECT_LT(test::relative_difference(x, problem.direct()), 1e-6);
    }
}

TEST(SolveLinear, TheReportedResidualIsTheTrueOne) {
    Problem<float> problem(1e4);
    for (const double tolerance : {1e-1, 1e-3, 1e-5, 1e-8, 1e-10}) {
        std::vector<Vec3> x;
        const auto result = problem.solve(x, {.target = tolerance * problem.norm_b(), .max_iterations = 20000});
        EXPECT_TRUE(result.converged) << tolerance;
        EXPECT_LE(problem.residual(x), tolerance * problem.norm_b() * (1 + 1e-6));
        EXPECT_NEAR(result.residual, problem.residual(x), 1e-9 * problem.residual(x) + 1e-13 * problem.norm_b());
    }
}

TEST(SolveLinear, RefinementCarriesSingleFarBelowItsOwnPrecision) {
    Problem<float> problem(1e2);
    std::vector<Vec3> x;
    const auto result = problem.solve(x, {.target = 1e-12 * problem.norm_b(), .max_iterations = 20000});
    EXPECT_TRUE(result.converged);
    EXPECT_LT(test::relative_difference(x, problem.direct()), 1e-10);
}

TEST(SolveLinear, AZeroRightHandSideCostsNothing) {
    Problem<double> d(1e3);
    Problem<float> f(1e3);
    std::vector<Vec3> x;
    d.b.assign(d.b.size(), Vec3::Zero());
    f.b.assign(f.b.size(), Vec3::Zero());
    const auto rd = d.solve(x, {.target = 0});
    EXPECT_TRUE(rd.converged);
    EXPECT_EQ(rd.iterations, 0);
    EXPECT_EQ(rd.residual, 0);
    const auto rf = f.solve(x, {.target = 0});
    EXPECT_TRUE(rf.converged);
    EXPECT_EQ(rf.iterations, 0);
    for (const Vec3& v : x) EXPECT_EQ(v, Vec3::Zero());
}

TEST(SolveLinear, TheIterationCapIsHonouredAndIsNoStall) {
    Problem<double> problem(1e4);
    std::vector<Vec3> x;
    const auto result = problem.solve(x, {.target = 1e-12 * problem.norm_b(), .max_iterations = 3});
    EXPECT_EQ(result.iterations, 3);
    EXPECT_FALSE(result.converged);
    EXPECT_FALSE(result.stalled);
    EXPECT_NEAR(result.residual, problem.residual(x), 1e-9 * result.residual);
}

TEST(SolveLinear, WhatNoPrecisionCanReachIsAStallAndEnds) {
    Problem<float> f(1e3);
    Problem<double> d(1e3);
    std::vector<Vec3> x;
    const auto rf = f.solve(x, {.target = 1e-25 * f.norm_b(), .max_iterations = 100000});
    EXPECT_TRUE(rf.stalled);
    EXPECT_FALSE(rf.converged);
    EXPECT_LT(rf.iterations, 100000);
    EXPECT_LT(f.residual(x), 1e-10 * f.norm_b()) << "a stall keeps the best that was reached";
    x.clear();
    const auto rd = d.solve(x, {.target = 1e-25 * d.norm_b(), .max_iterations = 100000});
    EXPECT_TRUE(rd.stalled);
    EXPECT_LT(d.residual(x), 1e-12 * d.norm_b());
}

TEST(SolveLinear, ANumberThatIsNoneEndsTheSolve) {
    Problem<float> problem(1e3);
    problem.b[7][1] = std::nan("");
    std::vector<Vec3> x;
    const auto result = problem.solve(x, {.target = 1e-5});
    EXPECT_FALSE(result.converged);
    EXPECT_FALSE(std::isfinite(result.residual));
}

template <class Real>
void check_warm_starts(double exact) {
    Problem<Real> problem(1e3);
    const std::vector<Vec3> answer = problem.direct();
    const auto start_residual = [&](std::span<const std::span<const Vec3>> guesses) {
        std::vector<Vec3> x;
        return problem.solve(x, {.target = 0, .max_iterations = 0}, guesses).residual / problem.norm_b();
    };
    test::Random random(62);
    for (int i = 0; i < 20; ++i) {
        std::vector<Vec3> bad(answer.size()), worse(answer.size());
        const double size = std::pow(10.0, random.uniform(-6, 6));
        for (Vec3& v : bad) v = random.vector(size);
        for (Vec3& v : worse) v = random.vector(size);
        const std::span<const Vec3> guesses[2] = {bad, worse};
        EXPECT_LE(start_residual(std::span(guesses, 2)), 1 + 1e-5);
        EXPECT_LE(start_residual(std::span(guesses, 1)), 1 + 1e-5);
    }
    std::vector<Vec3> none(answer.size(), Vec3::Zero()), half = answer;
    for (Vec3& v : half) v *= 0.5;
    const std::span<const Vec3> previous[2] = {answer, none};
    EXPECT_LT(start_residual(std::span(previous, 2)), exact);  // g0
    EXPECT_LT(start_residual(std::span(previous, 1)), exact);
    const std::span<const Vec3> extrapolated[2] = {half, none};
    EXPECT_LT(start_residual(std::span(extrapolated, 2)), exact);  // 2 g0 - g1
    const std::span<const Vec3> nothing[2] = {none, none};
    EXPECT_NEAR(start_residual(std::span(nothing, 2)), 1, 1e-6);
}

TEST(SolveLinear, AWarmStartNeverRaisesTheResidualInDouble) { check_warm_starts<double>(1e-10); }
TEST(SolveLinear, AWarmStartNeverRaisesTheResidualInSingle) { check_warm_starts<float>(1e-3); }

TEST(SolveLinear, AGoodGuessSavesIterations) {
    Problem<double> problem(1e3);
    std::vector<Vec3> cold, warm, guess = problem.direct();
    test::Random random(63);
    for (Vec3& v : guess) v += random.vector(1e-7 * v.norm());
    const std::span<const Vec3> guesses[1] = {guess};
    const LinearSolveDef def{.target = 1e-6 * problem.norm_b()};
    const int from_zero = problem.solve(cold, def).iterations;
    EXPECT_LT(problem.solve(warm, def, guesses).iterations, from_zero / 2);
}

TEST(SolveLinear, WhatXHoldsOnEntryIsKept) {
    Problem<double> problem(1e3);
    // The caller subtracts A x0 from b itself: here b belongs to what is to be added, and the true residual sees both.
    std::vector<Vec3> x(problem.b.size(), Vec3(1, 2, 3));
    const std::vector<Vec3> before = x;
    const std::vector<Vec3> add = problem.direct();
    const Sparse matrix = problem.matrix;
    std::vector<Vec3> r(x.size());
    LinearSolver<double> solver(problem.pattern.rows, best_isa());
    solve::BlockJacobi<double> preconditioner(problem.pattern.rows, best_isa());
    preconditioner.update(problem.team, problem.A, {});
    const solve::SystemPart<double> part{&problem.A, &preconditioner};
    const auto result = solver.solve(
        problem.team, {&part, 1}, {}, problem.b, {}, {.target = 1e-11 * problem.norm_b()},
        [&](const Vec3* at, Vec3* out) {
            Eigen::VectorXd v = Eigen::Map<const Eigen::VectorXd>(at->data(), matrix.rows()) - Problem<double>::flat(before);
            Eigen::Map<Eigen::VectorXd>(out->data(), matrix.rows()) = Problem<double>::flat(problem.b) - matrix * v;
        },
        x, r);
    EXPECT_TRUE(result.converged);
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((x[i] - before[i] - add[i]).norm(), 1e-8);
}

/// Three couplings, one of them over the same rows as another, one with a held coordinate.
struct Couplings {
    std::vector<std::int32_t> row_a{3, 40, 41, 200}, row_b{40, 41}, row_c{0};
    std::vector<Vec3> weight_a{{0.1, 0.1, 0.1}, {0.4, 0.4, 0}, {0.3, 0.3, 0.3}, {0.2, 0.2, 0.2}}, weight_b{{1, 1, 1}, {-1, -1, -1}}, weight_c{{1, 1, 1}};
    std::vector<AppendedRow> rows(double k) const {
        Mat3 S = k * Mat3::Identity();
        S(0, 1) = S(1, 0) = 0.3 * k;
        return {{row_a, weight_a, S}, {row_b, weight_b, 2 * S}, {row_c, weight_c, k * Vec3(1, 0, 0) * Vec3(1, 0, 0).transpose()}};
    }
};

Sparse with_couplings(const Sparse& matrix, std::span<const AppendedRow> rows) {
    Eigen::MatrixXd dense = matrix;
    for (const AppendedRow& extra : rows) {
        Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, matrix.rows());
        for (std::size_t i = 0; i < extra.row.size(); ++i)
            for (int c = 0; c < 3; ++c) J(c, 3 * extra.row[i] + c) = extra.weight[i][c];
        dense += J.transpose() * extra.stiffness * J;
    }
    return dense.sparseView();
}

TEST(SolveAppended, ProductEqualsTheDenseOne) {
    Problem<double> problem(10, 5);
    const Couplings couplings;
    const auto rows = couplings.rows(50);
    const Sparse full = with_couplings(problem.matrix, rows);
    LinearSolver<double> solver(problem.pattern.rows, best_isa());
    AlignedVector<double> x(problem.b.size() * 4, 0), y(x.size());
    for (std::size_t i = 0; i < problem.b.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) x[4 * i + c] = problem.b[i][Eigen::Index(c)];
    const double dot = solver.multiply(problem.team, std::array{solve::SystemPart<double>{&problem.A}}, rows, x.data(), y.data());
    const Eigen::VectorXd expected = full * problem.flat(problem.b);
    for (std::size_t i = 0; i < problem.b.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(y[4 * i + c], expected[Eigen::Index(3 * i + c)], 1e-11);
    EXPECT_NEAR(dot, problem.flat(problem.b).dot(expected), 1e-9 * std::abs(dot));
}

template <class Real>
void check_appended_solve(double tolerance, double difference) {
    Problem<Real> problem(100, 5);
    const Couplings couplings;
    for (const double k : {1.0, 1e3, 1e6}) {
        const auto rows = couplings.rows(k);
        const Sparse alone = problem.matrix;
        problem.matrix = with_couplings(alone, rows);
        std::vector<Vec3> x;
        const auto result = problem.solve(x, {.target = tolerance * problem.norm_b(), .max_iterations = 20000}, {}, rows);
        EXPECT_TRUE(result.converged) << k;
        EXPECT_LT(test::relative_difference(x, problem.direct()), difference) << k;
        problem.matrix = alone;
    }
}

TEST(SolveAppended, SolutionEqualsTheDenseOneInDouble) { check_appended_solve<double>(1e-12, 1e-9); }
TEST(SolveAppended, SolutionEqualsTheDenseOneInSingle) { check_appended_solve<float>(1e-8, 1e-5); }

/// Two matrices along the diagonal, tied together by rows that name both: the solution of the whole.
TEST(SolveParts, TwoMatricesAndWhatTiesThem) {
    Problem<double> one(50, 4), two(400, 5);
    const std::size_t n1 = one.pattern.rows, n = n1 + two.pattern.rows;
    const std::vector<std::int32_t> across{std::int32_t(n1) - 1, std::int32_t(n1) + 7}, within{std::int32_t(n1) + 3};
    const std::vector<Vec3> weights{Vec3::Ones(), -Vec3::Ones()}, single{Vec3(1, 0, 1)};
    const std::vector<AppendedRow> rows{{across, weights, 70 * Mat3::Identity()}, {within, single, 5 * Mat3::Identity()}};
    Sparse both(Eigen::Index(3 * n), Eigen::Index(3 * n));
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [problem, first] : {std::pair{&one, Eigen::Index(0)}, std::pair{&two, Eigen::Index(3 * n1)}}) {
        for (Eigen::Index k = 0; k < problem->matrix.outerSize(); ++k)
            for (Sparse::InnerIterator it(problem->matrix, k); it; ++it) entries.emplace_back(first + it.row(), first + it.col(), it.value());
    }
    both.setFromTriplets(entries.begin(), entries.end());
    both = with_couplings(both, rows);
    std::vector<Vec3> b = one.b;
    b.insert(b.end(), two.b.begin(), two.b.end());
    const Eigen::VectorXd rhs = Eigen::Map<const Eigen::VectorXd>(b.data()->data(), Eigen::Index(3 * n));
    solve::BlockJacobi<double> first(n1, best_isa()), second(two.pattern.rows, best_isa());
    first.update(one.team, one.A, {});
    second.update(one.team, two.A, {});
    const solve::SystemPart<double> parts[] = {{&one.A, &first, nullptr, 0}, {&two.A, &second, nullptr, n1}};
    LinearSolver<double> solver(3, best_isa());
    solver.resize(n);
    std::vector<Vec3> x(n, Vec3::Zero()), r(n);
    const std::vector<Vec3> guess(n, Vec3(0.1, 0.2, 0.3)), older(n, Vec3(0.3, 0.2, 0.1));
    const std::span<const Vec3> guesses[] = {guess, older};
    const auto result = solver.solve(
        one.team, parts, rows, b, guesses, {.target = 1e-12 * rhs.norm()},
        [&](const Vec3* at, Vec3* out) {
            const Eigen::Map<const Eigen::VectorXd> v(at->data(), both.rows());
            Eigen::Map<Eigen::VectorXd>(out->data(), both.rows()) = rhs - both * v;
        },
        x, r);
    EXPECT_TRUE(result.converged);
    const Eigen::VectorXd direct = Eigen::SimplicialLDLT<Sparse>(both).solve(rhs);
    for (std::size_t i = 0; i < n; ++i) EXPECT_LT((x[i] - direct.segment<3>(Eigen::Index(3 * i))).norm(), 1e-9 * direct.norm());
}

TEST(SolveDeterminism, SumsAndSolutionsDoNotDependOnTheTeam) {
    Problem<float> problem(1e3, 12);
    ASSERT_GT(problem.pattern.rows, 3 * solve::kRowChunk);
    const auto run = [&](int threads) {
        std::vector<Vec3> x(problem.b.size(), Vec3::Zero()), r(x.size());
        with_team(threads, [&](Team& team) {
            LinearSolver<float> solver(problem.pattern.rows, best_isa());
            solve::BlockJacobi<float> preconditioner(problem.pattern.rows, best_isa());
            preconditioner.update(team, problem.A, {});
            const solve::SystemPart<float> part{&problem.A, &preconditioner};
            solver.solve(
                team, {&part, 1}, {}, problem.b, {}, {.target = 1e-6 * problem.norm_b()},
                [&](const Vec3* at, Vec3* out) {
                    const Eigen::Map<const Eigen::VectorXd> v(at->data(), problem.matrix.rows());
                    Eigen::Map<Eigen::VectorXd>(out->data(), problem.matrix.rows()) = Problem<float>::flat(problem.b) - problem.matrix * v;
                },
                x, r);
        });
        return x;
    };
    const auto one = run(1);
    for (const int threads : {2, 3, 8}) EXPECT_EQ(run(threads), one) << threads << " threads";
}

}  // namespace
}  // namespace supple
