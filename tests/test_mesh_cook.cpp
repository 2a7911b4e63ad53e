// From surfaces to elements: winding numbers, solid regions, cooked meshes.
#include <cmath>
#include <cstring>
#include <numbers>

#include "mesh_helpers.h"
#include "supple/base/parallel.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/cook.h"
#include "supple/mesh/embedding.h"
#include "supple/mesh/lattice_hexes.h"
#include "supple/mesh/refine.h"

namespace supple {
namespace {

using supple_test::closed_and_oriented;
using supple_test::expect_error;
using supple_test::Random;

/// A sphere of 2 n^2 or so triangles.
mesh::TriangleMesh sphere(int n, const Vec3& centre, double radius) {
    mesh::TriangleMesh s;
    s.vertices.push_back(centre + Vec3(0, 0, radius));
    for (int i = 1; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j) {
            const double a = std::numbers::pi * i / n, b = std::numbers::pi * j / n;
            s.vertices.push_back(centre + radius * Vec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)));
        }
    s.vertices.push_back(centre - Vec3(0, 0, radius));
    const auto at = [&](int i, int j) { return i == 0 ? 0 : i == n ? int(s.vertices.size()) - 1 : 1 + (i - 1) * 2 * n + j % (2 * n); };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j) {
            if (i > 0) s.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
            if (i < n - 1) s.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
        }
    return s;
}

mesh::TriangleMesh joined(mesh::TriangleMesh a, const mesh::TriangleMesh& b) {
    const int first = int(a.vertices.size());
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (Triangle t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return a;
}

double volume_of(const VolumeMesh& mesh) { return supple_test::sum_of_tets(mesh); }
constexpr double kBall = 4.0 / 3 * std::numbers::pi;

TEST(MeshTriangleTree, WindingNumbersAreSolidAngles) {
    const mesh::TriangleMesh s = joined(sphere(20, Vec3::Zero(), 1), sphere(12, Vec3(0.7, 0.2, 0.1), 0.6));
    const TriangleTree tree(s);
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        const Vec3 x = 2 * random.vec();
        const double exact = tree.exact_winding_number(x);
        ASSERT_NEAR(tree.winding_number(x), exact, 0.01) << i;
        ASSERT_NEAR(tree.winding_number(x, SolidRegion::kAccuracy), exact, 0.05) << i;
        ASSERT_NEAR(tree.winding_number(x, 1e9), exact, 1e-12) << "without expansions";
        if (x.norm() > 1.02 && (x - Vec3(0.7, 0.2, 0.1)).norm() > 0.62) {
            ASSERT_NEAR(exact, 0, 1e-9);
        }
    }
    EXPECT_NEAR(tree.exact_winding_number(Vec3(0.6, 0.2, 0.1)), 2, 1e-9) << "in both";
}

TEST(MeshTriangleTree, NearestAndFirstHitAreThoseOfAllTriangles) {
    const mesh::TriangleMesh s = joined(sphere(14, Vec3::Zero(), 1), sphere(8, Vec3(0.9, 0, 0), 0.5));
    const TriangleTree tree(s);
    Random random(9);
    for (int i = 0; i < 500; ++i) {
        const Vec3 x = 2 * random.vec();
        double nearest = 1e300;
        for (const Triangle& t : s.triangles)
            nearest = std::min(nearest, nearest_on_triangle(x, s.vertices[std::size_t(t[0])], s.vertices[std::size_t(t[1])], s.vertices[std::size_t(t[2])]).distance);
        const NearestPoint p = tree.nearest(x);
        ASSERT_EQ(p.distance, nearest);
        ASSERT_NEAR((p.point - x).norm(), nearest, 1e-14);
        ASSERT_EQ(tree.nearest(x, 0.999 * nearest).triangle, -1);
        const Ray ray{x, random.vec()};
        const auto all = intersect(ray, s.triangles, s.vertices), hit = tree.first_hit(ray);
        ASSERT_EQ(all.has_value(), hit.has_value());
        if (all) {
            ASSERT_NEAR(all->distance, hit->distance, 1e-12);
        }
    }
}

TEST(MeshSolidRegion, VolumesOfClosedOverlappingHoledAndTurnedSurfaces) {
    Team team(2);
    const mesh::TriangleMesh ball = sphere(40, Vec3::Zero(), 1);
    EXPECT_NEAR(SolidRegion(ball).volume(team), kBall, 0.006 * kBall);
    mesh::TriangleMesh turned = ball;
    for (Triangle& t : turned.triangles) std::swap(t[0], t[1]);
    EXPECT_TRUE(SolidRegion(turned).was_inside_out());
    EXPECT_NEAR(SolidRegion(turned).volume(team), kBall, 0.006 * kBall);
    // Two balls a distance of one apart: their union, not their sum.
    const double lens = std::numbers::pi / 12 * 5;
    EXPECT_NEAR(SolidRegion(joined(ball, sphere(40, Vec3(1, 0, 0), 1))).volume(team), 2 * kBall - lens, 0.02 * kBall);
    // What lies inside of a part altogether bounds nothing, however many there are.
    mesh::TriangleMesh nested = ball;
    for (int i = 0; i < 12; ++i) nested = joined(nested, sphere(12, Vec3(0.05 * i - 0.3, 0.02 * i, 0), 0.4));
    EXPECT_NEAR(SolidRegion(nested).volume(team), kBall, 0.006 * kBall);
    mesh::TriangleMesh holed = ball;
    std::erase_if(holed.triangles, [&](const Triangle& t) { return holed.vertices[std::size_t(t[0])].z() > 0.92; });
    EXPECT_NEAR(SolidRegion(holed).volume(team), kBall, 0.02 * kBall);
}

