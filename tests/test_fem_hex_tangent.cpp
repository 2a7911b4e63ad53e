// The exact tangent of hexahedra: the derivative of their frame.
#include <gtest/gtest.h>

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

std::vector<Vec3> difference_of_forces(const BodyTemplate& shape, const Material& material, const std::vector<Vec3>& x, const std::vector<Vec3>& d) {
    const double h = 1e-6;
    std::vector<Vec3> ahead = x, behind = x, difference(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        ahead[i] += h * d[i];
        behind[i] -= h * d[i];
    }
    const auto up = evaluate(shape, material, ahead).forces_n, down = evaluate(shape, material, behind).forces_n;
    for (std::size_t i = 0; i < x.size(); ++i) difference[i] = (up[i] - down[i]) / (2 * h);
    return difference;
}

/// A cube, a parallelepiped and two free shapes.
std::vector<std::shared_ptr<const BodyTemplate>> hex_shapes() {
    Mat3 skew;
    skew << 1, 0.4, -0.2, 0, 0.7, 0.3, 0.1, 0, 1.3;
    std::vector<std::shared_ptr<const BodyTemplate>> shapes;
    for (const double shake : {0.0, 0.0, 0.15, 0.15}) {
        VolumeMesh mesh;
        const fem::HexShape X = shaken_cube(shake, std::uint64_t(60 + shapes.size()));
        mesh.vertices.assign(X.begin(), X.end());
        if (shapes.size() % 2 == 1)
            for (Vec3& v : mesh.vertices) v = skew * v;
        mesh.hexes = {{0, 1, 2, 3, 4, 5, 6, 7}};
        shapes.push_back(BodyTemplate::build(std::move(mesh)));
    }
    return shapes;
}

TEST(HexExactTangent, Row3IsTheDerivativeOfTheForceOfUniformlyStrainedHexesOfAnyShape) {
    auto shapes = hex_shapes();
    shapes.push_back(test::irregular_hex_cube(2, 0.25, 61));
    Random random(62);
    for (const auto& shape : shapes) {
        for (const Integration integration : kBoth) {
            for (const Rotation rotation : {Rotation::polar, Rotation::svd}) {
                const Corotational material{.rotation = rotation, .young_pa = 1e4, .poisson = 0.3, .integration = integration};
                for (int trial = 0; trial < 3; ++trial) {
                    const Mat3 F = random.rotation() * (Mat3::Identity() + random.matrix(0.3));
                    std::vector<Vec3> x, d;
                    for (const Vec3& X : shape->mesh().vertices) {
                        x.push_back(F * X + Vec3(1, 2, 3));
                        d.push_back(random.vector(1));  // any motion, bending and twisting too
                    }
                    const auto difference = difference_of_forces(*shape, material, x, d);
                    EXPECT_LT(test::relative_difference(force_differential(*shape, material, x, d, Tangent::exact), difference), 1e-6);
                    EXPECT_GT(test::relative_difference(force_differential(*shape, material, x, d, Tangent::warped), difference), 1e-3);
                }
            }
        }
    }
}

TEST(HexExactTangent, WhatItLacksInBentHexesIsDrivenByTheirTwistAlone) {
    // r x q - K0 (r x z), top of hex8_kernels_impl.h: nothing where the mean gradient is not twisted; its forces do no work on uniform strains; in proportion to the bending.
    for (const auto& shape : hex_shapes()) {
        const auto& X = shape->mesh().vertices;
        const Corotational material{.young_pa = 1e4, .poisson = 0.3};
        const fem::HexShape corners = fem::hex_shape(X, shape->mesh().hexes[0]);
        fem::HexGradients mean = fem::HexGradients::Zero();
        double volume = 0;
        for (std::size_t q = 0; q < 8; ++q) {
            const fem::HexPoint point = fem::hex_point(corners, fem::hex_gauss_point(q));
            mean += point.determinant * point.gradient;
            volume += point.determinant;
        }
        mean /= volume;
        Random random(63);
        const Mat3 Q = random.rotation(), S = Mat3::Identity() + 0.1 * Mat3(Vec3(1, -2, 1.5).asDiagonal());
        std::vector<Vec3> bend(8), d(8);
        for (Vec3& v : bend) v = random.vector(0.1);
        for (Vec3& v : d) v = random.vector(1);
        const auto gradient_of = [&](const std::vector<Vec3>& v) {
            Mat3 G = Mat3::Zero();
            for (std::size_t a = 0; a < 8; ++a) G += v[a] * mean.row(Eigen::Index(a));
            return G;
        };
        const Mat3 affine = gradient_of(bend);
        for (std::size_t a = 0; a < 8; ++a) bend[a] -= affine * X[a];
        const auto lack = [&](double amount, const std::vector<Vec3>& direction) {
            std::vector<Vec3> x(8);
            for (std::size_t a = 0; a < 8; ++a) x[a] = Q * (S * X[a] + amount * bend[a]);
            const auto difference = difference_of_forces(*shape, material, x, direction), own = force_differential(*shape, material, x, direction, Tangent::exact);
            std::vector<Vec3> rest(8);
            for (std::size_t a = 0; a < 8; ++a) rest[a] = difference[a] - own[a];
            return rest;
        };
        const auto size = [](const std::vector<Vec3>& v) { return test::relative_difference(v, std::vector<Vec3>(8, Vec3::Zero())); };
        const auto whole = lack(1, d), half = lack(0.5, d);
        EXPECT_GT(size(whole), 1);
        EXPECT_NEAR(size(half), 0.5 * size(whole), 1e-3 * size(whole));
        Mat3 work = Mat3::Zero();
        for (std::size_t a = 0; a < 8; ++a) work += whole[a] * X[a].transpose();
        EXPECT_LT(work.norm(), 1e-5 * size(whole));
        const Mat3 G = Q.transpose() * gradient_of(d), twist = Q * Mat3(0.5 * (G - G.transpose()));
        std::vector<Vec3> untwisted = d;
        for (std::size_t a = 0; a < 8; ++a) untwisted[a] -= twist * X[a];
        EXPECT_LT(size(lack(1, untwisted)), 1e-5 * size(whole));
    }
}

