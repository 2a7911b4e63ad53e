// The preconditioner of systems that contacts tie together, and the small factor in it.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "supple/solve/joint_preconditioner.h"
#include "supple/solve/linear_solver.h"
#include "support/bodies.h"

namespace supple::solve {
namespace {

TEST(JointPreconditioner, TheSkylineSolves) {
    // A random sparse positive matrix in the order that narrow_order() gives, against a dense solve.
    test::Random random(3);
    constexpr std::size_t n = 40;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    std::vector<std::vector<std::int32_t>> near(n);
    for (int k = 0; k < 60; ++k) {
        const auto i = Eigen::Index(random.uniform(0, n)), j = Eigen::Index(random.uniform(0, n));
        if (i == j) continue;
        A(i, j) = A(j, i) = random.uniform(-1, 1);
        near[std::size_t(i)].push_back(std::int32_t(j));
        near[std::size_t(j)].push_back(std::int32_t(i));
    }
    for (Eigen::Index i = 0; i < Eigen::Index(n); ++i) A(i, i) = 0.5 + A.row(i).cwiseAbs().sum();
    std::vector<std::int32_t> start{0}, neighbour, place, queue;
    for (const auto& list : near) {
        neighbour.insert(neighbour.end(), list.begin(), list.end());
        start.push_back(std::int32_t(neighbour.size()));
    }
    narrow_order(start, neighbour, place, queue);
    std::vector<std::int32_t> sorted = place, first(n);
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(sorted[i], std::int32_t(i)) << "a permutation";
    for (std::size_t i = 0; i < n; ++i) {
        std::int32_t lowest = place[i];
        for (const std::int32_t j : near[i]) lowest = std::min(lowest, place[std::size_t(j)]);
        first[std::size_t(place[i])] = lowest;
    }
    Skyline skyline;
    skyline.shape(first);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
            const auto row = std::size_t(place[i]), column = std::size_t(place[j]);
            if (column <= row && A(Eigen::Index(i), Eigen::Index(j)) != 0) skyline.at(row, column) = A(Eigen::Index(i), Eigen::Index(j));
        }
    ASSERT_TRUE(skyline.factor());
    const Eigen::VectorXd b = Eigen::VectorXd::Random(n), x = A.ldlt().solve(b);
    std::vector<double> y(n);
    for (std::size_t i = 0; i < n; ++i) y[std::size_t(place[i])] = b[Eigen::Index(i)];
    skyline.solve(y.data());
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(y[std::size_t(place[i])], x[Eigen::Index(i)], 1e-12);
    skyline.shape(first);
    skyline.at(n - 1, n - 1) = -1;
    EXPECT_FALSE(skyline.factor()) << "not positive";
}

/// Two chains of blocks that lie side by side, tied by rows of a stiffness.
struct Chains {
    static constexpr std::size_t kRows = 12;
    Bsr3Pattern pattern;
    Bsr3<double> A[2];
    std::vector<Vec3> points[2];
    std::vector<std::int32_t> owner = std::vector<std::int32_t>(3 * kRows, -1);
    std::vector<std::array<std::int32_t, 2>> tied;
    std::vector<std::array<Vec3, 2>> weight;
    std::vector<AppendedRow> rows;
    explicit Chains(double stiffness) {
        std::vector<std::array<std::int32_t, 4>> fours;
        for (std::int32_t i = 0; i + 3 < std::int32_t(kRows); ++i) fours.push_back({i, i + 1, i + 2, i + 3});
        pattern = make_pattern(kRows, fours);
        test::Random random(5);
        for (int k = 0; k < 2; ++k) {
            A[k].pattern = &pattern;
            A[k].value.assign(pattern.blocks() * 12, 0);
            for (std::size_t i = 0; i < kRows; ++i) {
                points[k].push_back(Vec3(double(i), k, random.uniform(-0.3, 0.3)));
                for (std::int32_t b = pattern.row_start[i]; b < pattern.row_start[i + 1]; ++b) {
                    const auto j = std::size_t(pattern.column[std::size_t(b)]);
                    for (std::size_t c = 0; c < 3; ++c) A[k].value[std::size_t(b) * 12 + 5 * c] = i == j ? 0.2 + double(pattern.row_start[i + 1] - pattern.row_start[i] - 1) : -1;
                }
            }
        }
        for (std::int32_t i = 2; i < 9; ++i) tied.push_back({i, std::int32_t(kRows) + i + 1});
        weight.assign(tied.size(), {Vec3::Ones(), Vec3(-Vec3::Ones())});
        for (std::size_t i = 0; i < tied.size(); ++i) {
            const Vec3 n = random.vector(1).normalized();
            rows.push_back({tied[i], weight[i], stiffness * (n * n.transpose())});
        }
    }
    int iterations(bool joint) {
        Team team;
        LinearSolver<double> solver(2 * kRows, best_isa());
        BlockJacobi<double> own[2] = {BlockJacobi<double>(kRows, best_isa()), BlockJacobi<double>(kRows, best_isa())};
        std::vector<SystemPart<double>> parts;
        std::vector<JointPart<double>> touching;
        for (std::size_t k = 0; k < 2; ++k) {
            std::vector<AppendedRow> mine;  // its half of each
            std::vector<std::int32_t> row(tied.size());
            for (std::size_t i = 0; i < tied.size(); ++i) {
                row[i] = tied[i][k] - std::int32_t(k * kRows);
                mine.push_back({{&row[i], 1}, {&weight[i][k], 1}, rows[i].stiffness});
            }
            own[k].update(team, A[k], mine);
            parts.push_back({&A[k], &own[k], nullptr, k * kRows});
            touching.push_back({&A[k], k * kRows, nullptr, {}, points[k], owner});
        }
        JointPreconditioner<double> both(best_isa());
        both.update(team, touching, rows, {}, false);
        if (joint) solver.set_joint(&both);
        std::vector<Vec3> b(2 * kRows), x(2 * kRows, Vec3::Zero()), residual(2 * kRows);
        test::Random random(9);
        for (Vec3& v : b) v = random.vector(1);
        LinearSolveDef def;
        def.target = 1e-7;
        const auto result = solver.solve(team, parts, rows, b, {}, def, [&](const Vec3* at, Vec3* r) {
            AlignedVector<double> in(8 * kRows, 0.0), out(8 * kRows, 0.0);
            for (std::size_t i = 0; i < 2 * kRows; ++i)
                for (std::size_t c = 0; c < 3; ++c) in[4 * i + c] = at[i][Eigen::Index(c)];
            solver.multiply(team, parts, rows, in.data(), out.data());
            for (std::size_t i = 0; i < 2 * kRows; ++i) r[i] = b[i] - Vec3(out[4 * i], out[4 * i + 1], out[4 * i + 2]);
        }, x, residual);
        EXPECT_TRUE(result.converged);
        // r . z is what apply() says it is, and it is symmetric.
        AlignedVector<double> r(8 * kRows, 0.0), s(8 * kRows, 0.0), z(8 * kRows), y(8 * kRows);
        for (std::size_t i = 0; i < 8 * kRows; ++i) {
            if (i % 4 == 3) continue;
            r[i] = random.uniform(-1, 1);
            s[i] = random.uniform(-1, 1);
        }
        const double rz = both.apply(team, r.data(), z.data());
        both.apply(team, s.data(), y.data());
        double dot = 0, sz = 0, ry = 0;
        for (std::size_t i = 0; i < 8 * kRows; ++i) dot += r[i] * z[i], sz += s[i] * z[i], ry += r[i] * y[i];
        EXPECT_NEAR(dot, rz, 1e-9 * rz);
        EXPECT_GT(rz, 0);
        EXPECT_NEAR(sz, ry, 1e-9 * rz);
        return result.iterations;
    }
};

TEST(JointPreconditioner, StiffRowsCostNoIterations) {
    const int apart = Chains(0).iterations(true), stiff = Chains(1e4).iterations(true), stiffer = Chains(1e7).iterations(true), diagonal = Chains(1e4).iterations(false);
    EXPECT_LE(stiff, 2 * apart);
    EXPECT_LE(2 * stiffer, 3 * stiff) << "a thousand times as stiff: three digits more of the rows themselves, none of the chains";
    EXPECT_GE(diagonal, 2 * stiff) << "what their diagonals alone would make of them";
}

}  // namespace
}  // namespace supple::solve
