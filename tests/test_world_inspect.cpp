// What the Inspector shows, against force differentials, closed forms and the step's own matrices.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "supple/world/evaluate.h"
#include "supple/world/inspect.h"
#include "supple/world/self_test.h"
#include "support/bodies.h"

namespace supple {
namespace {

const std::vector<Material>& all_laws() {
    static const std::vector<Material> laws = {Linear{}, Corotational{.rotation = Rotation::large}, Corotational{}, Corotational{.rotation = Rotation::svd},
                                               StVenantKirchhoff{}, NeoHookean{}, StableNeoHookean{}, MooneyRivlin{}, ArrudaBoyce{}, VerondaWestman{}, Ogden{}};
    return laws;
}

struct Scene {
    World world{WorldDef{.gravity_m_s2 = Vec3::Zero(), .threads = 1, .solver = {.rayleigh_mass_1_s = 3, .rayleigh_stiffness_s = 0.02}}};
    BodyId body;

    Scene(const Material& material, const Mat3& F, double shake, std::uint64_t seed) {
        const auto shape = test::irregular_cube(2, 0.2, seed);
        body = world.add_body({.shape = shape, .material = material, .density_kg_m3 = 700});
        test::Random random(seed);
        std::vector<Vec3> x = shape->mesh().vertices, v(x.size(), Vec3::Zero());
        for (Vec3& p : x) p = F * p + random.vector(shake);
        world.set_state(body, x, v);
    }
};

Eigen::VectorXd stacked(std::span<const Vec3> field) {
    Eigen::VectorXd v(Eigen::Index(3 * field.size()));
    for (std::size_t i = 0; i < field.size(); ++i) v.segment<3>(Eigen::Index(3 * i)) = field[i];
    return v;
}

TEST(WorldInspect, AStaticWorldShowsElementsInEdgeFramesAndHexesToo) {
    // Its tangent is exact, which edge frames have not: their own is shown.
    for (const bool hexes : {false, true}) {
        for (const Rotation rotation : {Rotation::large, Rotation::polar}) {
            WorldDef def{.gravity_m_s2 = Vec3::Zero(), .threads = 1};
            def.solver.integrator = Integrator::quasi_static;
            World world(def);
            const auto shape = hexes ? test::irregular_hex_cube(1, 0, 3) : test::irregular_cube(1, 0, 3);
            const BodyId body = world.add_body({.shape = shape, .material = Corotational{.rotation = rotation, .young_pa = 1e4, .poisson = 0.3}});
            std::vector<Vec3> x = shape->mesh().vertices;
            for (Vec3& p : x) p = Vec3(1.2 * p.x(), 0.9 * p.y() + 0.1 * p.z(), p.z());
            world.set_state(body, x, std::vector<Vec3>(x.size(), Vec3::Zero()));
            const ElementView view = Inspector(world, body).element(0);
            const Eigen::Index n = 3 * Eigen::Index(view.vertices.size());
            ASSERT_EQ(view.stiffness.rows(), n);
            EXPECT_TRUE(view.stiffness.allFinite());
            const MatX turned = [&] {
                MatX R = MatX::Zero(n, n);
                for (Eigen::Index a = 0; a < n / 3; ++a) R.block<3, 3>(3 * a, 3 * a) = view.rotation;
                return R;
            }();
            const double difference = (view.stiffness - turned * view.initial_stiffness * turned.transpose()).norm() / view.stiffness.norm();
            if (rotation == Rotation::large) {
                EXPECT_LT(difference, 1e-12);
            } else {
                EXPECT_GT(difference, 0.01);
            }
        }
    }
}

TEST(WorldInspect, AnElementOfARotatedAndStretchedBody) {
    const Mat3 R = Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()).toRotationMatrix(), U = Vec3(1.2, 0.9, 1.05).asDiagonal();
    for (const Material& law : all_laws()) {
        SCOPED_TRACE(law.index());
        Scene s(law, R * U, 0, 5);
        const Inspector inspector(s.world, s.body);
        const VolumeMesh& mesh = s.world.shape(s.body).mesh();
        ASSERT_EQ(inspector.element_count(), mesh.tets.size());
        double energy = 0, volume = 0;
        for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
            const ElementView view = inspector.element(e);
            EXPECT_LT((view.deformation_gradient - R * U).norm(), 1e-12);
            EXPECT_NEAR(view.rotation.determinant(), 1, 1e-12);
            const auto* corotational = std::get_if<Corotational>(&law);
            const bool large = corotational != nullptr && corotational->rotation == Rotation::large;
            if (std::holds_alternative<Linear>(law)) {
                EXPECT_EQ(view.rotation, Mat3::Identity());
            } else if (large) {
                // The first edge stays along x of the frame, the second in its plane.
                const Mat3 frame = view.rotation * view.initial_rotation;
                const auto& x = s.world.positions(s.body);
                const Vec3 first = frame.transpose() * (x[std::size_t(view.vertices[1])] - x[std::size_t(view.vertices[0])]);
                const Vec3 second = frame.transpose() * (x[std::size_t(view.vertices[2])] - x[std::size_t(view.vertices[0])]);
                EXPECT_NEAR(first.y(), 0, 1e-12);
                EXPECT_NEAR(first.z(), 0, 1e-12);
                EXPECT_NEAR(second.z(), 0, 1e-12);
            } else {
                EXPECT_LT((view.rotation - R).norm(), 1e-12);
                EXPECT_EQ(view.initial_rotation, Mat3::Identity());
            }
            for (std::size_t a = 0; a < 4; ++a) {
                EXPECT_LT((view.rotated_rest_shape_m[a] - view.rotation * view.rest_shape_m[a]).norm(), 1e-14);
                EXPECT_LT((view.rest_shape_m[a] - view.rest_shape_m[0] - (mesh.vertices[std::size_t(view.vertices[a])] - mesh.vertices[std::size_t(view.vertices[0])])).norm(), 1e-14);
            }
            for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(view.cauchy_pa[c], s.world.element_cauchy_stress(s.body)[e][c], 1e-6);
            energy += view.energy_j;
            volume += view.rest_volume_m3;
        }
        EXPECT_NEAR(energy, s.world.energy().elastic_j, 1e-10 * energy);
        EXPECT_NEAR(volume, 1, 1e-12);
    }
}

