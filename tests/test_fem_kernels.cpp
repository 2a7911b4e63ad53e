// The kernels of every instruction set against the scalar ones, the assembled matrix against the matrix-free product, rest data.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "supple/fem/assembly_order.h"
#include "supple/solve/bsr3.h"
#include "supple/solve/bsr3_kernels.h"
#include "supple/world/template_data.h"
#include "support/elements.h"

namespace supple {
namespace {

using test::Elements;
using test::Random;

constexpr Lame kLame{2.8e5, 7.1e4};

template <class A, class B>
double relative_difference(const A& a, const B& b) {
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
        difference = std::max(difference, std::abs(double(a[i]) - double(b[i])));
        size = std::max(size, std::abs(double(b[i])));
    }
    return difference / size;
}

/// 162 elements, not a multiple of eight: the tail is under test too.
struct Deformed {
    std::shared_ptr<const BodyTemplate> shape = test::irregular_cube(3, 0.2, 40);
    std::vector<Vec3> x = shape->mesh().vertices;
    solve::Bsr3Pattern pattern = solve::make_pattern(x.size(), shape->mesh().tets);  // and elements in the order of the mesh
    solve::GatherMap pairs = solve::make_gather_map(pattern, solve::Fours(shape->mesh().tets));
    explicit Deformed(double amount) {
        Random random(41);
        const Mat3 Q = random.rotation();
        for (Vec3& v : x) v = Q * (v + random.vector(amount));
    }
    const VolumeMesh& mesh() const { return shape->mesh(); }
};

constexpr fem::Frame kEveryFrame[] = {fem::Frame::rest, fem::Frame::large, fem::Frame::polar, fem::Frame::svd};

TEST(FemKernels, EveryInstructionSetAgreesWithScalarInEveryFrame) {
    const Deformed body(0.05);
    for (const fem::Frame frame : kEveryFrame) {
        Elements oracle(body.mesh().vertices, body.mesh().tets, kLame);
        ASSERT_NE(oracle.rest.elements % fem::kBlock, 0u);
        oracle.run(Isa::scalar, body.x, frame);
        for (const Isa isa : test::supported_isas()) {
            SCOPED_TRACE(testing::Message() << name(isa) << ", frame " << int(frame));
            Elements wide(body.mesh().vertices, body.mesh().tets, kLame);
            wide.run(isa, body.x, frame);
            EXPECT_LT(relative_difference(wide.corner, oracle.corner), 1e-12);
            EXPECT_LT(relative_difference(wide.energy, oracle.energy), 1e-12);
            EXPECT_LT(relative_difference(wide.stress, oracle.stress), 1e-12);
            EXPECT_LT(relative_difference(wide.quaternion, oracle.quaternion), 1e-12);
            EXPECT_LT(relative_difference(wide.record_d, oracle.record_d), 1e-12);
            EXPECT_LT(relative_difference(wide.record_f, oracle.record_f), 1e-6);
        }
    }
}

TEST(FemKernels, SingularValuesAndPolarFactorGiveTheSameElements) {
    const Deformed body(0.1);
    for (const Isa isa : test::supported_isas()) {
        Elements polar(body.mesh().vertices, body.mesh().tets, kLame), svd(body.mesh().vertices, body.mesh().tets, kLame);
        polar.run(isa, body.x, fem::Frame::polar);
        svd.run(isa, body.x, fem::Frame::svd);
        EXPECT_LT(relative_difference(svd.corner, polar.corner), 1e-11) << name(isa);
        EXPECT_LT(relative_difference(svd.energy, polar.energy), 1e-11) << name(isa);
    }
}

TEST(FemKernels, DegenerateElementsStayFiniteInEveryFrame) {
    const auto shape = test::irregular_cube(3, 0.2, 47);
    const auto& X = shape->mesh().vertices;
    for (int shape_of_x = 0; shape_of_x < 4; ++shape_of_x) {
        std::vector<Vec3> x = X;
        for (Vec3& v : x) {
            if (shape_of_x == 0) v.y() = 0;                   // flat
            if (shape_of_x == 1) v = Vec3(v.x(), 0, 0);       // a line
            if (shape_of_x == 2) v = Vec3(1, 2, 3);           // a point
            if (shape_of_x == 3) v.z() = -v.z();              // mirrored
        }
        for (const fem::Frame frame : kEveryFrame) {
            for (const Isa isa : test::supported_isas()) {
                Elements e(X, shape->mesh().tets, kLame);
                e.run(isa, x, frame);
                for (const double f : e.corner) ASSERT_TRUE(std::isfinite(f)) << "frame " << int(frame) << ", " << name(isa) << ", shape " << shape_of_x;
                for (const double q : e.quaternion) ASSERT_TRUE(std::isfinite(q)) << "frame " << int(frame) << ", " << name(isa) << ", shape " << shape_of_x;
                for (const double s : e.stress) ASSERT_TRUE(std::isfinite(s)) << "frame " << int(frame) << ", " << name(isa) << ", shape " << shape_of_x;
            }
        }
    }
}

TEST(FemKernels, LanesPastTheLastElementAddNothing) {
    const Deformed body(0.05);
    for (const Isa isa : test::supported_isas()) {
        Elements e(body.mesh().vertices, body.mesh().tets, kLame);
        e.run(isa, body.x);
        for (std::size_t i = e.rest.elements; i < e.rest.blocks() * fem::kBlock; ++i) {
            EXPECT_EQ(e.energy[i], 0);
            for (std::size_t a = 0; a < 4; ++a) EXPECT_EQ(e.force(i, a), Vec3::Zero());
        }
    }
}

TEST(FemKernels, EmptyRangesAndNullOutputsAreAllowed) {
    const Deformed body(0.05);
    for (const Isa isa : test::supported_isas()) {
        Elements e(body.mesh().vertices, body.mesh().tets, kLame);
        const auto before = e.quaternion;
        fem::Tet4Pass pass;
        pass.vertex = e.rest.vertex.data();
        pass.gradient = e.rest.gradient.data();
        pass.volume = e.rest.volume.data();
        pass.moduli = e.moduli.data();
        pass.position = body.x.data()->data();
        pass.quaternion = e.quaternion.data();
        fem::tet4_kernels(isa).elements[std::size_t(fem::Frame::polar)](pass, 3, 3);
        EXPECT_EQ(e.quaternion, before);
        fem::tet4_kernels(isa).elements[std::size_t(fem::Frame::polar)](pass, 0, 1);
        EXPECT_NE(e.quaternion, before);
        EXPECT_TRUE(std::equal(before.begin() + 4 * fem::kBlock, before.end(), e.quaternion.begin() + 4 * fem::kBlock)) << "wrote outside its range";
    }
}

/// K field, by the product kernel of one instruction set.
std::vector<Vec3> product(Isa isa, const Deformed& body, Elements& e, std::span<const Vec3> field) {
    Team alone;
    const fem::ElementLayout layout = fem::make_layout(body.mesh());
    std::vector<Vec3> out(field.size());
    fem::Tet4Product pass;
    pass.quaternion = e.quaternion.data();
    pass.field = field.data()->data();
    fem::run_product(alone, {e.rest, layout.groups[0].sums, e.moduli, fem::tet4_kernels(isa)}, pass, e.corner.data());
    fem::gather(alone, layout.forces, e.corner, out);
    return out;
}

TEST(FemKernels, ProductOfEveryInstructionSetAgreesWithScalar) {
    const Deformed body(0.05);
    Random random(42);
    std::vector<Vec3> field(body.x.size());
    for (Vec3& v : field) v = random.vector(1);
    Elements oracle(body.mesh().vertices, body.mesh().tets, kLame);
    oracle.run(Isa::scalar, body.x);
    const auto expected = product(Isa::scalar, body, oracle, field);
    for (const Isa isa : test::supported_isas()) {
        EXPECT_LT(test::relative_difference(product(isa, body, oracle, field), expected), 1e-12) << name(isa);
    }
}

/// The matrix that a step assembles, by the kernels of one instruction set.
template <class Real>
AlignedVector<Real> assembled(Isa isa, const Deformed& body, const Elements& e, const AlignedVector<Real>& record, double scale,
                              const std::vector<double>& shift, bool uniform) {
    std::vector<double> laplacian(body.pattern.blocks(), 0.0);
    for (std::size_t b = 0; b < body.pattern.blocks(); ++b)
        for (std::int64_t i = body.pairs.start[b]; i < body.pairs.start[b + 1]; ++i)
            laplacian[b] += fem::laplacian_entry(e.rest, e.moduli, body.pairs.pair[std::size_t(i)]);
    AlignedVector<Real> value(body.pattern.blocks() * 12, Real(-1));
    fem::Tet4Assembly<Real> pass;
    const fem::MatrixPattern pattern{body.pattern.row_start, body.pattern.column, body.pattern.mirror};
    const fem::AssemblyOrder order = fem::make_assembly_order(pattern, {body.pairs.start, body.pairs.pair}, pattern.rows());  // one chunk
    std::vector<double> ordered;
    for (const std::uint32_t block : order.block) ordered.push_back(laplacian[block]);
    pass.above = order.chunks[0].diagonal;
    pass.diagonal = order.chunks[0].last - order.chunks[0].diagonal;
    pass.block = order.block.data();
    pass.partner = order.partner.data();
    pass.count = order.count.data();
    pass.contribution = order.contribution.data();
    pass.laplacian = ordered.data();
    pass.uniform = uniform;
    pass.ratio = kLame.lambda_pa / kLame.mu_pa;
    pass.record = record.data();
    pass.diagonal_shift = shift.data();
    pass.stiffness_scale = scale;
    pass.value = value.data();
    if constexpr (sizeof(Real) == 4) {
        fem::tet4_kernels(isa).assemble_f(pass);
    } else {
        fem::tet4_kernels(isa).assemble_d(pass);
    }
    return value;
}

TEST(FemKernels, AssembledMatrixEqualsTheMatrixFreeProduct) {
    const Deformed body(0.05);
    const solve::Bsr3Pattern& pattern = body.pattern;
    Elements e(body.mesh().vertices, body.mesh().tets, kLame);
    e.run(Isa::scalar, body.x);
    Random random(43);
    std::vector<Vec3> field(body.x.size());
    for (Vec3& v : field) v = random.vector(1);
    std::vector<double> shift(body.x.size());
    for (double& s : shift) s = random.uniform(1, 2);
    const double scale = 1e-4;
    auto expected = product(Isa::scalar, body, e, field);
    for (std::size_t i = 0; i < field.size(); ++i) expected[i] = scale * expected[i] + shift[i] * field[i];

    const auto check = [&](Isa isa, const auto& value, double tolerance) {
        std::vector<Vec3> y(field.size(), Vec3::Zero());
        for (std::size_t row = 0; row < pattern.rows; ++row) {
            for (std::int32_t b = pattern.row_start[row]; b < pattern.row_start[row + 1]; ++b) {
                const auto* block = value.data() + std::size_t(b) * 12;
                const Vec3& x = field[std::size_t(pattern.column[std::size_t(b)])];
                for (int c = 0; c < 3; ++c) {
                    for (int i = 0; i < 3; ++i) y[row][i] += double(block[4 * c + i]) * x[c];
                    EXPECT_EQ(block[4 * c + 3], 0) << "the pad must stay zero";
                }
            }
        }
        EXPECT_LT(test::relative_difference(y, expected), tolerance) << name(isa);
    };
    const auto oracle = assembled<double>(Isa::scalar, body, e, e.record_d, scale, shift, false);
    for (const Isa isa : test::supported_isas())
    for (const bool uniform : {false, true}) {
        SCOPED_TRACE(testing::Message() << name(isa) << (uniform ? ", one ratio of moduli" : ", any moduli"));
        const auto wide = assembled<double>(isa, body, e, e.record_d, scale, shift, uniform);
        EXPECT_LT(relative_difference(wide, oracle), 1e-12) << name(isa);
        check(isa, wide, 1e-12);
        const auto single = assembled<float>(isa, body, e, e.record_f, scale, shift, uniform);
        EXPECT_LT(relative_difference(single, oracle), 1e-5) << name(isa);
        check(isa, single, 1e-5);
        // The mirrors hold the transposed numbers, to the bit.
        for (std::size_t b = 0; b < pattern.blocks(); ++b) {
            const std::size_t m = std::size_t(pattern.mirror[b]);
            if (m == b) continue;
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(wide[b * 12 + 4 * c + i], wide[m * 12 + 4 * i + c]);
        }
    }
}

TEST(FemKernels, DifferentialOfAWholeMeshIsSymmetricAndPositiveSemidefinite) {
    const Deformed body(0.15);
    Elements e(body.mesh().vertices, body.mesh().tets, kLame);
    e.run(best_isa(), body.x);
    const auto n = Eigen::Index(3 * body.x.size());
    Eigen::MatrixXd K(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        std::vector<Vec3> d(body.x.size(), Vec3::Zero());
        d[std::size_t(j / 3)][j % 3] = 1;
        const auto Kd = product(best_isa(), body, e, d);
        for (Eigen::Index i = 0; i < n; ++i) K(i, j) = Kd[std::size_t(i / 3)][i % 3];
    }
    EXPECT_LT((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-13 * K.cwiseAbs().maxCoeff());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, Eigen::EigenvaluesOnly);
    EXPECT_GT(solver.eigenvalues()[0], -1e-12 * solver.eigenvalues()[n - 1]);
    // Trace of the diagonal blocks, which the drag springs use.
    std::vector<double> at_rest(body.x.size(), 0.0);
    fem::add_stiffness_trace(e.rest, e.moduli, at_rest);
    for (std::size_t v = 0; v < body.x.size(); ++v) {
        const auto i = Eigen::Index(3 * v);
        EXPECT_NEAR((K.block<3, 3>(i, i).trace()), at_rest[v], 1e-12 * at_rest[v]) << "a rotation does not change it";
    }
}

TEST(FemRest, GradientsReproduceLinearFieldsAndVolumesAddUp) {
    const Deformed body(0);
    Elements e(body.mesh().vertices, body.mesh().tets, kLame);
    Random random(44);
    const Mat3 A = random.matrix(1);
    double volume = 0;
    for (std::size_t t = 0; t < e.rest.elements; ++t) {
        volume += e.rest.volume[t];
        Mat3 gradient = Mat3::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
            const double* g = e.rest.gradient.data() + (t / fem::kBlock * 9 + 3 * k) * fem::kBlock + t % fem::kBlock;
            const auto X = [&](std::size_t a) { return body.mesh().vertices[std::size_t(body.mesh().tets[t][a])]; };
            gradient += A * (X(k + 1) - X(0)) * Vec3(g[0], g[fem::kBlock], g[2 * fem::kBlock]).transpose();
        }
        EXPECT_LT((gradient - A).norm(), 1e-12);
    }
    EXPECT_NEAR(volume, 1, 1e-13);
    double mass = 0;
    for (const double m : fem::lumped_mass(body.mesh(), std::vector<double>{1234})) mass += m;
    EXPECT_NEAR(mass, 1234, 1e-9);
}

