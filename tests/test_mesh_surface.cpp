#include <limits>
#include <set>

#include "mesh_helpers.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/isosurface_stuffing.h"
#include "supple/mesh/topology.h"

namespace supple {
namespace {

using supple_test::expect_error;
using supple_test::Random;

TEST(MeshSurface, SingleTetAndHexFaceOutward) {
    VolumeMesh tet;
    tet.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    tet.tets = {{0, 1, 2, 3}};
    const BoundarySurface faces = extract_boundary(tet);
    EXPECT_EQ(faces.triangles.size(), 4u);
    EXPECT_EQ(faces.edges.size(), 6u);
    EXPECT_TRUE(supple_test::closed_and_oriented(faces));
    EXPECT_NEAR(supple_test::enclosed_volume(faces, tet), 1.0 / 6, 1e-16);

    const VolumeMesh hex = make_hex_box({Vec3(1, 1, 1), Vec3(2, 3, 4), {1, 1, 1}});
    const BoundarySurface quads = extract_boundary(hex);
    EXPECT_EQ(quads.triangles.size(), 12u);
    EXPECT_EQ(quads.edges.size(), 12u) << "no diagonals";
    EXPECT_TRUE(supple_test::closed_and_oriented(quads));
    EXPECT_NEAR(supple_test::enclosed_volume(quads, hex), 6, 1e-14);
}

TEST(MeshSurface, EveryTriangleBelongsToItsElementAndEdgesAreUnique) {
    const VolumeMesh mesh = make_tet_box({Vec3(0, 0, 0), Vec3(1, 1, 1), {3, 2, 4}});
    const BoundarySurface surface = extract_boundary(mesh);
    ASSERT_EQ(surface.element.size(), surface.triangles.size());
    std::set<std::array<std::int32_t, 2>> expected;
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
        const Tet& t = mesh.tets[surface.element[i]];
        const Triangle& f = surface.triangles[i];
        Vec3 inside = Vec3::Zero();
        for (const auto v : t) inside += 0.25 * mesh.vertices[v];
        for (int k = 0; k < 3; ++k) {
            EXPECT_NE(std::find(t.begin(), t.end(), f[k]), t.end());
            expected.insert({std::min(f[k], f[(k + 1) % 3]), std::max(f[k], f[(k + 1) % 3])});
        }
        EXPECT_LT(tet_volume(mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]], inside), 0) << "normal points away";
    }
    EXPECT_EQ(std::set(surface.edges.begin(), surface.edges.end()), expected);
    EXPECT_EQ(surface.edges.size(), expected.size());
    EXPECT_EQ(surface.edges.size(), surface.triangles.size() * 3 / 2) << "Euler: two triangles per edge";
    EXPECT_TRUE(std::is_sorted(surface.element.begin(), surface.element.end()));
}

TEST(MeshSurface, InnerFacesAndOverlapsAreNotBoundary) {
    VolumeMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.2, 0.2, 2}, {0, 0, -1}};
    mesh.tets = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 2, 1, 5}};
    EXPECT_EQ(extract_boundary(mesh).triangles.size(), 9u);
}

TEST(MeshSurface, TwoMillionTetsInSeconds) {
#ifdef NDEBUG
    VolumeMesh mesh = make_tet_box({Vec3(0, 0, 0), Vec3(1, 1, 1), {70, 70, 70}});  // 2,058,000
#else
    VolumeMesh mesh = make_tet_box({Vec3(0, 0, 0), Vec3(1, 1, 1), {20, 20, 20}});
#endif
    EXPECT_TRUE(check_and_repair(mesh).sentences().empty());
    const auto n = static_cast<std::size_t>(std::cbrt(static_cast<double>(mesh.tets.size() / 6)) + 0.5);
    EXPECT_EQ(extract_boundary(mesh).triangles.size(), 12 * n * n);
}

