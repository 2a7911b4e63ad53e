// Sparsity and the gather map against dense assembly.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <set>

#include "supple/solve/bsr3.h"
#include "support/bodies.h"

namespace supple {
namespace {

TEST(SolvePattern, HoldsExactlyTheNeighboursSortedWithMirrors) {
    const auto shape = test::irregular_cube(3, 0.2, 50);
    const auto& tets = shape->mesh().tets;
    const std::size_t n = shape->mesh().vertices.size();
    std::vector<std::set<std::int32_t>> expected(n);
    for (const Tet& t : tets)
        for (const std::int32_t a : t) expected[std::size_t(a)].insert(t.begin(), t.end());
    const solve::Bsr3Pattern p = solve::make_pattern(n, tets);
    ASSERT_EQ(p.rows, n);
    ASSERT_EQ(p.row_start.size(), n + 1);
    for (std::size_t i = 0; i < n; ++i) {
        const std::vector<std::int32_t> row(p.column.begin() + p.row_start[i], p.column.begin() + p.row_start[i + 1]);
        EXPECT_EQ(row, std::vector<std::int32_t>(expected[i].begin(), expected[i].end())) << "row " << i;
        EXPECT_EQ(p.column[std::size_t(p.diagonal[i])], std::int32_t(i));
        for (std::int32_t b = p.row_start[i]; b < p.row_start[i + 1]; ++b) {
            const std::size_t m = std::size_t(p.mirror[std::size_t(b)]);
            EXPECT_EQ(p.column[m], std::int32_t(i));
            EXPECT_EQ(std::size_t(p.mirror[m]), std::size_t(b));
        }
    }
}

TEST(SolvePattern, AVertexOfNoElementKeepsItsDiagonal) {
    const std::vector<std::array<std::int32_t, 4>> tets{{0, 1, 3, 4}};
    const solve::Bsr3Pattern p = solve::make_pattern(6, tets);
    EXPECT_EQ(p.row_start[3] - p.row_start[2], 1);
    EXPECT_EQ(p.column[std::size_t(p.diagonal[2])], 2);
    EXPECT_EQ(p.column[std::size_t(p.diagonal[5])], 5);
    EXPECT_EQ(p.blocks(), 4u * 4 + 2);
}

TEST(SolvePattern, GatherMapSumsWhatDenseAssemblyScatters) {
    const auto shape = test::irregular_cube(3, 0.2, 51);
    const auto& tets = shape->mesh().tets;
    const auto n = Eigen::Index(shape->mesh().vertices.size());
    const solve::Bsr3Pattern p = solve::make_pattern(std::size_t(n), tets);
    const solve::GatherMap map = solve::make_gather_map(p, tets);
    // A number for each pair of corners of each element, not symmetric: a swapped pair would show.
    test::Random random(52);
    std::vector<double> entry(tets.size() * 16);
    for (double& x : entry) x = random.uniform(-1, 1);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t e = 0; e < tets.size(); ++e)
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = 0; b < 4; ++b) dense(tets[e][a], tets[e][b]) += entry[e * 16 + a * 4 + b];
    std::size_t used = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
        for (std::int32_t b = p.row_start[std::size_t(i)]; b < p.row_start[std::size_t(i) + 1]; ++b) {
            double sum = 0;
            for (std::int64_t k = map.start[std::size_t(b)]; k < map.start[std::size_t(b) + 1]; ++k, ++used) {
                sum += entry[map.pair[std::size_t(k)]];
                if (k > map.start[std::size_t(b)]) {
                    EXPECT_LT(map.pair[std::size_t(k - 1)] / 16, map.pair[std::size_t(k)] / 16) << "elements ascend: the sum has one order";
                }
            }
            const std::int32_t column = p.column[std::size_t(b)];
            if (column < i) {
                EXPECT_EQ(map.start[std::size_t(b)], map.start[std::size_t(b) + 1]) << "below the diagonal nothing is gathered";
            } else {
                EXPECT_NEAR(sum, dense(i, column), 1e-13);
            }
        }
    }
    EXPECT_EQ(used, map.pair.size());
    EXPECT_EQ(used, tets.size() * 10);
}

TEST(SolvePattern, RowsLieInTheOrderThatIsAskedFor) {
    const auto shape = test::irregular_cube(3, 0.2, 53);
    const auto& tets = shape->mesh().tets;
    const std::size_t n = shape->mesh().vertices.size();
    std::vector<std::int32_t> order(n);
    for (std::size_t i = 0; i < n; ++i) order[i] = std::int32_t((i * 11 + 5) % n);  // 64 vertices
    const solve::Bsr3Pattern given = solve::make_pattern(n, tets), p = solve::make_pattern(n, tets, {}, order);
    EXPECT_EQ(p.vertex, order);
    for (std::size_t i = 0; i < n; ++i) {
        EXPECT_EQ(p.row[std::size_t(p.vertex[i])], std::int32_t(i));
        EXPECT_EQ(given.vertex[i], std::int32_t(i));
        const std::vector<std::int32_t> row(p.column.begin() + p.row_start[i], p.column.begin() + p.row_start[i + 1]);
        EXPECT_TRUE(std::is_sorted(row.begin(), row.end()));
        std::set<std::int32_t> vertices, expected;
        for (const std::int32_t c : row) vertices.insert(p.vertex[std::size_t(c)]);
        const auto v = std::size_t(p.vertex[i]);
        expected.insert(given.column.begin() + given.row_start[v], given.column.begin() + given.row_start[v + 1]);
        EXPECT_EQ(vertices, expected);
    }
}

}  // namespace
}  // namespace supple
