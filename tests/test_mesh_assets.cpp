// The committed assets are what their program makes today, and they are good meshes.
#include <fstream>

#include "../assets/organs.h"
#include "mesh_helpers.h"
#include "supple/mesh/quality.h"
#include "supple/mesh/selection.h"

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
    ASSERT_EQ(raw.vertices.size(), mesh.vertices.size()) << "run make_assets in assets/";
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

}  // namespace
}  // namespace supple
