// The table of mesh formats, and how one is found.
#include "supple/io/mesh_formats.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <string>

#include "supple/base/error.h"
#include "supple/io/binary_file.h"
#include "supple/io/surface_formats.h"
#include "supple/io/text_scanner.h"
#include "supple/io/volume_formats.h"

namespace supple::io {

namespace {

constexpr std::string_view kConvert = "convert it to Gmsh 4.1 or VTU first, e.g. with meshio (meshio convert IN OUT.vtu)";

template <mesh::TriangleMesh (*parse)(std::string_view, const std::string&)>
mesh::TriangleMesh surface(const MeshSource& source) {
    return parse(source.bytes, source.name);
}

mesh::TriangleMesh gltf(const MeshSource& source) { return parse_gltf(source); }

constexpr InputFormat kInputs[] = {
    // Volumes, and whatever surfaces the same files hold.
    {"gmsh", "a Gmsh file", ".msh", false, read_gmsh, nullptr, {}},
    {"vtk", "a VTK legacy file", ".vtk", false, read_vtk_legacy, nullptr, {}},
    {"vtu", "a VTK XML file", ".vtu .vtp", false, read_vtk_xml, nullptr, {}},
    {"medit", "a Medit file", ".mesh", false, read_medit, nullptr, {}},
    {"tetgen", "a TetGen file", ".node .ele", false, read_tetgen, nullptr, {}},
    {"vega", "a Vega file", ".veg", false, read_vega, nullptr, {}},
    {"abaqus", "an Abaqus file", ".inp", false, read_abaqus, nullptr, {}},
    // Surfaces.
    {"obj", "a Wavefront OBJ file", ".obj", true, nullptr, surface<parse_obj>, {}},
    {"stl", "an STL file", ".stl", true, nullptr, surface<parse_stl>, {}},
    {"ply", "a PLY file", ".ply", true, nullptr, surface<parse_ply>, {}},
    {"off", "an OFF file", ".off", true, nullptr, surface<parse_off>, {}},
    {"gltf", "a glTF file", ".gltf .glb", true, nullptr, gltf, {}},
    // Known, not read.
    {"fbx", "an FBX file", ".fbx", true, nullptr, nullptr, "save it as OBJ or glTF"},
    {"collada", "a Collada file", ".dae", true, nullptr, nullptr, "save it as OBJ or glTF"},
    {"3ds", "a 3DS file", ".3ds", true, nullptr, nullptr, "save it as OBJ or glTF"},
    {"3mf", "a 3MF file", ".3mf", true, nullptr, nullptr, "save it as STL or OBJ"},
    {"usd", "a USD file", ".usd .usda .usdc .usdz", true, nullptr, nullptr, "save it as OBJ or glTF"},
    {"poly", "a TetGen surface file", ".poly .smesh", true, nullptr, nullptr, "save it as OFF or PLY"},
    {"compressed", "a compressed file", ".gz .zip", false, nullptr, nullptr, "unpack it first"},
    {"hdf5", "an HDF5 file", ".h5 .med .cgns", false, nullptr, nullptr, kConvert},
    {"fluent", "a Fluent file", ".cas", false, nullptr, nullptr, kConvert},
    {"tetgen-part", "a TetGen file that lists faces or neighbours only", ".face .neigh .edge", false, nullptr, nullptr,
     "give the .ele or .node file"},
    {"nastran", "a Nastran file", ".bdf .nas .fem", false, nullptr, nullptr, kConvert},
    {"exodus", "an Exodus file", ".exo .e", false, nullptr, nullptr, kConvert},
    {"meditb", "a binary Medit file", ".meshb", false, nullptr, nullptr, kConvert},
    {"xdmf", "an XDMF file", ".xdmf", false, nullptr, nullptr, kConvert},
    {"ansys", "an Ansys file", ".cdb", false, nullptr, nullptr, kConvert},
    {"ideas", "an I-deas universal file", ".unv", false, nullptr, nullptr, kConvert},
    {"febio", "a FEBio file", ".feb", false, nullptr, nullptr, kConvert},
    {"netgen", "a Netgen file", ".vol", false, nullptr, nullptr, kConvert},
};

template <std::string (*format)(const VolumeMesh&)>
void volume_file(const std::filesystem::path& file, const VolumeMesh& mesh) {
    write_text_file(file, format(mesh));
}
template <std::string (*format)(const mesh::TriangleMesh&)>
void surface_file(const std::filesystem::path& file, const mesh::TriangleMesh& mesh) {
    write_text_file(file, format(mesh));
}
template <VtuEncoding encoding>
std::string vtu(const VolumeMesh& mesh) {
    return format_vtu(mesh, encoding);
}

constexpr OutputFormat kOutputs[] = {
    {"gmsh22", ".msh", "Gmsh 2.2, ASCII", {}, volume_file<format_gmsh22>, nullptr},
    {"gmsh22-binary", ".msh", "Gmsh 2.2, binary", {}, volume_file<format_gmsh22_binary>, nullptr},
    {"gmsh41", ".msh", "Gmsh 4.1, ASCII", {}, volume_file<format_gmsh41>, nullptr},
    {"gmsh41-binary", ".msh", "Gmsh 4.1, binary", {}, volume_file<format_gmsh41_binary>, nullptr},
    {"vtk", ".vtk", "VTK legacy, ASCII", {}, volume_file<format_vtk>, nullptr},
    {"vtk-binary", ".vtk", "VTK legacy, binary", {}, volume_file<format_vtk_binary>, nullptr},
    {"vtu", ".vtu", "VTU, appended raw, zlib", {}, volume_file<vtu<VtuEncoding::appended_zlib>>, nullptr},
    {"vtu-ascii", ".vtu", "VTU, ASCII", {}, volume_file<vtu<VtuEncoding::ascii>>, nullptr},
    {"vtu-base64", ".vtu", "VTU, inline base64", {}, volume_file<vtu<VtuEncoding::inline_base64>>, nullptr},
    {"vtu-base64-zlib", ".vtu", "VTU, inline base64, zlib", {}, volume_file<vtu<VtuEncoding::inline_zlib>>, nullptr},
    {"vtu-appended", ".vtu", "VTU, appended raw", {}, volume_file<vtu<VtuEncoding::appended_raw>>, nullptr},
    {"vtu-appended-base64", ".vtu", "VTU, appended base64", {}, volume_file<vtu<VtuEncoding::appended_base64>>, nullptr},
    {"medit", ".mesh", "Medit", "names of regions (their tags stay) and vertex groups", volume_file<format_medit>, nullptr},
    {"tetgen", ".node .ele", "TetGen, two files", "names of regions (their tags stay) and vertex groups", write_tetgen, nullptr},
    {"obj", ".obj", "Wavefront OBJ", {}, nullptr, surface_file<format_obj>},
    {"stl", ".stl", "STL, binary (float32)", {}, nullptr, surface_file<format_stl_binary>},
    {"stl-ascii", ".stl", "STL, ASCII", {}, nullptr, surface_file<format_stl_ascii>},
    {"ply", ".ply", "PLY, binary", {}, nullptr, surface_file<format_ply_binary>},
    {"ply-ascii", ".ply", "PLY, ASCII", {}, nullptr, surface_file<format_ply_ascii>},
    {"off", ".off", "OFF", {}, nullptr, surface_file<format_off>},
};

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return result;
}

bool starts_with(std::string_view text, std::string_view head) { return text.substr(0, head.size()) == head; }

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> list) {
    return std::find(list.begin(), list.end(), word) != list.end();
}