TEST(FemRest, ModuliFollowTheirElements) {
    const Deformed body(0);
    const fem::Tet4Rest rest = fem::make_rest(body.mesh().vertices, body.mesh().tets);
    std::vector<Lame> lame(rest.elements);
    for (std::size_t e = 0; e < lame.size(); ++e) lame[e] = {double(e), double(1000 + e)};
    const auto moduli = fem::make_moduli(rest.blocks(), lame);
    for (std::size_t e = 0; e < lame.size(); ++e) {
        EXPECT_EQ(moduli[e / fem::kBlock * 2 * fem::kBlock + e % fem::kBlock], double(e));
        EXPECT_EQ(moduli[(e / fem::kBlock * 2 + 1) * fem::kBlock + e % fem::kBlock], double(1000 + e));
    }
}

TEST(FemCorners, MapIsTheTransposeOfTheElementList) {
    const Deformed body(0);
    const fem::ElementMap map = fem::make_element_map(body.mesh());
    std::size_t corners = 0;
    for (std::size_t v = 0; v < body.x.size(); ++v) {
        for (std::int64_t i = map.start[v]; i < map.start[v + 1]; ++i, ++corners) {
            const std::int32_t element = map.element[std::size_t(i)];
            const Tet& tet = body.mesh().tets[std::size_t(element)];
            EXPECT_NE(std::find(tet.begin(), tet.end(), std::int32_t(v)), tet.end());
            if (i > map.start[v]) {
                EXPECT_LT(map.element[std::size_t(i - 1)], element);
            }
        }
    }
    EXPECT_EQ(corners, body.mesh().tets.size() * 4);
}

