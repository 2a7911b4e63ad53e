// Hyperelastic hexahedra: force and tangent by differences, the laws of tetrahedra at uniform strain, volumetric locking, crushed and inverted shapes.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "supple/fem/elements.h"
#include "supple/world/evaluate.h"
#include "supple/world/template_data.h"
#include "support/bodies.h"
#include "support/elements.h"

namespace supple {
namespace {

using test::Random;

struct NamedLaw {
    const char* name;
    Material material;
};

const std::vector<NamedLaw>& laws() {
    static const Fibres fibres{.fibre = {Vec3(1, 0.4, -0.2)}, .sheet = {Vec3(-0.3, 2, 0.5)}, .fibre_stiffness_pa = 800, .fibre_exponent = 2, .sheet_stiffness_pa = 300, .sheet_exponent = 0.7};
    static const std::vector<NamedLaw> all{{"StVenantKirchhoff", StVenantKirchhoff{1000, 9000}},
                                           {"NeoHookean", NeoHookean{1000, 9000}},
                                           {"StableNeoHookean", StableNeoHookean{1000, 9000}},
                                           {"MooneyRivlin", MooneyRivlin{300, 200, 1e4}},
                                           {"ArrudaBoyce", ArrudaBoyce{900, 1e4}},
                                           {"VerondaWestman", VerondaWestman{500, 2, 1e4}},
                                           {"Ogden", Ogden{{{1500, 3}, {500, -2}}, 1e4}},
                                           {"StableNeoHookean with fibres", StableNeoHookean{1000, 9000, fibres}},
                                           {"Ogden with fibres", Ogden{{{1500, 3}, {500, -2}}, 1e4, fibres}},
                                           {"Costa", Costa{800, 9000, {4, 2, 1.5, 3, 2.5, 2}, {.fibre = fibres.fibre, .sheet = fibres.sheet}}},
                                           {"Costa with fibres", Costa{800, 9000, {4, 2, 1.5, 3, 2.5, 2}, fibres}}};
    return all;
}

std::vector<Vec3> shaken(std::span<const Vec3> X, double amount, std::uint64_t seed) {
    Random random(seed);
    const Mat3 Q = random.rotation();
    std::vector<Vec3> x(X.begin(), X.end());
    for (Vec3& v : x) v = Q * (v + random.vector(amount));
    return x;
}

TEST(HexLaws, ForceIsTheDerivativeOfTheEnergyAndTangentOfTheForce) {
    const auto shape = test::irregular_hex_cube(2, 0.2, 21);
    const auto& X = shape->mesh().vertices;
    for (const NamedLaw& law : laws()) {
        for (const double amount : {0.0, 0.05, 0.12}) {  // cells of 0.5 m: up to a quarter of a cell at every vertex
            if (amount == 0 && fibres_of(law.material)->fibre_stiffness_pa > 0) continue;  // at rest fibres begin to pull: the force has a kink
            Random random(22);
            const auto x = shaken(X, amount, 23);
            std::vector<Vec3> d(X.size());
            for (Vec3& v : d) v = random.vector(1);
            const double h = 1e-6;
            std::vector<Vec3> ahead = x, behind = x;
            for (std::size_t i = 0; i < x.size(); ++i) {
                ahead[i] += h * d[i];
                behind[i] -= h * d[i];
            }
            const Evaluation here = evaluate(*shape, law.material, x), a = evaluate(*shape, law.material, ahead), b = evaluate(*shape, law.material, behind);
            double work = 0, scale = 0;
            for (std::size_t i = 0; i < x.size(); ++i) {
                work += here.forces_n[i].dot(d[i]);
                scale += std::abs(here.forces_n[i].dot(d[i]));
            }
            EXPECT_NEAR((a.energy_j - b.energy_j) / (2 * h), -work, 1e-7 * scale + 1e-5) << law.name << " " << amount;
            std::vector<Vec3> difference(x.size());
            for (std::size_t i = 0; i < x.size(); ++i) difference[i] = (a.forces_n[i] - b.forces_n[i]) / (2 * h);
            EXPECT_LT(test::relative_difference(force_differential(*shape, law.material, x, d), difference), 1e-6) << law.name << " " << amount;
        }
    }
}

TEST(HexLaws, CrushedAndInvertedPointsHaveAnEnergyToo) {
    // Points below the volume ratio 0.1, where the ratio goes on towards its floor.
    const auto shape = test::irregular_hex_cube(1, 0, 24);
    const auto& X = shape->mesh().vertices;
    for (const Material& material : {Material(StableNeoHookean{1000, 9000}), Material(StVenantKirchhoff{1000, 9000}), Material(Costa{800, 9000, {2, 1.5, 1.5, 2, 1, 2}})}) {
        for (const double squeeze : {0.15, 0.02, -0.3}) {
            std::vector<Vec3> x(X.begin(), X.end());
            Random random(25);
            for (Vec3& v : x) {
                v.z() *= v.x() > 0.5 ? squeeze : 0.9;  // one end flat or through itself, the other whole
                v += random.vector(0.02);
            }
            std::vector<Vec3> d(X.size());
            for (Vec3& v : d) v = random.vector(1);
            const double h = 1e-7;
            std::vector<Vec3> ahead = x, behind = x;
            for (std::size_t i = 0; i < x.size(); ++i) {
                ahead[i] += h * d[i];
                behind[i] -= h * d[i];
            }
            const Evaluation here = evaluate(*shape, material, x), a = evaluate(*shape, material, ahead), b = evaluate(*shape, material, behind);
            double work = 0, scale = 0;
            for (std::size_t i = 0; i < x.size(); ++i) {
                work += here.forces_n[i].dot(d[i]);
                scale += std::abs(here.forces_n[i].dot(d[i]));
            }
            EXPECT_NEAR((a.energy_j - b.energy_j) / (2 * h), -work, 1e-5 * scale) << squeeze;
        }
    }
}

TEST(HexLaws, UniformStrainGivesEnergyStressAndForcesOfTheTetrahedra) {
    VolumeMesh tets = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {2, 2, 2}});
    const auto tet_shape = BodyTemplate::build(tets);
    const auto hex_shape = test::irregular_hex_cube(2, 0.25, 26);
    Mat3 F;
    F << 1.2, 0.3, -0.1, 0.1, 0.8, 0.2, -0.2, 0.1, 1.1;
    const auto move = [&](const BodyTemplate& shape) {
        std::vector<Vec3> x;
        for (const Vec3& v : shape.mesh().vertices) x.push_back(F * v + Vec3(1, -2, 3));
        return x;
    };
    for (const NamedLaw& law : laws()) {
        const Evaluation tet = evaluate(*tet_shape, law.material, move(*tet_shape)), hex = evaluate(*hex_shape, law.material, move(*hex_shape));
        EXPECT_NEAR(hex.energy_j, tet.energy_j, 1e-11 * std::abs(tet.energy_j)) << law.name;
        double size = 0;
        for (const double s : tet.element_stress_pa[0]) size = std::max(size, std::abs(s));
        for (const Voigt& s : hex.element_stress_pa)
            for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(s[c], tet.element_stress_pa[0][c], 1e-10 * size) << law.name;
        // Patch test: the only inner vertex of either is in balance.
        for (std::size_t i = 0; i < hex.forces_n.size(); ++i) {
            const Vec3& X = hex_shape->mesh().vertices[i];
            if (X.minCoeff() > 1e-9 && X.maxCoeff() < 1 - 1e-9) {
                EXPECT_LT(hex.forces_n[i].norm(), 1e-10 * size) << law.name;
            }
        }
    }
}