TEST(WorldInspect, StrainDisplacementAndMaterialMatrix) {
    Scene s(Corotational{.young_pa = 2e5, .poisson = 0.25}, Mat3::Identity(), 0, 6);
    const ElementView view = Inspector(s.world, s.body).element(3);
    test::Random random(6);
    const Mat3 grad = random.matrix(1);
    Eigen::VectorXd u(12);
    for (int a = 0; a < 4; ++a) u.segment<3>(3 * a) = grad * view.rest_shape_m[std::size_t(a)] + Vec3(1, 2, 3);
    const Mat3 e = 0.5 * (grad + grad.transpose());
    const Eigen::VectorXd strain = view.strain_displacement * u;
    const double expected[6] = {e(0, 0), e(1, 1), e(2, 2), 2 * e(0, 1), 2 * e(1, 2), 2 * e(2, 0)};
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(strain[i], expected[i], 1e-12);
    const Lame l = lame_parameters(2e5, 0.25, "");
    const Eigen::VectorXd stress = view.material_matrix * strain;
    const Mat3 sigma = 2 * l.mu_pa * e + l.lambda_pa * e.trace() * Mat3::Identity();
    const double components[6] = {sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(2, 0)};
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(stress[i], components[i], 1e-7);
}

TEST(WorldInspect, ElementStiffness) {
    test::Random random(7);
    const Mat3 R = random.rotation();
    for (const Material& law : all_laws()) {
        SCOPED_TRACE(law.index());
        Scene s(law, R, 0.02, 7);
        const ElementView view = Inspector(s.world, s.body).element(5);
        // At rest every law is linear elasticity with its small-strain moduli.
        const MatX K0 = view.rest_volume_m3 * view.strain_displacement.transpose() * view.material_matrix * view.strain_displacement;
        EXPECT_LT((view.initial_stiffness - K0).norm(), 1e-7 * K0.norm());
        const MatX& K = view.stiffness;
        ASSERT_EQ(K.rows(), 12);
        EXPECT_LT((K - K.transpose()).norm(), 1e-10 * K.norm());
        for (int axis = 0; axis < 3; ++axis) {
            Eigen::VectorXd t = Eigen::VectorXd::Zero(12);
            for (int a = 0; a < 4; ++a) t[3 * a + axis] = 1;
            EXPECT_LT((K * t).norm(), 1e-10 * K.norm());
        }
        if (std::holds_alternative<Linear>(law)) {
            EXPECT_LT((K - K0).norm(), 1e-9 * K0.norm());
        } else if (!is_hyperelastic(law)) {
            MatX turn = MatX::Zero(12, 12);
            for (int a = 0; a < 4; ++a) turn.block<3, 3>(3 * a, 3 * a) = view.rotation;
            EXPECT_LT((K - turn * K0 * turn.transpose()).norm(), 1e-9 * K0.norm());
        }
        // Six rigid modes at rest, all others stiff.
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<MatX>(view.initial_stiffness).eigenvalues();
        for (int i = 0; i < 6; ++i) EXPECT_LT(std::abs(values[i]), 1e-7 * values[11]);
        EXPECT_GT(values[6], 1e-4 * values[11]);
    }
}

