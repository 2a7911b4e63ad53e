// Every volume mesh through every format that can be written, and what the binary readers refuse.
#include <cstring>
#include <iostream>

#include "supple/io/binary_file.h"
#include "supple/io/mesh_file.h"
#include "supple/io/mesh_formats.h"
#include "supple/mesh/box_mesh.h"
#include "test_io_helpers.h"

namespace supple::io {
namespace {

using test::caught;
using test::expect_error;

/// A name that the format's ending accepts.
std::filesystem::path file_for(const test::TemporaryFolder& folder, const OutputFormat& format) {
    return folder / ("mesh" + std::string(format.endings.substr(0, format.endings.find(' '))));
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

/// Tets and hexes, two regions and a part without, overlapping groups, numbers that are hard to print.
VolumeMesh awkward_mesh() {
    VolumeMesh mesh = make_tet_box({Vec3(-0.1, 1.0 / 3, 1e-17), Vec3(0.7, 2.0 / 3, 1e5), {3, 2, 2}});
    mesh.vertices[0] = Vec3(-0.0, 5e-324, 1.7976931348623157e308);
    mesh.hexes = {{0, 1, 2, 3, 4, 5, 6, 7}, {8, 9, 10, 11, 12, 13, 14, 15}};
    mesh.regions = {{"soft tissue \"A\" <&>", 7}, {"region_3", 3}};
    mesh.element_region.assign(mesh.element_count(), 1);
    for (std::size_t e = 0; e < mesh.element_count(); e += 3) mesh.element_region[e] = 0;
    mesh.element_region[1] = -1;
    mesh.element_region.back() = -1;
    mesh.groups = {{"ligament 100%", {0, 3, 5}}, {"tip", {1}}, {"other tip", {0, 1, 2}}};
    return mesh;
}

void expect_survives(const VolumeMesh& mesh, const OutputFormat& format, const test::TemporaryFolder& folder) {
    SCOPED_TRACE(std::string(format.key));
    const std::filesystem::path file = file_for(folder, format);
    write_mesh(file, mesh, format.key);
    const VolumeMesh back = read_mesh(file);
    EXPECT_TRUE(same_bits(back.vertices, mesh.vertices));
    EXPECT_EQ(back.tets, mesh.tets);
    EXPECT_EQ(back.hexes, mesh.hexes);
    ASSERT_EQ(back.element_region.size(), mesh.element_region.size());
    for (std::size_t e = 0; e < mesh.element_region.size(); ++e) {
        const std::int32_t a = mesh.element_region[e], b = back.element_region[e];
        ASSERT_EQ(a < 0, b < 0) << e;
        if (a >= 0) {
            ASSERT_EQ(mesh.regions[std::size_t(a)].tag, back.regions[std::size_t(b)].tag) << e;
        }
    }
    if (!format.loses.empty()) return;
    EXPECT_EQ(back.element_region, mesh.element_region);
    ASSERT_EQ(back.regions.size(), mesh.regions.size());
    for (std::size_t r = 0; r < mesh.regions.size(); ++r) EXPECT_EQ(back.regions[r].name, mesh.regions[r].name);
    ASSERT_EQ(back.groups.size(), mesh.groups.size());
    for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
        EXPECT_EQ(back.groups[g].name, mesh.groups[g].name);
        EXPECT_EQ(back.groups[g].vertices, mesh.groups[g].vertices);
    }
}

TEST(IoRoundTrips, AnAwkwardMeshSurvivesEveryFormat) {
    const test::TemporaryFolder folder;
    const VolumeMesh mesh = awkward_mesh();
    std::size_t formats = 0;
    for (const OutputFormat& format : output_formats()) {
        if (!format.write) continue;
        ++formats;
        if (format.key == "tetgen") {
            expect_error(ErrorCode::unsupported, file_for(folder, format).string(), {"2 hexahedra"},
                         [&] { write_mesh(file_for(folder, format), mesh, format.key); });
            VolumeMesh tets = mesh;
            tets.hexes.clear();
            tets.element_region.resize(tets.tets.size());
            expect_survives(tets, format, folder);
        } else {
            expect_survives(mesh, format, folder);
        }
    }
    EXPECT_EQ(formats, 14u);
}

TEST(IoRoundTrips, RealMeshesSurviveEveryFormat) {
    const std::filesystem::path meshes = test::shared_data("meshes");
    if (meshes.empty()) return;
    const test::TemporaryFolder folder;
    std::size_t read = 0;
    for (const auto& entry : std::filesystem::directory_iterator(meshes)) {
        if (entry.path().extension() == ".md") continue;
        SCOPED_TRACE(entry.path().filename().string());
        VolumeMesh mesh;
        try {
            mesh = read_mesh(entry.path());
        } catch (const Error& error) {
            EXPECT_EQ(to_string(error.code()), to_string(ErrorCode::surface_mesh)) << error.what();
            continue;
        }
        ++read;
        for (const OutputFormat& format : output_formats())
            if (format.write) expect_survives(mesh, format, folder);
    }
    EXPECT_GE(read, 9u);
}

TEST(IoRoundTrips, AMeshWithoutRegionsAndASingleElementSurvive) {
    const test::TemporaryFolder folder;
    VolumeMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tets = {{0, 1, 2, 3}};
    for (const OutputFormat& format : output_formats())
        if (format.write) expect_survives(mesh, format, folder);
}

TEST(IoRoundTrips, UnknownFormatsAreRefusedWithTheKnownOnes) {
    const test::TemporaryFolder folder;
    const VolumeMesh mesh = make_tet_box({});
    expect_error(ErrorCode::unsupported, (folder / "a.xyz").string(), {"\".xyz\"", "gmsh41-binary (.msh)", "vtu (.vtu)"},
                 [&] { write_mesh(folder / "a.xyz", mesh); });
    expect_error(ErrorCode::unsupported, (folder / "a.obj").string(), {"\".obj\"", "volume mesh"},
                 [&] { write_mesh(folder / "a.obj", mesh); });
    expect_error(ErrorCode::unsupported, (folder / "a.msh").string(), {"\"gmsh5\""}, [&] { write_mesh(folder / "a.msh", mesh, "gmsh5"); });
}

TEST(IoRoundTrips, EveryTruncationOfEveryFormatIsAnError) {
    const test::TemporaryFolder folder;
    VolumeMesh mesh = make_tet_box({});
    mesh.regions = {{"a", 7}};
    mesh.element_region.assign(mesh.element_count(), 0);
    mesh.groups = {{"g", {0, 1}}};
    for (const OutputFormat& format : output_formats()) {
        if (!format.write || format.key == "tetgen") continue;
        SCOPED_TRACE(std::string(format.key));
        const std::filesystem::path file = file_for(folder, format);
        write_mesh(file, mesh, format.key);
        const std::string text = read_text_file(file);
        std::size_t accepted = 0;
        for (std::size_t length = 0; length < text.size(); length += 1 + text.size() / 2000) {
            try {
                test::expect_consistent(parse_mesh(text.substr(0, length), file.filename().string()));
                ++accepted;
            } catch (const Error& error) {
                EXPECT_TRUE(error.code() == ErrorCode::parse || error.code() == ErrorCode::unsupported) << error.what();
            }
        }
        // Only line ends, trailing words and, in VTK files, arrays of data behind the mesh may be missing.
        const std::size_t most = format.endings == ".vtk" ? text.size() / 3 : format.endings == ".vtu" ? 28 : 12;
        EXPECT_LE(accepted, most);
    }
}

/// Every format's bytes, changed at random: only Errors escape, and what is accepted is in range.
TEST(IoRoundTrips, OnlyErrorsEscapeFromMutatedFiles) {
    const test::TemporaryFolder folder;
    VolumeMesh mesh = make_tet_box({Vec3(0, 0, 0), Vec3(1, 1, 1), {1, 1, 1}});
    mesh.regions = {{"a", 7}};
    mesh.element_region.assign(mesh.element_count(), 0);
    mesh.groups = {{"g", {0, 1}}};
    std::vector<std::string> texts;
    for (const OutputFormat& format : output_formats()) {
        if (!format.write || format.key == "tetgen") continue;
        const std::filesystem::path file = file_for(folder, format);
        write_mesh(file, mesh, format.key);
        texts.push_back(read_text_file(file));
    }
    const std::size_t accepted =
        test::expect_only_errors(texts, 1500, 4711, [](const std::string& text) { return parse_mesh(text, "m.msh"); });
    EXPECT_GT(accepted, 300u);
}

TEST(IoRoundTrips, HostileCountsInBytesAllocateNothing) {
    const test::TemporaryFolder folder;
    const VolumeMesh mesh = make_tet_box({});
    const auto bytes_of = [&](const char* key, const char* name) {
        write_mesh(folder / name, mesh, key);
        return read_text_file(folder / name);
    };
    const auto refuse = [](std::string bytes, const std::string& marker, std::size_t skip, const std::string& number,
                           const std::string& word) {
        const std::size_t at = bytes.find(marker);
        ASSERT_NE(at, std::string::npos);
        const bool is_text = number[0] == '9';
        const std::size_t end = is_text ? bytes.find('\n', at + marker.size() + skip) : at + marker.size() + skip + number.size();
        const std::size_t begin = at + marker.size() + skip;
        bytes.replace(begin, is_text && number.size() == 1 ? 1 : end - begin, number);
        const Error error = caught([&] { parse_mesh(bytes, "m.msh"); });
        EXPECT_EQ(to_string(error.code()), to_string(ErrorCode::parse)) << error.what();
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    };
    const std::string huge("\xff\xff\xff\xff\xff\xff\xff\x0f", 8);
    refuse(bytes_of("gmsh41-binary", "a.msh"), "$Nodes\n", 8, huge, "announces");
    refuse(bytes_of("gmsh41-binary", "a.msh"), "$Nodes\n", 0, huge, "announces");
    refuse(bytes_of("gmsh41-binary", "a.msh"), "$Elements\n", 0, huge, "announces");
    refuse(bytes_of("gmsh41-binary", "a.msh"), "$Entities\n", 24, huge, "announces");
    refuse(bytes_of("gmsh22-binary", "a.msh"), "$Nodes\n", 0, "9", "announces 9");
    refuse(bytes_of("vtu-appended", "a.vtu"), "\n_", 0, huge, "announces");
    refuse(bytes_of("vtu", "a.vtu"), "\n_", 0, huge, "announces");
    refuse(bytes_of("vtu", "a.vtu"), "\n_", 16, huge, "announces a block");
    refuse(bytes_of("vtk-binary", "a.vtk"), "POINTS ", 0, "99999 double", "announces 299997 values");
    refuse(bytes_of("vtk", "a.vtk"), "CELLS ", 0, "999999999 9999999999", "announces 9999999999 values");
}

}  // namespace
}  // namespace supple::io
