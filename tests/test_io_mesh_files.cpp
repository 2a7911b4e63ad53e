#include <fstream>

#include "supple/io/binary_file.h"
#include "supple/io/mesh_file.h"
#include "test_io_helpers.h"

namespace supple::io {
namespace {

using test::expect_error;

TEST(IoMeshFile, RealMeshesAreReadOrRefusedByName) {
    const std::filesystem::path folder = test::shared_data("meshes");
    if (folder.empty()) return;
    struct Volume {
        const char* file;
        std::size_t vertices, tets;
        std::vector<std::string> regions, groups;
    };
    const Volume volumes[] = {
        {"polyfem_bar-2523.msh", 886, 2523, {}, {}},    {"polyfem_bunny.msh", 4670, 19379, {}, {}},
        {"polyfem_sphere1K.msh", 1760, 6851, {}, {}},   {"sofa_cylinder.msh", 510, 2430, {"region_1"}, {}},
        {"sofa_liver.msh", 181, 596, {"region_1"}, {}}, {"sofa_liver2.msh", 507, 1493, {"region_2"}, {"curve_1", "surface_1"}},
    };
    for (const Volume& volume : volumes) {
        SCOPED_TRACE(volume.file);
        if (!std::filesystem::exists(folder / volume.file)) continue;
        const VolumeMesh mesh = read_mesh(folder / volume.file);
        EXPECT_EQ(mesh.vertices.size(), volume.vertices);
        EXPECT_EQ(mesh.tets.size(), volume.tets);
        std::vector<std::string> regions, groups;
        for (const Region& region : mesh.regions) regions.push_back(region.name);
        for (const VertexGroup& group : mesh.groups) groups.push_back(group.name);
        EXPECT_EQ(regions, volume.regions);
        EXPECT_EQ(groups, volume.groups);
    }
    for (const char* file : {"libigl_bunny.off", "libigl_decimated-knight.off", "libigl_elephant.obj", "sofa_dragon.obj",
                             "sofa_liver-smooth.obj", "sofa_liver.vtk", "sofa_pliers_binary.stl"}) {  // test_io_surfaces.cpp reads them
        SCOPED_TRACE(file);
        if (!std::filesystem::exists(folder / file)) continue;
        expect_error(ErrorCode::surface_mesh, (folder / file).string(), {"surface mesh", "volume mesh is needed"},
                     [&] { read_mesh(folder / file); });
    }
}

TEST(IoMeshFile, ReferenceBarsAreRead) {
    const std::filesystem::path folder = test::shared_data("reference");
    if (folder.empty()) return;
    EXPECT_EQ(read_mesh(folder / "bar1.tet.msh").tets.size(), 1536u);
    EXPECT_EQ(read_mesh(folder / "bar1.hex.msh").hexes.size(), 256u);
}

TEST(IoMeshFile, SurfaceFormatsAreKnownByContentWhateverTheirEnding) {
    const auto refuse = [](const std::string& text, const std::string& name, const std::string& word) {
        SCOPED_TRACE(text);
        expect_error(ErrorCode::surface_mesh, name, {word, "surface mesh", "volume mesh is needed"}, [&] { parse_mesh(text, name); });
    };
    refuse("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "a.msh", "OFF");
    refuse("# comment\n\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.msh", "OBJ");
    refuse("mtllib a.mtl\n", "a", "OBJ");
    refuse("ply\nformat ascii 1.0\n", "a.msh", "PLY");
    refuse("solid cube\nfacet normal 0 0 1\n", "a.msh", "STL");
    refuse(std::string(80, '\x07') + std::string("\x01\0\0\0", 4) + std::string(50, '\0'), "a.msh", "STL");
    refuse("solid but binary" + std::string(64, ' ') + std::string("\x01\0\0\0", 4) + std::string(50, '\0'), "a.msh", "STL");
    refuse("glTF\x02", "a.msh", "glTF");
    refuse("SOLID cube\nFACET NORMAL 0 0 1\n", "a.msh", "STL");
    refuse("\x01\x02\x03", "a.FBX", "FBX");
    refuse("4 3 0 0\n", "a.poly", "TetGen");
}

TEST(IoMeshFile, OtherVolumeFormatsAreRefusedByName) {
    const auto refuse = [](const std::string& text, const std::string& name, const std::string& word) {
        SCOPED_TRACE(text);
        expect_error(ErrorCode::unsupported, name, {word, "meshio"}, [&] { parse_mesh(text, name); });
    };
    refuse("(0 \"fluent\")\n", "a.msh", "Fluent");
    refuse("\x89HDF\r\n", "a.med", "HDF5");
    refuse("GRID 1\n", "a.bdf", "Nastran");
    expect_error(ErrorCode::unsupported, "a.1.ele", {"a.1.node", "from a file"}, [] { parse_mesh("1 4 0\n1 1 2 3 4\n", "a.1.ele"); });
    expect_error(ErrorCode::unsupported, "a.face", {"TetGen", ".ele or .node"}, [] { parse_mesh("1 0\n", "a.face"); });
    expect_error(ErrorCode::unsupported, "a.msh", {"compressed", "unpack"}, [] { parse_mesh("\x1f\x8b\x08", "a.msh"); });
    expect_error(ErrorCode::unsupported, "a.msh:1", {"not recognised", "Gmsh"}, [] { parse_mesh("hello", "a.msh"); });
    expect_error(ErrorCode::parse, "a.msh:1", {"empty"}, [] { parse_mesh("", "a.msh"); });
}

TEST(IoMeshFile, UnreadableFilesSayWhy) {
    const test::TemporaryFolder folder;
    expect_error(ErrorCode::file_unreadable, (folder / "none.msh").string(), {"cannot open", "No such file"},
                 [&] { read_mesh(folder / "none.msh"); });
    expect_error(ErrorCode::file_unreadable, folder.path().string(), {"directory"}, [&] { read_mesh(folder.path()); });
}

TEST(IoBinaryFile, WritesWholeFilesOrNone) {
    const test::TemporaryFolder folder;
    std::vector<std::byte> bytes(100000);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::byte(i * 7 % 256);
    write_binary_file(folder / "a.bin", bytes);
    EXPECT_EQ(read_binary_file(folder / "a.bin"), bytes);
    bytes.resize(3);
    write_binary_file(folder / "a.bin", bytes);
    EXPECT_EQ(read_binary_file(folder / "a.bin"), bytes);
    write_binary_file(folder / "empty.bin", {});
    EXPECT_TRUE(read_binary_file(folder / "empty.bin").empty());
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) files += entry.is_regular_file();
    EXPECT_EQ(files, 2u);  // no temporary file is left

    expect_error(ErrorCode::file_unreadable, (folder / "none/a.bin").string(), {"No such file"},
                 [&] { write_binary_file(folder / "none/a.bin", bytes); });
    expect_error(ErrorCode::file_unreadable, folder.path().string(), {"directory"}, [&] { write_binary_file(folder.path(), bytes); });
    expect_error(ErrorCode::file_unreadable, (folder / "none.bin").string(), {"No such file"},
                 [&] { read_binary_file(folder / "none.bin"); });
}

TEST(IoBinaryFile, WritesThroughLinksAndIntoDevices) {
    const test::TemporaryFolder folder;
    write_text_file(folder / "target.txt", "old");
    std::filesystem::create_symlink("target.txt", folder / "link.txt");
    write_text_file(folder / "link.txt", "new");
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
    EXPECT_EQ(read_text_file(folder / "target.txt"), "new");
    write_text_file("/dev/null", "gone");
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
    if (std::filesystem::exists("/dev/full")) {
        expect_error(ErrorCode::file_unreadable, "/dev/full", {"No space"}, [] { write_text_file("/dev/full", "too much"); });
    }
}

}  // namespace
}  // namespace supple::io
