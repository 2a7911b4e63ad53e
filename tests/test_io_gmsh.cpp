#include <cstring>
#include <fstream>
#include <functional>

#include "supple/io/mesh_file.h"
#include "supple/io/text_scanner.h"
#include "supple/mesh/box_mesh.h"
#include "test_io_helpers.h"

namespace supple::io {
namespace {

using test::caught;
using test::expect_consistent;
using test::expect_error;

/// Two tets and a triangle; ids neither contiguous nor ordered.
const char* const kGmsh1 =
    "$NOD\n5\n10 0 0 0\n7 1 0 0\n1000000007 0 1 0\n3 0 0 1\n5 1 1 1\n$ENDNOD\n"
    "$ELM\n3\n1 2 4 1 3 10 7 3\n2 4 6 1 4 10 7 1000000007 3\n3 4 0 1 4 7 1000000007 3 5\n$ENDELM\n";

const char* const kGmsh2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\nby hand\n$Nodes in a comment\n$EndComments\n"
    "$PhysicalNames\n3\n2 4 \"clamped face\"\n3 6 \"soft \"tissue\"\"\n0 9 \"tip\"\n$EndPhysicalNames\n"
    "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n"
    "$Elements\n5\n1 15 2 9 1 5\n2 2 2 4 1 1 2 4\n3 4 2 6 1 1 2 3 4\n4 4 0 2 3 4 5\n5 1 3 8 1 0 2 1\n$EndElements\n"
    "$NodeData\n1\n\"a view\"\n1\n0.0\n3\n0\n1\n0\n$EndNodeData\n";

const char* const kGmsh4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    "$PhysicalNames\n2\n3 7 \"all\"\n3 8 \"half\"\n$EndPhysicalNames\n"
    "$Entities\n1 0 1 2\n1 0 0 0 1 5\n"
    "1 0 0 0 1 1 0 1 -3 0\n"
    "1 0 0 0 1 1 1 1 7 1 1\n2 0 0 0 1 1 1 2 7 8 1 1\n$EndEntities\n"
    "$Nodes\n3 5 1 90\n"
    "0 1 0 1\n4\n0 0 1\n"
    "2 1 1 3\n90\n1\n2\n0 1 0 .5 .5\n0 0 0 0 0\n1 0 0 1 0\n"
    "3 1 0 1\n5\n1 1 1\n$EndNodes\n"
    "$Elements\n4 4 1 4\n0 1 15 1\n1 4\n2 1 2 1\n2 1 2 90\n3 1 4 1\n3 1 2 90 4\n3 2 4 1\n4 2 90 4 5\n$EndElements\n";

const char* const kHexes =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n12\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n"
    "9 2 0 0\n10 2 1 0\n11 2 0 1\n12 2 1 1\n$EndNodes\n$Elements\n3\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 4 2 2 1 2 9 3 6\n3 5 2 2 1 2 9 10 3 6 11 "
    "12 7\n$EndElements\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

VolumeMesh parse(const std::string& text) { return parse_mesh(text, "m.msh"); }

void expect_same(const VolumeMesh& a, const VolumeMesh& b) {
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    for (std::size_t i = 0; i < a.vertices.size(); ++i) EXPECT_EQ(std::memcmp(a.vertices[i].data(), b.vertices[i].data(), 24), 0) << i;
    EXPECT_EQ(a.tets, b.tets);
    EXPECT_EQ(a.hexes, b.hexes);
    EXPECT_EQ(a.element_region, b.element_region);
    ASSERT_EQ(a.regions.size(), b.regions.size());
    for (std::size_t r = 0; r < a.regions.size(); ++r) {
        EXPECT_EQ(a.regions[r].name, b.regions[r].name);
        EXPECT_EQ(a.regions[r].tag, b.regions[r].tag);
    }
    ASSERT_EQ(a.groups.size(), b.groups.size());
    for (std::size_t g = 0; g < a.groups.size(); ++g) {
        EXPECT_EQ(a.groups[g].name, b.groups[g].name);
        EXPECT_EQ(a.groups[g].vertices, b.groups[g].vertices);
    }
}

using Ids = std::vector<std::int32_t>;

TEST(IoGmsh, ReadsVersion1WithSparseUnorderedIds) {
    const VolumeMesh mesh = parse(kGmsh1);
    ASSERT_EQ(mesh.vertices.size(), 5u);
    EXPECT_EQ(mesh.vertices[2], Vec3(0, 1, 0));
    EXPECT_EQ(mesh.tets, (std::vector<Tet>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
    ASSERT_EQ(mesh.regions.size(), 1u);
    EXPECT_EQ(mesh.regions[0].name, "region_6");
    EXPECT_EQ(mesh.regions[0].tag, 6);
    EXPECT_EQ(mesh.element_region, (Ids{0, -1}));
    ASSERT_EQ(mesh.groups.size(), 1u);
    EXPECT_EQ(mesh.groups[0].name, "surface_4");
    EXPECT_EQ(mesh.groups[0].vertices, (Ids{0, 1, 3}));
    EXPECT_EQ(mesh.source, "m.msh");
}

TEST(IoGmsh, ReadsVersion2WithNamesCommentsAndUnknownSections) {
    const VolumeMesh mesh = parse(kGmsh2);
    EXPECT_EQ(mesh.tets, (std::vector<Tet>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
    ASSERT_EQ(mesh.regions.size(), 1u);
    EXPECT_EQ(mesh.regions[0].name, "soft \"tissue\"");
    EXPECT_EQ(mesh.element_region, (Ids{0, -1}));
    ASSERT_EQ(mesh.groups.size(), 3u);
    EXPECT_EQ(mesh.groups[0].name, "clamped face");
    EXPECT_EQ(mesh.groups[0].vertices, (Ids{0, 1, 3}));
    EXPECT_EQ(mesh.groups[1].name, "tip");
    EXPECT_EQ(mesh.groups[1].vertices, (Ids{4}));
    EXPECT_EQ(mesh.groups[2].name, "curve_8");
    EXPECT_EQ(mesh.groups[2].vertices, (Ids{0, 1}));
}

TEST(IoGmsh, ReadsVersion4WithEntitiesAndParametricNodes) {
    const VolumeMesh mesh = parse(kGmsh4);
    ASSERT_EQ(mesh.vertices.size(), 5u);
    EXPECT_EQ(mesh.vertices[0], Vec3(0, 0, 1));
    EXPECT_EQ(mesh.vertices[1], Vec3(0, 1, 0));
    EXPECT_EQ(mesh.vertices[2], Vec3(0, 0, 0));
    EXPECT_EQ(mesh.tets, (std::vector<Tet>{{2, 3, 1, 0}, {3, 1, 0, 4}}));
    ASSERT_EQ(mesh.regions.size(), 1u);
    EXPECT_EQ(mesh.regions[0].name, "all");
    EXPECT_EQ(mesh.element_region, (Ids{0, 0}));
    ASSERT_EQ(mesh.groups.size(), 3u);
    EXPECT_EQ(mesh.groups[0].name, "half");  // a second group of the same volume: as vertices
    EXPECT_EQ(mesh.groups[0].vertices, (Ids{0, 1, 3, 4}));
    EXPECT_EQ(mesh.groups[1].name, "point_5");
    EXPECT_EQ(mesh.groups[1].vertices, (Ids{0}));
    EXPECT_EQ(mesh.groups[2].name, "surface_3");  // written as -3: reversed, the same group
    EXPECT_EQ(mesh.groups[2].vertices, (Ids{1, 2, 3}));
}

TEST(IoGmsh, ReadsVersion4WithoutEntities) {
    std::string text = kGmsh4;
    const std::size_t begin = text.find("$Entities"), end = text.find("$Nodes");
    text.erase(begin, end - begin);
    text = replaced(text, "$PhysicalNames\n2\n3 7 \"all\"\n3 8 \"half\"\n$EndPhysicalNames\n", "");
    const VolumeMesh mesh = parse(text);
    EXPECT_EQ(mesh.tets.size(), 2u);
    EXPECT_TRUE(mesh.regions.empty());
    EXPECT_TRUE(mesh.element_region.empty());
}

TEST(IoGmsh, OverlappingVolumeGroupsHoldAllTheirVertices) {
    // Group 8 is the region of volume 1 and the second group of volume 2.
    const VolumeMesh mesh = parse(replaced(kGmsh4, "1 0 0 0 1 1 1 1 7 1 1\n", "1 0 0 0 1 1 1 1 8 1 1\n"));
    ASSERT_EQ(mesh.regions.size(), 2u);
    EXPECT_EQ(mesh.element_region, (Ids{1, 0}));
    ASSERT_FALSE(mesh.groups.empty());
    EXPECT_EQ(mesh.groups[0].name, "half");
    EXPECT_EQ(mesh.groups[0].vertices, (Ids{0, 1, 2, 3, 4}));
}

TEST(IoGmsh, ReadsMixedTetsAndHexes) {
    const VolumeMesh mesh = parse(kHexes);
    EXPECT_EQ(mesh.hexes, (std::vector<Hex>{{0, 1, 2, 3, 4, 5, 6, 7}, {1, 8, 9, 2, 5, 10, 11, 6}}));
    EXPECT_EQ(mesh.tets, (std::vector<Tet>{{1, 8, 2, 5}}));
    EXPECT_EQ(mesh.element_region, (Ids{1, 0, 1}));  // tets first
}

TEST(IoGmsh, ReadsCarriageReturnsAndOddNumbers) {
    std::string text;
    for (char c : std::string(kGmsh2)) text += c == '\n' ? "\r\n" : std::string(1, c);
    expect_same(parse(text), parse(kGmsh2));
    const VolumeMesh mesh = parse(replaced(kGmsh2, "2 1 0 0\n", "\n  2\t1.0D+03 6.12323e-018 +.5e-400  \n\n"));
    EXPECT_EQ(mesh.vertices[1], Vec3(1000, 6.12323e-18, 0));
    EXPECT_EQ(parse("\xEF\xBB\xBF" + std::string(kGmsh1)).tets.size(), 2u);
    EXPECT_EQ(parse(std::string("\n\n") + kGmsh4).tets.size(), 2u);
}

TEST(IoGmsh, EveryErrorNamesTheLine) {
    const auto refuse = [](const char* text, const std::string& from, const std::string& to, const std::string& where,
                           const std::vector<std::string>& words, ErrorCode code = ErrorCode::parse) {
        SCOPED_TRACE(to);
        expect_error(code, where, words, [&] { parse(replaced(text, from, to)); });
    };
    refuse(kGmsh1, "7 1 0 0", "7 1 0 zero", "m.msh:4", {"z coordinate", "zero"});
    refuse(kGmsh1, "7 1 0 0", "7 1 0", "m.msh:4", {"line ends", "z coordinate"});
    refuse(kGmsh1, "7 1 0 0", "7 1 0 0 4", "m.msh:4", {"unexpected \"4\""});
    refuse(kGmsh1, "7 1 0 0", "7 1 nan 0", "m.msh:4", {"finite"});
    refuse(kGmsh1, "7 1 0 0", "7 1 1e999 0", "m.msh:4", {"finite"});
    refuse(kGmsh1, "7 1 0 0", "10 1 0 0", "m.msh:4", {"node 10", "second time"});
    refuse(kGmsh1, "1 4 10 7 1000000007 3", "1 4 10 7 11 3", "m.msh:12", {"node 11", "does not define"});
    refuse(kGmsh1, "2 4 6 1 4", "2 4 6 1 5", "m.msh:12", {"number of nodes is 5", "[4, 4]"});
    refuse(kGmsh1, "$ELM\n3", "$ELM\n4", "m.msh:14", {"element 4 of 4"});
    refuse(kGmsh1, "$ELM\n3", "$ELM\n2", "m.msh:13", {"more than its counts"});
    refuse(kGmsh1, "$NOD\n5", "$NOD\n1152921504606846976", "m.msh:8", {"node 6 of"});
    refuse(kGmsh1, "$NOD\n5", "$NOD\n-5", "m.msh:2", {"-5", "outside"});
    refuse(kGmsh1, "$ELM\n3", "$ELM\n1152921504606846976", "m.msh:14", {"element 4 of"});
    refuse(kGmsh1, "$ENDELM\n", "", "m.msh:14", {"truncated"});
    refuse(kGmsh1, "$ENDELM\n", "$ENDELM\n$ELM\n0\n$ENDELM\n", "m.msh:15", {"second $ELM"});
    refuse(kGmsh1, "$NOD\n", "$NODE\n", "m.msh:1", {"$NODE", "truncated"});
    refuse(kGmsh2, "3 4 2 6 1 1 2 3 4", "3 11 2 6 1 1 2 3 4 5 1 2 3 4 5", "m.msh:26", {"10-node tetrahedron", "first-order"},
           ErrorCode::unsupported);
    refuse(kGmsh2, "3 4 2 6 1 1 2 3 4", "3 6 2 6 1 1 2 3 4 5 1", "m.msh:26", {"6-node prism", "tetrahedra"}, ErrorCode::unsupported);
    refuse(kGmsh2, "3 4 2 6 1 1 2 3 4", "3 77 2 6 1 1 2 3 4", "m.msh:26", {"type 77"}, ErrorCode::unsupported);
    refuse(kGmsh2, "3 0 1 0\n", "2 0 1 0\n", "m.msh:18", {"node 2", "second time"});
    refuse(kGmsh2, "2.2 0 8", "2.2 1 8", "m.msh:3", {"byte order"});
    refuse(kGmsh2, "2.2 0 8", "2.2 1 4", "m.msh:2", {"data size of 8"}, ErrorCode::unsupported);
    refuse(kGmsh2, "2.2 0 8", "4 0 8", "m.msh:2", {"version 4 ", "4.1"}, ErrorCode::unsupported);
    refuse(kGmsh2, "2.2 0 8", "9.9 0 8", "m.msh:2", {"version 9.9"}, ErrorCode::unsupported);
    refuse(kGmsh2, "2 4 \"clamped face\"", "2 4 clamped", "m.msh:10", {"quotes"});
    refuse(kGmsh2, "2 4 \"clamped face\"", "5 4 \"a\"", "m.msh:10", {"dimension", "[0, 3]"});
    refuse(kGmsh2, "$Nodes\n5", "$Knots\n5", "m.msh:14", {"no $EndKnots"});
    refuse(kGmsh4, "3 5 1 90", "3 1152921504606846976 1 90", "m.msh:31", {"blocks hold 5 nodes"});
    refuse(kGmsh4, "3 5 1 90", "3 4 1 90", "m.msh:28", {"announces 4 in all"});
    refuse(kGmsh4, "2 1 1 3\n", "2 1 1 1152921504606846976\n", "m.msh:21", {"1152921504606846976", "announces 5"});
    refuse(kGmsh4, "3 5 1 90\n", "1152921504606846976 5 1 90\n", "m.msh:31", {"node block 4"});
    refuse(kGmsh4, "3 2 4 1\n", "3 2 2 1\n", "m.msh:40", {"triangle", "dimension 3"});
    refuse(kGmsh4, "4 2 90 4 5", "4 2 90 4 91", "m.msh:41", {"node 91"});
    refuse(kGmsh4, "$Nodes\n3", "$PartitionedEntities\n$EndPartitionedEntities\n$Nodes\n3", "m.msh:16", {"partition"},
           ErrorCode::unsupported);
}

TEST(IoGmsh, SurfaceOnlyFilesAreCalledSurfaces) {
    const std::string text =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n1 2 2 0 1 1 2 "
        "3\n$EndElements\n";
    expect_error(ErrorCode::surface_mesh, "m.msh", {"surface mesh", "1 triangle", "volume mesh is needed", "tetrahedra"},
                 [&] { parse(text); });
    expect_error(ErrorCode::surface_mesh, "m.msh", {"surface mesh", "line"},
                 [&] { parse(replaced(text, "1 2 2 0 1 1 2 3", "1 1 2 0 1 1 2")); });
    expect_error(ErrorCode::parse, "m.msh", {"no elements"}, [&] { parse(replaced(text, "1\n1 2 2 0 1 1 2 3\n", "0\n")); });
}

TEST(IoGmsh, WritesAndReadsBackBitForBit) {
    VolumeMesh mesh = make_tet_box({Vec3(-0.1, 1.0 / 3, 1e-17), Vec3(0.7, 2.0 / 3, 1e5), {3, 2, 2}});
    mesh.vertices[0] = Vec3(-0.0, 5e-324, 1.7976931348623157e308);
    mesh.hexes.push_back({0, 1, 2, 3, 4, 5, 6, 7});
    mesh.regions = {{"soft tissue \"A\"", 7}, {"region_3", 3}, {"empty", 12}};
    mesh.element_region.assign(mesh.element_count(), 1);
    mesh.element_region[0] = -1;
    mesh.element_region.back() = 0;
    mesh.groups = {{"ligament", {0, 3, 5}}, {"none", {}}, {"0", {1}}};
    const test::TemporaryFolder folder;
    write_mesh(folder / "box.msh", mesh);
    const VolumeMesh back = read_mesh(folder / "box.msh");
    expect_same(back, mesh);
    EXPECT_EQ(back.source, (folder / "box.msh").string());
    for (const char* text : {kGmsh1, kGmsh2, kGmsh4, kHexes}) {
        const VolumeMesh first = parse(text);
        write_mesh(folder / "again.msh", first);
        expect_same(read_mesh(folder / "again.msh"), first);
    }
}

TEST(IoGmsh, GivesFreeTagsToRegionsThatShareOne) {
    VolumeMesh mesh = make_tet_box({});
    mesh.regions = {{"a", 1}, {"b", 1}, {"c", 0}, {"d", 2}};
    mesh.element_region = {0, 1, 2, 3, 0, 1};
    const test::TemporaryFolder folder;
    write_mesh(folder / "box.msh", mesh);
    const VolumeMesh back = read_mesh(folder / "box.msh");
    EXPECT_EQ(back.element_region, mesh.element_region);
    ASSERT_EQ(back.regions.size(), 4u);
    EXPECT_EQ(back.regions[1].name, "b");
    EXPECT_EQ(back.regions[3].tag, 2);
}

TEST(IoGmsh, RefusesToWriteWhatContradictsItself) {
    const test::TemporaryFolder folder;
    const auto refuse = [&](const std::string& field, const std::function<void(VolumeMesh&)>& spoil) {
        VolumeMesh mesh = make_tet_box({});
        spoil(mesh);
        expect_error(ErrorCode::invalid_argument, "write_mesh: VolumeMesh." + field, {}, [&] { write_mesh(folder / "bad.msh", mesh); });
        EXPECT_FALSE(std::filesystem::exists(folder / "bad.msh"));
    };
    refuse("tets", [](VolumeMesh& m) { m.tets[0][1] = 8; });
    refuse("tets", [](VolumeMesh& m) { m.tets[0][1] = -1; });
    refuse("vertices[2]", [](VolumeMesh& m) { m.vertices[2][1] = NAN; });
    refuse("element_region", [](VolumeMesh& m) { m.element_region = {0}; });
    refuse("element_region", [](VolumeMesh& m) { m.element_region.assign(6, 0); });
    refuse("regions", [](VolumeMesh& m) { m.regions = {{"two\nlines", 1}}; });
    refuse("groups", [](VolumeMesh& m) { m.groups = {{"g", {99}}}; });
}

TEST(IoGmsh, EveryTruncationIsAnError) {
    for (const char* whole : {kGmsh1, kGmsh4, kHexes}) {
        const std::string text(whole);
        for (std::size_t length = 0; length + 1 < text.size(); ++length) {
            SCOPED_TRACE(length);
            const Error error = caught([&] { parse(text.substr(0, length)); });
            EXPECT_TRUE(error.code() == ErrorCode::parse || error.code() == ErrorCode::unsupported) << error.what();
        }
    }
}

TEST(IoGmsh, OnlyErrorsEscapeFromMutatedFiles) {
    const std::size_t accepted = test::expect_only_errors({kGmsh1, kGmsh2, kGmsh4, kHexes}, 6000, 20240229, parse);
    EXPECT_GT(accepted, 300u);
    EXPECT_LT(accepted, 12000u);
}

TEST(IoGmsh, MemoryFollowsTheFileNotItsCounts) {
    const std::string text(1000, ' ');
    const TextScanner scanner(text, "t");
    EXPECT_LE(scanner.plausible(std::int64_t(1) << 60, 8), 126u);
    EXPECT_EQ(scanner.plausible(5, 8), 5u);
    EXPECT_EQ(scanner.plausible(-5, 8), 0u);
}

TEST(IoGmsh, SlowReadsHalfAMillionTetsInSeconds) {
    const test::TemporaryFolder folder;
    const VolumeMesh mesh = make_tet_box({Vec3(0, 0, 0), Vec3(1.1, 1.2, 1.3), {44, 44, 44}});
    ASSERT_EQ(mesh.tets.size(), 511104u);
    write_mesh(folder / "big.msh", mesh);
    const auto begin = std::chrono::steady_clock::now();
    const VolumeMesh back = read_mesh(folder / "big.msh");
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    EXPECT_EQ(back.tets, mesh.tets);
    EXPECT_LT(seconds, 5.0);
    std::cout << "511104 tets read in " << seconds << " s" << std::endl;
}

}  // namespace
}  // namespace supple::io
