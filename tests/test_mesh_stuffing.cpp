#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "mesh_helpers.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/isosurface_stuffing.h"
#include "supple/mesh/manifold.h"
#include "supple/mesh/quality.h"

namespace supple {
namespace {

using supple_test::closed_and_oriented;
using supple_test::enclosed_volume;
using supple_test::expect_error;
using supple_test::Random;

StuffingDef cube(double edge_m) { return {.min_m = Vec3(-1, -1, -1), .max_m = Vec3(1, 1, 1), .edge_m = edge_m}; }

void expect_sound(VolumeMesh mesh, double min_deg = 8.9, double max_deg = 158.9) {
    const MeshQuality quality = tet_mesh_quality(mesh);
    EXPECT_GE(quality.min_dihedral_deg, min_deg);
    EXPECT_LE(quality.max_dihedral_deg, max_deg);
    const BoundarySurface surface = extract_boundary(mesh);
    EXPECT_TRUE(closed_and_oriented(surface));
    const double volume = supple_test::sum_of_tets(mesh);
    EXPECT_NEAR(enclosed_volume(surface, mesh), volume, 1e-10 * volume);
    const auto tets = mesh.tets;
    const MeshReport report = check_and_repair(mesh);
    EXPECT_EQ(report.flipped + report.degenerate + report.duplicate_elements + report.unreferenced_vertices, 0u);
    EXPECT_EQ(report.overloaded_faces, 0u);
    EXPECT_EQ(mesh.tets, tets);
}

TEST(MeshStuffing, SphereConvergesAndIsSound) {
    double error[3];
    for (int level = 0; level < 3; ++level) {
        const Vec3 centre(0.031, -0.017, 0.023);
        const auto ball = [&](const Vec3& x) { return (x - centre).norm() - 0.8; };
        StuffingReport report;
        const VolumeMesh mesh = stuff_isosurface(ball, cube(0.3 / (1 << level)), &report);
        expect_sound(mesh);
        EXPECT_EQ(report.filled_tets + report.split_vertices + report.removed_tets, 0u);
        const double exact = 4.0 / 3 * std::numbers::pi * 0.512;
        const double points = 2 * std::pow(2 / (0.3 / (1 << level)) + 4, 3);
        EXPECT_LT(static_cast<double>(report.evaluations), 2.5 * points) << "a few evaluations per cut";
        error[level] = std::abs(supple_test::sum_of_tets(mesh) / exact - 1);
        for (const Triangle& t : extract_boundary(mesh).triangles)
            for (const auto v : t) ASSERT_NEAR(ball(mesh.vertices[v]), 0, 1e-8) << "boundary vertices lie on the surface";
    }
    EXPECT_LT(error[0], 0.05);
    EXPECT_LT(error[1], 0.3 * error[0]) << "second order";
    EXPECT_LT(error[2], 0.3 * error[1]);
}

TEST(MeshStuffing, ConformsWithPlanesInAnyPlace) {
    // Tets that disagree about the diagonal of a shared face leave a flat crack inside: its corners are boundary vertices that do
    // not lie on the surface. Planes almost across an axis cut the two long edges of tets apart, which curved shapes seldom do.
    Random random(5);
    for (int i = 0; i < 120; ++i) {
        Vec3 normal = random.vec();
        if (i % 2 == 0) normal = Vec3::Unit(i / 2 % 3) + 0.1 * normal;
        normal.normalize();
        const double offset = 0.3 * random();
        const auto cap = [&](const Vec3& x) { return std::max(x.norm() - 0.8, normal.dot(x) - offset); };
        const VolumeMesh mesh = stuff_isosurface(cap, cube(0.25));
        for (const Triangle& t : extract_boundary(mesh).triangles)
            for (const auto v : t) ASSERT_NEAR(cap(mesh.vertices[v]), 0, 1e-8) << "shape " << i;
    }
}

TEST(MeshStuffing, TetCountFollowsTheEdge) {
    const auto ball = [](const Vec3& x) { return x.norm() - 0.8; };
    const VolumeMesh mesh = stuff_isosurface(ball, cube(0.08));
    const double expected = 12 * supple_test::sum_of_tets(mesh) / std::pow(0.08, 3);
    EXPECT_GT(static_cast<double>(mesh.tets.size()), expected);
    EXPECT_LT(static_cast<double>(mesh.tets.size()), 1.4 * expected);
}

TEST(MeshStuffing, AnglesHoldForAnyShape) {
    // White noise: every lattice point and every cut is independent, so all stencils and warps occur; nothing is resolved.
    const auto hash = [](const Vec3& x, std::uint64_t h) {
        for (int k = 0; k < 3; ++k) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, &x[k], 8);
            h = (h ^ bits) * 0xff51afd7ed558ccdULL;
            h ^= h >> 33;
        }
        return static_cast<double>(h >> 11) / 9007199254740992.0;
    };
    std::size_t tets = 0, split = 0, removed = 0, filled = 0;
    for (std::uint64_t seed = 1; seed <= 2; ++seed)
        for (const double share : {0.4, 0.6, 0.75, 0.9}) {
            const auto noise = [&](const Vec3& x) { return x.cwiseAbs().maxCoeff() > 1 ? 1.0 : hash(x, seed) - share; };
            StuffingReport report;
            VolumeMesh mesh = stuff_isosurface(noise, cube(0.15), &report);
            expect_sound(mesh);
            tets += mesh.tets.size();
            split += report.split_vertices;
            removed += report.removed_tets;
            filled += report.filled_tets;
            EXPECT_EQ(make_boundary_manifold(mesh).removed_tets, 0u) << "already clean";
            StuffingDef other = cube(0.15);
            other.alpha_long = 0.24999;
            other.alpha_short = 0.41189;
            expect_sound(stuff_isosurface(noise, other), 8.9, 164.8);
        }
    EXPECT_GT(tets, 100000u);
    EXPECT_GT(split, 0u);
    EXPECT_GT(removed, 0u);
    EXPECT_GT(filled, 0u);
}