/// Stiffness of a body of one hex by the tangent of elements.
Eigen::MatrixXd stiffness_of(const BodyTemplate& shape, const Material& material, std::span<const Vec3> x, bool project, bool exact) {
    const fem::ElementLayout& layout = shape.data().layout;
    fem::ElementsDef def;
    def.layout = &layout;
    def.project = project;
    def.exact_rotation = exact;
    const auto elements = fem::make_elements(def, {{material}, {}, {}});
    Team alone;
    AlignedVector<double> q(layout.blocks * 4 * fem::kBlock), corner(layout.places * 4);
    fem::seed_rotations(alone, layout, x, q);
    fem::ElementOutputs outputs;
    outputs.tangent = true;
    elements->evaluate(alone, x.data()->data(), q.data(), outputs);
    Eigen::MatrixXd K(24, 24);
    std::vector<Vec3> out(8);
    for (Eigen::Index j = 0; j < 24; ++j) {
        std::vector<Vec3> d(8, Vec3::Zero());
        d[std::size_t(j / 3)][j % 3] = 1;
        fem::stiffness_product(alone, *elements, layout, q.data(), d, corner, out);
        for (Eigen::Index i = 0; i < 24; ++i) K(i, j) = out[std::size_t(i / 3)][i % 3];
    }
    return K;
}

TEST(HexExactTangent, ClampedItIsPositiveSemidefiniteInAnyConfiguration) {
    int indefinite = 0;
    Random random(64);
    for (const auto& shape : hex_shapes()) {
        const Corotational material{.young_pa = 1e4, .poisson = 0.4};
        for (int trial = 0; trial < 40; ++trial) {
            const Mat3 F = random.matrix(1);  // every other one is inside out
            std::vector<Vec3> x;
            for (const Vec3& X : shape->mesh().vertices) x.push_back(F * X + random.vector(0.2));
            const Eigen::MatrixXd clamped = stiffness_of(*shape, material, x, true, true), raw = stiffness_of(*shape, material, x, false, true);
            EXPECT_LT((clamped - clamped.transpose()).norm(), 1e-11 * clamped.norm());
            EXPECT_LT((raw - raw.transpose()).norm(), 1e-11 * raw.norm());
            const Eigen::VectorXd values = eigenvalues(clamped);
            EXPECT_GE(values.minCoeff(), -1e-12 * values.maxCoeff());
            indefinite += eigenvalues(raw).minCoeff() < -1e-6 * values.maxCoeff();
        }
    }
    EXPECT_GT(indefinite, 20) << "nothing was there to be clamped";
}

TEST(HexExactTangent, NewtonConvergesQuadraticallyWithItAndLinearlyWithoutIt) {
    // A hex under the dead forces that stretch it uniformly, from a turned and strained start.
    for (const auto& shape : hex_shapes()) {
        const auto& X = shape->mesh().vertices;
        const Corotational material{.young_pa = 1e4, .poisson = 0.3};
        Mat3 F;
        F << 1.3, 0.2, 0.1, -0.1, 1.2, 0.2, 0, -0.1, 1.4;
        std::vector<Vec3> goal;
        for (const Vec3& v : X) goal.push_back(F * v);
        const auto load = evaluate(*shape, material, goal).forces_n;
        const auto residuals = [&](bool exact) {
            std::vector<Vec3> x;
            const Mat3 start = Random(65).matrix(0.15) + F;
            for (const Vec3& v : X) x.push_back(start * v);
            std::vector<double> norms;
            for (int k = 0; k < 12; ++k) {
                const auto f = evaluate(*shape, material, x).forces_n;
                Eigen::VectorXd r(24);
                for (std::size_t a = 0; a < 8; ++a) r.segment<3>(Eigen::Index(3 * a)) = f[a] - load[a];
                norms.push_back(r.norm());
                Eigen::MatrixXd K = stiffness_of(*shape, material, x, false, exact);
                const Eigen::VectorXd dx = K.completeOrthogonalDecomposition().solve(r);
                for (std::size_t a = 0; a < 8; ++a) x[a] += dx.segment<3>(Eigen::Index(3 * a));
            }
            return norms;
        };
        const auto exact = residuals(true), warped = residuals(false);
        EXPECT_LT(exact[6], 1e-9 * exact[0]);
        EXPECT_LT(exact[4], 0.01 * exact[3]) << "digits double";
        EXPECT_GT(warped[11], 1e-6 * warped[0]);
        EXPECT_LT(warped[11], warped[0]);
    }
}

}  // namespace
}  // namespace supple