TEST(HexLaws, RigidMotionsAreFreeAndForcesTurnWithTheBody) {
    const auto shape = test::irregular_hex_cube(2, 0.2, 27);
    const auto& X = shape->mesh().vertices;
    const auto bent = shaken(X, 0.08, 28);
    const Mat3 R = Random(29).rotation();
    for (const NamedLaw& law : laws()) {
        std::vector<Vec3> rigid, turned, expected;
        const auto force = evaluate(*shape, law.material, bent).forces_n;
        Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
        for (std::size_t i = 0; i < X.size(); ++i) {
            rigid.push_back(R * X[i] + Vec3(1, 2, 3));
            turned.push_back(R * bent[i] + Vec3(1, 2, 3));
            expected.push_back(R * force[i]);
            sum += force[i];
            torque += bent[i].cross(force[i]);
        }
        for (const Vec3& f : evaluate(*shape, law.material, rigid).forces_n) EXPECT_LT(f.norm(), 1e-9 * 1e4) << law.name;
        EXPECT_LT(test::relative_difference(evaluate(*shape, law.material, turned).forces_n, expected), 1e-10) << law.name;
        EXPECT_LT(sum.norm(), 1e-9) << law.name;
        EXPECT_LT(torque.norm(), 1e-9) << law.name;
    }
}