/// Whether `ending` is one of the words of `endings`.
bool has_ending(std::string_view endings, std::string_view ending) {
    if (ending.empty()) return false;
    std::size_t at = 0;
    while ((at = endings.find(ending, at)) != std::string_view::npos) {
        const std::size_t behind = at + ending.size();
        if (behind == endings.size() || endings[behind] == ' ') return true;
        at = behind;
    }
    return false;
}

const InputFormat* by_key(std::string_view key) {
    return std::find_if(std::begin(kInputs), std::end(kInputs), [&](const InputFormat& f) { return f.key == key; });
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

std::string_view key_of_content(std::string_view bytes) {
    if (starts_with(bytes, "\x1f\x8b") || starts_with(bytes, "PK\x03\x04")) return "compressed";
    if (starts_with(bytes, "glTF")) return "gltf";
    if (starts_with(bytes, "\x89HDF")) return "hdf5";
    if (is_binary_stl(bytes)) return "stl";
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) return {};
    const std::string_view head = bytes.substr(first, 4096);
    if (starts_with(head, "# vtk DataFile")) return "vtk";
    if (starts_with(head, "<VTKFile") || (starts_with(head, "<?xml") && head.find("<VTKFile") != std::string_view::npos)) return "vtu";
    if (head.front() == '{' && head.find("\"asset\"") != std::string_view::npos) return "gltf";
    const std::string_view word = first_word(bytes);
    if (word.empty()) return {};
    if (word.front() == '$') return "gmsh";
    if (starts_with(word, "MeshVersionFormatted")) return "medit";
    if (is_one_of(word, {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "4OFF", "nOFF"})) return "off";
    if (word == "ply") return "ply";
    if (is_one_of(word, {"v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl"})) return "obj";
    const std::string keyword = lower(word.substr(0, word.find(',')));
    if (keyword == "solid") return "stl";
    if (is_one_of(keyword, {"*vertices", "*elements", "*material", "*set", "*region"})) return "vega";
    if (is_one_of(keyword, {"*heading", "*node", "*part", "*preprint", "*element"})) return "abaqus";
    if (word.front() == '(') return "fluent";
    return {};
}

