// The mechanics of one linear tetrahedron: energy, force, tangent, stress.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "supple/fem/stress.h"
#include "supple/math/polar.h"
#include "supple/world/evaluate.h"
#include "support/bodies.h"
#include "support/elements.h"

namespace supple {
namespace {

using test::Random;

constexpr Corotational kSoft{.young_pa = 1000, .poisson = 0.35};

std::array<Vec3, 4> random_tet(Random& random) {
    for (;;) {
        std::array<Vec3, 4> x;
        for (Vec3& v : x) v = random.vector(1);
        if (tet_volume(x[0], x[1], x[2], x[3]) > 0.05) return x;
    }
}

Mat3 deformation_gradient(const BodyTemplate& shape, std::span<const Vec3> x) {
    const auto& X = shape.mesh().vertices;
    const Tet& t = shape.mesh().tets[0];
    Mat3 Dm, Ds;
    for (int k = 0; k < 3; ++k) {
        Dm.col(k) = X[std::size_t(t[std::size_t(k) + 1])] - X[std::size_t(t[0])];
        Ds.col(k) = x[std::size_t(t[std::size_t(k) + 1])] - x[std::size_t(t[0])];
    }
    return Ds * Dm.inverse();
}

/// Distance to the set where two signed stretches cancel and the energy has a kink.
double smoothness(const Mat3& F) {
    const Eigen::JacobiSVD<Mat3> svd(F);
    const double last = F.determinant() < 0 ? -svd.singularValues()[2] : svd.singularValues()[2];
    return svd.singularValues()[1] + last;
}

TEST(FemElement, EnergyIsThatOfTheLaw) {
    Random random(20);
    for (int i = 0; i < 200; ++i) {
        const auto X = random_tet(random);
        const auto shape = test::one_tet(X);
        std::array<Vec3, 4> x;
        for (Vec3& v : x) v = random.vector(1);
        const Mat3 F = deformation_gradient(*shape, x);
        const Mat3 R = rotation_matrix(polar_quaternion(F));
        const Lame l = lame_parameters(kSoft.young_pa, kSoft.poisson, "");
        const double trace = (R.transpose() * F).trace() - 3;
        const double W = tet_volume(X[0], X[1], X[2], X[3]) * (l.mu_pa * (F - R).squaredNorm() + l.lambda_pa / 2 * trace * trace);
        EXPECT_NEAR(evaluate(*shape, kSoft, x).energy_j, W, 1e-11 * (1 + W));
    }
}

TEST(FemElement, ForceIsMinusTheGradientOfTheEnergyAlsoInverted) {
    Random random(21);
    int inverted = 0;
    for (int i = 0; i < 400; ++i) {
        const auto shape = test::one_tet(random_tet(random));
        std::array<Vec3, 4> x;
        for (Vec3& v : x) v = random.vector(1);
        const Mat3 F = deformation_gradient(*shape, x);
        if (smoothness(F) < 0.05) continue;  // the energy has a kink there
        inverted += F.determinant() < 0;
        const auto force = evaluate(*shape, kSoft, x).forces_n;
        double size = 0;
        for (const Vec3& f : force) size = std::max(size, f.norm());
        const double h = 1e-6;
        for (std::size_t v = 0; v < 4; ++v) {
            for (int c = 0; c < 3; ++c) {
                auto plus = x, minus = x;
                plus[v][c] += h;
                minus[v][c] -= h;
                const double slope = (evaluate(*shape, kSoft, plus).energy_j - evaluate(*shape, kSoft, minus).energy_j) / (2 * h);
                EXPECT_NEAR(force[v][c], -slope, 1e-7 * size) << "det F = " << F.determinant() << ", smoothness " << smoothness(F);
            }
        }
    }
    EXPECT_GT(inverted, 100);
}

TEST(FemElement, NoNetForceAndNoNetTorque) {
    Random random(22);
    for (int i = 0; i < 500; ++i) {
        const auto shape = test::one_tet(random_tet(random));
        std::array<Vec3, 4> x;
        for (Vec3& v : x) v = random.vector(1);
        const auto force = evaluate(*shape, kSoft, x).forces_n;
        Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
        double size = 0;
        for (std::size_t a = 0; a < 4; ++a) {
            sum += force[a];
            torque += x[a].cross(force[a]);
            size = std::max(size, force[a].norm());
        }
        EXPECT_LT(sum.norm(), 1e-13 * size);
        EXPECT_LT(torque.norm(), 1e-12 * size) << "det F = " << deformation_gradient(*shape, x).determinant();
    }
}

/// df of the warped tangent, from the formula: dP = R (mu (G + G^T) + lambda tr(G) I), G = R^T dF.
std::array<Vec3, 4> warped_differential(const BodyTemplate& shape, std::span<const Vec3> x, std::span<const Vec3> d) {
    const Lame l = lame_parameters(kSoft.young_pa, kSoft.poisson, "");
    const Mat3 R = rotation_matrix(polar_quaternion(deformation_gradient(shape, x)));
    const Mat3 G = R.transpose() * deformation_gradient(shape, d);
    const Mat3 dP = R * (l.mu_pa * (G + G.transpose()) + l.lambda_pa * G.trace() * Mat3::Identity());
    const auto& X = shape.mesh().vertices;
    const Tet& t = shape.mesh().tets[0];
    Mat3 Dm;
    for (int k = 0; k < 3; ++k) Dm.col(k) = X[std::size_t(t[std::size_t(k) + 1])] - X[std::size_t(t[0])];
    const Mat3 H = -Dm.determinant() / 6 * dP * Dm.inverse().transpose();
    std::array<Vec3, 4> df;
    df.fill(Vec3::Zero());
    for (int k = 0; k < 3; ++k) {
        df[std::size_t(t[std::size_t(k) + 1])] = H.col(k);
        df[std::size_t(t[0])] -= H.col(k);
    }
    return df;
}

TEST(FemElement, DifferentialIsTheWarpedTangent) {
    Random random(23);
    for (int i = 0; i < 300; ++i) {
        const auto shape = test::one_tet(random_tet(random));
        std::array<Vec3, 4> x, d;
        for (Vec3& v : x) v = random.vector(1);
        for (Vec3& v : d) v = random.vector(1);
        if (smoothness(deformation_gradient(*shape, x)) < 1e-2) continue;  // there R itself is ill-determined
        EXPECT_LT(test::relative_difference(force_differential(*shape, kSoft, x, d), warped_differential(*shape, x, d)), 1e-11);
    }
}

TEST(FemElement, DifferentialIsSymmetricAndPushesBack) {
    Random random(24);
    for (int i = 0; i < 100; ++i) {
        const auto shape = test::one_tet(random_tet(random));
        std::array<Vec3, 4> x;
        for (Vec3& v : x) v = random.vector(1);
        Eigen::Matrix<double, 12, 12> K;
        for (std::size_t j = 0; j < 12; ++j) {
            std::array<Vec3, 4> d;
            d.fill(Vec3::Zero());
            d[j / 3][Eigen::Index(j % 3)] = 1;
            const auto df = force_differential(*shape, kSoft, x, d);
            for (std::size_t k = 0; k < 12; ++k) K(Eigen::Index(k), Eigen::Index(j)) = -df[k / 3][Eigen::Index(k % 3)];
        }
        EXPECT_LT((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-12 * K.cwiseAbs().maxCoeff());
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>> solver(K);
        const auto w = solver.eigenvalues();
        EXPECT_GT(w[0], -1e-12 * w[11]);
        EXPECT_LT(w[5], 1e-12 * w[11]);  // three translations and three turns cost nothing...
        EXPECT_GT(w[6], 1e-6 * w[11]);   // ...and nothing else is free
    }
}

TEST(FemElement, DifferentialIsTheTrueOneWhereNothingIsStrained) {
    Random random(25);
    for (int i = 0; i < 50; ++i) {
        const auto X = random_tet(random);
        const auto shape = test::one_tet(X);
        const Mat3 Q = random.rotation();
        std::array<Vec3, 4> x, d;
        for (std::size_t a = 0; a < 4; ++a) x[a] = Q * X[a] + Vec3(1, 2, 3);
        for (Vec3& v : d) v = random.vector(1);
        const double h = 1e-6;
        auto plus = x, minus = x;
        for (std::size_t a = 0; a < 4; ++a) {
            plus[a] += h * d[a];
            minus[a] -= h * d[a];
        }
        auto slope = evaluate(*shape, kSoft, plus).forces_n;
        const auto low = evaluate(*shape, kSoft, minus).forces_n;
        for (std::size_t a = 0; a < 4; ++a) slope[a] = (slope[a] - low[a]) / (2 * h);
        EXPECT_LT(test::relative_difference(force_differential(*shape, kSoft, x, d), slope), 1e-6);
    }
}

TEST(FemElement, RigidMotionMakesNoForce) {
    const auto shape = test::irregular_cube(3, 0.2, 26);
    const Lame l = lame_parameters(kSoft.young_pa, kSoft.poisson, "");
    Random random(26);
    for (int i = 0; i < 20; ++i) {
        const Mat3 Q = random.rotation();
        const Vec3 t = random.vector(2);
        std::vector<Vec3> x = shape->mesh().vertices;
        for (Vec3& v : x) v = Q * v + t;
        const Evaluation e = evaluate(*shape, kSoft, x);
        const double edge = 1.0 / 3, scale = (l.lambda_pa + 2 * l.mu_pa) * edge * edge * (1 + t.norm()) / edge;
        for (const Vec3& f : e.forces_n) EXPECT_LT(f.norm(), 1e-12 * scale);
        EXPECT_LT(e.energy_j, 1e-20 * scale);
        for (const Voigt& s : e.element_stress_pa) EXPECT_LT(von_mises(s), 1e-10 * l.mu_pa);
    }
}

TEST(FemElement, ForceTurnsWithTheBody) {
    const auto shape = test::irregular_cube(2, 0.2, 27);
    Random random(27);
    std::vector<Vec3> x = shape->mesh().vertices;
    for (Vec3& v : x) v += random.vector(0.2);
    const auto force = evaluate(*shape, kSoft, x).forces_n;
    for (int i = 0; i < 10; ++i) {
        const Mat3 Q = random.rotation();
        std::vector<Vec3> turned = x, expected = force;
        for (Vec3& v : turned) v = Q * v + Vec3(0.3, -0.2, 0.1);
        for (Vec3& f : expected) f = Q * f;
        EXPECT_LT(test::relative_difference(evaluate(*shape, kSoft, turned).forces_n, expected), 1e-12);
    }
}

TEST(FemElement, AllTwentyFourVertexOrdersGiveTheSameForce) {
    Random random(28);
    const auto X = random_tet(random);
    std::array<Vec3, 4> x, d;
    for (Vec3& v : x) v = random.vector(1);
    for (Vec3& v : d) v = random.vector(1);
    const auto plain = test::one_tet(X);
    const Evaluation reference = evaluate(*plain, kSoft, x);
    const auto df = force_differential(*plain, kSoft, x, d);
    Tet order{0, 1, 2, 3};
    int orders = 0, rewound = 0;
    do {
        VolumeMesh mesh;
        mesh.vertices.assign(X.begin(), X.end());
        mesh.tets = {order};
        const auto shape = BodyTemplate::build(mesh);
        rewound += shape->report().flipped == 1;
        const Evaluation e = evaluate(*shape, kSoft, x);
        EXPECT_LT(test::relative_difference(e.forces_n, reference.forces_n), 1e-12);
        EXPECT_LT(test::relative_difference(force_differential(*shape, kSoft, x, d), df), 1e-12);
        EXPECT_NEAR(e.energy_j, reference.energy_j, 1e-12 * reference.energy_j);
        for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(e.element_stress_pa[0][c], reference.element_stress_pa[0][c], 1e-12 * von_mises(reference.element_stress_pa[0]));
        ++orders;
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_EQ(orders, 24);
    EXPECT_EQ(rewound, 12);
}

// -- stress ------------------------------------------------------------------------------------------

Voigt stress_of(const Mat3& F) {
    const auto x = test::unit_tet_at(F, {0.1, 0.2, 0.3});
    return evaluate(*test::unit_tet(), kSoft, x).element_stress_pa[0];
}

void expect_voigt(const Voigt& got, const Voigt& expected) {
    for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(got[c], expected[c], 1e-10) << "component " << c;
}

TEST(FemStress, UniaxialStrain) {
    const Lame l = lame_parameters(kSoft.young_pa, kSoft.poisson, "");
    const double e = 0.1, along = (l.lambda_pa + 2 * l.mu_pa) * e, across = l.lambda_pa * e;
    expect_voigt(stress_of(Vec3(1 + e, 1, 1).asDiagonal()), {along, across, across, 0, 0, 0});
    expect_voigt(stress_of(Vec3(1, 1 + e, 1).asDiagonal()), {across, along, across, 0, 0, 0});
    expect_voigt(stress_of(Vec3(1, 1, 1 + e).asDiagonal()), {across, across, along, 0, 0, 0});
    EXPECT_NEAR(von_mises(stress_of(Vec3(1 + e, 1, 1).asDiagonal())), 2 * l.mu_pa * e, 1e-10);
}

TEST(FemStress, UniaxialStressHasYoungsModulus) {
    const double e = 0.05;
    expect_voigt(stress_of(Vec3(1 + e, 1 - 0.35 * e, 1 - 0.35 * e).asDiagonal()), {1000 * e, 0, 0, 0, 0, 0});
}

TEST(FemStress, PureShearInEachPlaneHasTensorComponents) {
    const Lame l = lame_parameters(kSoft.young_pa, kSoft.poisson, "");
    const double half = 0.05;  // half the engineering shear
    const std::array<std::array<int, 2>, 3> planes{{{0, 1}, {1, 2}, {2, 0}}};
    for (std::size_t p = 0; p < 3; ++p) {
        Mat3 F = Mat3::Identity();
        F(planes[p][0], planes[p][1]) = F(planes[p][1], planes[p][0]) = half;
        Voigt expected{};
        expected[3 + p] = 2 * l.mu_pa * half;
        expect_voigt(stress_of(F), expected);
        EXPECT_NEAR(von_mises(stress_of(F)), std::sqrt(3.0) * 2 * l.mu_pa * half, 1e-10);
    }
}

TEST(FemStress, CauchyTensorTurnsWithTheElement) {
    Random random(30);
    for (int i = 0; i < 100; ++i) {
        const Mat3 A = 0.2 * random.matrix(1), U = Mat3::Identity() + 0.5 * (A + A.transpose()), Q = random.rotation();
        const auto tensor = [](const Voigt& s) {
            Mat3 S;
            S << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
            return S;
        };
        EXPECT_LT((tensor(stress_of(Q * U)) - Q * tensor(stress_of(U)) * Q.transpose()).norm(), 1e-9);
    }
}

TEST(FemStress, VonMisesOfKnownStates) {
    EXPECT_DOUBLE_EQ(von_mises({5, 0, 0, 0, 0, 0}), 5);
    EXPECT_DOUBLE_EQ(von_mises({0, -5, 0, 0, 0, 0}), 5);
    EXPECT_DOUBLE_EQ(von_mises({7, 7, 7, 0, 0, 0}), 0);
    EXPECT_DOUBLE_EQ(von_mises({0, 0, 0, 0, 2, 0}), 2 * std::sqrt(3.0));
    Random random(31);
    for (int i = 0; i < 50; ++i) {
        const Mat3 A = random.matrix(10), S = A + A.transpose(), deviator = S - S.trace() / 3 * Mat3::Identity();
        EXPECT_NEAR(von_mises({S(0, 0), S(1, 1), S(2, 2), S(0, 1), S(1, 2), S(2, 0)}), std::sqrt(1.5 * deviator.squaredNorm()), 1e-12 * S.norm());
    }
}

TEST(FemStress, VertexStressIsTheVolumeWeightedMeanOfTheTensors) {
    const auto shape = test::irregular_cube(2, 0.3, 32);
    Random random(32);
    std::vector<Vec3> x = shape->mesh().vertices;
    for (Vec3& v : x) v += random.vector(0.1);
    const Evaluation e = evaluate(*shape, kSoft, x);
    const auto& mesh = shape->mesh();
    std::vector<Voigt> sum(x.size(), Voigt{});
    std::vector<double> volume(x.size(), 0);
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const auto X = [&](std::size_t a) { return mesh.vertices[std::size_t(mesh.tets[t][a])]; };
        const double V = tet_volume(X(0), X(1), X(2), X(3));
        for (const std::int32_t v : mesh.tets[t]) {
            volume[std::size_t(v)] += V;
            for (std::size_t c = 0; c < 6; ++c) sum[std::size_t(v)][c] += V * e.element_stress_pa[t][c];
        }
    }
    for (std::size_t v = 0; v < x.size(); ++v)
        for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(e.vertex_stress_pa[v][c], sum[v][c] / volume[v], 1e-9);
}

// -- whole meshes ------------------------------------------------------------------------------------

TEST(FemPatch, AnAffineMapOfAnIrregularMeshIsInEquilibriumWithUniformStress) {
    const auto shape = test::irregular_cube(4, 0.25, 33);
    Random random(33);
    const Lame l = lame_parameters(kSoft.young_pa, kSoft.poisson, "");
    for (const double strain : {1e-6, 0.3}) {
        const Mat3 F = random.rotation() * (Mat3::Identity() + strain * random.matrix(1));
        std::vector<Vec3> x = shape->mesh().vertices;
        for (Vec3& v : x) v = F * v;
        const Evaluation e = evaluate(*shape, kSoft, x);
        const Mat3 R = rotation_matrix(polar_quaternion(F));
        const Mat3 G = R.transpose() * F, small = 0.5 * (G + G.transpose()) - Mat3::Identity();
        const Mat3 sigma = R * (2 * l.mu_pa * small + l.lambda_pa * small.trace() * Mat3::Identity()) * R.transpose();
        const Voigt expected{sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(2, 0)};
        for (const Voigt& s : e.element_stress_pa)
            for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(s[c], expected[c], 1e-11 * l.mu_pa);
        for (const Voigt& s : e.vertex_stress_pa)
            for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(s[c], expected[c], 1e-11 * l.mu_pa);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Vec3& X = shape->mesh().vertices[i];
            if (X.minCoeff() > 1e-9 && X.maxCoeff() < 1 - 1e-9) {
                EXPECT_LT(e.forces_n[i].norm(), 1e-12 * l.mu_pa) << "inner vertex " << i;
            }
        }
    }
}

TEST(FemEvaluate, RefusesWrongCountsAndBadNumbers) {
    const auto shape = test::unit_tet();
    std::vector<Vec3> x = shape->mesh().vertices;
    const auto refused = [&](const Material& material, std::span<const Vec3> positions, std::span<const Vec3> direction, const char* where) {
        try {
            (void)force_differential(*shape, material, positions, direction);
            ADD_FAILURE() << where;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
            EXPECT_EQ(e.where(), where);
        }
    };
    refused(kSoft, std::span(x).first(3), x, "positions_m");
    refused(kSoft, x, std::span(x).first(3), "direction_m");
    refused(Corotational{.young_pa = -1}, x, x, "material.young_pa");
    refused(Corotational{.poisson = 0.5}, x, x, "material.poisson");
    auto bad = x;
    bad[2][1] = std::nan("");
    refused(kSoft, bad, x, "positions_m");
    refused(kSoft, x, bad, "direction_m");
    EXPECT_THROW(evaluate(*shape, kSoft, bad), Error);
}

}  // namespace
}  // namespace supple
