// Hexahedra with one rest stiffness: patch test, rank, locking, rigid motions, shared stiffnesses, instruction sets, assembly.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "supple/base/error.h"
#include "supple/fem/elements.h"
#include "supple/fem/hex8_stiffness.h"
#include "supple/world/evaluate.h"
#include "supple/world/template_data.h"
#include "support/bodies.h"
#include "support/elements.h"
#include "support/hexes.h"

namespace supple {
namespace {

using test::eigenvalues;
using test::kBoth;
using test::Random;
using test::shaken_cube;

TEST(HexStiffness, HasSixZeroModesAndNoOther) {
    for (const Integration integration : kBoth) {
        for (const double poisson : {-0.5, 0.0, 0.3, 0.49, 0.4999}) {
            for (int trial = 0; trial < 20; ++trial) {
                const fem::HexShape X = shaken_cube(trial == 0 ? 0 : 0.2, std::uint64_t(trial));
                const Lame lame = lame_parameters(1, poisson, "test");
                const fem::Mat24 K = fem::hex_stiffness(X, lame, integration);
                EXPECT_LT((K - K.transpose()).norm(), 1e-15 * K.norm());
                const Eigen::VectorXd values = eigenvalues(K);
                // Hourglass modes would be as soft as the rigid motions; the softest mode of a unit cube is about a tenth of E.
                EXPECT_LT(values.head(6).cwiseAbs().maxCoeff(), 1e-13 * values[23]) << int(integration) << " nu " << poisson;
                EXPECT_GT(values[6], 0.01 * lame.mu_pa) << int(integration) << " nu " << poisson << " trial " << trial;
            }
        }
    }
}

TEST(HexStiffness, OnlyTheMeanDilatationIsStiffWhereMatterIsNearlyIncompressible) {
    // The number of eigenvalues that grow with lambda is the number of volume constraints of an element.
    for (const double shake : {0.0, 0.1}) {
        const auto stiff_modes = [&](Integration integration) {
            const Eigen::VectorXd values = eigenvalues(fem::hex_stiffness(shaken_cube(shake, 3), {1e6, 1}, integration));
            return (values.array() > 1e3).count();
        };
        EXPECT_GE(stiff_modes(Integration::full), 7);
        EXPECT_EQ(stiff_modes(Integration::incompatible), 1);
    }
}

TEST(HexStiffness, IncompatibleModesGiveABrickItsExactBendingStiffness) {
    // Pure bending of a brick L x b x h: u_x = kappa x y, u_y = -kappa x^2/2 - nu kappa (y^2 - z^2)/2, u_z = -nu kappa y z. At the corners of the brick only the x y and y z parts
    // are left (and constants); the energy is E kappa^2/2 * integral of y^2.
    const double L = 3, b = 0.7, h = 0.5, E = 2.5, kappa = 0.1;
    fem::HexShape X;
    for (std::size_t a = 0; a < 8; ++a) X[a] = Vec3(fem::kHexCorner[a][0] * L / 2, fem::kHexCorner[a][1] * h / 2, fem::kHexCorner[a][2] * b / 2);
    for (const double nu : {0.0, 0.3, 0.4999}) {
        Eigen::VectorXd u(24);
        for (std::size_t a = 0; a < 8; ++a) u.segment<3>(Eigen::Index(3 * a)) = kappa * Vec3(X[a].x() * X[a].y(), 0, -nu * X[a].y() * X[a].z());
        const double exact = E * kappa * kappa / 2 * L * b * h * h * h / 12;
        const Lame lame = lame_parameters(E, nu, "test");
        EXPECT_NEAR(0.5 * u.dot(fem::hex_stiffness(X, lame, Integration::incompatible) * u), exact, 1e-10 * exact) << nu;
        EXPECT_GT(0.5 * u.dot(fem::hex_stiffness(X, lame, Integration::full) * u), 5 * exact) << "shear locking has vanished: " << nu;
    }
}

TEST(HexStiffness, CellsOfALatticeShareOneAndFreeShapesKeepTheirOwn) {
    const auto count = [](const BodyTemplate& shape, std::vector<Lame> lame) {
        const fem::Hex8Rest& rest = shape.data().layout.groups[0].hexes;
        if (lame.size() == 1) lame.assign(rest.elements, lame[0]);
        const auto k = fem::make_hex_stiffness(rest, lame, std::vector<Integration>(rest.elements), false);
        return std::pair(k.shared_d.size() / fem::kHexBlocks, k.own.size());
    };
    EXPECT_EQ(count(*test::hex_bar({16, 4, 3}), {Lame{3, 1}}), std::pair(std::size_t(1), std::size_t(0)));
    EXPECT_EQ(count(*test::irregular_hex_cube(3, 0.1, 7), {Lame{3, 1}}).first, 27u) << "every hex has a shaken corner";
    // Harder by a factor is the same class; another Poisson's ratio is not.
    std::vector<Lame> lame(192, Lame{3, 1});
    for (std::size_t e = 0; e < lame.size(); e += 2) lame[e] = {21, 7};
    EXPECT_EQ(count(*test::hex_bar({16, 4, 3}), lame).first, 1u);
    for (std::size_t e = 0; e < lame.size(); e += 2) lame[e] = {20, 7};
    EXPECT_EQ(count(*test::hex_bar({16, 4, 3}), lame), std::pair(std::size_t(2), 24 * fem::kHexInner * fem::kBlock));
}

/// Patch test of a mesh of distorted hexes: the boundary moves by x = A X + c, the inside must follow and stress be uniform.
void patch_test(const Material& material, const Mat3& A, double tolerance) {
    const auto shape = test::irregular_hex_cube(3, 0.25, 11);
    const auto& X = shape->mesh().vertices;
    std::vector<Vec3> x(X.size());
    for (std::size_t i = 0; i < X.size(); ++i) x[i] = A * X[i] + Vec3(0.3, -2, 1);
    const Evaluation e = evaluate(*shape, material, x);
    double largest = 0, inside = 0;
    for (std::size_t i = 0; i < X.size(); ++i) {
        const bool inner = X[i].minCoeff() > 1e-9 && X[i].maxCoeff() < 1 - 1e-9;
        (inner ? inside : largest) = std::max(inner ? inside : largest, e.forces_n[i].norm());
    }
    EXPECT_LT(inside, tolerance * largest) << "the inner vertices are not in balance where they should be";
    EXPECT_GT(largest, 0);
    double size = 0;
    for (std::size_t c = 0; c < 6; ++c) size = std::max(size, std::abs(e.element_stress_pa[0][c]));
    for (const auto* stress : {&e.element_stress_pa, &e.vertex_stress_pa})
        for (const Voigt& s : *stress)
            for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(s[c], e.element_stress_pa[0][c], tolerance * size);
}

TEST(Hex, PatchTest) {
    Mat3 G;
    G << 0.3, 0.1, -0.2, 0.4, -0.2, 0.1, 0.2, 0.3, 0.1;
    for (const Integration integration : kBoth) {
        for (const double nu : {0.0, 0.3, 0.49}) {
            patch_test(Linear{.young_pa = 1e4, .poisson = nu, .integration = integration}, Mat3::Identity() + G, 1e-12);
            patch_test(Corotational{.young_pa = 1e4, .poisson = nu, .integration = integration}, Random(5).rotation() * (Mat3::Identity() + G), 1e-10);
        }
    }
}

TEST(Hex, UniformStrainGivesTheStressOfTheLaw) {
    const Lame lame = lame_parameters(1e4, 0.3, "test");
    const auto shape = test::irregular_hex_cube(2, 0.2, 12);
    const Mat3 R = Random(3).rotation();
    Mat3 e;
    e << 0.02, 0.01, 0.03, 0.01, -0.05, 0.02, 0.03, 0.02, 0.04;
    std::vector<Vec3> x = shape->mesh().vertices;
    for (Vec3& v : x) v = R * (v + e * v);
    const Mat3 sigma = R * (2 * lame.mu_pa * e + lame.lambda_pa * e.trace() * Mat3::Identity()) * R.transpose();
    const Evaluation result = evaluate(*shape, Corotational{.young_pa = 1e4, .poisson = 0.3}, x);
    EXPECT_NEAR(result.energy_j, lame.mu_pa * e.squaredNorm() + lame.lambda_pa / 2 * e.trace() * e.trace(), 1e-9);
    for (const Voigt& s : result.element_stress_pa) {
        const double expected[6] = {sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(2, 0)};
        for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(s[c], expected[c], 1e-9 * sigma.norm());
    }
}

TEST(Hex, RigidMotionsAreFreeAndForcesTurnWithTheBody) {
    const auto shape = test::irregular_hex_cube(3, 0.2, 13);
    const auto& X = shape->mesh().vertices;
    Random random(14);
    std::vector<Vec3> bent = X;
    for (Vec3& v : bent) v += 0.1 * Vec3(std::sin(3 * v.y()), std::sin(2 * v.z()), std::cos(4 * v.x()));
    for (const Rotation rotation : {Rotation::large, Rotation::polar, Rotation::svd}) {
        const Corotational material{.rotation = rotation, .young_pa = 1e4, .poisson = 0.3};
        const std::vector<Vec3> force = evaluate(*shape, material, bent).forces_n;
        for (int trial = 0; trial < 5; ++trial) {
            const Mat3 R = random.rotation();
            const Vec3 c = random.vector(3);
            std::vector<Vec3> rigid, turned, expected;
            for (std::size_t i = 0; i < X.size(); ++i) {
                rigid.push_back(R * X[i] + c);
                turned.push_back(R * bent[i] + c);
                expected.push_back(R * force[i]);
            }
            for (const Vec3& f : evaluate(*shape, material, rigid).forces_n) EXPECT_LT(f.norm(), 1e-10 * 1e4);
            EXPECT_LT(test::relative_difference(evaluate(*shape, material, turned).forces_n, expected), 1e-11);
        }
        Vec3 sum = Vec3::Zero();
        for (const Vec3& f : force) sum += f;
        EXPECT_LT(sum.norm(), 1e-11 * 1e4);
    }
}

/// Forces and matrix of a layout by one instruction set.
struct Computed {
    std::vector<Vec3> force, product;
    AlignedVector<double> stress, energy, quaternion, corner;
    std::vector<float> matrix_f;
    std::vector<double> matrix_d;
};

template <class Real>
constexpr fem::MatrixPrecision kPrecision = std::is_same_v<Real, float> ? fem::MatrixPrecision::single : fem::MatrixPrecision::double_;

template <class Real>
Computed run(const BodyTemplate& shape, const fem::ElementMaterials& materials, Isa isa, std::span<const Vec3> x, std::span<const Vec3> field, bool exact = false) {
    const TemplateData& data = shape.data();
    const fem::ElementLayout layout = fem::make_layout(data.mesh, materials.families(data.mesh.element_count()));
    const auto gather = make_gather_maps(data.mesh, data.pattern, layout);
    fem::ElementsDef def;
    def.layout = &layout;
    def.pattern = {data.pattern.row_start, data.pattern.column, data.pattern.mirror};
    for (const auto& map : gather) def.contributions.push_back({map.start, map.pair});
    def.precision = kPrecision<Real>;
    def.isa = isa;
    def.exact_rotation = exact;
    const auto elements = fem::make_elements(def, materials);
    Team team;
    Computed r;
    r.quaternion.resize(layout.blocks * 4 * fem::kBlock);
    fem::seed_rotations(team, layout, x, r.quaternion);
    r.corner.resize(layout.places * 4);
    r.energy.resize(layout.blocks * fem::kBlock);
    r.stress.resize(layout.blocks * 6 * fem::kBlock);
    fem::ElementOutputs outputs{nullptr, r.corner.data(), r.energy.data(), r.stress.data(), true};
    elements->evaluate(team, x.data()->data(), r.quaternion.data(), outputs);
    r.force.resize(layout.vertices);
    fem::gather_places(layout.forces, r.corner.data(), 0, layout.vertices, r.force.data());
    r.product.resize(layout.vertices);
    fem::stiffness_product(team, *elements, layout, r.quaternion.data(), field, r.corner, r.product);
    AlignedVector<Real> value(data.pattern.blocks() * 12, Real(77));
    elements->assemble(team, 2.0, std::vector<double>(layout.vertices, 0.0), value.data());
    if constexpr (std::is_same_v<Real, float>) {
        r.matrix_f.assign(value.begin(), value.end());
    } else {
        r.matrix_d.assign(value.begin(), value.end());
    }
    return r;
}

template <class Real>
std::vector<Vec3> multiply(const solve::Bsr3Pattern& p, const std::vector<Real>& value, std::span<const Vec3> x) {
    std::vector<Vec3> y(p.rows, Vec3::Zero());
    for (std::size_t row = 0; row < p.rows; ++row)
        for (std::int32_t b = p.row_start[row]; b < p.row_start[row + 1]; ++b)
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i) y[std::size_t(p.vertex[row])][i] += double(value[std::size_t(b) * 12 + std::size_t(4 * j + i)]) * x[std::size_t(p.vertex[std::size_t(p.column[std::size_t(b)])])][j];
    return y;
}

/// Tets on hexes: a cube of 3x3x3 hexes with its uppermost layer cut into tets (a crack of half a face diagonal stays where their diagonals meet nothing).
VolumeMesh mixed_mesh() {
    VolumeMesh mesh = make_hex_box({.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {3, 3, 3}});
    const VolumeMesh tets = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {3, 3, 3}});
    mesh.hexes.resize(18);
    mesh.tets.assign(tets.tets.begin() + 18 * 6, tets.tets.end());
    Random random(15);
    for (Vec3& x : mesh.vertices) x += random.vector(0.03);
    return mesh;
}