TEST(FemCorners, SumsByChunksAreTheSumsOverTheCorners) {
    const Deformed body(0);
    const fem::Tet4Rest rest = fem::make_rest(body.mesh().vertices, body.mesh().tets);
    Random random(47);
    AlignedVector<double> corner(rest.blocks() * fem::kBlock * 16);
    std::vector<Vec3> expected(body.x.size(), Vec3::Zero());
    for (std::size_t e = 0; e < rest.elements; ++e) {
        for (std::size_t a = 0; a < 4; ++a) {
            for (std::size_t c = 0; c < 3; ++c) {
                corner[(e * 4 + a) * 4 + c] = double(random.vector(8).array().round()[0]);  // whole numbers: sums are exact in any order
                expected[std::size_t(body.mesh().tets[e][a])][Eigen::Index(c)] += corner[(e * 4 + a) * 4 + c];
            }
        }
    }
    for (const std::size_t chunk : {std::size_t(1), std::size_t(3), fem::kCornerChunk}) {
        const fem::CornerSums sums = fem::make_corner_sums(rest, chunk);
        AlignedVector<double> sum(sums.vertex.size() * 4, 1e9);
        for (std::size_t begin = 0; begin < rest.blocks(); begin += chunk) {
            sums.add_up(corner.data() + begin * fem::kBlock * 16, begin, sum.data() + 4 * sums.first[begin / chunk]);
        }
        std::vector<Vec3> total(body.x.size(), Vec3::Zero());
        for (std::size_t k = 0; k < sums.vertex.size(); ++k) total[std::size_t(sums.vertex[k])] += Vec3(sum[4 * k], sum[4 * k + 1], sum[4 * k + 2]);
        for (std::size_t v = 0; v < total.size(); ++v) EXPECT_EQ(total[v], expected[v]) << "chunks of " << chunk << ", vertex " << v;
    }
}

