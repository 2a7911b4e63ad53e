// Costa's law in its frame, and fibres on every law. Row numbers are those of the verification table in the README.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "supple/base/error.h"
#include "supple/world/world.h"
#include "support/bodies.h"
#include "support/laws.h"

namespace supple {
namespace {

using test::difference_errors;
using test::OneTet;
using test::Random;

const Mat3 kTurn30 = Eigen::AngleAxisd(M_PI / 6, Vec3::UnitZ()).toRotationMatrix();
constexpr std::array<double, 6> kTissue{8, 4, 2, 4, 3, 2};

Fibres two_families() {
    return {.fibre = {Vec3(1, 0.4, -0.2)}, .sheet = {Vec3(-0.3, 2, 0.5)}, .fibre_stiffness_pa = 800, .fibre_exponent = 2, .sheet_stiffness_pa = 300, .sheet_exponent = 0.7};
}

std::vector<std::pair<std::string, Material>> with_fibres(const Fibres& f) {
    constexpr double la = 9000;
    return {{"StVenantKirchhoff", StVenantKirchhoff{1000, la, f}}, {"NeoHookean", NeoHookean{1000, la, f}},       {"StableNeoHookean", StableNeoHookean{1000, la, f}},
            {"MooneyRivlin", MooneyRivlin{300, 200, 1e4, f}},      {"ArrudaBoyce", ArrudaBoyce{900, 1e4, f}},     {"VerondaWestman", VerondaWestman{500, 2, 1e4, f}},
            {"Ogden", Ogden{{{1500, 3}, {500, -2}}, 1e4, f}},      {"Costa", Costa{1000, la, kTissue, f}}};
}

Mat3 tensor(const Voigt& s) {
    Mat3 S;
    S << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    return S;
}

TEST(Costa, Row9ATurnedFrameIsATurnedLoad) {
    const OneTet tet;
    Random random(1);
    for (int trial = 0; trial < 10; ++trial) {
        const Mat3 F = Mat3::Identity() + random.matrix(0.2);
        const Fibres turned{.fibre = {kTurn30.col(0)}, .sheet = {kTurn30.col(1)}};
        const Mat3 straight = tensor(tet.stress(Costa{1000, 9000, kTissue}, kTurn30.transpose() * F * kTurn30));
        const Mat3 in_frame = tensor(tet.stress(Costa{1000, 9000, kTissue, turned}, F));
        EXPECT_LT((in_frame - kTurn30 * straight * kTurn30.transpose()).norm(), 1e-10 * straight.norm());
        const Mat3 ignored = tensor(tet.stress(Costa{1000, 9000, kTissue}, F));
        EXPECT_GT((in_frame - ignored).norm(), 1e-3 * straight.norm()) << "the frame does nothing";
    }
}

TEST(Costa, Row9PureShearsInTheFrameAreABHalf) {
    const OneTet tet;
    Random random(2);
    const Mat3 Q0 = random.rotation();
    const Fibres frame{.fibre = {3 * Q0.col(0)}, .sheet = {Q0.col(1) + 0.5 * Q0.col(0)}};  // neither unit nor orthogonal
    constexpr std::array<double, 6> b{7, 1, 5, 2, 3, 4};
    const int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    const double expected[3] = {1, 2, 3};  // fs fn sn
    for (int k = 0; k < 3; ++k) {
        const Vec3 u = Q0.col(pairs[k][0]), v = Q0.col(pairs[k][1]);
        const Mat3 F = Mat3::Identity() + 0.5e-6 * (u * v.transpose() + v * u.transpose());  // gamma = 1e-6
        const Mat3 sigma = tensor(tet.stress(Costa{1000, 9000, b, frame}, F));
        EXPECT_NEAR(u.dot(sigma * v) / 1e-6, 1000 * expected[k] / 2, 0.05);
    }
    for (int k = 0; k < 3; ++k) {
        const double axis[3] = {7, 5, 4};
        const Vec3 u = Q0.col(k);
        const Mat3 sigma = tensor(tet.stress(Costa{1000, 9000, b, frame}, Mat3::Identity() + 1e-6 * u * u.transpose()));
        EXPECT_NEAR(u.dot(sigma * u) / 1e-6, 1000 * axis[k] + 9000, 0.5) << "C_ii = a b_ii + K";
        const Vec3 w = Q0.col((k + 1) % 3);
        EXPECT_NEAR(w.dot(sigma * w) / 1e-6, 9000, 0.5) << "C_ij = K";
    }
}

TEST(Costa, TheSheetDefaultsToYAndToZAlongAYFibre) {
    const OneTet tet;
    Random random(3);
    const Mat3 F = Mat3::Identity() + random.matrix(0.2);
    const auto stress = [&](std::vector<Vec3> fibre, std::vector<Vec3> sheet) {
        return tensor(tet.stress(Costa{1000, 9000, {7, 1, 5, 2, 3, 4}, {.fibre = std::move(fibre), .sheet = std::move(sheet)}}, F));
    };
    EXPECT_EQ(stress({}, {}), stress({Vec3::UnitX()}, {Vec3::UnitY()}));
    EXPECT_EQ(stress({Vec3::UnitZ()}, {}), stress({Vec3::UnitZ()}, {Vec3::UnitY()}));
    EXPECT_EQ(stress({Vec3::UnitY()}, {}), stress({Vec3::UnitY()}, {Vec3::UnitZ()}));
}

/// Guccione's law has no J^-4/3: at J = 1 the energies are equal, and the stresses differ by a pressure.
TEST(Costa, IsGucciones_LawWhereVolumeStays) {
    const OneTet tet;
    constexpr double C = 2000, bf = 8, bt = 2, bfs = 4;
    Random random(4);
    Mat3 F = Mat3::Identity() + random.matrix(0.2);
    F /= std::cbrt(F.determinant());
    const Mat3 E = 0.5 * (F.transpose() * F - Mat3::Identity());
    const double Q = bf * E(0, 0) * E(0, 0) + bt * (E(1, 1) * E(1, 1) + E(2, 2) * E(2, 2) + 2 * E(1, 2) * E(1, 2)) +
                     2 * bfs * (E(0, 1) * E(0, 1) + E(0, 2) * E(0, 2));
    Mat3 B;
    B << bf, bfs, bfs, bfs, bt, bt, bfs, bt, bt;
    const Mat3 S = C * std::exp(Q) * B.cwiseProduct(E);
    const Material costa = Costa{C, 1e4, {bf, bfs, bt, bfs, bt, bt}};
    EXPECT_NEAR(evaluate(*tet.shape, costa, tet.at(F)).energy_j / tet.volume, C / 2 * (std::exp(Q) - 1), 1e-9 * C);
    const Mat3 difference = tensor(tet.stress(costa, F)) - F * S * F.transpose();
    EXPECT_LT((difference - difference.trace() / 3 * Mat3::Identity()).norm(), 1e-9 * C);
}

TEST(Fibres, UniaxialStretchHasTheClosedForm) {
    const OneTet tet;
    const Fibres along_x{.fibre = {Vec3(2, 0, 0)}, .fibre_stiffness_pa = 500, .fibre_exponent = 1.5};
    for (const auto& [name, material] : with_fibres(along_x)) {
        const Material plain = std::visit([](auto m) -> Material {
            if constexpr (requires { m.fibres; }) m.fibres = Fibres{};
            return m;
        }, material);
        for (const double stretch : {0.7, 1.0, 1.05, 1.4}) {
            const Mat3 F = Vec3(stretch, 1.1, 0.9).asDiagonal();
            const Evaluation with = evaluate(*tet.shape, material, tet.at(F)), without = evaluate(*tet.shape, plain, tet.at(F));
            const double x = std::max(stretch * stretch - 1, 0.0), growth = std::exp(1.5 * x * x);
            EXPECT_NEAR((with.energy_j - without.energy_j) / tet.volume, 500 / 3.0 * (growth - 1), 1e-9 * 500 * growth) << name << " at " << stretch;
            const double J = F.determinant(), sigma = 2 * 500 * x * growth * stretch * stretch / J;
            EXPECT_NEAR(with.element_stress_pa[0][0] - without.element_stress_pa[0][0], sigma, 1e-9 * (1e3 + sigma)) << name << " at " << stretch;
            for (std::size_t c = 1; c < 6; ++c) EXPECT_NEAR(with.element_stress_pa[0][c], without.element_stress_pa[0][c], 1e-8) << name;
        }
    }
}

TEST(Fibres, Row2And3ForceAndTangentOfEveryLaw) {
    const OneTet tet;
    std::mt19937 random(7);
    for (const auto& [name, material] : with_fibres(two_families())) {
        int stretched = 0;
        for (int trial = 0; trial < 30; ++trial) {
            const Mat3 F = Mat3::Identity() + test::random_matrix(random, 0.3);
            if (F.determinant() < 0.3) continue;
            const double I4 = (F * Vec3(1, 0.4, -0.2).normalized()).squaredNorm(), I6 = (F * Vec3(-0.3, 2, 0.5).normalized()).squaredNorm();
            if (std::abs(I4 - 1) < 1e-3 || std::abs(I6 - 1) < 1e-3) continue;  // the tangent jumps where a fibre begins to pull
            stretched += I4 > 1 && I6 > 1;
            const auto [force, tangent] = difference_errors(tet, material, F, random);
            EXPECT_LT(force, 2e-7) << name << "\n" << F;
            EXPECT_LT(tangent, 1e-6) << name << "\n" << F;
        }
        EXPECT_GT(stretched, 2) << name;
    }
}

/// Random, flat, collapsed and inverted elements; frames and fibres in any direction; stretches at which exponentials overflow.
TEST(Fibres, AnyConfigurationGivesFiniteForceAndPositiveProjectedTangent) {
    const OneTet tet;
    Random random(5);
    for (const auto& [name, material] : with_fibres(two_families())) {
        for (int trial = 0; trial < 150; ++trial) {
            Mat3 F = random.matrix(trial % 3 == 0 ? 3.0 : 1.0);
            if (trial % 5 == 0) F.col(2) = F.col(1);
            if (trial % 7 == 0) F.setZero();
            if (trial % 11 == 0) F = -Mat3::Identity();
            if (trial % 13 == 0) F *= 100;
            const auto x = tet.at(F);
            const Evaluation e = evaluate(*tet.shape, material, x);
            for (const Vec3& f : e.forces_n) ASSERT_TRUE(f.allFinite()) << name << "\n" << F;
            for (const double s : e.element_stress_pa[0]) ASSERT_TRUE(std::isfinite(s)) << name << "\n" << F;
            const auto K = test::element_stiffness(material, x, true);
            ASSERT_TRUE(K.allFinite()) << name << "\n" << F;
            ASSERT_LT(K.cwiseAbs().maxCoeff(), 1e37) << name << ": does not fit into float32\n" << F;
            EXPECT_LT((K - K.transpose()).norm(), 1e-10 * (1e-12 + K.norm())) << name;
            const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
            EXPECT_GE(values.minCoeff(), -1e-10 * values.maxCoeff()) << name << "\n" << F;
        }
    }
}

TEST(Fibres, LargeExponentsGoOnSmoothly) {
    const OneTet tet;
    std::mt19937 random(9);
    const Material stiff = NeoHookean{1000, 9000, {.fibre = {Vec3::UnitX()}, .fibre_stiffness_pa = 1000, .fibre_exponent = 40}};
    double last = 0;
    for (double stretch = 1.2; stretch < 2; stretch += 0.01) {  // the exponent passes 30 at 1.366
        const Mat3 F = Vec3(stretch, 1, 1).asDiagonal();
        const double s = tet.stress(stiff, F)[0];
        EXPECT_GT(s, last) << "at " << stretch;
        last = s;
        const auto [force, tangent] = difference_errors(tet, stiff, F, random);
        EXPECT_LT(force, 1e-6) << "at " << stretch;
        EXPECT_LT(tangent, 1e-6) << "at " << stretch;
    }
    for (const Material& law : {Material(Costa{.b = {50, 50, 50, 50, 50, 50}}), Material(VerondaWestman{.c2 = 60})}) {
        for (double stretch = 1.2; stretch < 2.4; stretch += 0.05) {
            const auto [force, tangent] = difference_errors(tet, law, Vec3(stretch, 1, 1.05).asDiagonal(), random);
            EXPECT_LT(force, 1e-6) << "at " << stretch;
            EXPECT_LT(tangent, 1e-6) << "at " << stretch;
        }
    }
}

TEST(Fibres, DirectionsMayDifferFromElementToElement) {
    const auto shape = test::bar({2, 1, 1});
    const std::size_t n = shape->mesh().element_count();
    std::vector<Vec3> x = shape->mesh().vertices;
    for (Vec3& v : x) v[0] *= 1.2;
    Fibres f{.fibre_stiffness_pa = 1e4};
    for (std::size_t e = 0; e < n; ++e) f.fibre.push_back(e % 2 == 0 ? Vec3::UnitX() : Vec3::UnitY());
    const auto stress = evaluate(*shape, NeoHookean{.fibres = f}, x).element_stress_pa;
    const auto plain = evaluate(*shape, NeoHookean{}, x).element_stress_pa;
    Fibres frames;
    for (std::size_t e = 0; e < n; ++e) frames.fibre.push_back(e % 2 == 0 ? Vec3::UnitX() : Vec3::UnitY());
    const Material costa = Costa{.b = {9, 2, 2, 2, 2, 2}, .fibres = frames};
    const auto of_costa = evaluate(*shape, costa, x).element_stress_pa;
    for (std::size_t e = 0; e < n; ++e) {
        EXPECT_EQ(stress[e][0] - plain[e][0] > 1e3, e % 2 == 0) << "element " << e;
        const Material alone = Costa{.b = {9, 2, 2, 2, 2, 2}, .fibres = {.fibre = {frames.fibre[e]}}};
        EXPECT_NEAR(of_costa[e][0], evaluate(*shape, alone, x).element_stress_pa[e][0], 1e-6) << "element " << e;
    }
}

/// The projection may slow Newton down, it must not move what Newton finds.
TEST(Fibres, RegularizationDoesNotChangeTheEquilibrium) {
    const auto tip = [&](const Material& material) {
        WorldDef def;
        def.time_step_s = 0.05;
        def.solver.newton_iterations = 8;
        def.solver.rayleigh_mass_1_s = 20;
        def.solver.precision = Precision::double_;
        def.threads = 1;
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar({6, 2, 2}), .material = material});
        world.fix(body, test::at_x(0));
        EXPECT_TRUE(test::run_to_rest(world, 1e-7, 4000));
        return test::mean_position(world, body, test::at_x(0.4));
    };
    const Fibres fibres{.fibre = {Vec3::UnitX()}, .fibre_stiffness_pa = 4e4};
    for (const bool costa : {false, true}) {
        const auto material = [&](bool regular) {
            return costa ? Material(Costa{.b = kTissue, .fibres = fibres, .matrix_regularization = regular}) : Material(NeoHookean{.fibres = fibres, .matrix_regularization = regular});
        };
        const Vec3 with = tip(material(true)), without = tip(material(false));
        EXPECT_LT((with - without).norm(), 1e-6);
        EXPECT_LT(with[1], 0.045) << "it hangs";
    }
    // And the key does something: the exact tangent of a squeezed element is indefinite.
    const OneTet tet;
    const auto x = tet.at(Vec3(0.5, 0.7, 1).asDiagonal());
    for (const Material& law : {Material(StVenantKirchhoff{.matrix_regularization = false}), Material(Costa{.matrix_regularization = false})}) {
        const auto values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(test::element_stiffness(law, x, true))).eigenvalues();
        EXPECT_LT(values.minCoeff(), -1e-3 * values.maxCoeff());
    }
}

