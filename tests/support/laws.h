#pragma once
// One tetrahedron under a homogeneous deformation gradient, for the tests of laws.
#include <algorithm>
#include <random>

#include "supple/fem/corners.h"
#include "supple/fem/elements.h"
#include "supple/fem/rest.h"
#include "supple/mesh/volume_mesh.h"
#include "supple/world/evaluate.h"

namespace supple::test {

inline const std::vector<Vec3> kCorners{Vec3(0, 0, 0), Vec3(1, 0.1, 0), Vec3(0.2, 0.9, 0.1), Vec3(0.1, 0.3, 1.1)};

/// One tetrahedron under a homogeneous deformation gradient.
struct OneTet {
    std::shared_ptr<const BodyTemplate> shape;
    double volume;

    OneTet() {
        VolumeMesh mesh;
        mesh.vertices = kCorners;
        mesh.tets = {{0, 1, 2, 3}};
        shape = BodyTemplate::build(mesh);
        volume = tet_volume(kCorners[0], kCorners[1], kCorners[2], kCorners[3]);
    }
    std::vector<Vec3> at(const Mat3& F) const {
        std::vector<Vec3> x;
        for (const Vec3& X : shape->mesh().vertices) x.push_back(F * X);
        return x;
    }
    Voigt stress(const Material& m, const Mat3& F) const { return evaluate(*shape, m, at(F)).element_stress_pa[0]; }
};

inline Mat3 random_matrix(std::mt19937& random, double size) {
    std::uniform_real_distribution<double> u(-size, size);
    Mat3 A;
    for (int i = 0; i < 9; ++i) A(i / 3, i % 3) = u(random);
    return A;
}

/// Force and tangent by central differences; returns the worst relative errors.
inline std::pair<double, double> difference_errors(const OneTet& tet, const Material& m, const Mat3& F, std::mt19937& random) {
    const std::vector<Vec3> x = tet.at(F);
    const Evaluation here = evaluate(*tet.shape, m, x);
    double force_scale = 1e-12, force_error = 0, tangent_scale = 1e-12, tangent_error = 0;
    for (const Vec3& f : here.forces_n) force_scale = std::max(force_scale, f.norm());
    for (std::size_t v = 0; v < 4; ++v) {
        for (int c = 0; c < 3; ++c) {
            auto plus = x, minus = x;
            plus[v][c] += 1e-6;
            minus[v][c] -= 1e-6;
            const double slope = (evaluate(*tet.shape, m, plus).energy_j - evaluate(*tet.shape, m, minus).energy_j) / 2e-6;
            force_error = std::max(force_error, std::abs(here.forces_n[v][c] + slope));
        }
    }
    std::vector<Vec3> d(4), plus = x, minus = x;
    std::uniform_real_distribution<double> u(-1, 1);
    for (std::size_t v = 0; v < 4; ++v) {
        d[v] = Vec3(u(random), u(random), u(random));
        plus[v] += 1e-6 * d[v];
        minus[v] -= 1e-6 * d[v];
    }
    const auto df = force_differential(*tet.shape, m, x, d);
    const auto fp = evaluate(*tet.shape, m, plus).forces_n, fm = evaluate(*tet.shape, m, minus).forces_n;
    for (std::size_t v = 0; v < 4; ++v) {
        tangent_scale = std::max(tangent_scale, df[v].norm());
        tangent_error = std::max(tangent_error, (df[v] - (fp[v] - fm[v]) / 2e-6).norm());
    }
    return {force_error / force_scale, tangent_error / tangent_scale};
}

/// Stiffness of that tetrahedron at x, column by column.
inline Eigen::Matrix<double, 12, 12> element_stiffness(const Material& material, const std::vector<Vec3>& x, bool project) {
    Team alone;
    const OneTet tet;
    const fem::ElementLayout layout = fem::make_layout(tet.shape->mesh());
    fem::ElementsDef def;
    def.layout = &layout;
    def.project = project;
    const auto elements = fem::make_elements(def, fem::ElementMaterials{{material}, {}, {}});
    AlignedVector<double> q(4 * fem::kBlock, 0.0), scratch(fem::kBlock * 16);
    std::fill_n(q.begin(), fem::kBlock, 1.0);
    fem::ElementOutputs outputs;
    outputs.tangent = true;
    elements->evaluate(alone, x.data()->data(), q.data(), outputs);
    Eigen::Matrix<double, 12, 12> K;
    std::vector<Vec3> out(4);
    for (int i = 0; i < 12; ++i) {
        std::vector<Vec3> d(4, Vec3::Zero());
        d[std::size_t(i / 3)][i % 3] = 1;
        fem::stiffness_product(alone, *elements, layout, q.data(), d, scratch, out);
        for (int j = 0; j < 12; ++j) K(j, i) = out[std::size_t(j / 3)][j % 3];
    }
    return K;
}

}  // namespace supple::test