TEST(MeshCook, TetsOfAHoledSelfIntersectingSurface) {
    mesh::TriangleMesh s = joined(sphere(24, Vec3::Zero(), 1), sphere(20, Vec3(0.8, 0.1, 0), 0.7));
    std::erase_if(s.triangles, [&](const Triangle& t) { return s.vertices[std::size_t(t[0])].z() > 0.9; });
    Team team(2);
    CookReport report;
    const VolumeMesh mesh = cook(s, {.elements = 12000}, team, &report);
    EXPECT_NEAR(double(mesh.tets.size()), 12000, 0.08 * 12000);
    EXPECT_GE(report.quality.min_dihedral_deg, 8.9);
    EXPECT_LE(report.quality.max_dihedral_deg, 158.9);
    EXPECT_TRUE(closed_and_oriented(extract_boundary(mesh)));
    EXPECT_EQ(report.components, 1u);
    EXPECT_NEAR(volume_of(mesh), report.volume_m3, 1e-9);
    EXPECT_NEAR(report.volume_m3 / report.region_volume_m3, 1, 0.02);
}

/// A bar along the axes, of 4 x 1 x 1.
mesh::TriangleMesh bar_surface() {
    const VolumeMesh bar = make_hex_box({Vec3::Zero(), Vec3(4, 1, 1), {8, 2, 2}});
    return {bar.vertices, extract_boundary(bar).triangles};
}

TEST(MeshCook, CurvedBoundariesAreLiftedAndFlatOnesStay) {
    Team team(2);
    // Inscribed, a ball at this edge loses 2 %.
    CookReport report;
    const VolumeMesh ball = cook(sphere(48, Vec3::Zero(), 1), {.edge_m = 0.4}, team, &report);
    EXPECT_NEAR(report.volume_m3 / report.region_volume_m3, 1, 0.004);
    EXPECT_GE(report.quality.min_dihedral_deg, 8.9);
    EXPECT_LE(report.quality.max_dihedral_deg, 158.8);
    double farthest = 0;
    for (const Vec3& x : ball.vertices) farthest = std::max(farthest, x.norm());
    EXPECT_GT(farthest, 1.005) << "lifted";
    EXPECT_LT(farthest, 1.04) << "by what the triangles cut off, no more";
    const VolumeMesh bar = cook(bar_surface(), {.edge_m = 0.23}, team, &report);
    for (const Vec3& x : bar.vertices)
        for (int k = 0; k < 3; ++k) {
            ASSERT_GE(x[k], -1e-6) << "a flat side";
            ASSERT_LE(x[k], (k == 0 ? 4 : 1) + 1e-6);
        }
}

TEST(MeshCook, CountsAreMetWhereFlatSidesLieAlongTheLattice) {
    Team team(2);
    const mesh::TriangleMesh bar = bar_surface();
    for (const CookKind kind : {CookKind::tets, CookKind::hexes, CookKind::cage})
        for (const std::size_t wanted : {700u, 1000u, 1400u, 2000u, 2800u}) {
            const VolumeMesh mesh = cook(bar, {.kind = kind, .elements = wanted}, team);
            EXPECT_NEAR(double(mesh.element_count()), double(wanted), 0.05 * double(wanted) + 1) << int(kind);
        }
}

TEST(MeshCook, HexFillSumsToTheVolume) {
    Team team(2);
    const SolidRegion region(sphere(40, Vec3(0.1, 0.2, 0.3), 1));
    const VolumeMesh mesh = fill_with_hexes(region, {.edge_m = 0.13}, team);
    double sum = 0;
    bool partly = false, whole = false;
    for (const double f : mesh.fill) {
        ASSERT_GT(f, 0);
        ASSERT_LE(f, 1);
        partly = partly || f < 1;
        whole = whole || f == 1;
        sum += f * std::pow(0.13, 3);
    }
    EXPECT_TRUE(partly && whole);
    EXPECT_NEAR(sum, region.volume(team), 0.005 * kBall);
    EXPECT_EQ(mesh.fill.size(), mesh.hexes.size());
}

TEST(MeshCook, HexesKeepNeighbouringPartsApart) {
    // Two boxes with a gap of a tenth of a cube between them: their cubes are neighbours, but share no vertex.
    const auto box = [](double x0, double x1) {
        const VolumeMesh b = make_hex_box({Vec3(x0, 0, 0), Vec3(x1, 1, 1), {1, 1, 1}});
        return mesh::TriangleMesh{b.vertices, extract_boundary(b).triangles};
    };
    Team team(1);
    const VolumeMesh mesh = fill_with_hexes(SolidRegion(joined(box(0, 0.98), box(1.02, 2))), {.edge_m = 0.1}, team);
    VolumeMesh checked = mesh;
    EXPECT_EQ(check_and_repair(checked).components, 2u);
    for (const Hex& h : mesh.hexes)
        for (const std::int32_t v : h) ASSERT_LT(std::size_t(v), mesh.vertices.size());
}

