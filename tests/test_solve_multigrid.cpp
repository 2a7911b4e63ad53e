// The lattice multigrid: definite, symmetric, never in the way of the answer, and worth its cost on meshes of every kind.
#include <gtest/gtest.h>

#include "support/elastic_problem.h"

namespace supple {
namespace {

using test::ElasticProblem;

std::uint8_t clamp_low_x(const Vec3& X) { return X.x() < 1e-9 ? 7 : 0; }
/// A fixed face, a face that slides, and the rest free.
std::uint8_t mixed_supports(const Vec3& X) { return X.x() < 1e-9 ? 7 : X.x() > 1 - 1e-9 ? 2 : X.z() > 1 - 1e-9 ? 5 : 0; }
std::uint8_t nothing_held(const Vec3&) { return 0; }

/// A padded vector with random free coordinates.
template <class Real>
AlignedVector<Real> random_vector(const ElasticProblem<Real>& problem, std::uint64_t seed) {
    test::Random random(seed);
    AlignedVector<Real> v(problem.rows() * 4, Real(0));
    for (std::size_t i = 0; i < problem.rows(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double value = random.uniform(-1, 1);
            if (!(problem.held[i] >> c & 1)) v[4 * i + c] = Real(value);
        }
    }
    return v;
}

template <class Real>
double dot(const AlignedVector<Real>& a, const AlignedVector<Real>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += double(a[i]) * double(b[i]);
    return sum;
}

/// x.Py = y.Px, x.Px > 0, held coordinates stay zero, and the returned product is the product.
template <class Real>
void expect_symmetric_and_positive(ElasticProblem<Real>& problem, solve::Preconditioner<Real>& P, const char* what) {
    for (std::uint64_t seed = 1; seed <= 6; seed += 2) {
        const auto x = random_vector(problem, seed), y = random_vector(problem, seed + 1);
        AlignedVector<Real> Px(x.size()), Py(x.size());
        const double xPx = P.apply(problem.team, x.data(), Px.data()), yPy = P.apply(problem.team, y.data(), Py.data());
        EXPECT_GT(xPx, 0) << what;
        EXPECT_GT(yPy, 0) << what;
        EXPECT_NEAR(xPx, dot(x, Px), 1e-5 * xPx) << what;
        EXPECT_NEAR(dot(x, Py), dot(y, Px), 1e-5 * std::sqrt(xPx * yPy)) << what;
        for (std::size_t i = 0; i < problem.rows(); ++i) {
            EXPECT_EQ(Px[4 * i + 3], Real(0));
            for (std::size_t c = 0; c < 3; ++c) {
                if (problem.held[i] >> c & 1) {
                    EXPECT_EQ(Px[4 * i + c], Real(0)) << what << ", row " << i;
                }
            }
        }
    }
}

TEST(SolveMultigrid, SymmetricAndPositiveOnIrregularMeshesWithHeldVertices) {
    for (const Isa isa : {Isa::scalar, Isa::baseline, best_isa()}) {
        ElasticProblem<float> single(test::irregular_cube(8, 0.2, 3), {.young_pa = 1e6, .inclusion = 100}, mixed_supports);
        const auto P = single.multigrid(isa);
        ASSERT_GE(P->level_rows().size(), 2u);
        P->update(single.team, single.A, {});
        expect_symmetric_and_positive<float>(single, *P, "single");
    }
    ElasticProblem<double> dbl(test::irregular_cube(8, 0.2, 4), {.young_pa = 1e6, .poisson = 0.49}, mixed_supports);
    const auto P = dbl.multigrid();
    P->update(dbl.team, dbl.A, {});
    expect_symmetric_and_positive<double>(dbl, *P, "double");
}

TEST(SolveMultigrid, TheSolutionIsTheDirectOne) {
    const auto check = [](auto real, double tolerance, double error) {
        using Real = decltype(real);
        ElasticProblem<Real> problem(test::irregular_cube(7, 0.2, 7), {.young_pa = 3e5, .poisson = 0.45}, mixed_supports);
        std::vector<Vec3> x;
        const auto expected = problem.direct();
        const auto P = problem.multigrid();
        const auto result = problem.solve(*P, tolerance, x);
        EXPECT_TRUE(result.converged);
        EXPECT_LT(test::relative_difference(x, expected), error);
        solve::BlockJacobi<Real> jacobi(problem.rows(), best_isa());
        const auto plain = problem.solve(jacobi, tolerance, x);
        EXPECT_TRUE(plain.converged);
        EXPECT_LT(test::relative_difference(x, expected), error);
        EXPECT_LT(3 * result.iterations, plain.iterations);
    };
    check(float(), 1e-8, 1e-6);
    check(double(), 1e-11, 1e-9);
}

TEST(SolveMultigrid, IterationsHardlyGrowWithTheMesh) {
    std::vector<int> iterations;
    for (const int cells : {1, 2, 3}) {
        ElasticProblem<float> bar(test::bar({16 * cells, 4 * cells, 4 * cells}), {.young_pa = 2e5}, clamp_low_x, 2);
        const auto P = bar.multigrid();
        std::vector<Vec3> x;
        const auto result = bar.solve(*P, 1e-5, x);
        EXPECT_TRUE(result.converged);
        iterations.push_back(result.iterations);
    }
    EXPECT_LE(iterations[2], 20);
    EXPECT_LE(iterations[2], 1.6 * iterations[0]);
}

TEST(SolveMultigrid, HardMaterials) {
    const auto check = [](const char* what, const ElasticProblem<float>::Def& def, int most) {
        ElasticProblem<float> problem(test::irregular_cube(12, 0.2, 9), def, clamp_low_x, 2);
        const auto P = problem.multigrid();
        std::vector<Vec3> x;
        const auto result = problem.solve(*P, 1e-5, x);
        EXPECT_TRUE(result.converged) << what;
        EXPECT_LE(result.iterations, most) << what;
    };
    check("inclusions 100:1", {.young_pa = 1e5, .time_step_s = 1.0 / 60, .inclusion = 100}, 60);
    check("nearly incompressible", {.young_pa = 1e5, .poisson = 0.49, .time_step_s = 1.0 / 60}, 60);
    check("stiff", {.young_pa = 1e7, .poisson = 0.4, .time_step_s = 1.0 / 60}, 30);
    check("soft and quick", {.young_pa = 1e4, .poisson = 0.3, .time_step_s = 1e-3}, 12);
}

TEST(SolveMultigrid, TurnsWithTheBody) {
    const Mat3 turn = Eigen::AngleAxisd(2.0, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const auto shape = test::irregular_cube(9, 0.2, 11);
    ElasticProblem<float> rest(shape, {.young_pa = 1e6}, clamp_low_x), turned(shape, {.young_pa = 1e6, .turn = turn}, clamp_low_x);
    const auto P = rest.multigrid();
    std::vector<Vec3> x;
    const int at_home = rest.solve(*P, 1e-5, x).iterations;
    const int unaware = turned.solve(*P, 1e-5, x).iterations;
    P->turn(turned.team, turned.rotation());
    const int aware = turned.solve(*P, 1e-5, x).iterations;
    EXPECT_LE(aware, at_home + 2);
    EXPECT_GT(unaware, 1.5 * aware) << "or the turn would prove nothing";
    expect_symmetric_and_positive<float>(turned, *P, "turned");
}

/// A matrix that shows its products and its diagonal alone.
struct Products final : solve::Operator<float> {
    explicit Products(const solve::Bsr3<float>& of) : A(of), diagonal_blocks(of.pattern->rows * 12) {
        for (std::size_t row = 0; row < A.pattern->rows; ++row) {
            std::copy_n(A.value.begin() + std::ptrdiff_t(A.pattern->diagonal[row]) * 12, 12, diagonal_blocks.begin() + std::ptrdiff_t(12 * row));
        }
    }
    void begin_product(Team&, const float* x) override { begun = x; }
    double product_rows(const float* x, float* y, std::size_t begin, std::size_t end) const override {
        EXPECT_EQ(x, begun) << "rows of another product than the one that was begun";
        const solve::Bsr3Pattern& p = *A.pattern;
        return solve::bsr3_kernels<float>(best_isa()).multiply(p.row_start.data(), p.column.data(), A.value.data(), x, y, begin, end);
    }
    std::span<const float> diagonal() const override { return diagonal_blocks; }
    double traffic() const override { return 0; }

    const solve::Bsr3<float>& A;
    AlignedVector<float> diagonal_blocks;
    const float* begun = nullptr;
};

TEST(SolveMultigrid, AnOperatorInPlaceOfTheMatrixMakesTheSameCycle) {
    ElasticProblem<float> problem(test::irregular_cube(8, 0.2, 3), {.young_pa = 1e6, .inclusion = 10}, mixed_supports);
    Products products(problem.A);
    const std::vector<std::int32_t> row = {200, 37, 411};  // of springs, stiff against the matrix, one of them tilted
    const std::vector<Vec3> weight = {Vec3(1, 0.5, 0), Vec3(0, 0.7, 0.2), Vec3(0.3, 0, 0.4)};
    Mat3 K;
    K << 3, 1, 0, 1, 2, 0.5, 0, 0.5, 4;
    for (const std::size_t rows : {std::size_t(0), std::size_t(3)}) {
        const solve::AppendedRow spring{std::span(row).first(rows), std::span(weight).first(rows), 20 * K};
        const std::span<const solve::AppendedRow> appended(&spring, rows > 0 ? 1 : 0);
        const auto P = problem.multigrid(best_isa());
        const auto r = random_vector(problem, 5);
        AlignedVector<float> by_matrix(r.size()), by_products(r.size());
        P->update(problem.team, problem.A, appended);
        P->apply(problem.team, r.data(), by_matrix.data());
        P->update(problem.team, products, appended);
        P->apply(problem.team, r.data(), by_products.data());
        AlignedVector<float> difference(r.size());
        for (std::size_t i = 0; i < r.size(); ++i) difference[i] = by_products[i] - by_matrix[i];
        EXPECT_LT(std::sqrt(dot(difference, difference)), 2e-3 * std::sqrt(dot(by_matrix, by_matrix)));
        expect_symmetric_and_positive<float>(problem, *P, "operator");
        P->update(problem.team, problem.A, appended);  // and back
        P->apply(problem.team, r.data(), by_products.data());
        EXPECT_EQ(by_products, by_matrix);
    }
}

TEST(SolveMultigrid, AppendedRowsReachTheCoarseLevel) {
    ElasticProblem<float> problem(test::irregular_cube(12, 0.2, 13), {.young_pa = 1e5}, clamp_low_x);
    std::vector<std::int32_t> rows;
    for (std::size_t i = 0; i < problem.rows(); ++i) {
        const Vec3& X = problem.points[i];
        if (X.x() > 1 - 1e-9 && X.y() > 0.3 && X.z() > 0.3) rows.push_back(std::int32_t(i));
    }
    ASSERT_GE(rows.size(), 20u);
    const std::vector<Vec3> whole(rows.size(), Vec3::Ones());
    const double stiffness = 30 * double(problem.A.value[std::size_t(problem.pattern.diagonal[std::size_t(rows[0])]) * 12]);
    // Stiff springs to the ground, one for each vertex of a patch: a contact.
    std::vector<solve::AppendedRow> contact;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        contact.push_back({std::span(rows).subspan(i, 1), std::span(whole).subspan(i, 1), stiffness * Mat3::Identity()});
    }
    const auto P = problem.multigrid();
    std::vector<Vec3> x;
    const int without = problem.solve(*P, 1e-5, x).iterations;
    const auto result = problem.solve(*P, 1e-8, x, contact);
    EXPECT_TRUE(result.converged);
    EXPECT_LT(test::relative_difference(x, problem.direct(contact)), 1e-6);
    expect_symmetric_and_positive<float>(problem, *P, "with contact");
    EXPECT_LE(problem.solve(*P, 1e-5, x, contact).iterations, 2 * without);
    // A drag: the mean of the patch.
    const std::vector<Vec3> shared(rows.size(), Vec3::Constant(1.0 / double(rows.size())));
    const solve::AppendedRow drag{rows, shared, stiffness * Mat3::Identity()};
    EXPECT_LE(problem.solve(*P, 1e-5, x, std::span(&drag, 1)).iterations, without + 5);
    // Gone again: as if it had never been.
    EXPECT_EQ(problem.solve(*P, 1e-5, x).iterations, without);
}

TEST(SolveMultigrid, AnyTeamGivesTheSameBits) {
    std::vector<AlignedVector<float>> results;
    for (const int threads : {1, 2, 3, 8}) {
        ElasticProblem<float> problem(test::irregular_cube(14, 0.2, 17), {}, clamp_low_x, threads);
        const auto P = problem.multigrid();
        P->update(problem.team, problem.A, {});
        const auto r = random_vector(problem, 2);
        AlignedVector<float> z(r.size());
        const double rz = P->apply(problem.team, r.data(), z.data());
        z.push_back(float(rz));
        results.push_back(z);
    }
    for (const auto& z : results) EXPECT_TRUE(z == results[0]);
}

TEST(SolveMultigrid, NothingIsTooSmallOrTooBrokenUp) {
    // One tet, two cubes far apart in one body, everything held, and a crowd of single tets that no lattice can coarsen.
    const auto check = [](std::shared_ptr<const BodyTemplate> shape, auto held, const char* what) {
        ElasticProblem<float> problem(std::move(shape), {}, held);
        const auto P = problem.multigrid();
        std::vector<Vec3> x;
        const auto result = problem.solve(*P, 1e-6, x);
        EXPECT_TRUE(result.converged) << what;
        EXPECT_LT(test::relative_difference(x, problem.direct()), 1e-4) << what;
    };
    check(test::unit_tet(), nothing_held, "one tet");
    check(test::cube(5), [](const Vec3&) { return std::uint8_t(7); }, "all held");
    VolumeMesh crowd;
    test::Random random(23);
    for (int i = 0; i < 400; ++i) {
        const Vec3 at = random.vector(0.5);
        const auto first = std::int32_t(crowd.vertices.size());
        for (const Vec3& v : {Vec3(0, 0, 0), Vec3(0.02, 0, 0), Vec3(0, 0.02, 0), Vec3(0, 0, 0.02)}) crowd.vertices.push_back(at + v);
        crowd.tets.push_back({first, first + 1, first + 2, first + 3});
    }
    check(BodyTemplate::build(std::move(crowd)), nothing_held, "a crowd");
}

// -- the lattice itself ------------------------------------------------------------------------------

/// Points on a line of the given cells, joined where `joined` says so.
struct Graph {
    std::vector<solve::LatticePoint> points;
    std::vector<std::int32_t> row_start{0}, column;
    template <class Joined>
    Graph(std::vector<solve::LatticePoint> p, Joined&& joined) : points(std::move(p)) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (std::size_t j = 0; j < points.size(); ++j) {
                if (i == j || joined(std::min(i, j), std::max(i, j))) column.push_back(std::int32_t(j));
            }
            row_start.push_back(std::int32_t(column.size()));
        }
    }
    solve::LatticeInterpolation interpolation() const { return solve::make_interpolation(points, row_start, column); }
};

