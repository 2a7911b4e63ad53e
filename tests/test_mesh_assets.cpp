// The committed assets are what their program makes today, and they are good meshes.
#include <algorithm>
#include <fstream>

#include "../assets/cooked.h"
#include "../assets/organs.h"
#include "mesh_helpers.h"
#include "supple/base/parallel.h"
#include "supple/mesh/quality.h"
#include "supple/mesh/selection.h"
#include "supple/mesh/skin.h"
#include "supple/mesh/surface_check.h"

namespace supple {
namespace {

/// What this test needs of a Gmsh 2.2 file, read without the io room: vertices, tets, and points by physical tag.
struct RawGmsh {
    std::vector<Vec3> vertices;
    std::vector<Tet> tets;
    std::vector<int> tet_tag;
    std::map<int, std::vector<std::int32_t>> points;
    std::map<std::string, std::pair<int, int>> names;  ///< name in quotes: dimension, tag
};

RawGmsh read_raw(const std::filesystem::path& file) {
    RawGmsh raw;
    std::ifstream in(file);
    EXPECT_TRUE(in) << file;
    std::string word;
    std::size_t count = 0, id = 0;
    while (in >> word) {
        if (word == "$PhysicalNames") {
            in >> count;
            for (std::size_t i = 0; i < count; ++i) {
                int dimension = 0, tag = 0;
                in >> dimension >> tag >> word;
                raw.names[word] = {dimension, tag};
            }
        } else if (word == "$Nodes") {
            in >> count;
            raw.vertices.resize(count);
            for (Vec3& x : raw.vertices) in >> id >> x[0] >> x[1] >> x[2];
        } else if (word == "$Elements") {
            in >> count;
            for (std::size_t i = 0; i < count; ++i) {
                int type = 0, tags = 0, physical = 0, other = 0, v = 0;
                in >> id >> type >> tags >> physical >> other;
                Tet t{};
                for (int k = 0; k < (type == 4 ? 4 : 1); ++k) {
                    in >> v;
                    t[k] = v - 1;
                }
                if (type == 4) {
                    raw.tets.push_back(t);
                    raw.tet_tag.push_back(physical);
                } else {
                    raw.points[physical].push_back(t[0]);
                }
            }
        }
    }
    return raw;
}

TEST(MeshAssets, LiverFileIsWhatItsProgramMakes) {
    const VolumeMesh mesh = supple_assets::make_liver();
    const std::filesystem::path file = std::filesystem::path(SUPPLE_SOURCE_DIR) / "assets" / "liver.msh";
    const RawGmsh raw = read_raw(file);
    ASSERT_EQ(raw.vertices.size(), mesh.vertices.size()) << "run make_assets assets liver";
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) ASSERT_EQ(raw.vertices[v], mesh.vertices[v]) << v;
    EXPECT_EQ(raw.tets, mesh.tets);
    ASSERT_TRUE(raw.names.count("\"liver\"") && raw.names.count("\"ligament\""));
    EXPECT_EQ(raw.names.at("\"liver\"").first, 3);
    EXPECT_EQ(raw.tet_tag, std::vector<int>(mesh.tets.size(), raw.names.at("\"liver\"").second));
    EXPECT_EQ(raw.points.at(raw.names.at("\"ligament\"").second), mesh.groups[0].vertices);
    EXPECT_LT(std::filesystem::file_size(file), 1500000u);
}

TEST(MeshAssets, LiverIsAGoodMeshOfTheRightSize) {
    VolumeMesh mesh = supple_assets::make_liver();
    const MeshReport report = check_and_repair(mesh);
    EXPECT_TRUE(report.sentences().empty());
    EXPECT_EQ(report.components, 1u);
    EXPECT_GE(mesh.tets.size(), 6000u);
    EXPECT_LE(mesh.tets.size(), 9000u);
    EXPECT_NEAR(report.max_m.x() - report.min_m.x(), 0.22, 0.02) << "adult: about 0.2 m wide";
    EXPECT_NEAR(report.volume_m3, 1.6e-3, 0.2e-3) << "adult: about 1.5 litres";
    const MeshQuality quality = tet_mesh_quality(mesh);
    EXPECT_GE(quality.min_dihedral_deg, 8.9);
    EXPECT_LE(quality.max_dihedral_deg, 158.8);
    const BoundarySurface surface = extract_boundary(mesh);
    EXPECT_TRUE(supple_test::closed_and_oriented(surface));
    EXPECT_NEAR(supple_test::enclosed_volume(surface, mesh), report.volume_m3, 1e-12);
    const auto ligament = select_vertices(mesh, InGroup{"ligament"});
    EXPECT_GT(ligament.size(), 50u);
    EXPECT_LT(ligament.size(), 300u);
    for (const auto v : ligament) EXPECT_GT(mesh.vertices[v].y(), 0.02) << "hangs from above";
    EXPECT_EQ(select_elements(mesh, InGroup{"liver"}).size(), mesh.tets.size());
}

TEST(MeshAssets, CookedOnesFillTheirSkinsAndHaveTheirParts) {
    Team team(2);
    for (const supple_assets::Recipe& recipe : supple_assets::recipes()) {
        SCOPED_TRACE(recipe.name);
        const supple_assets::Asset asset = supple_assets::make_asset(recipe, team);
        EXPECT_NEAR(asset.report.volume_m3 / asset.report.region_volume_m3, 1, 0.02);
        EXPECT_EQ(asset.report.components, 1u);
        EXPECT_NEAR(double(asset.mesh.element_count()), double(recipe.cook.elements), 0.06 * double(recipe.cook.elements));
        if (recipe.cook.kind == CookKind::tets) {
            EXPECT_GT(asset.report.quality.min_dihedral_deg, 8.9);
            EXPECT_LT(asset.report.quality.max_dihedral_deg, 158.8);
        }
        EXPECT_TRUE(mesh::check_surface(asset.skin).is_closed());
        EXPECT_GT(asset.skin.triangles.size(), 2 * extract_boundary(asset.mesh).triangles.size()) << "a fine skin over a coarse mesh";
        const auto skin = Skin::build(asset.mesh, asset.skin);
        EXPECT_LT(skin->embedding().report().farthest_m, asset.report.edge_m) << "no part of the skin is left without elements";
        ASSERT_EQ(asset.inside.size(), recipe.inside.size());
        std::vector<double> part(asset.mesh.regions.size(), 0);
        for (const std::int32_t r : asset.mesh.element_region) part[std::size_t(r)] += 1;
        for (std::size_t r = 0; r < part.size(); ++r) EXPECT_GT(part[r], 0.01 * double(asset.mesh.element_count())) << asset.mesh.regions[r].name;
        for (const mesh::TriangleMesh& inside : asset.inside) EXPECT_TRUE(mesh::check_surface(inside).is_closed());
        for (const VertexGroup& group : asset.mesh.groups) EXPECT_GT(group.vertices.size(), 50u);
    }
}

TEST(MeshAssets, KidneyIsTheSameFromEveryTeam) {
    const auto& all = supple_assets::recipes();
    const auto kidney = std::find_if(all.begin(), all.end(), [](const auto& r) { return r.name == "kidney"; });
    ASSERT_NE(kidney, all.end());
    Team alone(1), three(3);
    const supple_assets::Asset a = supple_assets::make_asset(*kidney, alone), b = supple_assets::make_asset(*kidney, three);
    EXPECT_EQ(a.mesh.tets, b.mesh.tets);
    EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
    EXPECT_EQ(a.skin.vertices, b.skin.vertices);
    EXPECT_NEAR(a.report.volume_m3, 1.5e-4, 0.6e-4) << "adult: about 150 ml";
}

}  // namespace
}  // namespace supple
