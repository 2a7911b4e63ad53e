// Whatever a person or a script does to a body: forces stay finite, tangents positive, runs finite or contained, shapes come back.
#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "supple/fem/corners.h"
#include "supple/fem/elements.h"
#include "supple/fem/rest.h"
#include "supple/world/evaluate.h"
#include "support/bodies.h"

namespace supple {
namespace {

using test::Random;

struct NamedMaterial {
    const char* name;
    Material material;
};

const std::vector<NamedMaterial>& materials() {
    static const std::vector<NamedMaterial> list{
        {"linear", Linear{}},
        {"corotational large", Corotational{.rotation = Rotation::large}},
        {"corotational polar", Corotational{}},
        {"corotational svd", Corotational{.rotation = Rotation::svd}},
        {"StVenantKirchhoff", StVenantKirchhoff{}},
        {"NeoHookean", NeoHookean{}},
        {"StableNeoHookean", StableNeoHookean{}},
        {"MooneyRivlin", MooneyRivlin{}},
        {"ArrudaBoyce", ArrudaBoyce{}},
        {"VerondaWestman", VerondaWestman{}},
        {"Ogden", Ogden{}},
        {"Ogden, negative exponent", Ogden{.terms = {{8e4, 3}, {-2e3, -2}}}},
    };
    return list;
}

/// A rest tetrahedron: well shaped, a needle, a sliver, tiny, huge or wound the wrong way.
std::array<Vec3, 4> rest_of(Random& random, std::uint64_t seed) {
    std::array<Vec3, 4> x;
    do {
        for (Vec3& v : x) v = random.vector(1);
    } while (std::abs(tet_volume(x[0], x[1], x[2], x[3])) < 0.02);
    if (seed % 7 == 1) std::swap(x[0], x[1]);
    if (seed % 7 == 2) for (Vec3& v : x) v.z() *= 1e-3;
    if (seed % 7 == 3) for (Vec3& v : x) v.head<2>() *= 1e-3;
    const double size = seed % 7 == 4 ? 1e-3 : seed % 7 == 5 ? 10 : 1;
    for (Vec3& v : x) v *= size;
    return x;
}

/// A start: stretched, flat, a line, a point, inside out or anywhere.
std::vector<Vec3> start_of(Random& random, std::uint64_t seed, const std::vector<Vec3>& rest) {
    Mat3 F = random.matrix(seed % 2 ? 1.0 : 3.0);
    if (seed % 5 == 0) F.col(2) = F.col(0) - 0.5 * F.col(1);
    if (seed % 11 == 0) F.col(1) = F.col(2) = F.col(0);
    if (seed % 13 == 0) F.setZero();
    if (seed % 17 == 0) F = -Mat3::Identity();
    if (seed % 19 == 0) F = Vec3(1, 1, -1).asDiagonal();
    if (seed % 23 == 0) F = random.rotation();
    std::vector<Vec3> x;
    const Vec3 t = random.vector(1);
    for (const Vec3& X : rest) x.push_back(F * X + t);
    return x;
}

/// The tangent as a World uses it (made positive for every law), through the room below: d.K d.
class Tangents {
public:
    Tangents(const VolumeMesh& mesh, const Material& material)
        : layout_(fem::make_layout(mesh)), scratch_(fem::kBlock * 16), q_(4 * fem::kBlock, 0.0) {
        fem::ElementsDef def;
        def.layout = &layout_;
        elements_ = fem::make_elements(def, {{material}, {}, {}});
    }
    void at(const std::vector<Vec3>& x) {
        fem::seed_rotations(team_, layout_, x, q_);
        fem::ElementOutputs outputs;
        outputs.tangent = true;
        elements_->evaluate(team_, x.data()->data(), q_.data(), outputs);
    }
    std::vector<Vec3> product(const std::vector<Vec3>& d) {
        std::vector<Vec3> out(d.size());
        fem::stiffness_product(team_, *elements_, layout_, q_.data(), d, scratch_, out);
        return out;
    }

private:
    Team team_;
    fem::ElementLayout layout_;
    AlignedVector<double> scratch_, q_;
    std::unique_ptr<fem::Elements> elements_;
};

TEST(Robustness, TenThousandTangledElementsHaveFiniteForcesAndPositiveTangents) {
    for (std::uint64_t seed = 0; seed < 10000; ++seed) {
        Random random(seed);
        const auto corners = rest_of(random, seed);
        const auto shape = test::one_tet(corners);
        const NamedMaterial& m = materials()[seed % materials().size()];
        const std::vector<Vec3> x = start_of(random, seed / materials().size(), shape->mesh().vertices);
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << m.name);
        const Evaluation e = evaluate(*shape, m.material, x);
        ASSERT_TRUE(test::all_finite(e.forces_n));
        ASSERT_TRUE(std::isfinite(e.energy_j));
        for (const double s : e.element_stress_pa[0]) ASSERT_TRUE(std::isfinite(s));
        Vec3 sum = Vec3::Zero();
        double size = 0;
        for (const Vec3& f : e.forces_n) {
            sum += f;
            size += f.norm();
        }
        ASSERT_LE(sum.norm(), 1e-10 * size) << "forces of an element sum to nothing";
        Tangents tangents(shape->mesh(), m.material);
        tangents.at(x);
        for (int k = 0; k < 4; ++k) {
            std::vector<Vec3> d;
            for (int a = 0; a < 4; ++a) d.push_back(random.vector(1));
            const std::vector<Vec3> Kd = tangents.product(d);
            ASSERT_TRUE(test::all_finite(Kd));
            double curvature = 0, scale = 0;
            for (std::size_t a = 0; a < 4; ++a) {
                curvature += d[a].dot(Kd[a]);
                scale += d[a].norm() * Kd[a].norm();
            }
            ASSERT_GE(curvature, -1e-10 * scale);
        }
    }
}

TEST(Robustness, AFlatRestShapeIsRefusedByName) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        Random random(seed);
        std::array<Vec3, 4> x;
        for (Vec3& v : x) v = random.vector(1);
        x[3] = seed % 3 == 0 ? x[0] : seed % 3 == 1 ? Vec3(0.3 * x[0] + 0.3 * x[1] + 0.4 * x[2]) : x[3];
        if (seed % 3 == 2) for (Vec3& v : x) v.z() = 0.5;
        try {
            test::one_tet(x);
            ADD_FAILURE() << "seed " << seed << ": a flat element was accepted";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::surface_mesh) << error.what();
        }
    }
}