/// Three laws over the elements of a mesh.
fem::ElementMaterials three_laws(std::size_t elements) {
    fem::ElementMaterials materials;
    materials.materials = {Corotational{.young_pa = 1e4, .poisson = 0.3}, Linear{.young_pa = 2e4, .poisson = 0.4},
                           Corotational{.rotation = Rotation::large, .young_pa = 3e4, .poisson = 0.2, .integration = Integration::full},
                           Corotational{.young_pa = 5e4, .poisson = 0.45}};
    for (std::size_t e = 0; e < elements; ++e) materials.material_of_element.push_back(std::int32_t(e * 7 % 4));
    return materials;
}

double largest(const AlignedVector<double>& values) {
    double size = 0;
    for (const double v : values) size = std::max(size, std::abs(v));
    return size;
}

void check_every_isa(const BodyTemplate& shape, const fem::ElementMaterials& materials, bool exact = false) {
    Random random(16);
    std::vector<Vec3> x = shape.mesh().vertices, field(x.size());
    const Mat3 Q = random.rotation();
    for (Vec3& v : x) v = Q * (v + random.vector(0.04));
    for (Vec3& v : field) v = random.vector(1);
    const Computed oracle = run<double>(shape, materials, Isa::scalar, x, field, exact);
    const auto through_matrix = multiply(shape.data().pattern, oracle.matrix_d, field);
    std::vector<Vec3> twice = oracle.product;
    for (Vec3& v : twice) v *= 2;
    EXPECT_LT(test::relative_difference(through_matrix, twice), 1e-12) << "assembled matrix and matrix-free product differ";
    for (const Isa isa : test::supported_isas()) {
        SCOPED_TRACE(name(isa));
        const Computed wide = run<double>(shape, materials, isa, x, field, exact);
        EXPECT_LT(test::relative_difference(wide.force, oracle.force), 1e-12);
        EXPECT_LT(test::relative_difference(wide.product, oracle.product), 1e-12);
        EXPECT_LT(test::relative_difference(multiply(shape.data().pattern, wide.matrix_d, field), twice), 1e-12);
        EXPECT_LT(test::relative_difference(multiply(shape.data().pattern, run<float>(shape, materials, isa, x, field, exact).matrix_f, field), twice), 1e-5);
        for (std::size_t i = 0; i < oracle.energy.size(); ++i) EXPECT_NEAR(wide.energy[i], oracle.energy[i], 1e-11 * largest(oracle.energy));
        for (std::size_t i = 0; i < oracle.stress.size(); ++i) EXPECT_NEAR(wide.stress[i], oracle.stress[i], 1e-11 * largest(oracle.stress));
        for (std::size_t i = 0; i < oracle.quaternion.size(); ++i) EXPECT_NEAR(wide.quaternion[i], oracle.quaternion[i], 1e-12);
    }
}

