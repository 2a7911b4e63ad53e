// Stress by every strain measure, recovery and place, against closed forms.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "supple/world/evaluate.h"
#include "supple/world/template_data.h"
#include "support/bodies.h"

namespace supple {
namespace {

const std::vector<Material>& all_laws() {
    static const std::vector<Material> laws = {Linear{}, Corotational{.rotation = Rotation::large}, Corotational{}, Corotational{.rotation = Rotation::svd},
                                               StVenantKirchhoff{}, NeoHookean{}, StableNeoHookean{}, MooneyRivlin{}, ArrudaBoyce{}, VerondaWestman{}, Ogden{}};
    return laws;
}

Mat3 matrix_of(const Voigt& s) {
    Mat3 S;
    S << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    return S;
}

Voigt voigt_of(const Mat3& S) { return {S(0, 0), S(1, 1), S(2, 2), S(0, 1), S(1, 2), S(2, 0)}; }

std::vector<Vec3> moved(const BodyTemplate& shape, const Mat3& F) {
    std::vector<Vec3> x = shape.mesh().vertices;
    for (Vec3& p : x) p = F * p;
    return x;
}

// -- numbers made of a tensor ------------------------------------------------------------------------

TEST(WorldStress, PrincipalStressesAreSortedAndTheirDirectionsRightHanded) {
    test::Random random(1);
    for (int n = 0; n < 100; ++n) {
        const Mat3 Q = random.rotation();
        const Vec3 s(random.uniform(10, 20), random.uniform(-5, 5), random.uniform(-20, -10));
        Mat3 D;
        const auto p = principal_stresses(voigt_of(Q * s.asDiagonal() * Q.transpose()), &D);
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(p[std::size_t(k)], s[k], 1e-12);
            EXPECT_NEAR(std::abs(D.col(k).dot(Q.col(k))), 1, 1e-12);
        }
        EXPECT_NEAR(D.determinant(), 1, 1e-12);
        const double expected = std::sqrt(0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)));
        EXPECT_NEAR(von_mises(voigt_of(Q * s.asDiagonal() * Q.transpose())), expected, 1e-12);
    }
    EXPECT_NEAR(principal_stresses({0, 0, 0, 5, 0, 0})[0], 5, 1e-14);
    EXPECT_NEAR(principal_stresses({0, 0, 0, 5, 0, 0})[2], -5, 1e-14);
    EXPECT_TRUE(std::isnan(principal_stresses({NAN, 0, 0, 0, 0, 0})[1]));
}

// -- strain measures ---------------------------------------------------------------------------------

TEST(WorldStress, GreenIsStVenantKirchhoffUnderTheSameModuli) {
    test::Random random(2);
    const auto shape = test::irregular_cube(2, 0.2, 3);
    const double lambda = 3e4, mu = 2e4, young = mu * (3 * lambda + 2 * mu) / (lambda + mu), poisson = lambda / (2 * (lambda + mu));
    std::vector<Vec3> x = moved(*shape, random.rotation() * (Mat3::Identity() + random.matrix(0.3)));
    for (Vec3& p : x) p += random.vector(0.03);
    const StressField expected = evaluate_stress(*shape, StVenantKirchhoff{mu, lambda}, x, {.at = StressAt::element});
    Corotational polar, large;
    polar.young_pa = large.young_pa = young;
    polar.poisson = large.poisson = poisson;
    large.rotation = Rotation::large;
    const std::vector<Material> laws = {Linear{young, poisson}, polar, large};
    for (const Material& law : laws) {
        const StressField green = evaluate_stress(*shape, law, x, {.strain = StrainMeasure::green, .at = StressAt::element});
        const StressField own = evaluate_stress(*shape, law, x, {.at = StressAt::element});
        double difference = 0;
        for (std::size_t e = 0; e < green.cauchy_pa.size(); ++e) {
            for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(green.cauchy_pa[e][c], expected.cauchy_pa[e][c], 1e-9 * expected.von_mises_pa[e]);
            difference = std::max(difference, std::abs(own.von_mises_pa[e] - green.von_mises_pa[e]) / expected.von_mises_pa[e]);
        }
        EXPECT_GT(difference, 0.01) << "at these strains the measures differ";
    }
}

