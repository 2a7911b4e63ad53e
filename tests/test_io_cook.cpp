// Cooked meshes through files: real surfaces, partly filled elements, skins, scenes.
#include <chrono>

#include "supple/base/parallel.h"
#include "supple/io/binary_file.h"
#include "supple/io/mesh_file.h"
#include "supple/io/scene.h"
#include "supple/io/skin_file.h"
#include "supple/io/surface_file.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/cook.h"
#include "test_io_helpers.h"

namespace supple::test {
namespace {

mesh::TriangleMesh box_surface() {
    const VolumeMesh box = make_hex_box({Vec3::Zero(), Vec3(1, 0.5, 0.5), {8, 4, 4}});
    return {box.vertices, extract_boundary(box).triangles};
}

/// Every surface beside the repository, boundaries of volume meshes included, at `elements`: angles, closedness, volume.
void expect_all_cook(std::size_t elements, double volume_tolerance) {
    const std::filesystem::path folder = shared_data("meshes");
    if (folder.empty()) return;
    Team team(hardware_threads());
    std::size_t cooked = 0;
    std::vector<std::filesystem::path> files(std::filesystem::directory_iterator(folder), {});
    std::sort(files.begin(), files.end());
    for (const std::filesystem::path& file : files) {
        if (file.extension() == ".md") continue;
        const mesh::TriangleMesh surface = io::read_surface(file);
        CookReport report;
        const VolumeMesh mesh = cook(weld(surface), {.elements = elements}, team, &report);
        std::cout << file.filename().string() << ": " << mesh.tets.size() << " tets, " << report.quality.min_dihedral_deg << " to " << report.quality.max_dihedral_deg
                  << " degrees, volume " << 100 * report.volume_m3 / report.region_volume_m3 << " %\n";
        EXPECT_GT(report.quality.min_dihedral_deg, 8) << file;
        EXPECT_LT(report.quality.max_dihedral_deg, 160) << file;
        EXPECT_NEAR(double(mesh.tets.size()), double(elements), 0.12 * double(elements)) << file;
        EXPECT_NEAR(report.volume_m3 / report.region_volume_m3, 1, volume_tolerance) << file;
        if (std::abs(report.volume_m3 / report.region_volume_m3 - 1) > 0.02) {
            bool said = false;
            for (const std::string& sentence : report.sentences()) said = said || sentence.find("--edge-length") != std::string::npos;
            EXPECT_TRUE(said) << file << ": what thin parts cost is said, with the edge that would do";
        }
        VolumeMesh checked = mesh;
        const MeshReport faults = check_and_repair(checked);
        EXPECT_EQ(faults.flipped + faults.degenerate + faults.duplicate_elements + faults.overloaded_faces, 0u) << file;
        ++cooked;
    }
    EXPECT_GE(cooked, 13u);
}

TEST(IoCook, EverySharedSurfaceCoarse) { expect_all_cook(4000, 0.15); }
TEST(SlowIoCook, EverySharedSurfaceAtFiftyThousand) { expect_all_cook(50000, 0.02); }

TEST(IoCook, FillGoesThroughGmshFiles) {
    const TemporaryFolder folder;
    VolumeMesh mesh = make_hex_box({Vec3::Zero(), Vec3::Ones(), {2, 2, 2}});
    for (std::size_t e = 0; e < mesh.element_count(); ++e) mesh.fill.push_back(1.0 / double(e + 1));
    for (const char* format : {"gmsh22", "gmsh22-binary", "gmsh41", "gmsh41-binary"}) {
        io::write_mesh(folder / "a.msh", mesh, format);
        const VolumeMesh back = io::read_mesh(folder / "a.msh");
        EXPECT_EQ(back.fill, mesh.fill) << format;
        EXPECT_EQ(back.hexes, mesh.hexes) << format;
    }
    io::write_mesh(folder / "a.msh", mesh);
    std::string text = io::read_text_file(folder / "a.msh");
    const std::string wanted = "\n2 0.5\n";
    ASSERT_NE(text.find(wanted), std::string::npos);
    std::string wrong = text;
    wrong.replace(wrong.find(wanted), wanted.size(), "\n2 1.5\n");
    EXPECT_NE(std::string(caught([&] { io::parse_mesh(wrong, "a.msh"); }).what()).find("legal is (0, 1]"), std::string::npos);
    wrong = text;
    wrong.replace(wrong.find(wanted), wanted.size(), "\n1 0.5\n");
    EXPECT_NE(std::string(caught([&] { io::parse_mesh(wrong, "a.msh"); }).what()).find("ascending"), std::string::npos);
    wrong = text;
    wrong.replace(wrong.find("\"fill\""), 6, "\"heat\"");
    EXPECT_TRUE(io::parse_mesh(wrong, "a.msh").fill.empty()) << "other element data is passed over";
}

TEST(IoCook, SkinFilesHoldTheSurface) {
    const TemporaryFolder folder;
    const VolumeMesh mesh = make_tet_box({Vec3::Zero(), Vec3(1, 0.5, 0.5), {4, 2, 2}});
    const auto skin = Skin::build(mesh, box_surface());
    io::write_skin(folder / "a.skin", *skin);
    const mesh::TriangleMesh back = io::read_skin_surface(folder / "a.skin");
    EXPECT_EQ(back.triangles, skin->surface().triangles);
    ASSERT_EQ(back.vertices.size(), skin->surface().vertices.size());
    for (std::size_t v = 0; v < back.vertices.size(); ++v) EXPECT_LT((back.vertices[v] - skin->surface().vertices[v]).norm(), 1e-7);
    const std::string text = io::format_skin(*skin);
    const std::size_t n = skin->surface().vertices.size(), t = skin->surface().triangles.size();
    EXPECT_EQ(text.size(), text.find("end_head\n") + 9 + n * (12 + 12 + 4 + 4 * (4 + 4 + 12)) + t * 12) << "the layout that skin_file.h promises";
    for (const std::size_t cut : {std::size_t(5), std::size_t(60), text.size() / 8}) {
        io::write_text_file(folder / "cut.skin", text.substr(0, cut));
        EXPECT_EQ(caught([&] { io::read_skin_surface(folder / "cut.skin"); }).code(), ErrorCode::parse) << cut;
    }
}

TEST(IoCook, ScenesTakeSkinsRefinementAndPaint) {
    const TemporaryFolder folder;
    io::write_surface(folder / "skin.obj", box_surface());
    const auto scene = [&](const std::string& keys) {
        return io::parse_scene(R"({"supple_scene": 1, "bodies": [{"box": {"min_m": [0, 0, 0], "max_m": [1, 0.5, 0.5], "cells": [4, 2, 2]})" + keys + "}]}", folder.path(), "s.json");
    };
    const io::Scene skinned = scene(R"(, "skin": "skin.obj", "refine": 1)");
    EXPECT_EQ(skinned.bodies[0].def.shape->mesh().tets.size(), 8u * 96u);
    ASSERT_TRUE(skinned.bodies[0].def.skin);
    EXPECT_EQ(skinned.bodies[0].def.skin->embedding().report().outside, 0u);
    const io::Scene painted = scene(R"(, "regions": [{"capsule": {"a_m": [-1, 0.25, 0.25], "b_m": [2, 0.25, 0.25], "radius_m": 0.15}, "elements": "centre", "stiffness_factor": 5}])");
    const World world = io::build_world(painted);
    const auto young = world.element_young_pa(world.bodies()[0]);
    const auto stiff = std::count_if(young.begin(), young.end(), [&](double e) { return e > 2 * *std::min_element(young.begin(), young.end()); });
    EXPECT_GT(stiff, 10);
    EXPECT_LT(stiff, 90);
    EXPECT_NE(std::string(caught([&] { scene(R"(, "skin": "none.obj")"); }).what()).find("/bodies/0/skin"), std::string::npos);
    EXPECT_NE(std::string(caught([&] { scene(R"(, "refine": 99)"); }).what()).find("/bodies/0/refine"), std::string::npos);
}

}  // namespace
}  // namespace supple::test