TEST(HexKernels, EveryInstructionSetAgreesWithScalarAndTheMatrixWithTheProduct) {
    const auto irregular = test::irregular_hex_cube(3, 0.2, 17);  // 27: the tail is under test too
    const auto lattice = test::hex_bar({5, 2, 2});
    for (const Rotation rotation : {Rotation::large, Rotation::polar, Rotation::svd}) {
        for (const auto& shape : {irregular, lattice}) {
            for (const bool exact : {false, true}) check_every_isa(*shape, {{Corotational{.rotation = rotation, .young_pa = 1e4, .poisson = 0.4}}, {}, {}}, exact);
        }
    }
    check_every_isa(*irregular, {{Linear{.young_pa = 1e4, .poisson = 0.4}}, {}, {}});
}

TEST(ElementGroups, MixedKindsAndLawsAgreeOnEveryInstructionSet) {
    const auto shape = BodyTemplate::build(mixed_mesh());
    EXPECT_EQ(shape->data().layout.groups.size(), 2u);
    check_every_isa(*shape, {{Corotational{.young_pa = 1e4, .poisson = 0.4}}, {}, {}});
    for (const bool exact : {false, true}) check_every_isa(*shape, three_laws(shape->mesh().element_count()), exact);
}

/// Hyperelastic laws with fibres, projected and not, beside corotational elements; a stiffness factor per element.
fem::ElementMaterials hyperelastic_laws(const VolumeMesh& mesh) {
    Random random(19);
    Fibres fibres{.sheet = {Vec3(0.1, 1, -0.3)}, .fibre_stiffness_pa = 3e4, .fibre_exponent = 2, .sheet_stiffness_pa = 1e4};
    for (std::size_t e = 0; e < mesh.element_count(); ++e) fibres.fibre.push_back(random.vector(1));
    fem::ElementMaterials materials;
    materials.materials = {NeoHookean{1e4, 4e4, fibres}, NeoHookean{3e4, 4e4}, Corotational{.young_pa = 5e4, .poisson = 0.45},
                           Ogden{{{5e4, 3}, {2e4, -2}}, 1e5, fibres, false}, Ogden{{{5e4, 3}}, 1e5}, Costa{4e4, 6e4, {8, 4, 2, 4, 3, 2}, fibres}};
    for (std::size_t e = 0; e < mesh.element_count(); ++e) {
        materials.material_of_element.push_back(std::int32_t(e * 7 % 6));
        materials.stiffness_factor.push_back(0.5 + double(e % 3));
    }
    return materials;
}

