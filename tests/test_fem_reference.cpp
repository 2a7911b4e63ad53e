// Forces and force differentials of a strongly deformed bar against an independent implementation's, in double precision.
#include <gtest/gtest.h>

#include "supple/world/evaluate.h"
#include "support/bodies.h"
#include "support/shared_data.h"

namespace supple {
namespace {

constexpr Corotational kBar{.young_pa = 2e5, .poisson = 0.4};

/// The deformation of the reference, from its formula: so that there is something to look at where the files are not.
std::vector<Vec3> deformed(std::span<const Vec3> rest) {
    std::vector<Vec3> x(rest.begin(), rest.end());
    for (Vec3& v : x) {
        v += 0.02 * Vec3(std::sin(37 * v[0] + 11 * v[1]), std::sin(23 * v[1] + 5 * v[2]), std::sin(31 * v[2] + 7 * v[0]));
    }
    return x;
}

std::vector<Vec3> direction(std::span<const Vec3> rest) {
    std::vector<Vec3> d;
    for (const Vec3& v : rest) {
        d.push_back(0.01 * Vec3(std::cos(13 * v[0] + 3 * v[2]), std::cos(7 * v[1] + 17 * v[0]), std::cos(29 * v[2] + 5 * v[1])));
    }
    return d;
}

TEST(FemReference, TheGeneratedBarDeformsAsTheFilesDo) {
    const auto folder = test::shared_directory() / "reference";
    if (test::skipped_for_want_of(folder / "bar1.xprime.txt")) return;
    const auto shape = test::bar();
    EXPECT_LT(test::relative_difference(test::read_vectors(folder / "bar1.xprime.txt"), deformed(shape->mesh().vertices)), 1e-12);
    EXPECT_LT(test::relative_difference(test::read_vectors(folder / "bar1.direction.txt"), direction(shape->mesh().vertices)), 1e-12);
}

/// Force and force differential of one material against the files of one method.
void check_method(const std::string& method, const Material& material) {
    const auto shape = test::bar();
    const auto& X = shape->mesh().vertices;
    const auto force = evaluate(*shape, material, deformed(X)).forces_n;
    const auto df = force_differential(*shape, material, deformed(X), direction(X));
    EXPECT_TRUE(test::all_finite(force));
    EXPECT_TRUE(test::all_finite(df));
    const auto folder = test::shared_directory() / "reference";
    if (test::skipped_for_want_of(folder / ("bar1.tet." + method + ".force.txt"))) return;
    const auto expected_force = test::read_vectors(folder / ("bar1.tet." + method + ".force.txt"));
    const auto expected_df = test::read_vectors(folder / ("bar1.tet." + method + ".dforce.txt"));
    ASSERT_EQ(expected_force.size(), X.size());
    ASSERT_EQ(expected_df.size(), X.size());
    EXPECT_LT(test::relative_difference(force, expected_force), 1e-9);
    EXPECT_LT(test::relative_difference(df, expected_df), 1e-9);
}

TEST(FemReference, PolarFramesWithTheWarpedTangent) { check_method("polar", kBar); }
TEST(FemReference, SingularValueFramesAreThePolarOnes) { check_method("polar", Corotational{.rotation = Rotation::svd, .young_pa = 2e5, .poisson = 0.4}); }
TEST(FemReference, EdgeFrames) { check_method("large", Corotational{.rotation = Rotation::large, .young_pa = 2e5, .poisson = 0.4}); }
TEST(FemReference, SmallDisplacements) { check_method("linear", Linear{.young_pa = 2e5, .poisson = 0.4}); }

/// The same bar of 256 cubes, fully integrated as the reference is.
void check_hexes(const std::string& method, const Material& material) {
    const auto shape = test::hex_bar();
    const auto& X = shape->mesh().vertices;
    const auto force = evaluate(*shape, material, deformed(X)).forces_n;
    const auto df = force_differential(*shape, material, deformed(X), direction(X));
    EXPECT_TRUE(test::all_finite(force));
    const auto folder = test::shared_directory() / "reference";
    if (test::skipped_for_want_of(folder / ("bar1.hex." + method + ".force.txt"))) return;
    EXPECT_LT(test::relative_difference(force, test::read_vectors(folder / ("bar1.hex." + method + ".force.txt"))), 1e-9);
    EXPECT_LT(test::relative_difference(df, test::read_vectors(folder / ("bar1.hex." + method + ".dforce.txt"))), 1e-9);
}

TEST(FemReference, Hexahedra) {
    check_hexes("linear", Linear{.young_pa = 2e5, .poisson = 0.4, .integration = Integration::full});
    for (const Rotation rotation : {Rotation::large, Rotation::polar, Rotation::svd}) {
        check_hexes(rotation == Rotation::large ? "large" : "polar",
                    Corotational{.rotation = rotation, .young_pa = 2e5, .poisson = 0.4, .integration = Integration::full});
    }
}

/// A fifth of the deformation.
std::vector<Vec3> deformed_a_little(std::span<const Vec3> X) {
    std::vector<Vec3> x = deformed(X);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = X[i] + 0.2 * (x[i] - X[i]);
    return x;
}

/// The hyperelastic laws, at a fifth of the deformation.
void check_law(const std::string& law, const Material& material, double tolerance) {
    const auto shape = test::bar();
    const auto& X = shape->mesh().vertices;
    const std::vector<Vec3> x = deformed_a_little(X);
    const auto force = evaluate(*shape, material, x).forces_n;
    const auto df = force_differential(*shape, material, x, direction(X));
    EXPECT_TRUE(test::all_finite(force));
    const auto folder = test::shared_directory() / "reference";
    if (test::skipped_for_want_of(folder / ("bar1.amp004.tet." + law + ".force.txt"))) return;
    EXPECT_LT(test::relative_difference(force, test::read_vectors(folder / ("bar1.amp004.tet." + law + ".force.txt"))), tolerance);
    EXPECT_LT(test::relative_difference(df, test::read_vectors(folder / ("bar1.amp004.tet." + law + ".dforce.txt"))), tolerance);
}

TEST(FemReference, HyperelasticLaws) {
    const double mu = 71428.571428571428, lambda = 285714.28571428571, K = 333333.33333333331;
    check_law("StVenantKirchhoff", StVenantKirchhoff{.mu_pa = mu, .lambda_pa = lambda}, 1e-9);
    check_law("NeoHookean", NeoHookean{.mu_pa = mu, .lambda_pa = lambda}, 1e-9);
    check_law("StableNeoHookean", StableNeoHookean{.mu_pa = mu, .lambda_pa = lambda}, 1e-9);
    check_law("MooneyRivlin", MooneyRivlin{.c1_pa = 0.4 * mu, .c2_pa = 0.1 * mu, .bulk_pa = K}, 1e-9);
    check_law("Ogden", Ogden{.terms = {{.mu_pa = 2 * mu, .alpha = 3}}, .bulk_pa = K}, 1e-8);
    check_law("ArrudaBoyce", ArrudaBoyce{.mu_pa = mu / 1.0851367078791743, .bulk_pa = K}, 1e-9);
    check_law("VerondaWestman", VerondaWestman{.c1_pa = mu / 2, .c2 = 2, .bulk_pa = K}, 1e-9);
    check_law("Costa", Costa{.a_pa = 2 * mu, .bulk_pa = lambda, .b = {1.5, 1, 1, 1, 1, 1}}, 1e-9);
}

/// Energies [J] of the same configuration. The reference's StableNeoHookean has mu^2/(2 (lambda + mu)) per unit volume at rest; its energies of
/// MooneyRivlin and Costa are defective, and the numbers here those of the formulas that its forces follow.
TEST(FemReference, EnergiesOfTheHyperelasticLaws) {
    const double mu = 71428.571428571428, lambda = 285714.28571428571, K = 333333.33333333331;
    const auto shape = test::bar();
    const std::vector<Vec3> x = deformed_a_little(shape->mesh().vertices);
    EXPECT_NEAR(evaluate(*shape, MooneyRivlin{.c1_pa = 0.4 * mu, .c2_pa = 0.1 * mu, .bulk_pa = K}, x).energy_j, 17.789492555300377, 1e-10);
    EXPECT_NEAR(evaluate(*shape, Costa{.a_pa = 2 * mu, .bulk_pa = lambda, .b = {1.5, 1, 1, 1, 1, 1}}, x).energy_j, 18.61631638535437, 1e-10);
}

}  // namespace
}  // namespace supple