TEST(HexLaws, CostaTakesTheFrameOfEachElement) {
    // Pulled along x by the same stretch: stiff where the fibres lie along x, soft where they lie across; and the frame turned is the load turned back.
    const auto shape = test::hex_bar({2, 1, 1});
    const auto stress = [&](const std::vector<Vec3>& fibre, const std::vector<Vec3>& sheet, const Mat3& F) {
        std::vector<Vec3> x;
        for (const Vec3& v : shape->mesh().vertices) x.push_back(F * v);
        return evaluate(*shape, Costa{800, 9000, {8, 2, 1.5, 3, 2.5, 1}, {.fibre = fibre, .sheet = sheet}}, x).element_stress_pa;
    };
    const Mat3 F = Vec3(1.15, 0.95, 0.94).asDiagonal();
    const auto along = stress({Vec3::UnitX()}, {Vec3::UnitY()}, F), across = stress({Vec3::UnitY()}, {Vec3::UnitZ()}, F);
    EXPECT_GT(along[0][0], across[0][0] + 800);
    const auto each = stress({Vec3::UnitX(), Vec3::UnitY()}, {Vec3::UnitY(), Vec3::UnitZ()}, F);
    for (std::size_t c = 0; c < 6; ++c) {
        EXPECT_NEAR(each[0][c], along[0][c], 1e-9 * along[0][0]);
        EXPECT_NEAR(each[1][c], across[0][c], 1e-9 * along[0][0]);
    }
    const Mat3 Q = Eigen::AngleAxisd(M_PI / 6, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    const auto turned = stress({Q * Vec3::UnitX()}, {Q * Vec3::UnitY()}, Q * F * Q.transpose());
    const auto tensor = [](const Voigt& v) {
        Mat3 s;
        s << v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2];
        return s;
    };
    EXPECT_LT((tensor(turned[0]) - Q * tensor(along[0]) * Q.transpose()).norm(), 1e-10 * along[0][0]);
}

/// Tangent of one hex, 24 x 24.
Eigen::MatrixXd tangent(const BodyTemplate& shape, const Material& material, std::span<const Vec3> x, bool project) {
    fem::ElementsDef def;
    const fem::ElementLayout& layout = shape.data().layout;
    def.layout = &layout;
    def.project = project;
    const auto elements = fem::make_elements(def, {{material}, {}, {}});
    Team alone;
    AlignedVector<double> q(layout.blocks * 4 * fem::kBlock), corner(layout.places * 4);
    fem::seed_rotations(alone, layout, x, q);
    fem::ElementOutputs outputs;
    outputs.tangent = true;
    elements->evaluate(alone, x.data()->data(), q.data(), outputs);
    const auto n = Eigen::Index(3 * x.size());
    Eigen::MatrixXd K(n, n);
    std::vector<Vec3> out(x.size());
    for (Eigen::Index j = 0; j < n; ++j) {
        std::vector<Vec3> d(x.size(), Vec3::Zero());
        d[std::size_t(j / 3)][j % 3] = 1;
        fem::stiffness_product(alone, *elements, layout, q.data(), d, corner, out);
        for (Eigen::Index i = 0; i < n; ++i) K(i, j) = out[std::size_t(i / 3)][i % 3];
    }
    return K;
}

