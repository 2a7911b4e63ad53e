// TetGen, Vega and Abaqus/CalculiX.
#include "supple/io/binary_file.h"
#include "supple/io/mesh_builder.h"
#include "supple/io/mesh_file.h"
#include "supple/io/volume_formats.h"
#include "test_io_helpers.h"

namespace supple::io {
namespace {

using test::expect_error;
using Ids = std::vector<std::int32_t>;

const char* const kNode =
    "# nodes\n5 3 1 1\n\n 1 0 0 0 9.5 0\n2 1 0 0 9.5 3 # marked\n3 0 1 0 9.5 0\n4 0 0 1 9.5 0\n5 1 1 1 9.5 3\n# end\n";
const char* const kEle = "2 4 1\n1 1 2 3 4 6\n# comment\n2 2 3 4 5 -2\n";

const char* const kVega =
    "# a comment\n*VERTICES\n5 3 0 0\n1 0 0 0\n2 1 0 0\n3, 0, 1, 0\n4 0 0 1\n5 1 1 1\n\n*ELEMENTS\nTET\n2 4 0\n1 1 2 3 4\n2 2 3 4 5\n"
    "*MATERIAL soft\nENU, 1000, 1E5, 0.45 # tissue\n*SET one\n1,\n*SET both\n1, 2\n*SET two\n2\n*REGION\ntwo, soft\n*REGION\none, soft\n";

const char* const kAbaqus =
    "** made by hand\n*HEADING\na title, with commas\n*NODE, NSET=Nall\n1, 0., 0., 0.\n2, 1., 0, 0\n3, 1., 1.\n4, 0, 1\n5, 0, 0, 1.D0\n6, "
    "1, 0, 1\n"
    "7, 1, 1, 1\n8, 0, 1, 1\n9, 2, 0, 0\n*Element, type=C3D8R, ELSET=block\n10, 1,2,3,4,5,6,\n7,8\n*ELEMENT, TYPE=C3D4, elset=\"tip\"\n20, "
    "2, 9, 3, 6\n"
    "*ELEMENT, TYPE=S3\n30, 1, 2, 5\n*ELEMENT, TYPE=MASS\n40, 9\n*NSET, NSET=held, GENERATE\n1, 7, 2\n*NSET, NSET=more\nheld, 8,\n*ELSET, "
    "ELSET=all\nblock, tip\n"
    "*MATERIAL, NAME=m\n*ELASTIC\n210000., .3\n*SOLID SECTION, ELSET=tip, MATERIAL=m\n*SOLID SECTION, ELSET=block, "
    "MATERIAL=m\n*STEP\n*STATIC\n*END STEP\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

VolumeMesh tetgen(const std::string& nodes, const std::string& elements) {
    MeshBuilder builder;
    read_tetgen({elements, "m.ele", {}}, nodes, "m.node", builder);
    return builder.finish("m.ele");
}

VolumeMesh vega(const std::string& text) { return parse_mesh(text, "m.veg"); }
VolumeMesh abaqus(const std::string& text) { return parse_mesh(text, "m.inp"); }

TEST(IoTetGen, ReadsBothFilesWhicheverIsNamed) {
    const VolumeMesh mesh = tetgen(kNode, kEle);
    EXPECT_EQ(mesh.vertices[4], Vec3(1, 1, 1));
    EXPECT_EQ(mesh.tets, (std::vector<Tet>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
    EXPECT_EQ(mesh.element_region, (Ids{0, 1}));
    EXPECT_EQ(mesh.regions[1].name, "region_-2");
    ASSERT_EQ(mesh.groups.size(), 1u);
    EXPECT_EQ(mesh.groups[0].name, "point_3");
    EXPECT_EQ(mesh.groups[0].vertices, (Ids{1, 4}));
    const test::TemporaryFolder folder;
    write_text_file(folder / "m.1.node", kNode);
    write_text_file(folder / "m.1.ele", kEle);
    EXPECT_EQ(read_mesh(folder / "m.1.node").tets, mesh.tets);
    EXPECT_EQ(read_mesh(folder / "m.1.ele").tets, mesh.tets);
    std::filesystem::remove(folder / "m.1.node");
    expect_error(ErrorCode::file_unreadable, (folder / "m.1.ele").string(), {"m.1.node", "not there"},
                 [&] { read_mesh(folder / "m.1.ele"); });
}

TEST(IoTetGen, ErrorsNameTheLineAndTheFile) {
    const auto refuse = [](const std::string& nodes, const std::string& elements, const std::string& where,
                           const std::vector<std::string>& words,
                           ErrorCode code = ErrorCode::parse) { expect_error(code, where, words, [&] { tetgen(nodes, elements); }); };
    refuse(replaced(kNode, "5 3 1 1", "6 3 1 1"), kEle, "m.node:10", {"a node", "truncated"});
    refuse(replaced(kNode, "5 3 1 1", "5 2 1 1"), kEle, "m.node:2", {"dimension", "2"});
    refuse(replaced(kNode, "5 3 1 1", "0 3 1 1"), kEle, "m.node:2", {".poly"}, ErrorCode::unsupported);
    refuse(replaced(kNode, "2 1 0 0", "2 1 b 0"), kEle, "m.node:5", {"\"b\""});
    refuse(kNode, replaced(kEle, "1 1 2 3 4 6", "1 1 2 3 7 6"), "m.ele:2", {"node 7"});
    refuse(kNode, replaced(kEle, "2 4 1", "2 10 1"), "m.ele:1", {"10 nodes", "-o2"}, ErrorCode::unsupported);
    refuse(kNode, replaced(kEle, "3 4 6", "3 4 6.5"), "m.ele:2", {"6.5", "region"});
    refuse(kNode, replaced(kEle, "2 4 1", "1152921504606846976 4 1"), "m.ele:5", {"tetrahedron", "truncated"});
}

TEST(IoVega, ReadsSetsAndRegions) {
    const VolumeMesh mesh = vega(kVega);
    EXPECT_EQ(mesh.tets, (std::vector<Tet>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
    ASSERT_EQ(mesh.regions.size(), 2u);
    EXPECT_EQ(mesh.regions[std::size_t(mesh.element_region[0])].name, "one");
    EXPECT_EQ(mesh.regions[std::size_t(mesh.element_region[1])].name, "two");
    ASSERT_EQ(mesh.groups.size(), 1u);
    EXPECT_EQ(mesh.groups[0].name, "both");
    EXPECT_EQ(mesh.groups[0].vertices.size(), 5u);
    const VolumeMesh hex = vega(
        "*VERTICES\n8 3 0 0\n0 0 0 0\n1 1 0 0\n2 1 1 0\n3 0 1 0\n4 0 0 1\n5 1 0 1\n6 1 1 1\n7 0 1 1\n*ELEMENTS\nCUBIC\n1 8 0\n0 0 1 2 3 4 "
        "5 6 7\n");
    EXPECT_EQ(hex.hexes, (std::vector<Hex>{{0, 1, 2, 3, 4, 5, 6, 7}}));
    EXPECT_TRUE(hex.regions.empty());
}

TEST(IoVega, ReadsIncludedFilesBesideIt) {
    const test::TemporaryFolder folder;
    write_text_file(folder / "m.node", "5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n");
    write_text_file(folder / "m.veg", "*VERTICES\n*INCLUDE m.node\n*ELEMENTS\nTET\n1 4 0\n1 1 2 3 5\n");
    EXPECT_EQ(read_mesh(folder / "m.veg").tets, (std::vector<Tet>{{0, 1, 2, 4}}));
    write_text_file(folder / "loop.veg", "*VERTICES\n*INCLUDE loop.veg\n");
    expect_error(ErrorCode::parse, "loop.veg:2", {"16 deep"}, [&] { read_mesh(folder / "loop.veg"); });
    write_text_file(folder / "zero.veg", "*VERTICES\n*INCLUDE /dev/zero\n");
    expect_error(ErrorCode::file_unreadable, (folder / "zero.veg").string() + ":2", {"not there"}, [&] { read_mesh(folder / "zero.veg"); });
    expect_error(ErrorCode::unsupported, "m.veg:2", {"from a file"}, [] { vega("*VERTICES\n*INCLUDE a.node\n"); });
}

TEST(IoVega, ErrorsNameTheLine) {
    const auto refuse = [](const std::string& from, const std::string& to, const std::string& where, const std::vector<std::string>& words,
                           ErrorCode code = ErrorCode::parse) {
        SCOPED_TRACE(to);
        expect_error(code, where, words, [&] { vega(replaced(kVega, from, to)); });
    };
    refuse("5 3 0 0", "6 3 0 0", "m.veg:27", {"1 vertices are missing"});
    refuse("5 3 0 0", "4 3 0 0", "m.veg:8", {"more vertices"});
    refuse("5 3 0 0", "-1 3 0 0", "m.veg:3", {"negative"});
    refuse("TET", "WEDGE", "m.veg:11", {"WEDGE"}, ErrorCode::unsupported);
    refuse("2 4 0\n", "2 8 0\n", "m.veg:12", {"4 vertices", "\"8\""});
    refuse("2 2 3 4 5", "2 2 3 4 9", "m.veg:14", {"node 9"});
    refuse("2 2 3 4 5", "1 2 3 4 5", "m.veg:14", {"element 1", "second time"});
    refuse("*SET two\n2", "*SET two\n7", "m.veg", {"\"two\"", "element 7"});
    refuse("3, 0, 1, 0", "3, 0, one, 0", "m.veg:6", {"\"one\""});
}

TEST(IoAbaqus, ReadsElementsSetsAndSections) {
    const VolumeMesh mesh = abaqus(kAbaqus);
    EXPECT_EQ(mesh.hexes, (std::vector<Hex>{{0, 1, 2, 3, 4, 5, 6, 7}}));
    EXPECT_EQ(mesh.tets, (std::vector<Tet>{{1, 8, 2, 5}}));
    EXPECT_EQ(mesh.vertices[2], Vec3(1, 1, 0));
    EXPECT_EQ(mesh.vertices[4], Vec3(0, 0, 1));
    ASSERT_EQ(mesh.regions.size(), 2u);
    EXPECT_EQ(mesh.regions[std::size_t(mesh.element_region[0])].name, "tip");
    EXPECT_EQ(mesh.regions[std::size_t(mesh.element_region[1])].name, "block");
    const auto group = [&](const std::string& name) {
        for (const VertexGroup& g : mesh.groups)
            if (g.name == name) return g.vertices;
        ADD_FAILURE() << name;
        return Ids{};
    };
    EXPECT_EQ(group("held"), (Ids{0, 2, 4, 6}));
    EXPECT_EQ(group("more"), (Ids{0, 2, 4, 6, 7}));
    EXPECT_EQ(group("all").size(), 9u);
    EXPECT_EQ(group("Nall").size(), 9u);
}

TEST(IoAbaqus, ReadsIncludesAndSurfaces) {
    const test::TemporaryFolder folder;
    write_text_file(folder / "nodes.inc", "1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n");
    write_text_file(folder / "m.inp", "*NODE, INPUT=nodes.inc\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n");
    EXPECT_EQ(read_mesh(folder / "m.inp").tets.size(), 1u);
    write_text_file(folder / "n.inp", "*INCLUDE, INPUT=all.inc\n");
    write_text_file(folder / "all.inc", "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n*ELEMENT, TYPE=S3\n1, 1, 2, 3\n");
    expect_error(ErrorCode::surface_mesh, (folder / "n.inp").string(), {"1 triangle"}, [&] { read_mesh(folder / "n.inp"); });
}

TEST(IoAbaqus, ErrorsNameTheLine) {
    const auto refuse = [](const std::string& from, const std::string& to, const std::string& where, const std::vector<std::string>& words,
                           ErrorCode code = ErrorCode::parse) {
        SCOPED_TRACE(to);
        expect_error(code, where, words, [&] { abaqus(replaced(kAbaqus, from, to)); });
    };
    refuse("type=C3D8R", "type=C3D20R", "m.inp:14", {"C3D20R", "C3D4 or C3D8"}, ErrorCode::unsupported);
    refuse("type=C3D8R", "type=C3D10", "m.inp:14", {"C3D10"}, ErrorCode::unsupported);
    refuse("7,8\n", "7\n", "m.inp:15", {"7 nodes", "has 8"});
    refuse("7,8\n", "7,8,9\n", "m.inp:15", {"9 nodes"});
    refuse("20, 2, 9, 3, 6", "20, 2, 99, 3, 6", "m.inp:18", {"node 99"});
    refuse("2, 1., 0, 0", "2, one, 0, 0", "m.inp:6", {"\"one\""});
    refuse("1, 7, 2", "1, 7000000000000000000, 1", "m.inp:24", {"at most"});
    refuse("1, 7, 2", "1, 7, 0", "m.inp:24", {"positive"});
    refuse("held, 8,", "hold, 8,", "m.inp:26", {"\"hold\""});
    refuse("*HEADING", "*PART, NAME=a\n*END PART\n*PART, NAME=b", "m.inp:4", {"second *PART", "flat"}, ErrorCode::unsupported);
    refuse("*STEP", "*INSTANCE, NAME=a, PART=b\n0, 0, 1.\n*STEP", "m.inp:35", {"instance is moved"}, ErrorCode::unsupported);
    refuse("*NODE, NSET=Nall", "*NODE, SYSTEM=C", "m.inp:4", {"cylindrical"}, ErrorCode::unsupported);
    refuse("*STEP", "*NGEN\n1, 7, 2\n*STEP", "m.inp:34", {"*ngen"}, ErrorCode::unsupported);
}

TEST(IoKeywordFiles, OnlyErrorsEscapeFromMutatedFiles) {
    EXPECT_GT(test::expect_only_errors({kVega}, 4000, 5, vega), 100u);
    EXPECT_GT(test::expect_only_errors({kAbaqus}, 4000, 6, abaqus), 100u);
    EXPECT_GT(test::expect_only_errors({kEle}, 2000, 7, [](const std::string& text) { return tetgen(kNode, text); }), 50u);
    EXPECT_GT(test::expect_only_errors({kNode}, 2000, 8, [](const std::string& text) { return tetgen(text, kEle); }), 50u);
}

}  // namespace
}  // namespace supple::io