TEST(MeshStuffing, SignsAloneAreEnough) {
    const auto ball = [](const Vec3& x) { return (x - Vec3(0.031, -0.017, 0.023)).norm() - 0.8; };  // off the lattice's symmetries
    const auto occupancy = [&](const Vec3& x) { return ball(x) < 0 ? -1.0 : 1.0; };
    const auto steep = [&](const Vec3& x) { return std::pow(ball(x), 3) * 1e30; };
    const auto infinite = [&](const Vec3& x) {
        return ball(x) < 0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    };
    const VolumeMesh a = stuff_isosurface(ball, cube(0.2));
    for (const VolumeMesh& b :
         {stuff_isosurface(occupancy, cube(0.2)), stuff_isosurface(steep, cube(0.2)), stuff_isosurface(infinite, cube(0.2))}) {
        ASSERT_EQ(a.tets.size(), b.tets.size());
        for (std::size_t v = 0; v < a.vertices.size(); ++v) ASSERT_LT((a.vertices[v] - b.vertices[v]).norm(), 1e-3) << v;
    }
}

TEST(MeshStuffing, KeepsTheTopologyOfATorus) {
    const auto torus = [](const Vec3& x) { return std::hypot(std::hypot(x.x(), x.y()) - 0.6, x.z()) - 0.25; };
    VolumeMesh mesh = stuff_isosurface(torus, cube(0.1));
    expect_sound(mesh);
    const BoundarySurface surface = extract_boundary(mesh);
    std::vector<char> used(mesh.vertices.size(), 0);
    for (const Triangle& t : surface.triangles)
        for (const auto v : t) used[v] = 1;
    const auto vertices = std::count(used.begin(), used.end(), 1);
    EXPECT_EQ(vertices - static_cast<std::ptrdiff_t>(surface.edges.size()) + static_cast<std::ptrdiff_t>(surface.triangles.size()), 0)
        << "Euler characteristic of a torus";
    EXPECT_NEAR(supple_test::sum_of_tets(mesh), 2 * std::pow(std::numbers::pi, 2) * 0.6 * 0.0625, 0.03 * 0.74);
    EXPECT_EQ(check_and_repair(mesh).components, 1u);
}

TEST(MeshStuffing, SurfaceThroughLatticePointsExactly) {
    // The half-space x < 0 in a box whose lattice has points on x = 0 and values that are exactly zero there.
    const auto slab = [](const Vec3& x) { return std::max({x.x(), -0.5 - x.x(), std::abs(x.y()) - 0.5, std::abs(x.z()) - 0.5}); };
    VolumeMesh mesh = stuff_isosurface(slab, cube(0.125));
    expect_sound(mesh);
    EXPECT_NEAR(supple_test::sum_of_tets(mesh), 0.5, 0.02);
}

TEST(MeshStuffing, SameInputSameBits) {
    const auto shape = [](const Vec3& x) { return x.norm() - 0.7 - 0.1 * x.x() * x.y(); };
    const VolumeMesh a = stuff_isosurface(shape, cube(0.1)), b = stuff_isosurface(shape, cube(0.1));
    EXPECT_EQ(a.tets, b.tets);
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    EXPECT_EQ(std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3)), 0);
}

TEST(MeshStuffing, FiftyThousandTetsInSeconds) {
    const auto start = std::chrono::steady_clock::now();
    const VolumeMesh mesh = stuff_isosurface([](const Vec3& x) { return x.norm() - 0.8; }, cube(0.08));
    EXPECT_GT(mesh.tets.size(), 50000u);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 20) << "0.15 s optimised";
}