/// The material of one element as that of a body of it alone.
fem::ElementMaterials alone(const fem::ElementMaterials& materials, std::size_t e) {
    Material material = materials.of(e);
    std::visit(
        [&](auto& m) {
            if constexpr (requires { m.fibres; }) {
                if (m.fibres.fibre.size() > 1) m.fibres.fibre = {m.fibres.fibre[e]};
            }
        },
        material);
    return {{material}, {}, {materials.factor(e)}};
}

/// Every element alone, with its own material, against all together.
void check_sum_of_elements(const fem::ElementMaterials& materials, std::size_t groups, const BodyTemplate& shape) {
    const VolumeMesh& mesh = shape.mesh();
    Random random(18);
    std::vector<Vec3> x = mesh.vertices, field(x.size());
    for (Vec3& v : x) v += random.vector(0.04);
    for (Vec3& v : field) v = random.vector(1);
    const fem::ElementLayout layout = fem::make_layout(mesh, materials.families(mesh.element_count()));
    EXPECT_EQ(layout.groups.size(), groups);
    const Computed together = run<double>(shape, materials, best_isa(), x, field);
    std::vector<Vec3> force(x.size(), Vec3::Zero()), product = force;
    for (std::size_t e = 0; e < mesh.element_count(); ++e) {
        VolumeMesh one;
        one.vertices = mesh.vertices;
        if (e < mesh.tets.size()) one.tets = {mesh.tets[e]};
        if (e >= mesh.tets.size()) one.hexes = {mesh.hexes[e - mesh.tets.size()]};
        const auto single = BodyTemplate::build(one);
        const Computed part = run<double>(*single, alone(materials, e), best_isa(), x, field);
        for (std::size_t i = 0; i < x.size(); ++i) {
            force[i] += part.force[i];
            product[i] += part.product[i];
        }
        const std::size_t slot = layout.slot[e];
        EXPECT_NEAR(together.energy[slot], part.energy[0], 1e-9);
        for (std::size_t c = 0; c < 6; ++c) {
            EXPECT_NEAR(together.stress[(slot / 8 * 6 + c) * 8 + slot % 8], part.stress[c * 8], 1e-12 * largest(together.stress));
        }
        EXPECT_DOUBLE_EQ(layout.volume[e], single->data().layout.volume[0]);
    }
    EXPECT_LT(test::relative_difference(together.force, force), 1e-12);
    EXPECT_LT(test::relative_difference(together.product, product), 1e-12);
}

