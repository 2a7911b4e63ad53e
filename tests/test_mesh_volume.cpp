#include <cmath>
#include <limits>
#include <numeric>

#include "mesh_helpers.h"
#include "supple/mesh/box_mesh.h"

namespace supple {
namespace {

using supple_test::expect_error;
using supple_test::Random;

VolumeMesh small_tets() { return make_tet_box({Vec3(0, 0, 0), Vec3(2, 1, 1), {4, 2, 2}}); }
VolumeMesh small_hexes() { return make_hex_box({Vec3(0, 0, 0), Vec3(2, 1, 1), {4, 2, 2}}); }

TEST(MeshVolume, CleanMeshIsLeftAloneAndSaysNothing) {
    VolumeMesh mesh = small_tets();
    const VolumeMesh before = mesh;
    const MeshReport report = check_and_repair(mesh);
    EXPECT_TRUE(report.sentences().empty());
    EXPECT_EQ(mesh.tets, before.tets);
    EXPECT_EQ(report.components, 1u);
    EXPECT_NEAR(report.volume_m3, 2, 1e-14);
    EXPECT_EQ(report.min_m, Vec3(0, 0, 0));
    EXPECT_EQ(report.max_m, Vec3(2, 1, 1));
}

TEST(MeshVolume, EveryVertexOrderOfATetEndsPositiveAndHalfAreCounted) {
    std::array<int, 4> order{0, 1, 2, 3};
    int flipped = 0;
    do {
        VolumeMesh mesh;
        mesh.vertices = {{0, 0, 0}, {1, 0.1, 0}, {0, 1, 0.2}, {0.3, 0, 1}};
        mesh.tets = {{order[0], order[1], order[2], order[3]}};
        const MeshReport report = check_and_repair(mesh);
        flipped += static_cast<int>(report.flipped);
        EXPECT_GT(supple_test::sum_of_tets(mesh), 0);
        EXPECT_GT(report.volume_m3, 0);
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_EQ(flipped, 12);
}

TEST(MeshVolume, CountsRewoundTetsAndHexes) {
    VolumeMesh tets = small_tets();
    for (std::size_t i = 0; i < tets.tets.size(); i += 3) std::swap(tets.tets[i][1], tets.tets[i][3]);
    const std::size_t turned = (tets.tets.size() + 2) / 3;
    const MeshReport report = check_and_repair(tets);
    EXPECT_EQ(report.flipped, turned);
    EXPECT_NEAR(report.volume_m3, 2, 1e-14);
    ASSERT_EQ(report.sentences().size(), 1u);
    EXPECT_EQ(report.sentences()[0], std::to_string(turned) + " elements had negative volume and were rewound.");
    EXPECT_EQ(check_and_repair(tets).flipped, 0u) << "a second look finds nothing";

    VolumeMesh hexes = small_hexes();
    const VolumeMesh clean = hexes;
    std::swap_ranges(hexes.hexes[5].begin(), hexes.hexes[5].begin() + 4, hexes.hexes[5].begin() + 4);
    EXPECT_EQ(check_and_repair(hexes).flipped, 1u);
    EXPECT_EQ(hexes.hexes, clean.hexes);
}

TEST(MeshVolume, HexVolumeIsExactForWarpedFaces) {
    // The integral of det J over the trilinear map, by 3-point Gauss quadrature (exact: degree 2 per coordinate in det J).
    const double g[3] = {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)}, w[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    Random random(7);
    for (int trial = 0; trial < 20; ++trial) {
        std::array<Vec3, 8> x;
        const double corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
        for (int i = 0; i < 8; ++i) x[i] = Vec3(corner[i][0], corner[i][1], corner[i][2]) + 0.3 * random.vec() + Vec3(10, -20, 5);
        double expected = 0;
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                for (int c = 0; c < 3; ++c) {
                    const double xi[3] = {g[a], g[b], g[c]};
                    Mat3 J = Mat3::Zero();
                    for (int i = 0; i < 8; ++i)
                        for (int d = 0; d < 3; ++d) {
                            double dN = corner[i][d] > 0 ? 1 : -1;
                            for (int o = 0; o < 3; ++o)
                                if (o != d) dN *= corner[i][o] > 0 ? xi[o] : 1 - xi[o];
                            J.col(d) += dN * x[i];
                        }
                    expected += w[a] * w[b] * w[c] * J.col(0).dot(J.col(1).cross(J.col(2)));
                }
        EXPECT_NEAR(hex_volume(x), expected, 1e-12);
    }
}

TEST(MeshVolume, RemovesDegenerateAndDuplicateElementsAndRegionsFollow) {
    VolumeMesh mesh = small_tets();
    mesh.regions = {{"soft", 3}, {"hard", 9}};
    const std::size_t n = mesh.tets.size();
    for (std::size_t e = 0; e < n; ++e) mesh.element_region.push_back(e < n / 2 ? 0 : 1);
    const VolumeMesh clean = mesh;
    // In front and in the middle, so that every later element moves.
    const Tet repeated{3, 3, 7, 9}, flat{0, 1, 2, 3}, duplicate{mesh.tets[4][2], mesh.tets[4][1], mesh.tets[4][0], mesh.tets[4][3]};
    mesh.tets.insert(mesh.tets.begin(), repeated);
    mesh.element_region.insert(mesh.element_region.begin(), 1);
    mesh.tets.insert(mesh.tets.begin() + 10, flat);
    mesh.element_region.insert(mesh.element_region.begin() + 10, -1);
    mesh.tets.push_back(duplicate);
    mesh.element_region.push_back(0);
    const MeshReport report = check_and_repair(mesh);
    EXPECT_EQ(report.degenerate, 2u);
    EXPECT_EQ(report.duplicate_elements, 1u);
    EXPECT_EQ(mesh.tets, clean.tets);
    EXPECT_EQ(mesh.element_region, clean.element_region);
    EXPECT_EQ(mesh.regions.size(), 2u);
    EXPECT_EQ(report.sentences().size(), 3u) << "flipped duplicate, degenerate, duplicates";
}

TEST(MeshVolume, RegionsFollowInMixedMeshes) {
    VolumeMesh mesh = small_hexes();
    const auto shift = static_cast<std::int32_t>(mesh.vertices.size());
    const VolumeMesh tets = make_tet_box({Vec3(5, 0, 0), Vec3(6, 1, 1), {1, 1, 1}});
    mesh.vertices.insert(mesh.vertices.end(), tets.vertices.begin(), tets.vertices.end());
    for (Tet t : tets.tets) {
        for (auto& v : t) v += shift;
        mesh.tets.push_back(t);
    }
    mesh.regions = {{"a", 1}, {"b", 2}};
    mesh.tets.insert(mesh.tets.begin() + 2, Tet{0, 1, 2, 3});  // flat
    mesh.hexes.insert(mesh.hexes.begin() + 3, mesh.hexes[0]);  // duplicate
    for (std::size_t e = 0; e < mesh.element_count(); ++e) mesh.element_region.push_back(e < mesh.tets.size() ? 0 : 1);
    const MeshReport report = check_and_repair(mesh);
    EXPECT_EQ(report.degenerate, 1u);
    EXPECT_EQ(report.duplicate_elements, 1u);
    EXPECT_EQ(report.components, 2u);
    ASSERT_EQ(mesh.element_region.size(), 6u + 16u);
    for (std::size_t e = 0; e < 22; ++e) EXPECT_EQ(mesh.element_region[e], e < 6 ? 0 : 1) << e;
    EXPECT_NEAR(report.volume_m3, 3, 1e-13);
}

TEST(MeshVolume, DegenerateIsRelativeToSize) {
    for (const double size : {1e-9, 1e-3, 1.0, 1e6, 1e30}) {
        VolumeMesh mesh;
        mesh.vertices = {
            {0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}, {0.2 * size, 0.2 * size, 1e-14 * size}, {size, size, 1e-9 * size}};
        mesh.tets = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 2, 5}};
        const MeshReport report = check_and_repair(mesh);
        EXPECT_EQ(report.degenerate, 1u) << size;
        EXPECT_EQ(mesh.tets.size(), 2u) << size;
    }
}

TEST(MeshVolume, ReportsUnreferencedAndCoincidentVerticesWithoutTouchingThem) {
    VolumeMesh mesh = small_tets();
    const auto count = mesh.vertices.size();
    mesh.vertices.push_back({100, 0, 0});
    mesh.vertices.push_back(mesh.vertices[4]);
    mesh.vertices.push_back(mesh.vertices[4]);
    const MeshReport report = check_and_repair(mesh);
    EXPECT_EQ(report.unreferenced_vertices, 3u);
    EXPECT_EQ(report.duplicate_vertices, 2u);
    EXPECT_EQ(mesh.vertices.size(), count + 3);
    EXPECT_EQ(report.max_m, Vec3(2, 1, 1)) << "a vertex of no element does not stretch the box";
    VolumeMesh zeros;
    zeros.vertices = {{0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-0.0, 0, 0}};
    zeros.tets = {{0, 1, 2, 3}};
    EXPECT_EQ(check_and_repair(zeros).duplicate_vertices, 1u) << "-0 is 0";
}

TEST(MeshVolume, ComponentsAreFaceConnected) {
    VolumeMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {-1, 0, 0}, {0, -1, 0}};
    mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
    EXPECT_EQ(check_and_repair(mesh).components, 1u);
    mesh.tets.push_back({0, 3, 5, 6});  // shares the edge 0-3 only
    const MeshReport report = check_and_repair(mesh);
    EXPECT_EQ(report.components, 2u);
    ASSERT_FALSE(report.sentences().empty());
    EXPECT_NE(report.sentences().back().find("2 parts"), std::string::npos);
}

