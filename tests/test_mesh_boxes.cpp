#include <fstream>
#include <iostream>
#include <limits>

#include "mesh_helpers.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/quality.h"

namespace supple {
namespace {

using supple_test::expect_error;

TEST(MeshBoxes, CountsOrderVolumesAndConformity) {
    const BoxDef def{Vec3(-1, 0, 2), Vec3(0.4, 0.9, 3.1), {7, 3, 5}};
    VolumeMesh tets = make_tet_box(def), hexes = make_hex_box(def);
    EXPECT_EQ(tets.vertices.size(), 8u * 4 * 6);
    EXPECT_EQ(tets.tets.size(), 6u * 7 * 3 * 5);
    EXPECT_EQ(hexes.hexes.size(), 7u * 3 * 5);
    EXPECT_EQ(tets.vertices, hexes.vertices);
    EXPECT_LT((tets.vertices[2 + 8 * (1 + 4 * 3)] - Vec3(-1 + 2 * 0.2, 0.3, 2 + 3 * 0.22)).norm(), 1e-14);
    EXPECT_EQ(tets.vertices.back(), def.max_m) << "the last layer is exact";
    const double cell = 0.2 * 0.3 * 0.22;
    for (const Tet& t : tets.tets)
        EXPECT_NEAR(tet_volume(tets.vertices[t[0]], tets.vertices[t[1]], tets.vertices[t[2]], tets.vertices[t[3]]), cell / 6, 1e-14);
    for (VolumeMesh* mesh : {&tets, &hexes}) {
        const MeshReport report = check_and_repair(*mesh);
        EXPECT_TRUE(report.sentences().empty());
        EXPECT_NEAR(report.volume_m3, 1.4 * 0.9 * 1.1, 1e-13);
        const BoundarySurface surface = extract_boundary(*mesh);
        EXPECT_EQ(surface.triangles.size(), 4u * (7 * 3 + 3 * 5 + 5 * 7)) << "conforming: only the outer quads are open";
        EXPECT_TRUE(supple_test::closed_and_oriented(surface));
        EXPECT_NEAR(supple_test::enclosed_volume(surface, *mesh), report.volume_m3, 1e-13);
    }
}

TEST(MeshBoxes, IsTheReferenceBar) {
    const std::filesystem::path shared = supple_test::shared_data();
    const VolumeMesh tets = make_tet_box({Vec3(0, 0, 0), Vec3(0.4, 0.1, 0.1), {16, 4, 4}});
    const VolumeMesh hexes = make_hex_box({Vec3(0, 0, 0), Vec3(0.4, 0.1, 0.1), {16, 4, 4}});
    EXPECT_EQ(tets.vertices.size(), 425u);
    EXPECT_EQ(tets.tets.size(), 1536u);
    EXPECT_EQ(hexes.hexes.size(), 256u);
    EXPECT_EQ(tets.tets[1], (Tet{0, 86, 1, 103}));
    if (shared.empty()) {
        std::cout << "skipped: comparison with reference/bar1.*.msh (set SUPPLE_SHARED to the shared data)\n";
        return;
    }
    const auto compare = [&](const char* name, std::size_t corners, const auto& elements) {
        std::ifstream in(shared / "reference" / name);
        ASSERT_TRUE(in) << name;
        std::string word;
        while (in >> word && word != "$Nodes") continue;
        std::size_t count = 0, id = 0;
        in >> count;
        ASSERT_EQ(count, tets.vertices.size());
        for (std::size_t v = 0; v < count; ++v) {
            double x = 0, y = 0, z = 0;
            in >> id >> x >> y >> z;
            ASSERT_LE((tets.vertices[v] - Vec3(x, y, z)).cwiseAbs().maxCoeff(), 1e-16) << v;
        }
        while (in >> word && word != "$Elements") continue;
        in >> count;
        ASSERT_EQ(count, elements.size());
        for (std::size_t e = 0; e < count; ++e) {
            int type = 0, tags = 0, tag = 0;
            in >> id >> type >> tags;
            for (int i = 0; i < tags; ++i) in >> tag;
            for (std::size_t i = 0; i < corners; ++i) {
                int v = 0;
                in >> v;
                ASSERT_EQ(elements[e][i], v - 1) << name << " element " << e;
            }
        }
        ASSERT_TRUE(in);
    };
    compare("bar1.tet.msh", 4, tets.tets);
    compare("bar1.hex.msh", 8, hexes.hexes);
}

TEST(MeshBoxes, RefusesIllegalBoxes) {
    expect_error(ErrorCode::invalid_argument, "cells along y", [] { make_tet_box({Vec3(0, 0, 0), Vec3(1, 1, 1), {1, 0, 1}}); });
    expect_error(ErrorCode::invalid_argument, "z runs from", [] { make_hex_box({Vec3(0, 0, 1), Vec3(1, 1, 1), {1, 1, 1}}); });
    expect_error(ErrorCode::invalid_argument, "x runs from", [] {
        make_hex_box({Vec3(0, 0, 0), Vec3(std::numeric_limits<double>::infinity(), 1, 1), {1, 1, 1}});
    });
    expect_error(ErrorCode::invalid_argument, "fewer cells", [] { make_tet_box({Vec3(0, 0, 0), Vec3(1, 1, 1), {1000, 1000, 1000}}); });
}

TEST(MeshQuality, KnownTets) {
    const TetQuality regular = tet_quality({1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1});
    EXPECT_NEAR(regular.min_dihedral_deg, 70.528779365509308, 1e-10);
    EXPECT_NEAR(regular.max_dihedral_deg, 70.528779365509308, 1e-10);
    EXPECT_NEAR(regular.radius_ratio, 1, 1e-12);
    for (const double scale : {1e-6, 1.0, 1e5}) {
        // Right-angled corner: r = s (3 - sqrt 3) / 6, R = s sqrt 3 / 2; angles acos(1/sqrt 3) and 90.
        const Vec3 o(7 * scale, 0, 0);
        const TetQuality corner = tet_quality(o, o + Vec3(scale, 0, 0), o + Vec3(0, 0, scale), o + Vec3(0, scale, 0));
        EXPECT_NEAR(corner.min_dihedral_deg, 54.735610317245346, 1e-6);
        EXPECT_NEAR(corner.max_dihedral_deg, 90, 1e-6);
        EXPECT_NEAR(corner.radius_ratio, 3 * (3 - std::sqrt(3.0)) / 6 / (std::sqrt(3.0) / 2), 1e-9);
    }
    const TetQuality flat = tet_quality({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0});
    EXPECT_EQ(flat.radius_ratio, 0);
    EXPECT_NEAR(flat.max_dihedral_deg, 180, 1e-9);
    EXPECT_NEAR(flat.min_dihedral_deg, 0, 1e-9);
    const VolumeMesh box = make_tet_box({Vec3(0, 0, 0), Vec3(1, 1, 1), {2, 2, 2}});
    const MeshQuality quality = tet_mesh_quality(box);
    EXPECT_NEAR(quality.min_dihedral_deg, 45, 1e-9);
    EXPECT_NEAR(quality.max_dihedral_deg, 90, 1e-9);
    EXPECT_NEAR(quality.min_radius_ratio, quality.mean_radius_ratio, 1e-12);
    EXPECT_EQ(tet_mesh_quality(VolumeMesh{}).worst_tet, -1);
}

}  // namespace
}  // namespace supple
