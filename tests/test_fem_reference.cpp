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

TEST(FemReference, Forces) {
    const auto shape = test::bar();
    const auto force = evaluate(*shape, kBar, deformed(shape->mesh().vertices)).forces_n;
    EXPECT_TRUE(test::all_finite(force));
    const auto file = test::shared_directory() / "reference" / "bar1.tet.polar.force.txt";
    if (test::skipped_for_want_of(file)) return;
    const auto expected = test::read_vectors(file);
    ASSERT_EQ(expected.size(), shape->mesh().vertices.size());
    EXPECT_LT(test::relative_difference(force, expected), 1e-9);
}

TEST(FemReference, ForceDifferentialsWithTheWarpedTangent) {
    const auto shape = test::bar();
    const auto& X = shape->mesh().vertices;
    const auto df = force_differential(*shape, kBar, deformed(X), direction(X));
    EXPECT_TRUE(test::all_finite(df));
    const auto file = test::shared_directory() / "reference" / "bar1.tet.polar.dforce.txt";
    if (test::skipped_for_want_of(file)) return;
    const auto expected = test::read_vectors(file);
    ASSERT_EQ(expected.size(), X.size());
    EXPECT_LT(test::relative_difference(df, expected), 1e-9);
}

}  // namespace
}  // namespace supple