TEST(MeshVolume, ReportsOverlapsAndFoldedHexes) {
    VolumeMesh overlap;
    overlap.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.2, 0.2, 2}, {0, 0, -1}};
    overlap.tets = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 2, 1, 5}};
    EXPECT_EQ(check_and_repair(overlap).overloaded_faces, 1u);
    VolumeMesh folded = make_hex_box({});
    EXPECT_EQ(check_and_repair(folded).folded_hexes, 0u);
    folded.vertices[7] = Vec3(0.2, 0.2, 0.2);  // corner (1,1,1) pushed through the diagonal plane of its neighbours
    const MeshReport report = check_and_repair(folded);
    EXPECT_EQ(report.flipped, 0u);
    EXPECT_EQ(report.folded_hexes, 1u);
}

TEST(MeshVolume, RefusesWhatCannotBeSimulated) {
    VolumeMesh surface;
    surface.source = "skin.msh";
    surface.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    expect_error(ErrorCode::surface_mesh, "skin.msh", [&] { check_and_repair(surface); });
    VolumeMesh flat = surface;
    flat.vertices.push_back({1, 1, 0});
    flat.tets = {{0, 1, 2, 3}};
    expect_error(ErrorCode::surface_mesh, "flat", [&] { check_and_repair(flat); });

    VolumeMesh mesh = small_tets();
    mesh.tets[3][2] = static_cast<std::int32_t>(mesh.vertices.size());
    expect_error(ErrorCode::invalid_argument, "tet 3 uses vertex 45; legal are 0 to 44", [&] { check_and_repair(mesh); });
    mesh = small_tets();
    mesh.tets[3][2] = -1;
    expect_error(ErrorCode::invalid_argument, "tet 3 uses vertex -1", [&] { check_and_repair(mesh); });
    mesh = small_tets();
    mesh.vertices[6].y() = std::numeric_limits<double>::quiet_NaN();
    expect_error(ErrorCode::invalid_argument, "vertex 6 has y", [&] { check_and_repair(mesh); });
    mesh = small_tets();
    mesh.vertices[6].z() = 1e200;
    expect_error(ErrorCode::invalid_argument, "vertex 6 has z", [&] { check_and_repair(mesh); });
    mesh = small_tets();
    mesh.element_region = {0};
    expect_error(ErrorCode::invalid_argument, "element_region", [&] { check_and_repair(mesh); });
    mesh = small_tets();
    mesh.element_region.assign(mesh.tets.size(), 1);
    expect_error(ErrorCode::invalid_argument, "region 1", [&] { check_and_repair(mesh); });
    mesh = small_tets();
    mesh.groups = {{"g", {0, 999}}};
    expect_error(ErrorCode::invalid_argument, "999", [&] { check_and_repair(mesh); });
}

}  // namespace
}  // namespace supple
