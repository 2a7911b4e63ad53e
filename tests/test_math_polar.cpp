// The rotation of an element: the lanes' Newton iteration against the oracle, and the oracle against the singular value decomposition.
#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "supple/math/isa.h"
#include "supple/math/polar.h"
#include "support/elements.h"

namespace supple {
namespace {

using test::Random;

Mat3 rotation_by_svd(const Mat3& F) {
    const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 flip = Mat3::Identity();
    flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    return svd.matrixU() * flip * svd.matrixV().transpose();
}

/// The second smallest signed singular value sum; the rotation is unique where it is above zero.
double uniqueness(const Mat3& F) {
    const Eigen::JacobiSVD<Mat3> svd(F);
    const double last = F.determinant() < 0 ? -svd.singularValues()[2] : svd.singularValues()[2];
    return svd.singularValues()[1] + last;
}

double objective(const Mat3& R, const Mat3& F) { return (R.transpose() * F).trace(); }

struct Case {
    const char* name;
    Mat3 F;
    std::array<double, 4> start;
};

std::array<double, 4> wxyz(const Eigen::Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }

std::vector<std::pair<Isa, fem::Frame>> every_way() {
    std::vector<std::pair<Isa, fem::Frame>> ways;
    for (const Isa isa : test::supported_isas()) {
        for (const fem::Frame frame : {fem::Frame::polar, fem::Frame::svd}) ways.emplace_back(isa, frame);
    }
    return ways;
}

/// Runs every case on every instruction set and checks what a rotation must be.
void check_cases(const std::vector<Case>& cases) {
    std::vector<Vec3> rest_vertices, positions;
    std::vector<Tet> tets;
    for (const Case& c : cases) {
        const std::int32_t first = std::int32_t(rest_vertices.size());
        for (const Vec3& x : test::unit_tet_at(Mat3::Identity())) rest_vertices.push_back(x);
        for (const Vec3& x : test::unit_tet_at(c.F)) positions.push_back(x);
        tets.push_back({first, first + 1, first + 2, first + 3});
    }
    for (const auto& [isa, frame] : every_way()) {
        SCOPED_TRACE(testing::Message() << name(isa) << (frame == fem::Frame::svd ? ", singular values" : ", warm start"));
        test::Elements elements(rest_vertices, tets, {1, 1});
        for (std::size_t i = 0; i < cases.size(); ++i) elements.set_quaternion(i, cases[i].start);
        elements.run(isa, positions, frame);
        for (std::size_t i = 0; i < cases.size(); ++i) {
            const Case& c = cases[i];
            SCOPED_TRACE(testing::Message() << c.name << " (case " << i << "), F =\n" << c.F << "\nstart " << c.start[0] << " " << c.start[1] << " "
                                            << c.start[2] << " " << c.start[3]);
            const auto q = elements.wxyz(i);
            const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
            ASSERT_NEAR(norm, 1, 1e-13);
            const Mat3 R = rotation_matrix(q);
            EXPECT_LT((R.transpose() * R - Mat3::Identity()).norm(), 1e-12);
            EXPECT_NEAR(R.determinant(), 1, 1e-12);
            const Mat3 best = rotation_matrix(polar_quaternion(c.F));
            EXPECT_GE(objective(R, c.F), objective(best, c.F) - 1e-12 * c.F.norm());
            if (uniqueness(c.F) > 1e-2 * c.F.norm()) {
                EXPECT_LT((R - best).norm(), 1e-10);
            }
        }
    }
}

constexpr std::array<double, 4> kNoTurn{1, 0, 0, 0};

TEST(MathPolar, OracleIsTheRotationOfTheSingularValueDecomposition) {
    Random random(1);
    for (int i = 0; i < 2000; ++i) {
        const Mat3 F = random.matrix(std::pow(10.0, random.uniform(-6, 6)));
        if (uniqueness(F) < 1e-3 * F.norm()) continue;
        const auto q = polar_quaternion(F);
        EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-14);
        EXPECT_LT((rotation_matrix(q) - rotation_by_svd(F)).norm(), 1e-10) << F;
    }
}

TEST(MathPolar, OracleIsFiniteForFlatCollapsedAndHugeMatrices) {
    Random random(2);
    std::vector<Mat3> hard{Mat3::Zero(), Mat3::Constant(1), -Mat3::Identity(), 1e150 * Mat3::Identity(), 1e-150 * Mat3::Identity()};
    for (int i = 0; i < 100; ++i) hard.push_back(random.vector(1) * random.vector(1).transpose());
    for (const Mat3& F : hard) {
        const Mat3 R = rotation_matrix(polar_quaternion(F));
        EXPECT_LT((R.transpose() * R - Mat3::Identity()).norm(), 1e-13) << F;
        EXPECT_NEAR(R.determinant(), 1, 1e-13);
    }
}

TEST(MathPolar, RotationMatrixTurnsAsEigenDoes) {
    Random random(3);
    for (int i = 0; i < 100; ++i) {
        const Eigen::Quaterniond q = random.quaternion();
        EXPECT_LT((rotation_matrix(wxyz(q)) - q.toRotationMatrix()).norm(), 1e-14);
    }
}

TEST(MathPolar, RandomMatricesFromNoTurn) {
    Random random(4);
    std::vector<Case> cases;
    for (int i = 0; i < 4000; ++i) cases.push_back({"random", random.matrix(std::pow(10.0, random.uniform(-3, 3))), kNoTurn});
    check_cases(cases);
}

TEST(MathPolar, RandomMatricesFromFarStarts) {
    Random random(5);
    std::vector<Case> cases;
    for (int i = 0; i < 4000; ++i) cases.push_back({"random, far start", random.matrix(1), wxyz(random.quaternion())});
    check_cases(cases);
}

TEST(MathPolar, InvertedElements) {
    Random random(6);
    std::vector<Case> cases;
    for (int i = 0; i < 1000; ++i) {
        // Signed stretches with one negative: a tet pushed through its own face.
        const Vec3 s(random.uniform(0.5, 2), random.uniform(0.5, 2), -random.uniform(0.01, 2));
        cases.push_back({"inverted", random.rotation() * s.asDiagonal() * random.rotation(), wxyz(random.quaternion())});
    }
    cases.push_back({"mirrored", Vec3(1, 1, -1).asDiagonal().toDenseMatrix(), kNoTurn});
    cases.push_back({"point mirrored", -Mat3::Identity(), kNoTurn});
    check_cases(cases);
}

TEST(MathPolar, FlatLineAndCollapsedElements) {
    Random random(7);
    std::vector<Case> cases;
    for (int i = 0; i < 500; ++i) {
        const Mat3 U = random.rotation(), V = random.rotation();
        const double a = random.uniform(0.1, 2), b = random.uniform(0.1, 2);
        cases.push_back({"flat", U * Vec3(a, b, 0).asDiagonal() * V, wxyz(random.quaternion())});
        cases.push_back({"nearly flat", U * Vec3(a, b, random.uniform(-1e-9, 1e-9)).asDiagonal() * V, wxyz(random.quaternion())});
        cases.push_back({"line", U * Vec3(a, 0, 0).asDiagonal() * V, wxyz(random.quaternion())});
    }
    cases.push_back({"collapsed", Mat3::Zero(), kNoTurn});
    cases.push_back({"collapsed, turned", Mat3::Zero(), wxyz(random.quaternion())});
    cases.push_back({"all corners on a diagonal", Mat3::Constant(1), kNoTurn});
    check_cases(cases);
}

TEST(MathPolar, TinyAndHugeMatrices) {
    Random random(8);
    std::vector<Case> cases;
    for (const double size : {1e-140, 1e-30, 1e-12, 1e12, 1e30, 1e140}) {
        for (int i = 0; i < 50; ++i) cases.push_back({"scaled", size * random.matrix(1), wxyz(random.quaternion())});
    }
    check_cases(cases);
}

TEST(MathPolar, HalfTurnsAreNoTrap) {
    // A half turn away from the answer the gradient vanishes: a minimum or a saddle, where an ascent may stand still.
    Random random(9);
    std::vector<Case> cases;
    const Eigen::Quaterniond half_turns[] = {{0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}, {0, std::sqrt(0.5), std::sqrt(0.5), 0}, {0, 0.6, 0, 0.8}};
    for (const Eigen::Quaterniond& turn : half_turns) {
        cases.push_back({"identity, half turn", Mat3::Identity(), wxyz(turn)});
        cases.push_back({"stretched, half turn", Vec3(1.2, 1, 0.9).asDiagonal().toDenseMatrix(), wxyz(turn)});
        cases.push_back({"inverted, half turn", Vec3(1.2, 1, -0.5).asDiagonal().toDenseMatrix(), wxyz(turn)});
        cases.push_back({"the turn itself", turn.toRotationMatrix(), kNoTurn});
        for (int i = 0; i < 20; ++i) {
            const Mat3 R = random.rotation();
            const Mat3 U = R * Vec3(random.uniform(0.5, 2), random.uniform(0.5, 2), random.uniform(0.5, 2)).asDiagonal() * R.transpose();
            const Eigen::Quaterniond answer = random.quaternion();
            cases.push_back({"half turn of a stretch", answer.toRotationMatrix() * U, wxyz(answer * Eigen::Quaterniond(R) * turn * Eigen::Quaterniond(R).conjugate())});
        }
    }
    check_cases(cases);
}

TEST(MathPolar, NearHalfTurns) {
    Random random(10);
    std::vector<Case> cases;
    for (const double miss : {1e-15, 1e-12, 1e-8, 1e-4, 1e-2, 0.1}) {
        for (int i = 0; i < 50; ++i) {
            const Eigen::Quaterniond answer = random.quaternion();
            const Vec3 axis = random.vector(1).normalized();
            const Eigen::Quaterniond start = answer * Eigen::Quaterniond(Eigen::AngleAxisd(EIGEN_PI - miss, axis));
            cases.push_back({"nearly a half turn", answer.toRotationMatrix(), wxyz(start)});
        }
    }
    check_cases(cases);
}

TEST(MathPolar, WarmStartKeepsItsAnswer) {
    // At the optimum already: the answer must not wander, or a resting body would creep.
    Random random(11);
    std::vector<Case> cases;
    for (int i = 0; i < 200; ++i) {
        const Mat3 F = random.matrix(1);
        cases.push_back({"settled", F, polar_quaternion(F)});
    }
    check_cases(cases);
}

TEST(MathPolar, NotANumberInOneLaneLeavesTheOthersAlone) {
    std::vector<Vec3> rest_vertices, positions;
    std::vector<Tet> tets;
    Random random(12);
    std::vector<Mat3> F;
    for (std::int32_t i = 0; i < 8; ++i) {
        F.push_back(random.matrix(1));
        if (i == 3) F.back()(1, 1) = std::nan("");
        for (const Vec3& x : test::unit_tet_at(Mat3::Identity())) rest_vertices.push_back(x);
        for (const Vec3& x : test::unit_tet_at(F.back())) positions.push_back(x);
        tets.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
    }
    for (const Isa isa : test::supported_isas()) {
        test::Elements elements(rest_vertices, tets, {1, 1});
        elements.run(isa, positions);
        for (std::size_t i = 0; i < 8; ++i) {
            if (i == 3) continue;
            const Mat3 R = rotation_matrix(elements.wxyz(i));
            EXPECT_GE(objective(R, F[i]), objective(rotation_matrix(polar_quaternion(F[i])), F[i]) - 1e-12 * F[i].norm()) << name(isa) << ", lane " << i;
        }
    }
}

TEST(MathIsa, ScalarAndBaselineAlwaysWorkAndTheBestIsSupported) {
    EXPECT_TRUE(is_supported(Isa::scalar));
    EXPECT_TRUE(is_supported(Isa::baseline));
    EXPECT_TRUE(is_supported(best_isa()));
    for (const Isa isa : kAllIsas) {
        if (is_supported(isa)) {
            EXPECT_LE(int(isa), int(best_isa()));
        }
        EXPECT_NE(name(isa), "unknown");
    }
    EXPECT_EQ(name(Isa::avx512), "avx512");
}

}  // namespace
}  // namespace supple
