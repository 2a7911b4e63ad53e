// Three-by-three algebra of the kernels, as plain doubles, against Eigen.
#define SUPPLE_ISA tested_lanes
#define SUPPLE_SCALAR_LANES
#include <gtest/gtest.h>

#include "supple/math/lane_eigen.h"
#include "supple/math/lane_polar.h"
#include "supple/math/polar.h"
#include "support/elements.h"

namespace supple {
namespace {

using test::Random;

M3<double> lanes_of(const Mat3& A) {
    M3<double> L;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) L.m[i][j] = A(i, j);
    return L;
}

Mat3 matrix_of(const M3<double>& L) {
    Mat3 A;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) A(i, j) = L.m[i][j];
    return A;
}

void expect_eigenvectors(const Mat3& S) {
    M3<double> values = lanes_of(S), vectors;
    symmetric_eigen(values, vectors);
    const Mat3 V = matrix_of(vectors), D = matrix_of(values);
    SCOPED_TRACE(testing::Message() << "S =\n" << S);
    EXPECT_LT((V.transpose() * V - Mat3::Identity()).norm(), 1e-14);
    EXPECT_NEAR(V.determinant(), 1, 1e-14);
    EXPECT_EQ(D, Mat3(D.diagonal().asDiagonal()));
    EXPECT_LE((V * D * V.transpose() - S).norm(), 4e-15 * S.norm());
}

TEST(MathLanes, EigenvectorsOfRandomMatrices) {
    Random random(21);
    for (int i = 0; i < 20000; ++i) {
        const Mat3 A = random.matrix(std::pow(10.0, random.uniform(-8, 8)));
        expect_eigenvectors(A + A.transpose());
    }
}

TEST(MathLanes, EigenvectorsWhereEigenvaluesMeet) {
    Random random(22);
    for (const double gap : {0.0, 1e-300, 1e-17, 1e-16, 1e-15, 1e-12, 1e-8, 1e-4, 1e-2}) {
        for (int i = 0; i < 300; ++i) {
            const Mat3 R = i % 3 == 0 ? Mat3(Mat3::Identity()) : random.rotation();
            const double size = std::pow(10.0, random.uniform(-3, 3));
            for (const Vec3& values : {Vec3(1, 1 + gap, 1 - 0.3 * gap), Vec3(1, 1 + gap, -2), Vec3(1, 1 + gap, 2), Vec3(-1, -1 - gap, 0), Vec3(1, -1, gap), Vec3(gap, 0, -gap)}) {
                const Mat3 S = size * R * values.asDiagonal() * R.transpose();
                expect_eigenvectors((S + S.transpose()) / 2);
            }
        }
    }
    expect_eigenvectors(Mat3::Zero());
    for (const double size : {1e-130, 1e130}) expect_eigenvectors(size * Mat3(Vec3(1, 2, -3).asDiagonal()));
}

/// What rounding leaves of a body at rest: the mean is then no nearer to the trace than the entries of the deviator are large.
TEST(MathLanes, EigenvectorsAFewRoundingsFromTheIdentity) {
    const double eps = std::numeric_limits<double>::epsilon();
    for (int code = 0; code < 7 * 7 * 7 * 27; ++code) {
        int rest = code;
        const auto digit = [&](int base) {
            const int d = rest % base;
            rest /= base;
            return d;
        };
        Mat3 S = Mat3::Identity();
        for (int i = 0; i < 3; ++i) {
            const int d = digit(7) - 3;
            S(i, i) += d * (d < 0 ? eps / 2 : eps);
        }
        for (int i = 0; i < 3; ++i) S(i, (i + 1) % 3) = S((i + 1) % 3, i) = (digit(3) - 1) * eps / 2;
        expect_eigenvectors(S);
    }
}

/// |R - best| after near_turn, and whether it was sure.
struct Near {
    double error;
    bool sure;
};

Near near(const Mat3& F, const Eigen::Quaterniond& start) {
    Quat<double> q{start.w(), start.x(), start.y(), start.z()};
    M3<double> R = rotation_matrix(q);
    const bool sure = near_turn(lanes_of(F), q, R);
    return {(matrix_of(R) - rotation_matrix(polar_quaternion(F))).norm(), sure};
}

TEST(MathLanes, NearStartsNeedNoTurns) {
    Random random(23);
    for (const double angle : {0.0, 1e-15, 1e-10, 1e-6, 1e-3, 1e-2, 0.05, 0.1}) {
        for (int i = 0; i < 500; ++i) {
            const Eigen::Quaterniond answer = random.quaternion();
            const Mat3 V = random.rotation();
            const Vec3 s(random.uniform(0.8, 1.25), random.uniform(0.8, 1.25), random.uniform(0.8, 1.25));
            const Mat3 F = answer.toRotationMatrix() * V * s.asDiagonal() * V.transpose();
            const Near found = near(F, answer * Eigen::Quaterniond(Eigen::AngleAxisd(angle, random.vector(1).normalized())));
            EXPECT_TRUE(found.sure) << "angle " << angle;
            EXPECT_LT(found.error, 1e-14) << "angle " << angle << ", s " << s.transpose();
        }
    }
}

TEST(MathLanes, WhereANearStartIsSureItIsRight) {
    Random random(24);
    int sure = 0, left = 0;
    for (int i = 0; i < 40000; ++i) {
        const Mat3 F = random.matrix(std::pow(10.0, random.uniform(-3, 3)));  // inverted and nearly flat ones as well
        const Eigen::Quaterniond start(Eigen::AngleAxisd(std::pow(10.0, random.uniform(-6, 0.5)), random.vector(1).normalized()));
        const auto [w, x, y, z] = polar_quaternion(F);
        const Near found = near(F, Eigen::Quaterniond(w, x, y, z) * start);
        (found.sure ? sure : left) += 1;
        if (found.sure) {
            EXPECT_LT(found.error, 1e-11) << F << "\n" << start.angularDistance(Eigen::Quaterniond::Identity());
        }
    }
    EXPECT_GT(sure, 20000);
    EXPECT_GT(left, 5000);
    // Turned by more, of no size, of a size whose powers are no numbers, and no number itself.
    const Eigen::Quaterniond none = Eigen::Quaterniond::Identity(), half(0, 1, 0, 0);
    for (const Mat3& F : {Mat3(Mat3::Zero()), Mat3(1e-60 * Mat3::Identity()), Mat3(1e60 * Mat3::Identity()), Mat3(Mat3::Constant(std::nan("")))}) EXPECT_FALSE(near(F, none).sure) << F;
    EXPECT_FALSE(near(Mat3::Identity(), half).sure);
    EXPECT_FALSE(near(-Mat3::Identity(), none).sure);
}

}  // namespace
}  // namespace supple