TEST(WorldInspect, AssembledMatricesAreTheForceDifferentialAndTheSumOfTheElements) {
    test::Random random(8);
    for (const Material& law : all_laws()) {
        SCOPED_TRACE(law.index());
        Scene s(law, random.rotation(), 0.03, 8);
        const Inspector inspector(s.world, s.body);
        const std::uint64_t hash = s.world.hash();
        const Eigen::SparseMatrix<double> K = inspector.matrix(SystemMatrix::stiffness), M = inspector.matrix(SystemMatrix::mass);
        std::vector<Vec3> d(s.world.positions(s.body).size());
        for (Vec3& v : d) v = random.vector(1);
        const Eigen::VectorXd df = stacked(force_differential(s.world.shape(s.body), law, s.world.positions(s.body), d));
        EXPECT_LT((K * stacked(d) + df).norm(), 1e-8 * df.norm());
        EXPECT_LT((MatX(K) - MatX(K).transpose()).norm(), 1e-10 * K.norm());
        MatX sum = MatX::Zero(K.rows(), K.cols());
        for (std::size_t e = 0; e < inspector.element_count(); ++e) {
            const ElementView view = inspector.element(e);
            for (std::size_t a = 0; a < 4; ++a)
                for (std::size_t b = 0; b < 4; ++b)
                    sum.block<3, 3>(3 * view.vertices[a], 3 * view.vertices[b]) += view.stiffness.block<3, 3>(Eigen::Index(3 * a), Eigen::Index(3 * b));
        }
        EXPECT_LT((MatX(K) - sum).norm(), 1e-9 * K.norm());
        EXPECT_NEAR(MatX(M).sum(), 3 * 700, 1e-9);
        EXPECT_LT((MatX(inspector.matrix(SystemMatrix::damping)) - 3 * MatX(M) - 0.02 * MatX(K)).norm(), 1e-9 * K.norm());
        EXPECT_EQ(s.world.hash(), hash);
    }
}

TEST(WorldInspect, NodalVolumesAreInTheAssembledStiffness) {
    Corotational law;
    law.poisson = 0.49;
    law.volumetric = Volumetric::nodal;
    test::Random random(12);
    Scene s(law, random.rotation(), 0.02, 12);
    std::vector<Vec3> d(s.world.positions(s.body).size());
    for (Vec3& v : d) v = random.vector(1);
    const Eigen::VectorXd df = stacked(force_differential(s.world.shape(s.body), law, s.world.positions(s.body), d));
    EXPECT_LT((Inspector(s.world, s.body).matrix(SystemMatrix::stiffness) * stacked(d) + df).norm(), 1e-8 * df.norm());
}

TEST(WorldInspect, RigidModesOfTheRestStiffnessAreSix) {
    Scene s(NeoHookean{}, Mat3::Identity(), 0, 9);
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<MatX>(MatX(Inspector(s.world, s.body).matrix(SystemMatrix::stiffness))).eigenvalues();
    for (int i = 0; i < 6; ++i) EXPECT_LT(std::abs(values[i]), 1e-9 * values[values.size() - 1]);
    EXPECT_GT(values[6], 1e-4 * values[values.size() - 1]);
}

