// Products of hexahedra without a matrix: the assembled matrix's product and diagonal, on every instruction set.
#include <gtest/gtest.h>

#include "supple/base/error.h"
#include "supple/fem/elements.h"
#include "supple/fem/hex8_products.h"
#include "supple/world/template_data.h"
#include "support/bodies.h"
#include "support/elements.h"
#include "support/hexes.h"

namespace supple {
namespace {

using test::Random;

constexpr double kFactor = 2.5;

/// y and the diagonal blocks by rows, from the products or from the matrix of the same elements.
struct Operated {
    std::vector<double> product, diagonal;
    double dot = 0;
};

struct Case {
    std::shared_ptr<const BodyTemplate> shape;
    fem::ElementMaterials materials;
    bool exact = false;
    double shake = 0.004;  ///< of the corners [m]
};

std::vector<Vec3> deformed(const Case& c) {
    Random random(21);
    const Mat3 Q = random.rotation(), A = Mat3::Identity() + random.matrix(0.2);
    std::vector<Vec3> x = c.shape->mesh().vertices;
    for (Vec3& v : x) v = Q * (A * v + random.vector(c.shake));
    return x;
}

template <class Real>
Operated operate(const Case& c, Isa isa, bool by_products) {
    const TemplateData& data = c.shape->data();
    const fem::ElementLayout layout = fem::make_layout(data.mesh, c.materials.families(data.mesh.element_count()), data.pattern.row);
    const auto gather = make_gather_maps(data.mesh, data.pattern, layout);
    fem::ElementsDef def;
    def.layout = &layout;
    def.pattern = {data.pattern.row_start, data.pattern.column, data.pattern.mirror, data.pattern.row};
    for (const auto& map : gather) def.contributions.push_back({map.start, map.pair});
    def.precision = std::is_same_v<Real, float> ? fem::MatrixPrecision::single : fem::MatrixPrecision::double_;
    def.isa = isa;
    def.exact_rotation = c.exact;
    const auto elements = fem::make_elements(def, c.materials);
    Team team(by_products ? 2 : 1);
    const std::vector<Vec3> x = deformed(c);
    AlignedVector<double> quaternion(layout.blocks * 4 * fem::kBlock);
    fem::seed_rotations(team, layout, x, quaternion);
    fem::ElementOutputs outputs;
    outputs.tangent = true;
    elements->evaluate(team, x.data()->data(), quaternion.data(), outputs);
    const std::size_t n = data.pattern.rows;
    Random random(22);
    AlignedVector<Real> field(4 * n, Real(0)), y(4 * n, Real(7)), mass(n), block(12 * n, Real(7));
    std::vector<double> shift(n);
    for (std::size_t i = 0; i < n; ++i) {
        shift[i] = random.uniform(10, 40);
        mass[i] = Real(shift[i]);
        for (std::size_t k = 0; k < 3; ++k) field[4 * i + k] = Real(random.uniform(-1, 1));
    }
    Operated out;
    if (by_products) {
        EXPECT_TRUE(elements->has_products());
        fem::ElementProducts<Real>* products = elements->products(team, quaternion.data(), kFactor, Real(0));
        products->multiply(team, field.data());
        for (std::size_t begin = n; begin > 0; begin -= std::min<std::size_t>(begin, 17)) {  // any rows in any order
            out.dot += products->rows(mass.data(), field.data(), y.data(), begin - std::min<std::size_t>(begin, 17), begin);
        }
        products->diagonal(team, mass.data(), block.data());
    } else {
        AlignedVector<Real> value(data.pattern.blocks() * 12);
        elements->assemble(team, kFactor, shift, value.data());
        for (std::size_t row = 0; row < n; ++row) {
            double sum[3] = {0, 0, 0};
            for (std::int32_t b = data.pattern.row_start[row]; b < data.pattern.row_start[row + 1]; ++b)
                for (std::size_t j = 0; j < 3; ++j)
                    for (std::size_t i = 0; i < 3; ++i)
                        sum[i] += double(value[std::size_t(b) * 12 + 4 * j + i]) * double(field[4 * std::size_t(data.pattern.column[std::size_t(b)]) + j]);
            for (std::size_t i = 0; i < 4; ++i) y[4 * row + i] = i < 3 ? Real(sum[i]) : Real(0);
            for (std::size_t i = 0; i < 3; ++i) out.dot += sum[i] * double(field[4 * row + i]);
            std::copy_n(value.begin() + std::ptrdiff_t(data.pattern.diagonal[row]) * 12, 12, block.begin() + std::ptrdiff_t(12 * row));
        }
    }
    out.product.assign(y.begin(), y.end());
    out.diagonal.assign(block.begin(), block.end());
    return out;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
    double most = 0, size = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
        most = std::max(most, std::abs(a[i] - b[i]));
        size = std::max(size, std::abs(b[i]));
    }
    return most / size;
}

void check(const Case& c) {
    const Operated matrix = operate<double>(c, Isa::scalar, false);
    for (const Isa isa : test::supported_isas()) {
        SCOPED_TRACE(name(isa));
        const Operated twice = operate<double>(c, isa, true), single = operate<float>(c, isa, true);
        EXPECT_LT(difference(twice.product, matrix.product), 1e-12);
        EXPECT_LT(difference(twice.diagonal, matrix.diagonal), 1e-12);
        EXPECT_NEAR(twice.dot, matrix.dot, 1e-11 * matrix.dot);
        EXPECT_LT(difference(single.product, matrix.product), 1e-5);
        EXPECT_LT(difference(single.diagonal, matrix.diagonal), 1e-5);
        EXPECT_NEAR(single.dot, matrix.dot, 1e-5 * matrix.dot);
    }
}

fem::ElementMaterials one(const Material& material) { return {{material}, {}, {}}; }

TEST(HexProducts, AreThoseOfTheMatrixForEveryRotationAndIntegration) {
    const auto lattice = test::hex_bar({5, 2, 2});  // 20: a group and a tail
    for (const Integration integration : {Integration::full, Integration::incompatible}) {
        for (const Rotation rotation : {Rotation::large, Rotation::polar, Rotation::svd}) {
            for (const bool exact : {false, true}) {
                check({lattice, one(Corotational{.rotation = rotation, .young_pa = 1e4, .poisson = 0.4, .integration = integration}), exact});
            }
        }
        check({lattice, one(Linear{.young_pa = 1e4, .poisson = 0.3, .integration = integration})});
    }
}

TEST(HexProducts, AreThoseOfTheMatrixOverSeveralChunksAndForInvertedElements) {
    const auto large = test::hex_bar({17, 6, 6});  // 612: three chunks, a tail
    for (const bool exact : {false, true}) {
        check({large, one(Corotational{.young_pa = 1e4, .poisson = 0.45}), exact});
        check({large, one(Corotational{.rotation = Rotation::svd, .young_pa = 1e4, .poisson = 0.45}), exact, 0.04});  // corners go past one another
    }
}

TEST(HexProducts, AreThoseOfTheMatrixWhereShapesAndMaterialsDiffer) {
    Case free{test::irregular_hex_cube(3, 0.2, 17), one(Corotational{.young_pa = 1e4, .poisson = 0.4})};
    Case mixed{test::hex_bar({9, 4, 4}), {}};
    mixed.materials.materials = {Corotational{.young_pa = 1e4, .poisson = 0.3}, Corotational{.young_pa = 5e4, .poisson = 0.45}};
    for (std::size_t e = 0; e < 144; ++e) {
        mixed.materials.material_of_element.push_back(e < 40 || e % 5 == 0 ? 1 : 0);
        mixed.materials.stiffness_factor.push_back(0.5 + double(e % 3));
    }
    for (Case* c : {&free, &mixed}) {
        c->shake = 0.02;
        for (const bool exact : {false, true}) {
            c->exact = exact;
            check(*c);
        }
    }
}

TEST(HexProducts, ArePreferredWhereMostElementsShareTheirShape) {
    const auto prefers = [](const std::shared_ptr<const BodyTemplate>& shape, const fem::ElementMaterials& materials, Isa isa, bool rows = true) {
        const TemplateData& data = shape->data();
        fem::ElementsDef def;
        def.layout = &data.layout;
        def.pattern = {data.pattern.row_start, data.pattern.column, data.pattern.mirror};
        if (rows) def.pattern.row = data.pattern.row;
        for (const auto& map : data.gather) def.contributions.push_back({map.start, map.pair});
        def.precision = fem::MatrixPrecision::single;
        def.isa = isa;
        const auto elements = fem::make_elements(def, materials);
        return std::pair(elements->has_products(), elements->prefers_products());
    };
    const fem::ElementMaterials corotational = one(Corotational{.young_pa = 1e4, .poisson = 0.4});
    for (const Isa isa : test::supported_isas()) {
        const bool wide = isa == Isa::avx2 || isa == Isa::avx512;
        EXPECT_EQ(prefers(test::hex_bar({8, 4, 4}), corotational, isa), std::pair(true, wide)) << name(isa);
        EXPECT_EQ(prefers(test::hex_bar({8, 4, 4}), corotational, isa, false), std::pair(false, false));
        EXPECT_EQ(prefers(test::irregular_hex_cube(3, 0.2, 17), corotational, isa), std::pair(true, false));
        EXPECT_EQ(prefers(test::hex_bar({8, 4, 4}), one(NeoHookean{1e4, 4e4}), isa), std::pair(false, false));
        EXPECT_EQ(prefers(test::bar({4, 2, 2}), corotational, isa), std::pair(false, false));
    }
}

}  // namespace
}  // namespace supple
