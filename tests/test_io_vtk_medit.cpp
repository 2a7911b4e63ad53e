#include "supple/io/mesh_file.h"
#include "test_io_helpers.h"

namespace supple::io {
namespace {

using test::caught;
using test::expect_error;

using Ids = std::vector<std::int32_t>;

const char* const kMedit =
    "MeshVersionFormatted 2\nDimension\n3\n# a comment\nVertices\n5\n0 0 0 0\n1 0 0 7\n0 1 0 0 0 0 1 0\n1 1 1 7\n\nCorners 2\n1 2\nNormals "
    "1 .5 1e-3 0\n"
    "Triangles 1\n1 2 4 3\nTetrahedra\n2\n1 2 3 4 6\n2 3 4 5 0\nPrisms 0\nEnd\n";

const char* const kVtk =
    "# vtk DataFile Version 3.0\na title\nASCII\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\nTIME 1 1 double\n0.5\nPOINTS 9 float\n"
    "0 0 0 1 0 0 0 1 0\n1 1 0 0 0 1 1 0 1\n0 1 1 1 1 1\n2 2 2\nCELLS 3 18\n4 0 1 2 4\n3 0 1 2\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 3\n10\n5\n11\n"
    "CELL_DATA 3\nSCALARS a int 1\nLOOKUP_TABLE default\n1\n2\n3\n";

const char* const kVtk5 =
    "# vtk DataFile Version 5.1\na title\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0\n0 0 1 1 1 "
    "1\nMETADATA\nINFORMATION 0\n\n"
    "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3\n1 2 3 4\nCELL_TYPES 2\n10\n10\n";

const char* const kVtu =
    "<?xml version='1.0'?>\n<!-- a <comment> -->\n<VTKFile type=\"UnstructuredGrid\" byte_order=\"BigEndian\">\n<UnstructuredGrid>\n"
    "<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n<PointData><DataArray type=\"Float32\" Name=\"a\" format=\"ascii\">1 2 3 4 "
    "5</DataArray></PointData>\n"
    "<Points>\n<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\n0 0 0 1 0 0 0 1 0\n0 0 1 1 1 "
    "1\n</DataArray>\n</Points>\n<Cells>\n"
    "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n0 1 2 3\n1 2 3 4\n</DataArray>\n"
    "<DataArray type='Int32' Name = 'offsets' format='ascii'>4 8</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10 "
    "10</DataArray>\n"
    "</Cells>\n</Piece>\n"
    "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray format=\"ascii\">0 0 0 2 0 0 0 2 0 0 0 "
    "2</DataArray></Points><Cells>"
    "<DataArray Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray><DataArray Name=\"offsets\" format=\"ascii\">4</DataArray>"
    "<DataArray Name=\"types\" format=\"ascii\">10</DataArray></Cells></Piece>\n"
    "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"/>\n</UnstructuredGrid>\n</VTKFile>\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

VolumeMesh parse(const std::string& text) { return parse_mesh(text, "m"); }

void refuse(const char* text, const std::string& from, const std::string& to, const std::string& where,
            const std::vector<std::string>& words, ErrorCode code = ErrorCode::parse) {
    SCOPED_TRACE(to);
    expect_error(code, where, words, [&] { parse(replaced(text, from, to)); });
}

TEST(IoMedit, ReadsTetsReferencesAndSkipsTheRest) {
    const VolumeMesh mesh = parse(kMedit);
    ASSERT_EQ(mesh.vertices.size(), 5u);
    EXPECT_EQ(mesh.vertices[3], Vec3(0, 0, 1));
    EXPECT_EQ(mesh.tets, (std::vector<Tet>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
    ASSERT_EQ(mesh.regions.size(), 1u);
    EXPECT_EQ(mesh.regions[0].name, "region_6");
    EXPECT_EQ(mesh.element_region, (Ids{0, -1}));
    ASSERT_EQ(mesh.groups.size(), 2u);
    EXPECT_EQ(mesh.groups[0].name, "point_7");
    EXPECT_EQ(mesh.groups[0].vertices, (Ids{1, 4}));
    EXPECT_EQ(mesh.groups[1].name, "surface_3");
    EXPECT_EQ(mesh.groups[1].vertices, (Ids{0, 1, 3}));
    const VolumeMesh hexes = parse(
        "MeshVersionFormatted 1 Dimension 3 Vertices 8 0 0 0 0 1 0 0 0 1 1 0 0 0 1 0 0 0 0 1 0 1 0 1 0 1 1 1 0 0 1 1 0 Hexahedra 1 1 2 3 4 "
        "5 6 7 8 0 End");
    EXPECT_EQ(hexes.hexes, (std::vector<Hex>{{0, 1, 2, 3, 4, 5, 6, 7}}));
}

TEST(IoMedit, ErrorsNameTheLine) {
    refuse(kMedit, "1 0 0 7", "1 0 zero 7", "m:8", {"z coordinate", "zero"});
    refuse(kMedit, "2 3 4 5 0", "2 3 4 6 0", "m:20", {"node 6"});
    refuse(kMedit, "2 3 4 5 0", "2 3 4 0 0", "m:20", {"node 0"});
    refuse(kMedit, "Vertices\n5", "Vertices\n1152921504606846976", "m:12", {"x coordinate", "Corners"});
    refuse(kMedit, "Vertices\n5", "Vertices\n4", "m:10", {"section", "\"1\""});
    refuse(kMedit, "Prisms 0", "Prisms 1\n1 2 3 4 5 6 0", "m:21", {"Prisms"}, ErrorCode::unsupported);
    refuse(kMedit, "3\n# a comment", "2\n# a comment", "m:2", {"dimension 2"}, ErrorCode::surface_mesh);
    refuse(kMedit, "Tetrahedra\n2\n1 2 3 4 6\n2 3 4 5 0\n", "", "m", {"1 triangle"}, ErrorCode::surface_mesh);
    refuse(kMedit, "Vertices\n5\n0 0 0 0\n1 0 0 7\n0 1 0 0 0 0 1 0\n1 1 1 7\n", "", "m:9", {"before the vertices"});
}

TEST(IoVtk, ReadsLegacyUnstructuredGrids) {
    const VolumeMesh mesh = parse(kVtk);
    EXPECT_EQ(mesh.vertices.size(), 9u);
    EXPECT_EQ(mesh.tets, (std::vector<Tet>{{0, 1, 2, 4}}));
    EXPECT_EQ(mesh.hexes, (std::vector<Hex>{{0, 1, 3, 2, 4, 5, 7, 6}}));  // a voxel goes by rows
    const VolumeMesh version5 = parse(kVtk5);
    EXPECT_EQ(version5.tets, (std::vector<Tet>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
    EXPECT_EQ(version5.vertices[4], Vec3(1, 1, 1));
}

TEST(IoVtk, LegacyErrorsNameTheLine) {
    refuse(kVtk, "ASCII", "UTF8", "m:3", {"ASCII or BINARY", "UTF8"});
    refuse(kVtk, "UNSTRUCTURED_GRID", "STRUCTURED_POINTS", "m:4", {"STRUCTURED_POINTS"}, ErrorCode::unsupported);
    refuse(kVtk, "2 2 2\n", "2 2 b\n", "m:12", {"coordinate", "\"b\""});
    refuse(kVtk, "POINTS 9", "POINTS 1152921504606846976", "m:9", {"announces", "points"});
    refuse(kVtk, "POINTS 9", "POINTS 10", "m:13", {"coordinate", "CELLS"});
    refuse(kVtk, "4 0 1 2 4", "4 0 1 2 9", "m:14", {"point 9"});
    refuse(kVtk, "4 0 1 2 4", "1152921504606846976 0 1 2 4", "m:14", {"1152921504606846976 points", "does not fit"});
    refuse(kVtk, "CELLS 3 18", "CELLS 3 19", "m:17", {"point number", "CELL_TYPES"});
    refuse(kVtk, "CELLS 3 18", "CELLS 2 18", "m:16", {"longer than its cells"});
    refuse(kVtk, "CELL_TYPES 3\n10", "CELL_TYPES 3\n13", "m:14", {"wedge"}, ErrorCode::unsupported);
    refuse(kVtk, "CELL_TYPES 3\n10", "CELL_TYPES 3\n12", "m:14", {"4 vertices", "needs 8"});
    refuse(kVtk, "CELL_TYPES 3", "CELL_TYPES 4", "m:17", {"4", "[3, 3]"});
    refuse(kVtk, "CELL_TYPES 3\n10\n5\n11\n", "", "m:23", {"CELL_TYPES", "truncated"});
    refuse(kVtk5, "0 4 8\n", "0 9 8\n", "m:13", {"offset", "9"});
    refuse(kVtk5, "0 4 8\n", "0 4 3\n", "m:13", {"offset", "3"});
    refuse(kVtk5, "CONNECTIVITY", "CONNECT", "m:14", {"CONNECTIVITY"});
}

TEST(IoVtk, ReadsXmlUnstructuredGridsOfSeveralPieces) {
    const VolumeMesh mesh = parse(kVtu);
    EXPECT_EQ(mesh.vertices.size(), 9u);
    EXPECT_EQ(mesh.vertices[4], Vec3(1, 1, 1));
    EXPECT_EQ(mesh.vertices[6], Vec3(2, 0, 0));
    EXPECT_EQ(mesh.tets, (std::vector<Tet>{{0, 1, 2, 3}, {1, 2, 3, 4}, {5, 6, 7, 8}}));
}

TEST(IoVtk, XmlErrorsNameTheLine) {
    refuse(kVtu, "NumberOfComponents=\"3\" format=\"ascii\"", "NumberOfComponents=\"3\" format=\"binary\"", "m:8", {"announces"});
    refuse(kVtu, "NumberOfComponents=\"3\" format=\"ascii\"", "NumberOfComponents=\"3\" format=\"appended\"", "m:8", {"AppendedData"});
    refuse(kVtu, "NumberOfComponents=\"3\" format=\"ascii\"", "NumberOfComponents=\"3\" format=\"csv\"", "m:8", {"csv"}, ErrorCode::unsupported);
    refuse(kVtu, "byte_order", "compressor=\"vtkLZ4DataCompressor\" byte_order", "m:3", {"vtkLZ4DataCompressor"}, ErrorCode::unsupported);
    refuse(kVtu, "\"UnstructuredGrid\"", "\"ImageData\"", "m:3", {"ImageData"}, ErrorCode::unsupported);
    refuse(kVtu, "1 2 3 4\n</", "1 2 3 9\n</", "m:16", {"point 9", "5"});
    refuse(kVtu, "1 2 3 4\n</", "1 2 3 x\n</", "m:16", {"\"x\""});
    refuse(kVtu, "0 0 1 1 1 1\n", "0 0 1 1 1\n", "m:5", {"three each"});
    refuse(kVtu, "NumberOfPoints=\"5\"", "NumberOfPoints=\"1152921504606846976\"", "m:5", {"1152921504606846976 points", "5"});
    refuse(kVtu, "NumberOfCells=\"2\"", "NumberOfCells=\"3\"", "m:5", {"3 cells", "2"});
    refuse(kVtu, "NumberOfCells=\"2\"", "NumberOfCells=\"-2\"", "m:5", {"NumberOfCells", "-2"});
    refuse(kVtu, ">4 8<", ">4 9<", "m:18", {"offset 9", "[4, 8]"});
    refuse(kVtu, ">10 10<", ">10 14<", "m:16", {"pyramid"}, ErrorCode::unsupported);
    refuse(kVtu, "<Cells>", "<Cells", "m:13", {"tag is not closed"});
    refuse(kVtu, "</VTKFile>\n", "", "m:25", {"truncated"});
    refuse(kVtu, "</VTKFile>\n", "<!-- ", "m:25", {"comment"});
    std::string triangle = replaced(kVtk5, "CELLS 3 8", "CELLS 2 3");
    triangle = replaced(triangle, "0 4 8\n", "0 3\n");
    triangle = replaced(triangle, "0 1 2 3\n1 2 3 4\nCELL_TYPES 2\n10\n10", "0 1 2\nCELL_TYPES 1\n5");
    expect_error(ErrorCode::surface_mesh, "m", {"1 triangle"}, [&] { parse(triangle); });
}

TEST(IoVtkMedit, TruncatedFilesAreErrors) {
    for (const char* whole : {kVtk5, kVtu}) {
        const std::string text(whole);
        const std::size_t enough = whole == kVtu ? text.size() - 2 : text.size() - 3;  // the last figure may be cut: "1" of "10"
        for (std::size_t length = 0; length < enough; ++length) {
            SCOPED_TRACE(length);
            const Error error = caught([&] { parse(text.substr(0, length)); });
            EXPECT_TRUE(error.code() == ErrorCode::parse || error.code() == ErrorCode::unsupported) << error.what();
        }
    }
}

TEST(IoVtkMedit, OnlyErrorsEscapeFromMutatedFiles) {
    const std::size_t accepted = test::expect_only_errors({kMedit, kVtk, kVtk5, kVtu}, 6000, 77, parse);
    EXPECT_GT(accepted, 300u);
    EXPECT_LT(accepted, 20000u);
}

TEST(IoVtkMedit, RealMeshes) {
    const std::filesystem::path folder = test::shared_data("meshes");
    if (folder.empty()) return;
    struct Row {
        const char* file;
        std::size_t vertices, tets;
    };
    for (const Row& row :
         {Row{"libigl_hand.mesh", 7234, 29998}, Row{"libigl_octopus-low.mesh", 452, 1140}, Row{"sofa_raptorTetra_8418.vtu", 2996, 8418}}) {
        SCOPED_TRACE(row.file);
        if (!std::filesystem::exists(folder / row.file)) continue;
        const VolumeMesh mesh = read_mesh(folder / row.file);
        EXPECT_EQ(mesh.vertices.size(), row.vertices);
        EXPECT_EQ(mesh.tets.size(), row.tets);
        EXPECT_TRUE(mesh.regions.empty());
    }
}

}  // namespace
}  // namespace supple::io
