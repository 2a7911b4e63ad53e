// Hyperelastic kernels: every instruction set against the scalar twin, and the assembled matrix against the matrix-free product.
#include <gtest/gtest.h>

#include "supple/fem/element_passes.h"
#include "supple/fem/elements.h"
#include "supple/world/template_data.h"
#include "support/bodies.h"
#include "support/elements.h"

namespace supple {
namespace {

using test::Random;

std::vector<std::pair<std::string, Material>> materials(std::size_t elements) {
    Random random(5);
    Fibres fibres;
    for (std::size_t e = 0; e < elements; ++e) fibres.fibre.push_back(random.vector(1));
    fibres.sheet = {Vec3(0.1, 1, -0.3)};
    fibres.fibre_stiffness_pa = 3e4;
    fibres.fibre_exponent = 2;
    fibres.sheet_stiffness_pa = 1e4;
    return {
        {"StVenantKirchhoff", StVenantKirchhoff{}},
        {"NeoHookean", NeoHookean{}},
        {"StableNeoHookean", StableNeoHookean{}},
        {"MooneyRivlin", MooneyRivlin{}},
        {"ArrudaBoyce", ArrudaBoyce{}},
        {"VerondaWestman", VerondaWestman{}},
        {"Ogden", Ogden{{{5e4, 3}, {2e4, -2}, {1e4, 1.3}}, 1e5}},
        {"Costa", Costa{.b = {8, 4, 2, 4, 2, 2}}},
        {"Costa in frames, with fibres", Costa{.b = {8, 4, 2, 4, 2, 2}, .fibres = fibres}},
        {"NeoHookean with fibres", NeoHookean{.fibres = fibres}},
        {"NeoHookean not projected", NeoHookean{.matrix_regularization = false}},
    };
}

/// Everything a set of elements can be asked for, in one configuration.
struct Outcome {
    AlignedVector<double> corner, energy, stress, quaternion, matrix;
    std::vector<Vec3> product;
    AlignedVector<float> matrix_f;
};

Outcome run(Isa isa, const Material& material, const TemplateData& data, std::span<const Vec3> x, std::span<const Vec3> field) {
    fem::ElementsDef def;
    def.layout = &data.layout;
    def.pattern = {data.pattern.row_start, data.pattern.column, data.pattern.mirror};
    for (const auto& map : data.gather) def.contributions.push_back({map.start, map.pair});
    def.isa = isa;
    fem::ElementMaterials of;
    of.materials = {material};
    Team team;
    Outcome r;
    const std::size_t lanes = data.layout.blocks * fem::kBlock;
    r.corner.resize(lanes * 16);
    r.energy.resize(lanes);
    r.stress.resize(lanes * 6);
    r.product.resize(x.size());
    const fem::ElementOutputs outputs{.force = r.corner.data(), .energy = r.energy.data(), .stress = r.stress.data(), .tangent = true};
    const std::vector<double> shift(x.size(), 0.125);
    const auto evaluate_with = [&](fem::MatrixPrecision precision, auto& matrix) {
        def.precision = precision;
        const auto elements = fem::make_elements(def, of);
        r.quaternion.assign(lanes * 4, 0.0);
        fem::seed_rotations(team, data.layout, x, r.quaternion);
        elements->evaluate(team, x.data()->data(), r.quaternion.data(), outputs);
        matrix.resize(data.pattern.blocks() * 12);
        elements->assemble(team, 0.5, shift, matrix.data());
        AlignedVector<double> scratch(lanes * 16);
        fem::stiffness_product(team, *elements, data.layout, r.quaternion.data(), field, scratch, r.product);
    };
    evaluate_with(fem::MatrixPrecision::single, r.matrix_f);
    evaluate_with(fem::MatrixPrecision::double_, r.matrix);
    return r;
}

template <class A, class B>
double difference(const A& a, const B& b) {
    double most = 0, size = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
        most = std::max(most, std::abs(double(a[i]) - double(b[i])));
        size = std::max(size, std::abs(double(b[i])));
    }
    return a.size() != b.size() ? HUGE_VAL : most / size;
}

/// y = matrix d, blocks in columns [x y z 0].
std::vector<Vec3> multiply(const solve::Bsr3Pattern& pattern, const AlignedVector<double>& matrix, std::span<const Vec3> d) {
    std::vector<Vec3> y(d.size(), Vec3::Zero());
    for (std::size_t row = 0; row < d.size(); ++row) {
        for (std::int32_t b = pattern.row_start[row]; b < pattern.row_start[row + 1]; ++b) {
            const Vec3& v = d[std::size_t(pattern.vertex[std::size_t(pattern.column[std::size_t(b)])])];
            for (Eigen::Index c = 0; c < 3; ++c)
                for (Eigen::Index i = 0; i < 3; ++i) y[std::size_t(pattern.vertex[row])][i] += matrix[std::size_t(b) * 12 + std::size_t(4 * c + i)] * v[c];
        }
    }
    return y;
}

void compare(double deformation, double tolerance) {
    const auto shape = test::bar({5, 3, 3});  // 270 tets: the last block is not full
    const TemplateData& data = shape->data();
    Random random(17);
    std::vector<Vec3> x = data.mesh.vertices, field;
    for (Vec3& v : x) {
        v = v + random.vector(deformation * 0.02);
        field.push_back(random.vector(1));
    }
    for (const auto& [name_of, material] : materials(data.layout.elements)) {
        const Outcome oracle = run(Isa::scalar, material, data, x, field);
        auto y = multiply(data.pattern, oracle.matrix, field);
        for (std::size_t i = 0; i < y.size(); ++i) y[i] = (y[i] - 0.125 * field[i]) / 0.5;
        EXPECT_LT(test::relative_difference(y, oracle.product), 1e-11) << name_of << ": matrix and product differ";
        for (const Isa isa : test::supported_isas()) {
            SCOPED_TRACE(name_of + ", " + std::string(name(isa)));
            const Outcome wide = run(isa, material, data, x, field);
            EXPECT_LT(difference(wide.corner, oracle.corner), tolerance);
            EXPECT_LT(difference(wide.energy, oracle.energy), tolerance);
            EXPECT_LT(difference(wide.stress, oracle.stress), tolerance);
            EXPECT_LT(test::relative_difference(wide.product, oracle.product), tolerance);
            EXPECT_LT(difference(wide.matrix, oracle.matrix), tolerance);
            EXPECT_LT(difference(wide.matrix_f, oracle.matrix), 1e-6 + tolerance);
        }
    }
}

TEST(FemHyper, EveryInstructionSetAgreesWithTheScalarTwin) { compare(0.3, 1e-12); }

TEST(FemHyper, AlsoWhereElementsAreFlatAndInverted) { compare(2.5, 1e-8); }

}  // namespace
}  // namespace supple
