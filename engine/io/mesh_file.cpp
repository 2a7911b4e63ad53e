#include "supple/io/mesh_file.h"

#include "supple/base/error.h"
#include "supple/io/binary_file.h"
#include "supple/io/mesh_builder.h"
#include "supple/io/mesh_formats.h"
#include "supple/io/refusals.h"
#include "supple/io/surface_file.h"

namespace supple::io {

namespace {

/// Finds the format of a file and takes a byte order mark off.
const InputFormat& format_of(MeshSource& source) {
    if (source.bytes.empty()) throw Error(ErrorCode::parse, source.name + ":1", "the file is empty");
    if (source.bytes.substr(0, 3) == "\xEF\xBB\xBF") source.bytes.remove_prefix(3);
    const InputFormat* format = detect_format(source.bytes, source.name);
    if (!format) {
        std::string known;
        for (const InputFormat& row : input_formats())
            if (row.read || row.read_surface) known += (known.empty() ? "" : ", ") + std::string(row.endings);
        throw Error(ErrorCode::unsupported, source.name + ":1", "the format is not recognised; readable are Gmsh, VTK, Medit, TetGen, Vega, "
                    "Abaqus and the usual surface files (" + known + ")");
    }
    return *format;
}

[[noreturn]] void refuse_unread(const InputFormat& format, const std::string& name) {
    throw Error(ErrorCode::unsupported, name,
                "this is " + std::string(format.title) + ", which is not read; " + std::string(format.advice));
}

VolumeMesh volume_of(MeshSource source) {
    const InputFormat& format = format_of(source);
    if (format.is_surface) throw surface_error(source.name, std::string(format.title));
    if (!format.read) refuse_unread(format, source.name);
    MeshBuilder builder;
    format.read(source, builder);
    return builder.finish(source.name);
}

mesh::TriangleMesh surface_of(MeshSource source) {
    const InputFormat& format = format_of(source);
    if (format.read_surface) return format.read_surface(source);
    if (!format.read) refuse_unread(format, source.name);
    MeshBuilder builder;
    format.read(source, builder);
    return builder.finish_surface(source.name);
}

std::filesystem::path folder_of(const std::filesystem::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

}  // namespace

Error surface_error(const std::string& where, const std::string& holds) {
    return Error(ErrorCode::surface_mesh, where,
                 "this is a surface mesh (" + holds +
                     ", no tetrahedra or hexahedra), but a volume mesh is needed; fill the closed surface with "
                     "tetrahedra first, e.g. with `supple mesh cook`, Gmsh, TetGen or fTetWild");
}

VolumeMesh parse_mesh(std::string_view bytes, const std::string& name) { return volume_of({bytes, name, {}}); }

VolumeMesh read_mesh(const std::filesystem::path& file) {
    const std::string bytes = read_text_file(file);
    return volume_of({bytes, file.string(), folder_of(file)});
}

void write_mesh(const std::filesystem::path& file, const VolumeMesh& mesh, std::string_view format) {
    const OutputFormat& chosen = choose_volume_format(file, format);
    if (!mesh.fill.empty() && chosen.key.substr(0, 4) != "gmsh")
        throw Error(ErrorCode::unsupported, file.string(),
                    "this mesh has elements that are filled in part, which only Gmsh files hold; write a .msh file, or clear VolumeMesh::fill to fill them");
    chosen.write(file, mesh);
}

mesh::TriangleMesh parse_surface(std::string_view bytes, const std::string& name) { return surface_of({bytes, name, {}}); }

mesh::TriangleMesh read_surface(const std::filesystem::path& file) {
    const std::string bytes = read_text_file(file);
    return surface_of({bytes, file.string(), folder_of(file)});
}

void write_surface(const std::filesystem::path& file, const mesh::TriangleMesh& mesh, std::string_view format) {
    choose_surface_format(file, format).write_surface(file, mesh);
}

}  // namespace supple::io