TEST(HexLaws, ProjectedTangentIsPositiveSemidefiniteWhereTheConsistentOneIsNot) {
    const auto shape = test::irregular_hex_cube(1, 0, 30);
    int indefinite = 0;
    for (const NamedLaw& law : laws()) {
        for (int trial = 0; trial < 10; ++trial) {
            const auto x = shaken(shape->mesh().vertices, 0.3, std::uint64_t(31 + trial));
            for (const bool project : {true, false}) {
                const Eigen::MatrixXd K = tangent(*shape, law.material, x, project);
                ASSERT_TRUE(K.allFinite()) << law.name;
                EXPECT_LT((K - K.transpose()).norm(), 1e-10 * K.norm()) << law.name;
                const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
                if (project) {
                    EXPECT_GE(values.minCoeff(), -1e-10 * values.maxCoeff()) << law.name << " trial " << trial;
                } else {
                    indefinite += values.minCoeff() < -1e-6 * values.maxCoeff();
                }
            }
        }
    }
    EXPECT_GT(indefinite, 10) << "nothing was there to be projected";
}

TEST(HexLaws, AtRestTheTangentsAgreeAndOnlyTheMeanDilatationIsStiff) {
    const auto shape = test::irregular_hex_cube(1, 0, 32);
    const auto& X = shape->mesh().vertices;
    const Eigen::MatrixXd K = tangent(*shape, NeoHookean{1, 1e6}, X, false);
    EXPECT_LT((K - tangent(*shape, NeoHookean{1, 1e6}, X, true)).norm(), 1e-11 * K.norm());
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
    EXPECT_EQ((values.array() > 1e3).count(), 1) << "more than one volume constraint locks";
    EXPECT_LT(values.head(6).cwiseAbs().maxCoeff(), 1e-9 * values[23]);
    EXPECT_GT(values[6], 0.05) << "an hourglass mode";
}

TEST(HexLaws, WithoutRegularizationTheTangentStaysConsistent) {
    const auto shape = test::irregular_hex_cube(1, 0, 30);
    const auto x = shaken(shape->mesh().vertices, 0.3, 31);
    const Eigen::MatrixXd projected = tangent(*shape, NeoHookean{1000, 9000}, x, true), consistent = tangent(*shape, NeoHookean{1000, 9000}, x, false);
    EXPECT_GT((projected - consistent).norm(), 1e-3 * consistent.norm());
    EXPECT_EQ(tangent(*shape, NeoHookean{.mu_pa = 1000, .lambda_pa = 9000, .matrix_regularization = false}, x, true), consistent);
}

TEST(HexLaws, AnyConfigurationIsFinite) {
    const auto shape = test::irregular_hex_cube(2, 0.2, 33);
    for (const NamedLaw& law : laws()) {
        for (int kind = 0; kind < 5; ++kind) {
            std::vector<Vec3> x = shape->mesh().vertices;
            Random random(34);
            for (Vec3& v : x) {
                if (kind == 0) v.y() = 0;
                if (kind == 1) v = Vec3(v.x(), 0, 0);
                if (kind == 2) v = Vec3(1, 2, 3);
                if (kind == 3) v.z() = -v.z();
                if (kind == 4) v = random.vector(1);
            }
            const Evaluation e = evaluate(*shape, law.material, x);
            EXPECT_TRUE(test::all_finite(e.forces_n)) << law.name << " " << kind;
            EXPECT_TRUE(std::isfinite(e.energy_j)) << law.name << " " << kind;
            for (const Voigt& s : e.element_stress_pa)
                for (const double c : s) EXPECT_TRUE(std::isfinite(c)) << law.name << " " << kind;
        }
    }
}

}  // namespace
}  // namespace supple