TEST(SolveLattice, WeightsSumToOneAndReproduceLinearFields) {
    test::Random random(31);
    std::vector<solve::LatticePoint> points(200);
    for (auto& p : points) {
        for (std::size_t c = 0; c < 3; ++c) {
            p.cell[c] = std::int32_t(random.uniform(0, 4));
            p.fraction[c] = float(random.uniform(0, 1));
        }
    }
    points[7].active = false;
    const Graph graph(points, [](std::size_t, std::size_t) { return true; });
    const auto P = graph.interpolation();
    EXPECT_LE(P.node.size(), 125u);
    EXPECT_EQ(P.to_points.row_start[7], P.to_points.row_start[8]);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points[i].active) continue;
        double sum = 0;
        Vec3 at = Vec3::Zero();
        for (std::int32_t k = P.to_points.row_start[i]; k < P.to_points.row_start[i + 1]; ++k) {
            const double w = double(P.to_points.weight[std::size_t(k)]);
            const auto& node = P.node[std::size_t(P.to_points.column[std::size_t(k)])];
            sum += w;
            at += w * Vec3(node[0], node[1], node[2]);
        }
        EXPECT_NEAR(sum, 1, 1e-6);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(at[Eigen::Index(c)], points[i].cell[c] + double(points[i].fraction[c]), 5e-3);
    }
}

