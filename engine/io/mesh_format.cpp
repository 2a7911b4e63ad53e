#include "supple/io/mesh_format.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <initializer_list>

#include "supple/io/text_scanner.h"

namespace supple::io {

namespace {

using Kind = MeshFormat::Kind;

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return result;
}

bool starts_with(std::string_view text, std::string_view head) { return text.substr(0, head.size()) == head; }

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> list) {
    return std::find(list.begin(), list.end(), word) != list.end();
}

/// 80 bytes of anything, a little-endian triangle count, 50 bytes per triangle: the size is the only signature there is.
bool is_binary_stl(std::string_view bytes) {
    if (bytes.size() < 84) return false;
    std::uint64_t count = 0;
    for (int i = 3; i >= 0; --i) count = 256 * count + static_cast<unsigned char>(bytes[std::size_t(80 + i)]);
    return bytes.size() == 84 + 50 * count;
}

/// The first word of the first line that is neither empty nor a comment of the OBJ and OFF kind.
std::string_view first_word(std::string_view bytes) {
    TextScanner scanner(bytes, "");
    for (int line = 0; line < 1000 && !scanner.at_end(); ++line) {
        if (!scanner.line_ended()) {
            const std::string_view word = scanner.word();
            if (word.front() != '#') return word;
        }
        scanner.next_line();
    }
    return {};
}

const char* const kConvert =
    "convert it to Gmsh 2.2 or 4.1 ASCII first, e.g. with meshio (meshio convert IN OUT.msh --output-format gmsh22 --ascii)";

MeshFormat from_content(std::string_view bytes) {
    if (starts_with(bytes, "\x1f\x8b") || starts_with(bytes, "PK\x03\x04")) return {Kind::volume, "a compressed file", "unpack it first"};
    if (starts_with(bytes, "glTF")) return {Kind::surface, "a binary glTF file", ""};
    if (starts_with(bytes, "\x89HDF")) return {Kind::volume, "an HDF5 file", kConvert};
    if (is_binary_stl(bytes)) return {Kind::surface, "a binary STL file", ""};
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) return {};
    const std::string_view head = bytes.substr(first, 4096);
    if (starts_with(head, "# vtk DataFile")) return {Kind::vtk_legacy, "a VTK legacy file", ""};
    if (starts_with(head, "<VTKFile") || (starts_with(head, "<?xml") && head.find("<VTKFile") != std::string_view::npos)) {
        return {Kind::vtk_xml, "a VTK XML file", ""};
    }
    const std::string_view word = first_word(bytes);
    if (word.empty()) return {};
    if (word.front() == '$') return {Kind::gmsh, "a Gmsh file", ""};
    if (starts_with(word, "MeshVersionFormatted")) return {Kind::medit, "a Medit file", ""};
    if (is_one_of(word, {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "4OFF", "nOFF"})) return {Kind::surface, "an OFF file", ""};
    if (word == "ply") return {Kind::surface, "a PLY file", ""};
    if (word == "solid") return {Kind::surface, "an STL file", ""};
    if (is_one_of(word, {"v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl"})) return {Kind::surface, "a Wavefront OBJ file", ""};
    const std::string keyword = lower(word.substr(0, word.find(',')));
    if (is_one_of(keyword, {"*vertices", "*elements", "*material", "*set", "*region", "*include"}))
        return {Kind::volume, "a Vega file", kConvert};
    if (is_one_of(keyword, {"*heading", "*node", "*part", "*preprint", "*element"})) return {Kind::volume, "an Abaqus file", kConvert};
    if (word.front() == '(') return {Kind::volume, "a Fluent file", kConvert};
    return {};
}

MeshFormat from_ending(const std::filesystem::path& file) {
    const std::string ending = lower(file.extension().string());
    struct Row {
        const char* ending;
        Kind kind;
        const char* name;
    };
    static constexpr Row kRows[] = {
        {".obj", Kind::surface, "a Wavefront OBJ file"},
        {".stl", Kind::surface, "an STL file"},
        {".off", Kind::surface, "an OFF file"},
        {".ply", Kind::surface, "a PLY file"},
        {".gltf", Kind::surface, "a glTF file"},
        {".glb", Kind::surface, "a binary glTF file"},
        {".fbx", Kind::surface, "an FBX file"},
        {".dae", Kind::surface, "a Collada file"},
        {".3ds", Kind::surface, "a 3DS file"},
        {".3mf", Kind::surface, "a 3MF file"},
        {".vtp", Kind::surface, "a VTK PolyData file"},
        {".poly", Kind::surface, "a TetGen surface file"},
        {".smesh", Kind::surface, "a TetGen surface file"},
        {".node", Kind::volume, "a TetGen file"},
        {".ele", Kind::volume, "a TetGen file"},
        {".face", Kind::volume, "a TetGen file"},
        {".neigh", Kind::volume, "a TetGen file"},
        {".veg", Kind::volume, "a Vega file"},
        {".inp", Kind::volume, "an Abaqus file"},
        {".bdf", Kind::volume, "a Nastran file"},
        {".nas", Kind::volume, "a Nastran file"},
        {".fem", Kind::volume, "a Nastran file"},
        {".exo", Kind::volume, "an Exodus file"},
        {".meshb", Kind::volume, "a binary Medit file"},
        {".med", Kind::volume, "a MED file"},
        {".cgns", Kind::volume, "a CGNS file"},
        {".xdmf", Kind::volume, "an XDMF file"},
        {".cdb", Kind::volume, "an Ansys file"},
        {".unv", Kind::volume, "an I-deas universal file"},
        {".feb", Kind::volume, "a FEBio file"},
        {".vol", Kind::volume, "a Netgen file"},
        {".usd", Kind::surface, "a USD file"},
    };
    for (const Row& row : kRows) {
        if (ending == row.ending) return {row.kind, row.name, row.kind == Kind::volume ? kConvert : ""};
    }
    return {};
}

}  // namespace

MeshFormat detect_mesh_format(std::string_view bytes, const std::filesystem::path& file) {
    MeshFormat format = from_content(bytes);
    return format.kind == Kind::unknown ? from_ending(file) : format;
}

}  // namespace supple::io
