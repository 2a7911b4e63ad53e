// Hyperelastic laws against closed forms and finite differences. Row numbers are those of the verification table in the README.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <random>

#include "supple/base/error.h"
#include "supple/world/world.h"
#include "support/laws.h"

namespace supple {
namespace {

using test::difference_errors;
using test::kCorners;
using test::OneTet;
using test::random_matrix;

struct LawCase {
    std::string name;
    Material material;
    std::array<double, 4> uniaxial;  // P11 [Pa] at stretch 0.8, 1.1, 1.2, 1.5
    std::array<double, 2> shear;     // sigma12 [Pa] at 0.2, 0.5
};

/// The calibration set mu = 1000, K = 10000.
std::vector<LawCase> calibrated() {
    constexpr double la = 28000.0 / 3;
    return {
        {"ArrudaBoyce", ArrudaBoyce{1000 / 1.0851367078791743, 1e4}, {-744.463, 264.013, 486.983, 1014.258}, {200.238, 503.757}},
        {"MooneyRivlin", MooneyRivlin{300, 200, 1e4}, {-810.969, 254.839, 455.375, 875.697}, {200, 500}},
        {"NeoHookean", NeoHookean{1000, la}, {-725.973, 266.189, 494.085, 1040.508}, {200, 500}},
        {"Ogden", Ogden{{{2000, 3}}, 1e4}, {-718.592, 270.760, 513.495, 1165.972}, {201.661, 525.494}},
        {"StVenantKirchhoff", StVenantKirchhoff{1000, la}, {-418.065, 335.323, 766.452, 2721.774}, {245.333, 1208.333}},
        {"VerondaWestman", VerondaWestman{500, 2, 1e4}, {-992.988, 312.808, 748.606, 3407.888}, {233.315, 1148.721}},
        {"StableNeoHookean", StableNeoHookean{1000, la}, {-724.698, 266.283, 494.355, 1041.219}, {200, 500}},
        {"Costa", Costa{1000, la}, {-723.416, 303.634, 687.806, 3467.824}, {216.662, 827.991}},
    };
}

TEST(Laws, Row6UniaxialTractionFreeSides) {
    const OneTet tet;
    constexpr double stretch[4] = {0.8, 1.1, 1.2, 1.5};
    for (const LawCase& law : calibrated()) {
        for (std::size_t k = 0; k < 4; ++k) {
            double low = 0.5, high = 1.5;  // lateral stretch by bisection: sigma22 rises with it
            for (int i = 0; i < 100; ++i) {
                const double t = 0.5 * (low + high);
                (tet.stress(law.material, Vec3(stretch[k], t, t).asDiagonal())[1] > 0 ? high : low) = t;
            }
            const double P11 = tet.stress(law.material, Vec3(stretch[k], low, low).asDiagonal())[0] * low * low;
            EXPECT_NEAR(P11, law.uniaxial[k], 1e-5 * std::abs(law.uniaxial[k])) << law.name << " at " << stretch[k];
        }
    }
}

TEST(Laws, Row7SimpleShear) {
    const OneTet tet;
    constexpr double gamma[2] = {0.2, 0.5};
    for (const LawCase& law : calibrated()) {
        for (std::size_t k = 0; k < 2; ++k) {
            Mat3 F = Mat3::Identity();
            F(0, 1) = gamma[k];
            const Voigt s = tet.stress(law.material, F);
            EXPECT_NEAR(s[3], law.shear[k], 1e-5 * law.shear[k]) << law.name;
            EXPECT_NEAR(s[0] - s[1], gamma[k] * s[3], 1e-8 * law.shear[k]) << law.name << ": Rivlin's relation";
        }
    }
}

TEST(Laws, Row8Hydrostatic) {
    const OneTet tet;
    constexpr double mu = 1000, la = 28000.0 / 3, K = 1e4;
    for (const double s : {0.8, 1.3}) {
        const double J = s * s * s, L = std::log(J), al = 1 + mu / (la + mu);
        for (const LawCase& law : calibrated()) {
            double expected = K * L / J;
            if (law.name == "NeoHookean") expected = (la * L + mu * (s * s - 1)) / J;
            if (law.name == "StVenantKirchhoff") expected = (3 * la + 2 * mu) * (s * s - 1) / (2 * s);
            if (law.name == "StableNeoHookean") expected = mu * s * s / J + (la + mu) * (J - al);
            if (law.name == "Costa") {
                const double b = 2, E = (s * s - 1) / 2, Qb = 3 * b * E * E * std::pow(J, -4.0 / 3);
                expected = mu * b * std::exp(Qb) * std::pow(J, -7.0 / 3) * E + la * L;
                EXPECT_NEAR(expected, s == 0.8 ? -9007.2807 : 7487.4006, 1e-4);
            }
            EXPECT_NEAR(tet.stress(law.material, s * Mat3::Identity())[0], expected, 1e-9 * std::abs(expected)) << law.name << " at " << s;
        }
    }
}

TEST(Laws, Row4SmallStrainModuli) {
    const OneTet tet;
    for (const LawCase& law : calibrated()) {
        const Lame lame = small_strain(law.material);
        EXPECT_NEAR(lame.mu_pa, 1000, 1e-3) << law.name;
        EXPECT_NEAR(lame.lambda_pa + 2 * lame.mu_pa / 3, 1e4, 1e-2) << law.name;
        Mat3 F = Mat3::Identity();
        F(0, 1) = 1e-6;
        EXPECT_NEAR(tet.stress(law.material, F)[3] / 1e-6, 1000, 0.1) << law.name;
        EXPECT_NEAR(tet.stress(law.material, (1 + 1e-6) * Mat3::Identity())[0] / 3e-6, 1e4, 1) << law.name;
    }
}

TEST(Laws, RestHasNoEnergyAndNoForce) {
    const OneTet tet;
    for (const LawCase& law : calibrated()) {
        const Evaluation e = evaluate(*tet.shape, law.material, tet.at(Mat3::Identity()));
        EXPECT_NEAR(e.energy_j, 0, 1e-10) << law.name;
        for (const Vec3& f : e.forces_n) EXPECT_LT(f.norm(), 1e-9) << law.name;
    }
}

TEST(Laws, Row2And3ForceAndTangentByDifferences) {
    const OneTet tet;
    std::mt19937 random(7);
    for (const LawCase& law : calibrated()) {
        for (int trial = 0; trial < 20; ++trial) {
            const Mat3 F = Mat3::Identity() + random_matrix(random, 0.25);
            if (F.determinant() < 0.3) continue;
            const auto [force, tangent] = difference_errors(tet, law.material, F, random);
            EXPECT_LT(force, 2e-7) << law.name << "\n" << F;
            EXPECT_LT(tangent, 1e-6) << law.name << "\n" << F;
        }
    }
}

TEST(Laws, EqualStretchesNeedNoLimit) {
    const OneTet tet;
    std::mt19937 random(3);
    for (const LawCase& law : calibrated()) {
        for (const double gap : {0.0, 1e-12, 1e-7, 1e-5, 3e-4}) {
            Mat3 F = Vec3(1.2 + gap, 1.2, 1.2 - gap).asDiagonal();
            F = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix() * F;
            const auto [force, tangent] = difference_errors(tet, law.material, F, random);
            EXPECT_LT(force, 2e-7) << law.name << " gap " << gap;
            EXPECT_LT(tangent, 1e-6) << law.name << " gap " << gap;
        }
    }
}

TEST(Laws, InvertedForceIsTheGradientOfItsEnergy) {
    const OneTet tet;
    std::mt19937 random(11);
    int tested = 0;
    for (const LawCase& law : calibrated()) {
        for (int trial = 0; trial < 60; ++trial) {
            const Mat3 F = random_matrix(random, 1.2);
            const Eigen::Vector3d s = F.jacobiSvd().singularValues();
            // Finite differences need a smooth spot: away from the floor of the extension and from s2 = -s3.
            const double s3 = F.determinant() < 0 ? -s[2] : s[2];
            const auto near_floor = [](double x) { return std::abs(x - 0.1) < 1e-3 || std::abs(x - 0.3) < 1e-3; };
            if (near_floor(s3) || near_floor(s[1]) || (s3 < 0 && s[1] + s3 < 0.05)) continue;
            ++tested;
            EXPECT_LT(difference_errors(tet, law.material, F, random).first, 1e-6) << law.name << "\n" << F;
        }
    }
    EXPECT_GT(tested, 200);
}

TEST(Laws, AnyConfigurationGivesFiniteForceAndPositiveProjectedTangent) {
    const OneTet tet;
    std::mt19937 random(5);
    for (const LawCase& law : calibrated()) {
        for (int trial = 0; trial < 300; ++trial) {
            Mat3 F = random_matrix(random, trial % 3 == 0 ? 3.0 : 1.0);
            if (trial % 5 == 0) F.col(2) = F.col(1);            // flat
            if (trial % 7 == 0) F.setZero();                    // a point
            if (trial % 11 == 0) F = -Mat3::Identity();         // inside out
            const auto x = tet.at(F);
            const Evaluation e = evaluate(*tet.shape, law.material, x);
            for (const Vec3& f : e.forces_n) ASSERT_TRUE(f.allFinite()) << law.name << "\n" << F;
            for (const double s : e.element_stress_pa[0]) ASSERT_TRUE(std::isfinite(s)) << law.name << "\n" << F;

            const auto K = test::element_stiffness(law.material, x, true);
            ASSERT_TRUE(K.allFinite()) << law.name << "\n" << F;
            EXPECT_LT((K - K.transpose()).norm(), 1e-10 * (1e-12 + K.norm())) << law.name;
            const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
            EXPECT_GE(values.minCoeff(), -1e-10 * values.maxCoeff()) << law.name << "\n" << F;
        }
    }
}

TEST(Laws, FlattenedAndInvertedBodyRecoversItsShape) {
    const auto shape = BodyTemplate::build([] {
        VolumeMesh mesh;
        mesh.vertices = kCorners;
        mesh.tets = {{0, 1, 2, 3}};
        return mesh;
    }());
    for (const Material& material : {Material(StableNeoHookean{1000, 9000}), Material(NeoHookean{1000, 9000}), Material(VerondaWestman{500, 2, 1e4}), Material(Costa{1000, 9000})}) {
        WorldDef def;
        def.gravity_m_s2 = Vec3::Zero();
        def.time_step_s = 0.01;
        def.solver.rayleigh_mass_1_s = 2;
        World world(def);
        const BodyId body = world.add_body({.shape = shape, .material = material});
        auto x = kCorners;
        x[3] = Vec3(0.3, 0.3, -0.6);  // through the opposite face
        world.set_state(body, x, std::vector<Vec3>(4, Vec3::Zero()));
        for (int i = 0; i < 2000; ++i) EXPECT_EQ(world.step().flags & StepFlag::non_finite, StepFlag::none);
        for (std::size_t a = 0; a < 4; ++a) {
            for (std::size_t b = 0; b < a; ++b) {
                EXPECT_NEAR((world.positions(body)[a] - world.positions(body)[b]).norm(), (kCorners[a] - kCorners[b]).norm(), 1e-3);
            }
        }
    }
}

TEST(Laws, BadParametersAreNamed) {
    const auto refused = [](const Material& m, const std::string& where) {
        try {
            check_material(m, 4);
            ADD_FAILURE() << where << " was accepted";
        } catch (const Error& e) {
            EXPECT_EQ(e.where(), where);
        }
    };
    refused(NeoHookean{-1, 1}, "material.mu_pa");
    refused(NeoHookean{3, -2}, "material.lambda_pa");
    refused(StVenantKirchhoff{0, 1}, "material.mu_pa");
    refused(StableNeoHookean{std::nan(""), 1}, "material.mu_pa");
    refused(MooneyRivlin{1, -1, 1}, "material.c1_pa");
    refused(ArrudaBoyce{1, 0}, "material.bulk_pa");
    refused(VerondaWestman{1, -1, 1}, "material.c2");
    refused(Ogden{{}, 1}, "material.terms");
    refused(Ogden{{{1, 0}}, 1}, "material.terms[0].alpha");
    refused(Costa{.a_pa = 0}, "material.a_pa");
    refused(Costa{.bulk_pa = -1}, "material.bulk_pa");
    refused(Costa{.b = {1, 1, 1, 0, 1, 1}}, "material.b[3]");
}

}  // namespace
}  // namespace supple