TEST(ElementGroups, ABodyOfManyLawsIsTheSumOfItsElements) {
    const auto shape = BodyTemplate::build(mixed_mesh());
    check_sum_of_elements(three_laws(shape->mesh().element_count()), 6, *shape);  // three families of laws on two kinds
    const fem::ElementMaterials many = hyperelastic_laws(shape->mesh());
    check_sum_of_elements(many, 10, *shape);
    check_every_isa(*shape, many);
}

TEST(ElementGroups, ManyNumbersOfOneFamilyAreOneGroup) {
    const auto shape = BodyTemplate::build(make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {2, 2, 2}}));
    fem::ElementMaterials materials;
    materials.materials = {NeoHookean{1, 2}, NeoHookean{3, 4}};
    for (std::size_t e = 0; e < 48; ++e) materials.material_of_element.push_back(std::int32_t(e % 2));
    EXPECT_EQ(fem::make_layout(shape->mesh(), materials.families(48)).groups.size(), 1u);
    materials.materials[1] = Ogden{};
    EXPECT_EQ(fem::make_layout(shape->mesh(), materials.families(48)).groups.size(), 2u);
}

TEST(Hex, LumpedMassAndCornerVolumesAddUp) {
    const auto shape = BodyTemplate::build(mixed_mesh());
    double mass = 0, volume = 0;
    for (const double m : fem::lumped_mass(shape->mesh(), std::vector<double>{1234})) {
        EXPECT_GT(m, 0);
        mass += m;
    }
    for (const double v : shape->data().layout.volume) volume += v;
    EXPECT_NEAR(volume, shape->report().volume_m3, 1e-14);
    EXPECT_NEAR(mass, 1234 * volume, 1e-9);
}