TEST(WorldStress, GreenUsesTheModuliOfEachElement) {
    World world({.threads = 1});
    const auto shape = test::cube(1);
    BodyDef def{.shape = shape};
    for (std::size_t e = 0; e < shape->mesh().tets.size(); ++e) def.young_pa_per_element.push_back(1e4 * double(e + 1));
    const BodyId body = world.add_body(def);
    std::vector<Vec3> x = moved(*shape, Vec3(1.1, 1, 1).asDiagonal()), v(x.size(), Vec3::Zero());
    world.set_state(body, x, v);
    const StressField field = world.stress(body, {.strain = StrainMeasure::green, .at = StressAt::element});
    const double E = (1.1 * 1.1 - 1) / 2;
    for (std::size_t e = 0; e < field.cauchy_pa.size(); ++e) {
        const Lame l = lame_parameters(1e4 * double(e + 1), 0.3, "");
        EXPECT_NEAR(field.cauchy_pa[e][0], 1.1 * (l.lambda_pa + 2 * l.mu_pa) * E, 1e-8);
        EXPECT_NEAR(field.cauchy_pa[e][1], l.lambda_pa * E / 1.1, 1e-8);
    }
}

TEST(WorldStress, HyperelasticLawsHaveOneStress) {
    test::Random random(4);
    const auto shape = test::irregular_cube(2, 0.2, 5);
    const auto x = moved(*shape, Mat3::Identity() + random.matrix(0.2));
    for (const Material& law : all_laws()) {
        if (!is_hyperelastic(law)) continue;
        const StressField a = evaluate_stress(*shape, law, x), b = evaluate_stress(*shape, law, x, {.strain = StrainMeasure::green});
        EXPECT_EQ(a.cauchy_pa, b.cauchy_pa);
    }
}

TEST(WorldStress, TurnsWithTheBodyInEveryLawMeasureAndRecovery) {
    test::Random random(6);
    const auto shape = test::irregular_cube(3, 0.2, 7);
    std::vector<Vec3> x = moved(*shape, Mat3::Identity() + random.matrix(0.15));
    for (Vec3& p : x) p += random.vector(0.02);
    const Mat3 R = random.rotation();
    std::vector<Vec3> y = x;
    for (Vec3& p : y) p = R * p + Vec3(1, 2, 3);
    for (const Material& law : all_laws()) {
        for (const StrainMeasure strain : {StrainMeasure::corotational, StrainMeasure::green}) {
            if (std::holds_alternative<Linear>(law) && strain == StrainMeasure::corotational) continue;  // small displacements know no rotation
            for (const Recovery recovery : {Recovery::raw, Recovery::volume_weighted, Recovery::spr}) {
                for (const StressAt at : {StressAt::vertex, StressAt::element}) {
                    const StressField a = evaluate_stress(*shape, law, x, {strain, recovery, at, true}), b = evaluate_stress(*shape, law, y, {strain, recovery, at, true});
                    ASSERT_EQ(a.cauchy_pa.size(), at == StressAt::vertex ? x.size() : shape->mesh().tets.size());
                    double scale = 0;
                    for (const double s : a.von_mises_pa) scale = std::max(scale, s);
                    ASSERT_GT(scale, 100);
                    for (std::size_t i = 0; i < a.cauchy_pa.size(); ++i) {
                        ASSERT_LT((matrix_of(b.cauchy_pa[i]) - R * matrix_of(a.cauchy_pa[i]) * R.transpose()).norm(), 1e-9 * scale) << law.index();
                        ASSERT_NEAR(a.von_mises_pa[i], b.von_mises_pa[i], 1e-9 * scale);
                        for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(a.principal_pa[i][k], b.principal_pa[i][k], 1e-9 * scale);
                        const Vec3 p(a.principal_pa[i][0], a.principal_pa[i][1], a.principal_pa[i][2]);
                        ASSERT_LT((a.directions[i] * p.asDiagonal() * a.directions[i].transpose() - matrix_of(a.cauchy_pa[i])).norm(), 1e-10 * scale);
                    }
                }
            }
        }
    }
}

// -- recovery ----------------------------------------------------------------------------------------