TEST(MeshStuffing, RefusesIllegalInput) {
    const auto ball = [](const Vec3& x) { return x.norm() - 0.8; };
    const auto invalid = [](const std::string& text, FunctionRef<double(const Vec3&)> shape, const StuffingDef& def) {
        expect_error(ErrorCode::invalid_argument, text, [&] { stuff_isosurface(shape, def); });
    };
    invalid("edge_m", ball, cube(0));
    invalid("edge_m", ball, cube(-1));
    invalid("edge_m", ball, cube(std::numeric_limits<double>::quiet_NaN()));
    invalid("2^30", ball, cube(1e-4));
    invalid("2^30", ball, cube(1e-300));
    StuffingDef def = cube(0.1);
    def.alpha_long = 0.6;
    invalid("alpha_long", ball, def);
    def = cube(0.1);
    def.max_m.z() = -1;
    invalid("z runs from", ball, def);
    invalid(
        "beyond the box", [](const Vec3& x) { return x.norm() - 5; }, cube(0.2));
    invalid(
        "no lattice point", [](const Vec3& x) { return x.norm() + 1; }, cube(0.2));
    invalid(
        "not a number", [](const Vec3& x) { return x.x() > 0.5 ? std::nan("") : x.norm() - 0.4; }, cube(0.2));
}

TEST(MeshManifold, PartsThatTouchInAVertexOrAnEdgeAreTakenApart) {
    VolumeMesh vertex;
    vertex.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    vertex.tets = {{0, 1, 2, 3}, {0, 5, 4, 6}};
    ManifoldReport report = make_boundary_manifold(vertex);
    EXPECT_EQ(report.split_vertices, 1u);
    EXPECT_EQ(report.removed_tets, 0u);
    EXPECT_EQ(vertex.vertices.size(), 8u);
    EXPECT_EQ(check_and_repair(vertex).components, 2u);

    VolumeMesh edge;
    edge.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
    edge.tets = {{0, 2, 3, 1}, {0, 4, 5, 1}};
    report = make_boundary_manifold(edge);
    EXPECT_EQ(report.split_vertices, 2u);
    EXPECT_EQ(report.removed_tets, 0u);
    EXPECT_TRUE(closed_and_oriented(extract_boundary(edge)));
}

TEST(MeshManifold, OpensAPinchedTunnel) {
    // A solid block in which two outside regions touch in one vertex: two opposite octants of the tets around it are missing.
    VolumeMesh block = make_tet_box({Vec3(-1, -1, -1), Vec3(1, 1, 1), {2, 2, 2}});
    const auto in_octant = [&](const Tet& t, double sign) {
        Vec3 centre = Vec3::Zero();
        for (const auto v : t) centre += 0.25 * block.vertices[v];
        return (sign * centre.array() > 0).all();
    };
    std::erase_if(block.tets, [&](const Tet& t) { return in_octant(t, 1) || in_octant(t, -1); });
    const std::size_t tets = block.tets.size();
    EXPECT_FALSE(closed_and_oriented(extract_boundary(block)));
    const ManifoldReport report = make_boundary_manifold(block);
    EXPECT_TRUE(closed_and_oriented(extract_boundary(block)));
    EXPECT_GT(report.removed_tets, 0u);
    EXPECT_LT(report.removed_tets, 12u);
    EXPECT_EQ(block.tets.size() + report.removed_tets, tets);
    EXPECT_EQ(check_and_repair(block).components, 1u);
}

TEST(MeshManifold, TakesTheSmallerFanAtAnEdge) {
    // Two boxes that touch along an edge in the middle of a frame that joins them: the edge cannot be split.
    VolumeMesh block = make_tet_box({Vec3(-1, -1, 0), Vec3(1, 1, 3), {2, 2, 3}});
    std::erase_if(block.tets, [&](const Tet& t) {
        Vec3 c = Vec3::Zero();
        for (const auto v : t) c += 0.25 * block.vertices[v];
        return c.x() * c.y() > 0 && c.z() > 1 && c.z() < 2;  // two tunnels side by side through the middle layer
    });
    EXPECT_FALSE(closed_and_oriented(extract_boundary(block)));
    make_boundary_manifold(block);
    EXPECT_TRUE(closed_and_oriented(extract_boundary(block)));
    EXPECT_EQ(check_and_repair(block).components, 1u);
}

TEST(MeshManifold, DropsUnusedVerticesInOrder) {
    VolumeMesh mesh;
    mesh.vertices = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {8, 8, 8}, {0, 1, 0}, {0, 0, 1}};
    mesh.tets = {{1, 2, 4, 5}};
    drop_unused_vertices(mesh);
    EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
    EXPECT_EQ(mesh.tets[0], (Tet{0, 1, 2, 3}));
}

}  // namespace
}  // namespace supple