TEST(Hex, DegenerateConfigurationsStayFinite) {
    const auto shape = test::irregular_hex_cube(2, 0.2, 19);
    for (int kind = 0; kind < 4; ++kind) {
        std::vector<Vec3> x = shape->mesh().vertices;
        for (Vec3& v : x) {
            if (kind == 0) v.y() = 0;
            if (kind == 1) v = Vec3(v.x(), 0, 0);
            if (kind == 2) v = Vec3(1, 2, 3);
            if (kind == 3) v.z() = -v.z();
        }
        for (const Rotation rotation : {Rotation::large, Rotation::polar, Rotation::svd}) {
            const fem::ElementMaterials materials{{Corotational{.rotation = rotation, .young_pa = 1e4, .poisson = 0.3}}, {}, {}};
            for (const Isa isa : test::supported_isas()) {
                const Computed r = run<float>(*shape, materials, isa, x, x);
                EXPECT_TRUE(test::all_finite(r.force));
                EXPECT_TRUE(test::all_finite(r.product));
                for (const double s : r.stress) EXPECT_TRUE(std::isfinite(s));
            }
        }
    }
}

// -- plastic strain -----------------------------------------------------------------------------------

/// Forces and energy of a body of one material whose elements carry plastic strains, and a step of flow.
struct Strained {
    std::vector<Vec3> force;
    double energy = 0;
    AlignedVector<double> stress, plastic;