Voigt linear_field(const Vec3& x) {
    return {1 + 2 * x.x() - x.y(), 3 * x.z() + x.y(), -2 + x.x(), 4 * x.y() - x.z(), 0.5 + x.x() + x.y() + x.z(), 7 - 2 * x.z()};
}

Voigt smooth_field(const Vec3& x) {
    return {std::sin(2 * x.x()) * std::cos(x.y()), std::exp(x.z()) * x.x(), std::cos(x.x() + 2 * x.z()), x.x() * x.y() * x.z(), std::sin(x.y()), std::cos(3 * x.z())};
}

/// Stress of the elements: the field at their centres.
template <class Field>
std::vector<Voigt> at_centres(const VolumeMesh& mesh, Field&& field) {
    std::vector<Voigt> s;
    for (const Tet& t : mesh.tets) {
        Vec3 centre = Vec3::Zero();
        for (const std::int32_t v : t) centre += mesh.vertices[std::size_t(v)] / 4;
        s.push_back(field(centre));
    }
    return s;
}

template <class Field>
std::pair<double, double> errors(const BodyTemplate& shape, Recovery recovery, Field&& field) {  // largest, root of the mean square
    const auto s = at_centres(shape.mesh(), field);
    const auto& weights = shape.data().recovery(recovery);
    double worst = 0, sum = 0;
    for (std::size_t v = 0; v < shape.mesh().vertices.size(); ++v) {
        const Voigt got = weights.at(s, v), expected = field(shape.mesh().vertices[v]);
        for (std::size_t c = 0; c < 6; ++c) {
            worst = std::max(worst, std::abs(got[c] - expected[c]));
            sum += std::pow(got[c] - expected[c], 2);
        }
    }
    return {worst, std::sqrt(sum / double(6 * shape.mesh().vertices.size()))};
}

TEST(WorldRecovery, PatchesReproduceLinearFieldsExactlyOnIrregularMeshes) {
    const auto shape = test::irregular_cube(4, 0.3, 8);
    EXPECT_EQ(shape->data().recovery(Recovery::spr).fallbacks, 0u);
    EXPECT_LT(errors(*shape, Recovery::spr, linear_field).first, 1e-11);
    EXPECT_GT(errors(*shape, Recovery::volume_weighted, linear_field).first, 0.1);
    EXPECT_GT(errors(*shape, Recovery::raw, linear_field).first, 0.1);
    // A bar of one layer has no vertex inside.
    const auto thin = test::bar({8, 1, 1});
    EXPECT_EQ(thin->data().recovery(Recovery::spr).fallbacks, 0u);
    EXPECT_LT(errors(*thin, Recovery::spr, linear_field).first, 1e-11);
}

TEST(WorldRecovery, EveryKindKeepsAConstantField) {
    const auto shape = test::irregular_cube(3, 0.3, 9);
    for (const Recovery recovery : {Recovery::raw, Recovery::volume_weighted, Recovery::spr})
        EXPECT_LT(errors(*shape, recovery, [](const Vec3&) { return Voigt{1, 2, 3, 4, 5, 6}; }).first, 1e-12);
}

TEST(WorldRecovery, PatchesAreOfSecondOrderAndMeansOfFirst) {
    const auto order = [](Recovery recovery) {
        const double coarse = errors(*test::irregular_cube(6, 0.2, 10), recovery, smooth_field).second;
        const double fine = errors(*test::irregular_cube(12, 0.2, 10), recovery, smooth_field).second;
        return std::log2(coarse / fine);
    };
    EXPECT_GT(order(Recovery::spr), 1.8);
    EXPECT_LT(order(Recovery::raw), 1.6);
    EXPECT_LT(order(Recovery::volume_weighted), 1.6);
    const auto fine = test::irregular_cube(12, 0.2, 10);
    EXPECT_LT(4 * errors(*fine, Recovery::spr, smooth_field).second, errors(*fine, Recovery::volume_weighted, smooth_field).second);
}