TEST(WorldInspect, AddsWithFactorAndOffsetIntoTheCallersMatrix) {
    Scene s(Corotational{}, Mat3::Identity(), 0.02, 10);
    const Inspector inspector(s.world, s.body);
    const Eigen::Index n = inspector.rows();
    const MatX K = inspector.matrix(SystemMatrix::stiffness);
    Eigen::SparseMatrix<double> sparse(n + 5, n + 7);
    sparse.coeffRef(0, 0) = 4;
    MatX dense = MatX::Constant(n + 5, n + 7, 1.5);
    inspector.add_to(SystemMatrix::stiffness, -2, 5, 7, sparse);
    inspector.add_to(SystemMatrix::stiffness, -2, 5, 7, dense);
    EXPECT_EQ(sparse.coeff(0, 0), 4);
    EXPECT_LT((MatX(sparse).bottomRightCorner(n, n) + 2 * K).norm(), 1e-12 * K.norm());
    EXPECT_LT((dense.bottomRightCorner(n, n) - MatX::Constant(n, n, 1.5) + 2 * K).norm(), 1e-12 * K.norm());
    EXPECT_EQ(dense(4, 6), 1.5);
    EXPECT_THROW(inspector.add_to(SystemMatrix::mass, 1, 6, 7, sparse), Error);
    EXPECT_THROW(inspector.add_to(SystemMatrix::mass, 1, -1, 0, dense), Error);
    EXPECT_THROW(inspector.element(inspector.element_count()), Error);
}

TEST(WorldInspect, VertexRotationsAndBoundingBox) {
    const Mat3 R = Eigen::AngleAxisd(2.5, Vec3(3, -1, 2).normalized()).toRotationMatrix();
    Scene s(Corotational{}, R, 0, 11);
    for (const Mat3& Q : Inspector(s.world, s.body).vertex_rotations()) EXPECT_LT((Q - R).norm(), 1e-12);
    const BoundingBox box = Inspector(s.world, s.body).bounding_box();
    Vec3 low = Vec3::Constant(1e9), high = -low;
    for (int c = 0; c < 8; ++c) {
        const Vec3 p = R * Vec3(c & 1, (c >> 1) & 1, c >> 2);
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    EXPECT_LT((box.min_m - low).norm() + (box.max_m - high).norm(), 1e-12);
    // A twist about x by theta per length: the mean rotation of a vertex is that of its place.
    World world({.gravity_m_s2 = Vec3::Zero(), .threads = 1});
    const BodyId bar = world.add_body({.shape = test::bar({16, 4, 4})});
    std::vector<Vec3> x = world.shape(bar).mesh().vertices, v(x.size(), Vec3::Zero());
    for (Vec3& p : x) p = Vec3(p.x(), 0.05, 0.05) + Eigen::AngleAxisd(p.x(), Vec3::UnitX()) * Vec3(0, p.y() - 0.05, p.z() - 0.05);
    world.set_state(bar, x, v);
    const auto rotations = Inspector(world, bar).vertex_rotations();
    std::size_t inside = 0;
    for (std::size_t i = 0; i < rotations.size(); ++i) {
        EXPECT_NEAR(rotations[i].determinant(), 1, 1e-12);
        const Vec3& X = world.shape(bar).mesh().vertices[i];
        if ((X - Vec3(X.x(), 0.05, 0.05)).norm() > 1e-9 || X.x() < 0.01 || X.x() > 0.39) continue;
        EXPECT_LT((rotations[i] - Eigen::AngleAxisd(X.x(), Vec3::UnitX()).toRotationMatrix()).norm(), 2e-3);
        ++inside;
    }
    EXPECT_GT(inside, 10u);
}

// -- derivative self-test ----------------------------------------------------------------------------

TEST(WorldSelfTest, EveryLawPasses) {
    for (const Material& law : all_laws()) {
        const DerivativeCheck check = check_derivatives(law, 60);
        EXPECT_EQ(check.samples, 60u) << law.index();
        EXPECT_LT(check.force_error, 1e-6) << law.index() << "\n" << check.worst_force_at;
        EXPECT_LT(check.tangent_error, 1e-5) << law.index() << "\n" << check.worst_tangent_at;
        EXPECT_TRUE(check.passed());
    }
    EXPECT_FALSE(check_derivatives(Corotational{.rotation = Rotation::large}).has_energy);
    EXPECT_THROW(check_derivatives(NeoHookean{.mu_pa = -1}), Error);
    EXPECT_FALSE(DerivativeCheck{}.passed()) << "nothing tried is nothing passed";
}

}  // namespace
}  // namespace supple