TEST(SolveLattice, PartsThatDoNotHangTogetherShareNoNode) {
    // Two fingers, three cells long, in the same row of cells; they meet in a palm in cell 0 - or not.
    std::vector<solve::LatticePoint> points;
    for (const float side : {0.3f, 0.7f}) {
        for (std::int32_t cell = 1; cell <= 3; ++cell) points.push_back({{cell, 0, 0}, {0.5f, side, 0.5f}, true});
    }
    const auto chain = [](std::size_t i, std::size_t j) { return j == i + 1 && j != 3; };
    const auto nodes_of = [](const solve::LatticeInterpolation& P, std::size_t i) {
        return std::vector<std::int32_t>(P.to_points.column.begin() + P.to_points.row_start[i], P.to_points.column.begin() + P.to_points.row_start[i + 1]);
    };
    const auto share = [&](const solve::LatticeInterpolation& P, std::size_t i, std::size_t j) {
        int common = 0;
        for (const auto a : nodes_of(P, i))
            for (const auto b : nodes_of(P, j)) common += a == b;
        return common;
    };
    const auto apart = Graph(points, chain).interpolation();
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 3; j < 6; ++j) EXPECT_EQ(share(apart, i, j), 0);
    EXPECT_EQ(share(apart, 0, 1), 4);
    EXPECT_EQ(apart.node.size(), 2u * 16);
    points.push_back({{0, 0, 0}, {0.9f, 0.5f, 0.5f}, true});
    const auto joined = Graph(points, [&](std::size_t i, std::size_t j) { return chain(i, j) || (j == 6 && (i == 0 || i == 3)); }).interpolation();
    EXPECT_EQ(share(joined, 0, 3), 4) << "at the palm";
    EXPECT_EQ(share(joined, 1, 4), 0);
    EXPECT_EQ(share(joined, 2, 5), 0);
}

}  // namespace
}  // namespace supple