    Strained(const BodyTemplate& shape, const Material& material, std::span<const Vec3> x, const AlignedVector<double>& strain, Isa isa = Isa::scalar, double flow_s = 0) : plastic(strain) {
        const fem::ElementLayout& layout = shape.data().layout;
        fem::ElementsDef def;
        def.layout = &layout;
        def.isa = isa;
        const auto elements = fem::make_elements(def, {{material}, {}, {}});
        Team alone;
        AlignedVector<double> q(layout.blocks * 4 * fem::kBlock), corner(layout.places * 4), energies(layout.blocks * fem::kBlock);
        stress.resize(layout.blocks * 6 * fem::kBlock);
        fem::seed_rotations(alone, layout, x, q);
        if (flow_s > 0) elements->flow(alone, x.data()->data(), q.data(), plastic.data(), flow_s);
        fem::ElementOutputs outputs;
        outputs.plastic = plastic.data();
        outputs.force = corner.data();
        outputs.energy = energies.data();
        outputs.stress = stress.data();
        elements->evaluate(alone, x.data()->data(), q.data(), outputs);
        force.resize(x.size());
        fem::gather(alone, layout.forces, corner, force);
        for (const double w : energies) energy += w;
    }
};

/// Plastic strains without a trace, one for each element or one for all.
AlignedVector<double> plastic_strains(const BodyTemplate& shape, double size, std::uint64_t seed, bool uniform) {
    AlignedVector<double> strain(shape.data().layout.blocks * 6 * fem::kBlock);
    for (std::size_t i = 0; i < shape.data().layout.blocks * fem::kBlock; ++i) {
        Random random(seed + (uniform ? 0 : i));
        double e[6];
        for (double& c : e) c = random.uniform(-size, size);
        e[2] = -e[0] - e[1];
        for (std::size_t c = 0; c < 6; ++c) strain[(i / 8 * 6 + c) * 8 + i % 8] = e[c];
    }
    return strain;
}

Mat3 strain_of(const AlignedVector<double>& strain) {
    Mat3 e;
    e << strain[0], strain[24], strain[40], strain[24], strain[8], strain[32], strain[40], strain[32], strain[16];
    return e;
}

const Plasticity kFlows{.yield = 0.01, .max = 0.2, .creep_1_s = 3};

std::vector<Material> plastic_materials() {
    std::vector<Material> all;
    for (const Integration integration : kBoth) {
        all.emplace_back(Linear{.young_pa = 1e4, .poisson = 0.3, .plasticity = kFlows, .integration = integration});
        for (const Rotation rotation : {Rotation::large, Rotation::polar, Rotation::svd}) {
            all.emplace_back(Corotational{.rotation = rotation, .young_pa = 1e4, .poisson = 0.3, .plasticity = kFlows, .integration = integration});
        }
    }
    return all;
}

TEST(HexPlasticity, ABodyStrainedAsItHasFlowedIsAtRest) {
    for (const auto& shape : {test::irregular_hex_cube(3, 0.25, 41), test::hex_bar({4, 2, 2})}) {
        const auto strain = plastic_strains(*shape, 0.1, 42, true);
        const Mat3 U = Mat3::Identity() + strain_of(strain), Q = Random(43).rotation();
        for (const Material& material : plastic_materials()) {
            // The edge frame of the strained element is not that of its polar factor: turn none, and leave `large` a strain that keeps its edges' directions.
            const auto* corotational = std::get_if<Corotational>(&material);
            if (corotational != nullptr && corotational->rotation == Rotation::large) continue;
            const Mat3 F = corotational != nullptr ? Mat3(Q * U) : U;
            std::vector<Vec3> x = shape->mesh().vertices;
            for (Vec3& v : x) v = F * v + Vec3(1, 2, 3);
            const Strained body(*shape, material, x, strain);
            for (const Vec3& f : body.force) EXPECT_LT(f.norm(), 1e-11 * 1e4);
            EXPECT_NEAR(body.energy, 0, 1e-12 * 1e4);
            EXPECT_LT(largest(body.stress), 1e-11 * 1e4);
        }
    }
}