TEST(MeshCook, CageHoldsTheSurface) {
    const mesh::TriangleMesh s = joined(sphere(24, Vec3::Zero(), 1), sphere(20, Vec3(1.3, 0.1, 0), 0.5));
    Team team(2);
    CookReport report;
    const VolumeMesh cage = cook(s, {.kind = CookKind::cage, .elements = 1500}, team, &report);
    EXPECT_EQ(Embedding(cage, s.vertices).report().outside, 0u);
    EXPECT_LT(report.volume_m3, volume_of(cage)) << "filled in part";
    EXPECT_NEAR(report.volume_m3 / report.region_volume_m3, 1, 0.05);
}

TEST(MeshCook, SameBitsFromEveryTeam) {
    const mesh::TriangleMesh s = joined(sphere(16, Vec3::Zero(), 1), sphere(12, Vec3(0.8, 0.1, 0), 0.7));
    for (const CookKind kind : {CookKind::tets, CookKind::hexes, CookKind::cage}) {
        VolumeMesh first;
        for (int threads = 1; threads <= 3; ++threads) {
            Team team(threads);
            VolumeMesh mesh = cook(s, {.kind = kind, .elements = 600}, team);
            if (threads == 1) {
                first = std::move(mesh);
                continue;
            }
            ASSERT_EQ(mesh.tets, first.tets);
            ASSERT_EQ(mesh.hexes, first.hexes);
            ASSERT_EQ(mesh.fill, first.fill);
            ASSERT_EQ(mesh.vertices.size(), first.vertices.size());
            ASSERT_EQ(std::memcmp(mesh.vertices.data(), first.vertices.data(), mesh.vertices.size() * sizeof(Vec3)), 0);
        }
    }
}

TEST(MeshCook, RefusesWhatEnclosesNothing) {
    Team team(1);
    const auto invalid = [&](const std::string& text, const mesh::TriangleMesh& s, const CookDef& def) {
        expect_error(ErrorCode::invalid_argument, text, [&] { cook(s, def, team); });
    };
    mesh::TriangleMesh sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    invalid("encloses nothing", sheet, {});
    invalid("no triangle", {sheet.vertices, {}}, {});
    invalid("uses vertex 7", {sheet.vertices, {{0, 1, 7}}}, {});
    sheet.vertices[1].x() = std::nan("");
    invalid("not finite", sheet, {});
    invalid("edge_m", sphere(8, Vec3::Zero(), 1), {.edge_m = -1});
}

TEST(MeshRefine, KeepsVolumeFacesRegionsAndFill) {
    for (const bool hexes : {false, true}) {
        VolumeMesh mesh = hexes ? make_hex_box({Vec3::Zero(), Vec3(2, 1, 1), {2, 1, 1}}) : make_tet_box({Vec3::Zero(), Vec3(2, 1, 1), {2, 1, 1}});
        for (Vec3& x : mesh.vertices) x += 0.1 * Vec3(x.y() * x.z(), x.x() * x.z(), x.x() * x.y());
        mesh.regions = {{"a", 1}, {"b", 2}};
        mesh.element_region.assign(mesh.element_count(), 0);
        mesh.element_region.back() = 1;
        mesh.fill.assign(mesh.element_count(), 0.5);
        mesh.groups = {{"end", {}}};
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
            if (v % 3 == 0) mesh.groups[0].vertices.push_back(std::int32_t(v));
        VolumeMesh before = mesh, fine = refine(mesh, 2);
        EXPECT_EQ(fine.element_count(), 64 * mesh.element_count());
        const double volume = check_and_repair(before).volume_m3;
        const MeshReport report = check_and_repair(fine);
        EXPECT_NEAR(report.volume_m3, volume, 1e-12);
        EXPECT_EQ(report.flipped + report.degenerate + report.duplicate_vertices + report.overloaded_faces, 0u);
        EXPECT_EQ(report.components, 1u);
        EXPECT_EQ(std::count(fine.element_region.begin(), fine.element_region.end(), 1), 64);
        EXPECT_EQ(fine.fill.size(), fine.element_count());
        EXPECT_TRUE(closed_and_oriented(extract_boundary(fine)));
        EXPECT_EQ(extract_boundary(fine).triangles.size(), 16 * extract_boundary(mesh).triangles.size()) << "conforming inside";
        if (!hexes) {
            EXPECT_GT(tet_mesh_quality(fine).min_radius_ratio, 0.2 * tet_mesh_quality(mesh).min_radius_ratio);
        }
    }
    expect_error(ErrorCode::invalid_argument, "refine", [&] { refine(VolumeMesh{}, 11); });
}

}  // namespace
}  // namespace supple