TEST(WorldRecovery, PoorPatchesFallBackToVolumesAndAreCounted) {
    const auto tet = test::unit_tet();  // one sample fixes no linear field
    EXPECT_EQ(tet->data().recovery(Recovery::spr).fallbacks, 4u);
    const std::vector<Voigt> s = {{1, 2, 3, 4, 5, 6}};
    for (std::size_t v = 0; v < 4; ++v) EXPECT_EQ(tet->data().recovery(Recovery::spr).at(s, v), s[0]);
    // A plate of one tet by two: the patches are nearly flat in places; the result stays bounded by its neighbours.
    VolumeMesh mesh = make_tet_box({.min_m = Vec3::Zero(), .max_m = {1, 1, 1e-7}, .cells = {4, 4, 1}});
    const auto plate = BodyTemplate::build(mesh);
    const auto& weights = plate->data().recovery(Recovery::spr);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        double sum = 0, size = 0;
        for (std::int64_t i = weights.start[v]; i < weights.start[v + 1]; ++i) {
            sum += weights.weight[std::size_t(i)];
            size += std::abs(weights.weight[std::size_t(i)]);
        }
        EXPECT_NEAR(sum, 1, 1e-6);
        EXPECT_LE(size, 10.001);
    }
}

TEST(WorldRecovery, MeansAreWhatTheirNamesSay) {
    const auto shape = test::irregular_cube(2, 0.3, 11);
    const VolumeMesh& mesh = shape->mesh();
    test::Random random(11);
    std::vector<Vec3> x = mesh.vertices;
    for (Vec3& p : x) p += random.vector(0.05);
    const auto elements = evaluate_stress(*shape, NeoHookean{}, x, {.at = StressAt::element});
    const auto raw = evaluate_stress(*shape, NeoHookean{}, x, {.recovery = Recovery::raw});
    const auto weighted = evaluate_stress(*shape, NeoHookean{}, x);
    for (std::size_t v = 0; v < x.size(); ++v) {
        double plain = 0, sum = 0, volume = 0;
        int count = 0;
        for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
            const Tet& t = mesh.tets[e];
            if (std::find(t.begin(), t.end(), std::int32_t(v)) == t.end()) continue;
            const double V = tet_volume(mesh.vertices[std::size_t(t[0])], mesh.vertices[std::size_t(t[1])], mesh.vertices[std::size_t(t[2])], mesh.vertices[std::size_t(t[3])]);
            plain += elements.cauchy_pa[e][3];
            sum += V * elements.cauchy_pa[e][3];
            volume += V;
            ++count;
        }
        EXPECT_NEAR(raw.cauchy_pa[v][3], plain / count, 1e-8);
        EXPECT_NEAR(weighted.cauchy_pa[v][3], sum / volume, 1e-8);
    }
    EXPECT_EQ(evaluate(*shape, NeoHookean{}, x).element_stress_pa, elements.cauchy_pa);
}

// -- of a world --------------------------------------------------------------------------------------

TEST(WorldStress, OfAWorldIsThatOfItsPositions) {
    for (const Material& law : all_laws()) {
        World world({.time_step_s = 0.01, .threads = 1});
        const BodyId body = world.add_body({.shape = test::bar({6, 2, 2}), .material = law});
        world.fix(body, test::at_x(0));
        for (int n = 0; n < 10; ++n) world.step();
        const auto hash = world.hash();
        for (const StressDef def : {StressDef{}, StressDef{StrainMeasure::green, Recovery::spr}, StressDef{.at = StressAt::element}}) {
            const StressField got = world.stress(body, def), expected = evaluate_stress(world.shape(body), law, world.positions(body), def);
            for (std::size_t i = 0; i < got.cauchy_pa.size(); ++i)
                for (std::size_t c = 0; c < 6; ++c) ASSERT_NEAR(got.cauchy_pa[i][c], expected.cauchy_pa[i][c], 1e-6 + 1e-8 * expected.von_mises_pa[i]);
        }
        const StressField plain = world.stress(body);
        for (std::size_t v = 0; v < plain.von_mises_pa.size(); ++v) ASSERT_NEAR(plain.von_mises_pa[v], world.von_mises(body)[v], 1e-9 * (1 + plain.von_mises_pa[v]));
        EXPECT_EQ(world.hash(), hash) << "looking changes nothing";
    }
}

}  // namespace
}  // namespace supple