TEST(Fibres, BadDirectionsAreNamed) {
    const auto refused = [](const Material& m, const std::string& where) {
        try {
            check_material(m, 3);
            ADD_FAILURE() << where << " was accepted";
        } catch (const Error& e) {
            EXPECT_EQ(e.where(), where);
            EXPECT_FALSE(e.message().empty());
        }
    };
    const Vec3 x = Vec3::UnitX();
    refused(NeoHookean{.fibres = {.fibre_stiffness_pa = 1}}, "material.fibre_stiffness_pa");
    refused(NeoHookean{.fibres = {.fibre = {x}, .fibre_stiffness_pa = -1}}, "material.fibre_stiffness_pa");
    refused(NeoHookean{.fibres = {.fibre = {x}}}, "material.fibre");
    refused(NeoHookean{.fibres = {.fibre = {x, x}, .fibre_stiffness_pa = 1}}, "material.fibre");
    refused(NeoHookean{.fibres = {.fibre = {Vec3::Zero()}, .fibre_stiffness_pa = 1}}, "material.fibre");
    refused(Ogden{.fibres = {.fibre = {x, x, Vec3(0, NAN, 0)}, .fibre_stiffness_pa = 1}}, "material.fibre[2]");
    refused(NeoHookean{.fibres = {.fibre = {x}, .fibre_stiffness_pa = 1, .fibre_exponent = 0}}, "material.fibre_exponent");
    refused(StVenantKirchhoff{.fibres = {.sheet = {x}, .sheet_stiffness_pa = NAN}}, "material.sheet_stiffness_pa");
    refused(Costa{.fibres = {.fibre = {x}, .sheet = {-2 * x}}}, "material.sheet");
    refused(Costa{.fibres = {.sheet = {x}}}, "material.sheet");
}

}  // namespace
}  // namespace supple