TEST(MeshRay, KnownHit) {
    const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -3}, {1, 0, -3}, {0, 1, -3}};
    const std::vector<Triangle> t{{3, 4, 5}, {0, 1, 2}};
    const auto hit = intersect({Vec3(0.25, 0.5, 4), Vec3(0, 0, -2)}, t, x);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->triangle, 1);
    EXPECT_NEAR(hit->distance, 2, 1e-15) << "in lengths of the direction";
    EXPECT_NEAR(hit->barycentric[0], 0.25, 1e-15);
    EXPECT_NEAR(hit->barycentric[1], 0.25, 1e-15);
    EXPECT_NEAR(hit->barycentric[2], 0.5, 1e-15);
    EXPECT_EQ(intersect({Vec3(0.25, 0.5, -1), Vec3(0, 0, 1)}, t, x)->triangle, 1) << "from behind as well";
    EXPECT_FALSE(intersect({Vec3(0.25, 0.5, 4), Vec3(0, 0, 1)}, t, x)) << "nothing behind the origin";
    EXPECT_FALSE(intersect({Vec3(0.75, 0.5, 4), Vec3(0, 0, -1)}, t, x));
    EXPECT_FALSE(intersect({Vec3(0.25, 0.5, 4), Vec3(1, 0, 0)}, t, x)) << "parallel";
    EXPECT_FALSE(intersect({Vec3(-1, 0.2, 0), Vec3(1, 0, 0)}, t, x)) << "edge-on triangles are passed over";
    EXPECT_TRUE(intersect({Vec3(0, 0, 1), Vec3(0, 0, -1)}, t, x)) << "a corner belongs to its triangle";
}

TEST(MeshRay, AgreesWithThePlaneFromAllSides) {
    const auto ball = [](const Vec3& p) { return p.norm() - 0.8; };
    const VolumeMesh mesh = stuff_isosurface(ball, {Vec3(-1, -1, -1), Vec3(1, 1, 1), 0.3});
    const BoundarySurface surface = extract_boundary(mesh);
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 target = 0.3 * random.vec(), from = 3 * random.vec().normalized();
        const Ray ray{from, (target - from) * (0.1 + 5 * random())};
        const auto hit = intersect(ray, surface.triangles, mesh.vertices);
        ASSERT_TRUE(hit);
        const Triangle& t = surface.triangles[hit->triangle];
        const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
        const Vec3 on_ray = ray.origin + hit->distance * ray.direction;
        const Vec3 on_triangle = hit->barycentric[0] * a + hit->barycentric[1] * b + hit->barycentric[2] * c;
        EXPECT_LT((on_ray - on_triangle).norm(), 1e-12);
        EXPECT_LT((b - a).cross(c - a).dot(ray.direction), 0) << "the first hit faces the ray";
    }
}

TEST(MeshRay, NeverSlipsThroughSharedEdgesAndVertices) {
    // Rays aimed exactly at vertices and at points of edges of a closed surface, from inside: each must hit something.
    const auto ball = [](const Vec3& p) { return (p - Vec3(0.013, 0.021, -0.008)).norm() - 0.77; };
    const VolumeMesh mesh = stuff_isosurface(ball, {Vec3(-1, -1, -1), Vec3(1, 1, 1), 0.25});
    const BoundarySurface surface = extract_boundary(mesh);
    Random random(11);
    std::size_t misses = 0, shots = 0;
    for (const auto& e : surface.edges)
        for (int i = 0; i < 8; ++i) {
            const Vec3 origin = 0.2 * random.vec();
            const double s = i == 0 ? 0 : i == 1 ? 0.5 : random();
            const Vec3 target = mesh.vertices[e[0]] + s * (mesh.vertices[e[1]] - mesh.vertices[e[0]]);
            const auto hit = intersect({origin, target - origin}, surface.triangles, mesh.vertices);
            misses += !hit || std::abs(hit->distance - 1) > 1e-9;
            ++shots;
        }
    EXPECT_GT(shots, 3000u);
    EXPECT_EQ(misses, 0u);
}

TEST(MeshRay, BadInput) {
    const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    expect_error(ErrorCode::invalid_argument, "Ray.direction", [&] { intersect({Vec3(0, 0, 1), Vec3(0, 0, 0)}, {}, x); });
    expect_error(ErrorCode::invalid_argument, "Ray.direction", [&] { intersect({Vec3(0, 0, 1), Vec3(0, nan, 0)}, {}, x); });
    expect_error(ErrorCode::invalid_argument, "Ray.origin", [&] { intersect({Vec3(0, nan, 1), Vec3(0, 0, 1)}, {}, x); });
    const std::vector<Triangle> outside{{0, 1, 3}}, good{{0, 1, 2}};
    expect_error(ErrorCode::invalid_argument, "vertex 3", [&] { intersect({Vec3(0, 0, 1), Vec3(0, 0, 1)}, outside, x); });
    const std::vector<Vec3> bad{{0, 0, 0}, {1, nan, 0}, {0, 1, 0}};
    EXPECT_FALSE(intersect({Vec3(0.1, 0.1, 1), Vec3(0, 0, -1)}, good, bad)) << "a triangle that is not finite is never hit";
}

}  // namespace
}  // namespace supple
