// Fine surfaces in coarse meshes.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "mesh_helpers.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/selection.h"
#include "supple/mesh/skin.h"

namespace supple {
namespace {

using supple_test::expect_error;
using supple_test::Random;

VolumeMesh block(bool hexes, bool warped) {
    const BoxDef def{Vec3::Zero(), Vec3(2, 1, 1), {4, 2, 2}};
    VolumeMesh mesh = hexes ? make_hex_box(def) : make_tet_box(def);
    if (warped)
        for (Vec3& x : mesh.vertices) x += 0.08 * Vec3(std::sin(3 * x.y()), std::sin(2 * x.z()), std::sin(2 * x.x()));
    return mesh;
}

std::vector<Vec3> points_about(Random& random, double reach) {
    std::vector<Vec3> points;
    for (int i = 0; i < 400; ++i) points.push_back(Vec3(1, 0.5, 0.5) + reach * random.vec());
    return points;
}

TEST(MeshEmbedding, AffineMotionsAreExactInsideAndOutside) {
    Random random(4);
    for (const bool hexes : {false, true})
        for (const bool warped : {false, true}) {
            const VolumeMesh mesh = block(hexes, warped);
            const std::vector<Vec3> points = points_about(random, 1.5);
            const Embedding embedding(mesh, points);
            EXPECT_GT(embedding.report().outside, 20u);
            EXPECT_LT(embedding.report().outside, 400u);
            EXPECT_LT(embedding.report().least_weight, 0);
            EXPECT_GT(embedding.report().farthest_m, 0.1);
            Mat3 A;
            A << 1.2, 0.3, -0.1, 0.0, 0.8, 0.4, 0.2, -0.3, 1.1;
            const Vec3 t(0.3, -2, 5);
            std::vector<Vec3> x, moved(points.size()), normals, turned(points.size());
            for (const Vec3& X : mesh.vertices) x.push_back(A * X + t);
            embedding.deform(x, moved);
            for (std::size_t i = 0; i < points.size(); ++i) normals.push_back(random.vec().normalized());
            embedding.deform_normals(x, normals, turned);
            for (std::size_t i = 0; i < points.size(); ++i) {
                ASSERT_LT((moved[i] - (A * points[i] + t)).norm(), 1e-11) << i;
                ASSERT_LT((embedding.deformation_gradient(i, x) - A).norm(), 1e-10);
                ASSERT_LT((turned[i] - (A.inverse().transpose() * normals[i]).normalized()).norm(), 1e-10);
                double sum = 0;
                for (std::size_t k = 0; k < embedding.corners(); ++k) sum += embedding.weights()[i * embedding.corners() + k];
                ASSERT_NEAR(sum, 1, 1e-12);
            }
        }
}

TEST(MeshEmbedding, InsideMeansWeightsOfTheElementThatHoldsThePoint) {
    Random random(8);
    for (const bool hexes : {false, true}) {
        const VolumeMesh mesh = block(hexes, true);
        std::vector<Vec3> points;
        std::vector<std::int32_t> home;
        for (std::size_t e = 0; e < mesh.element_count(); ++e) {
            Vec3 x = Vec3::Zero();
            double sum = 0;
            for (const std::int32_t v : element_vertices(mesh, e)) {
                const double w = 0.2 + std::abs(random());
                x += w * mesh.vertices[std::size_t(v)];
                sum += w;
            }
            points.push_back(x / sum);
            home.push_back(std::int32_t(e));
        }
        const Embedding embedding(mesh, points);
        EXPECT_EQ(embedding.report().outside, 0u);
        EXPECT_EQ(embedding.report().worst_point, -1);
        if (!hexes) {
            EXPECT_TRUE(std::equal(home.begin(), home.end(), embedding.elements().begin()));
        }
    }
}

TEST(MeshEmbedding, InterpolationStaysWithinTheCorners) {
    Random random(2);
    const VolumeMesh mesh = block(false, false);
    const std::vector<Vec3> points = points_about(random, 2);
    const Embedding embedding(mesh, points);
    std::vector<double> values(mesh.vertices.size()), out(points.size());
    for (double& v : values) v = std::abs(random());
    embedding.interpolate(values, out);
    for (const double v : out) {
        ASSERT_GE(v, 0);
        ASSERT_LE(v, *std::max_element(values.begin(), values.end()));
    }
}

TEST(MeshSkin, WeldsAndRefuses) {
    const VolumeMesh mesh = block(false, false);
    const mesh::TriangleMesh soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {9, 9, 9}}, {{0, 1, 2}, {3, 4, 5}, {0, 1, 3}}};
    const auto skin = Skin::build(mesh, soup);
    EXPECT_EQ(skin->surface().vertices.size(), 4u);
    EXPECT_EQ(skin->surface().triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
    EXPECT_EQ(vertex_normals(skin->surface())[0], Vec3(0, 0, 1));
    expect_error(ErrorCode::invalid_argument, "no triangle with an area", [&] { Skin::build(mesh, {soup.vertices, {{0, 1, 3}}}); });
    expect_error(ErrorCode::invalid_argument, "uses vertex 7", [&] { Skin::build(mesh, {soup.vertices, {{0, 1, 7}}}); });
    expect_error(ErrorCode::invalid_argument, "no element", [&] { Skin::build(VolumeMesh{}, soup); });
}

TEST(MeshSelection, CapsulesAndCentres) {
    const VolumeMesh mesh = block(true, false);
    const InsideCapsule capsule{Vec3(-1, 0.25, 0.25), Vec3(3, 0.25, 0.25), 0.1};
    EXPECT_TRUE(select_vertices(mesh, capsule).empty());
    EXPECT_TRUE(select_elements(mesh, capsule).empty());
    EXPECT_EQ(select_elements(mesh, capsule, ElementRule::centre), (std::vector<std::int32_t>{0, 1, 2, 3}));
    EXPECT_EQ(select_vertices(mesh, InsideCapsule{Vec3(0, 0, 0), Vec3(0, 1, 0), 0.01}).size(), 3u);
    EXPECT_EQ(select_elements(mesh, Everything{}, ElementRule::centre).size(), mesh.element_count());
    expect_error(ErrorCode::invalid_argument, "centre", [&] { select_elements(mesh, VertexList{{1}}, ElementRule::centre); });
    expect_error(ErrorCode::invalid_argument, "radius", [&] { select_vertices(mesh, InsideCapsule{Vec3::Zero(), Vec3::Ones(), -1}); });
}

}  // namespace
}  // namespace supple