TEST(Robustness, ReleasedBodiesFindTheirShapeAgain) {
    const NamedMaterial robust[] = {{"StableNeoHookean", StableNeoHookean{}}, {"corotational polar", Corotational{}}, {"corotational svd", Corotational{.rotation = Rotation::svd}}};
    for (const NamedMaterial& m : robust) {
        for (std::uint64_t seed = 0; seed < 60; ++seed) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << m.name);
            Random random(seed);
            WorldDef def;
            def.threads = 1;
            def.time_step_s = 0.02;
            def.gravity_m_s2 = Vec3::Zero();
            World world(def);
            const BodyId body = world.add_body({.shape = test::one_tet({Vec3(0, 0, 0), Vec3(0.1, 0.01, 0), Vec3(0.02, 0.09, 0.01), Vec3(0.01, 0.03, 0.11)}), .material = m.material});
            const auto rest = world.shape(body).mesh().vertices;
            world.set_state(body, start_of(random, seed, rest), std::vector<Vec3>(4, Vec3::Zero()));
            for (int k = 0; k < 600; ++k) ASSERT_EQ(world.step().flags & StepFlag::non_finite, StepFlag::none);
            for (std::size_t a = 0; a < 4; ++a)
                for (std::size_t b = 0; b < a; ++b) EXPECT_NEAR((world.positions(body)[a] - world.positions(body)[b]).norm(), (rest[a] - rest[b]).norm(), 1e-3 * 0.1);
        }
    }
}

TEST(SlowRobustness, StiffnessTimesStepTimesDensity) {
    int contained = 0;
    for (double young = 1e2; young < 2e9; young *= 10) {
        for (const double h : {1.0 / 30, 1.0 / 60, 1.0 / 240, 1.0 / 1000}) {
            for (const double density : {1.0, 100.0, 1e4}) {
                SCOPED_TRACE(testing::Message() << "E " << young << " Pa, h " << h << " s, " << density << " kg/m3");
                const double mu = young / 2.6, la = young * 0.3 / (1.3 * 0.4);
                for (const Material& m : {Material(Corotational{.young_pa = young, .poisson = 0.3}), Material(StableNeoHookean{mu, la}), Material(NeoHookean{mu, la})}) {
                    WorldDef def;
                    def.threads = 1;
                    def.time_step_s = h;
                    World world(def);
                    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = m, .density_kg_m3 = density});
                    world.fix(body, test::at_x(0));
                    for (int k = 0; k < 300; ++k) {
                        const StepReport report = world.step();
                        ASSERT_TRUE(test::all_finite(world.positions(body))) << "step " << k;
                        ASSERT_TRUE(test::all_finite(world.velocities(body))) << "step " << k;
                        for (const StepFlag flag : kAllStepFlags) {
                            if ((report.flags & flag) == StepFlag::none) continue;
                            EXPECT_FALSE(cure(flag).empty());
                            if (flag == StepFlag::non_finite) {
                                EXPECT_TRUE(world.is_frozen(body));
                                ++contained;
                            }
                        }
                    }
                }
            }
        }
    }
    EXPECT_EQ(contained, 0) << "none of these should even need containment";
}

}  // namespace
}  // namespace supple