template <class Real>
void check_row_kernels(double tolerance) {
    const auto shape = test::irregular_cube(3, 0.2, 45);
    const solve::Bsr3Pattern& p = shape->data().pattern;
    Random random(46);
    AlignedVector<Real> value(p.blocks() * 12), x(p.rows * 4), b(p.rows * 4), inverse(p.rows * 12);
    const auto fill = [&](AlignedVector<Real>& v) {
        for (std::size_t i = 0; i < v.size(); ++i) v[i] = i % 4 == 3 ? Real(0) : Real(random.uniform(-1, 1));
    };
    for (auto* v : {&value, &x, &b, &inverse}) fill(*v);
    const auto& oracle = solve::bsr3_kernels<Real>(Isa::scalar);
    AlignedVector<Real> y(x.size()), y1(x.size());
    const double dot = oracle.multiply(p.row_start.data(), p.column.data(), value.data(), x.data(), y.data(), 0, p.rows);
    for (const Isa isa : test::supported_isas()) {
        SCOPED_TRACE(name(isa));
        const auto& kernels = solve::bsr3_kernels<Real>(isa);
        EXPECT_NEAR(kernels.multiply(p.row_start.data(), p.column.data(), value.data(), x.data(), y1.data(), 0, p.rows), dot, tolerance * double(p.rows));
        EXPECT_LT(relative_difference(y1, y), tolerance);
        auto d0 = x, r0 = b, d1 = x, r1 = b;
        const double rr = oracle.advance(Real(0.3), b.data(), y.data(), d0.data(), r0.data(), 0, p.rows);
        EXPECT_NEAR(kernels.advance(Real(0.3), b.data(), y.data(), d1.data(), r1.data(), 0, p.rows), rr, tolerance * rr);
        EXPECT_LT(relative_difference(d1, d0), tolerance);
        EXPECT_LT(relative_difference(r1, r0), tolerance);
        AlignedVector<Real> z0(x.size()), z1(x.size());
        const double rz = oracle.block_diagonal(inverse.data(), b.data(), z0.data(), 0, p.rows);
        EXPECT_NEAR(kernels.block_diagonal(inverse.data(), b.data(), z1.data(), 0, p.rows), rz, tolerance * double(p.rows));
        EXPECT_LT(relative_difference(z1, z0), tolerance);
        auto p0 = x, p1 = x;
        oracle.turn(Real(0.7), b.data(), p0.data(), 0, p.rows);
        kernels.turn(Real(0.7), b.data(), p1.data(), 0, p.rows);
        EXPECT_LT(relative_difference(p1, p0), tolerance);
    }
}

TEST(SolveKernels, EveryInstructionSetAgreesWithScalarInDouble) { check_row_kernels<double>(1e-13); }
TEST(SolveKernels, EveryInstructionSetAgreesWithScalarInSingle) { check_row_kernels<float>(1e-5); }

}  // namespace
}  // namespace supple