TEST(HexPlasticity, ForceIsTheDerivativeOfTheEnergyWhereTheFrameStandsStill) {
    const auto shape = test::irregular_hex_cube(2, 0.25, 44);
    const auto strain = plastic_strains(*shape, 0.1, 45, false);
    for (const Integration integration : kBoth) {
        const Linear material{.young_pa = 1e4, .poisson = 0.3, .plasticity = kFlows, .integration = integration};
        Random random(46);
        std::vector<Vec3> x = shape->mesh().vertices, d(x.size());
        for (Vec3& v : x) v += random.vector(0.1);
        for (Vec3& v : d) v = random.vector(1);
        std::vector<Vec3> ahead = x, behind = x;
        for (std::size_t i = 0; i < x.size(); ++i) {
            ahead[i] += 1e-3 * d[i];  // quadratic: differences are exact
            behind[i] -= 1e-3 * d[i];
        }
        const Strained body(*shape, material, x, strain);
        double work = 0, scale = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            work += body.force[i].dot(d[i]);
            scale += std::abs(body.force[i].dot(d[i]));
        }
        EXPECT_NEAR((Strained(*shape, material, ahead, strain).energy - Strained(*shape, material, behind, strain).energy) / 2e-3, -work, 1e-10 * scale);
        const Strained elastic(*shape, material, x, AlignedVector<double>(strain.size()));
        EXPECT_GT(test::relative_difference(body.force, elastic.force), 0.1) << "plastic strain does nothing";
    }
}

TEST(HexPlasticity, TurnsWithTheBodyAndLeavesItsMomentum) {
    const auto shape = test::irregular_hex_cube(2, 0.25, 47);
    const auto strain = plastic_strains(*shape, 0.1, 48, false);
    Random random(49);
    const Mat3 Q = random.rotation();
    std::vector<Vec3> x = shape->mesh().vertices, turned;
    for (Vec3& v : x) {
        v += random.vector(0.1);
        turned.push_back(Q * v);
    }
    for (const Material& material : plastic_materials()) {
        const Strained body(*shape, material, x, strain);
        Vec3 sum = Vec3::Zero();
        std::vector<Vec3> expected;
        for (const Vec3& f : body.force) {
            sum += f;
            expected.push_back(Q * f);
        }
        EXPECT_LT(sum.norm(), 1e-11 * 1e4);
        if (std::holds_alternative<Linear>(material)) continue;
        const Strained other(*shape, material, turned, strain);
        EXPECT_LT(test::relative_difference(other.force, expected), 1e-10);
        EXPECT_NEAR(other.energy, body.energy, 1e-11 * std::abs(body.energy));
    }
}

TEST(HexPlasticity, EveryInstructionSetAgreesWithScalar) {
    const auto shape = test::irregular_hex_cube(3, 0.2, 50);
    const auto strain = plastic_strains(*shape, 0.1, 51, false);
    Random random(52);
    const Mat3 Q = random.rotation();
    std::vector<Vec3> x = shape->mesh().vertices;
    for (Vec3& v : x) v = Q * (v + random.vector(0.05));
    for (const Material& material : plastic_materials()) {
        const Strained oracle(*shape, material, x, strain, Isa::scalar, 0.2);
        double moved = 0;
        for (std::size_t i = 0; i < strain.size(); ++i) moved = std::max(moved, std::abs(oracle.plastic[i] - strain[i]));
        EXPECT_GT(moved, 1e-3) << "nothing flowed";
        for (const Isa isa : test::supported_isas()) {
            const Strained wide(*shape, material, x, strain, isa, 0.2);
            EXPECT_LT(test::relative_difference(wide.force, oracle.force), 1e-12) << name(isa);
            EXPECT_NEAR(wide.energy, oracle.energy, 1e-12 * std::abs(oracle.energy)) << name(isa);
            for (std::size_t i = 0; i < strain.size(); ++i) {
                EXPECT_NEAR(wide.plastic[i], oracle.plastic[i], 1e-14) << name(isa);
                EXPECT_NEAR(wide.stress[i], oracle.stress[i], 1e-11 * largest(oracle.stress)) << name(isa);
            }
        }
    }
}

TEST(Hex, FoldedShapesAreRefusedByName) {
    VolumeMesh mesh = make_hex_box({.min_m = Vec3::Zero(), .max_m = {2, 1, 1}, .cells = {2, 1, 1}});
    mesh.vertices[4] = Vec3(0.9, 0.9, 0.05);  // an edge of hex 1 pulled through its neighbours
    mesh.vertices[10] = Vec3(-3, 0.5, 0.5);
    try {
        BodyTemplate::build(mesh);
        ADD_FAILURE() << "a folded mesh was accepted";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
        EXPECT_NE(std::string(e.what()).find("Jacobian"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("hex 0"), std::string::npos) << e.what();
    }
}

}  // namespace
}  // namespace supple
