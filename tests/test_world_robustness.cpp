// Whatever a person or a script does to a body: forces stay finite, tangents positive, runs finite or contained, shapes come back.
#include <gtest/gtest.h>

#include <functional>

#include "supple/fem/elements.h"
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

/// A rest element: well shaped, a sliver, a needle, tiny, huge or wound the wrong way; a tetrahedron or a distorted hexahedron.
std::shared_ptr<const BodyTemplate> rest_of(Random& random, std::uint64_t seed) {
    VolumeMesh mesh;
    if (seed % 2) {
        mesh = make_hex_box({});
        for (Vec3& v : mesh.vertices) v += random.vector(0.15);
    } else {
        do {
            mesh.vertices.clear();
            for (int a = 0; a < 4; ++a) mesh.vertices.push_back(random.vector(1));
        } while (std::abs(tet_volume(mesh.vertices[0], mesh.vertices[1], mesh.vertices[2], mesh.vertices[3])) < 0.02);
        mesh.tets = {seed % 4 ? Tet{0, 1, 2, 3} : Tet{0, 2, 1, 3}};
    }
    const std::uint64_t form = seed / 2 % 6;
    for (Vec3& v : mesh.vertices) {
        if (form == 1) v.z() *= 1e-3;
        if (form == 2) v.head<2>() *= 1e-3;
        v *= form == 3 ? 1e-3 : form == 4 ? 10 : 1;
    }
    return BodyTemplate::build(std::move(mesh));
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
    if (seed % 3 == 0)
        for (Vec3& v : x) v += random.vector(0.3 * (rest[1] - rest[0]).norm());  // no affine map: a hexahedron folds
    return x;
}

/// The tangent as a World uses it (made positive for every law), through the room below: d.K d.
class Tangents {
public:
    Tangents(const VolumeMesh& mesh, const Material& material)
        : layout_(fem::make_layout(mesh)), q_(layout_.blocks * 4 * fem::kBlock, 0.0), scratch_(layout_.places * 4) {
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
    AlignedVector<double> q_, scratch_;
    std::unique_ptr<fem::Elements> elements_;
};

TEST(Robustness, TenThousandTangledElementsHaveFiniteForcesAndPositiveTangents) {
    for (std::uint64_t seed = 0; seed < 10000; ++seed) {
        Random random(seed);
        const auto shape = rest_of(random, seed);
        const std::size_t corners = shape->mesh().vertices.size();
        const NamedMaterial& m = materials()[seed / 2 % materials().size()];
        const std::vector<Vec3> x = start_of(random, seed / 2 / materials().size(), shape->mesh().vertices);
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << m.name << (corners == 8 ? ", hex" : ", tet"));
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
            for (std::size_t a = 0; a < corners; ++a) d.push_back(random.vector(1));
            const std::vector<Vec3> Kd = tangents.product(d);
            ASSERT_TRUE(test::all_finite(Kd));
            double curvature = 0, scale = 0;
            for (std::size_t a = 0; a < corners; ++a) {
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

/// Releases one tetrahedron; the largest change of an edge, relative to the body.
double left_after_release(const Material& material, const WorldDef& def, const std::function<std::vector<Vec3>(const std::vector<Vec3>&)>& start) {
    World world(def);
    const BodyId body = world.add_body({.shape = test::one_tet({Vec3(0, 0, 0), Vec3(0.1, 0.01, 0), Vec3(0.02, 0.09, 0.01), Vec3(0.01, 0.03, 0.11)}), .material = material});
    const auto rest = world.shape(body).mesh().vertices;
    world.set_state(body, start(rest), std::vector<Vec3>(4, Vec3::Zero()));
    for (int k = 0; k < 600; ++k) EXPECT_EQ(world.step().flags & StepFlag::non_finite, StepFlag::none);
    const auto x = world.positions(body);
    double worst = 0;
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = 0; b < a; ++b) worst = std::max(worst, std::abs((x[a] - x[b]).norm() - (rest[a] - rest[b]).norm()));
    return worst / 0.1;
}

TEST(Robustness, ReleasedCorotationalBodiesFindTheirShapeAgain) {
    WorldDef def;
    def.threads = 1;
    def.time_step_s = 0.02;
    def.gravity_m_s2 = Vec3::Zero();
    for (const Rotation rotation : {Rotation::polar, Rotation::svd}) {
        for (std::uint64_t seed = 0; seed < 60; ++seed) {
            Random random(seed);
            EXPECT_LT(left_after_release(Corotational{.rotation = rotation}, def, [&](const auto& rest) { return start_of(random, seed, rest); }), 1e-3) << "seed " << seed;
        }
    }
}

TEST(Robustness, ReleasedStableNeoHookeanBodiesFindTheirShapeAgain) {
    // Flat and inverted, but not collapsed to a line or a point: below a stretch of mu/((lambda + mu) a) in two directions its energy, as the law is written, falls towards the point.
    WorldDef def;
    def.threads = 1;
    def.time_step_s = 0.02;
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.newton_iterations = 30;
    def.solver.newton_tolerance = 1e-3;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Random random(seed);
        const Vec3 s(random.uniform(0.7, 2), random.uniform(0.7, 2), seed % 4 == 0 ? 0 : random.uniform(-2, 2));
        const Mat3 F = random.rotation() * s.asDiagonal() * random.rotation();
        const auto start = [&](const std::vector<Vec3>& rest) {
            std::vector<Vec3> x;
            for (const Vec3& X : rest) x.push_back(F * X);
            return x;
        };
        EXPECT_LT(left_after_release(StableNeoHookean{}, def, start), 1e-3) << "seed " << seed << ", stretches " << s.transpose();
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