template <class Has>
const OutputFormat& choose(const std::filesystem::path& file, std::string_view key, const char* what, Has&& has) {
    const std::string ending = lower(file.extension().string());
    std::string known;
    for (const OutputFormat& format : kOutputs) {
        if (!has(format)) continue;
        if (key.empty() ? has_ending(format.endings, ending) : format.key == key) return format;
        known += (known.empty() ? "" : ", ") + std::string(format.key) + " (" + std::string(format.endings) + ")";
    }
    const std::string given = key.empty() ? "the ending \"" + ending + "\"" : "the format \"" + std::string(key) + "\"";
    throw Error(ErrorCode::unsupported, file.string(), given + " is none that " + what + " can be written in; choose one of " + known);
}

}  // namespace

std::span<const InputFormat> input_formats() { return kInputs; }
std::span<const OutputFormat> output_formats() { return kOutputs; }

const InputFormat* detect_format(std::string_view bytes, const std::filesystem::path& file) {
    const std::string_view key = key_of_content(bytes);
    if (!key.empty()) return by_key(key);
    // Files of these formats can be told by their content, and this is none.
    constexpr std::string_view kTold = "gmsh vtk vtu medit ply";
    const std::string ending = lower(file.extension().string());
    const InputFormat* found = std::find_if(std::begin(kInputs), std::end(kInputs), [&](const InputFormat& f) {
        return has_ending(f.endings, ending) && !has_ending(kTold, f.key);
    });
    return found == std::end(kInputs) ? nullptr : found;
}

const OutputFormat& choose_volume_format(const std::filesystem::path& file, std::string_view key) {
    return choose(file, key, "a volume mesh", [](const OutputFormat& f) { return f.write != nullptr; });
}

const OutputFormat& choose_surface_format(const std::filesystem::path& file, std::string_view key) {
    return choose(file, key, "a surface", [](const OutputFormat& f) { return f.write_surface != nullptr; });
}

}  // namespace supple::io
