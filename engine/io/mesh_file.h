#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "supple/mesh/volume_mesh.h"

namespace supple::io {

/// Reads a volume mesh; the format is found from the content, then from the ending. Vertex order is that of the file. Read are Gmsh 1, 2.x and 4.1,
/// VTK legacy, VTU, Medit, TetGen, Vega and Abaqus/CalculiX (volume_formats.h says what of each). Every other common format is refused by its
/// name, with what to do. Not yet checked or repaired: BodyTemplate::build() does that.
/// @error Error(parse) "file:line: ...", Error(surface_mesh), Error(unsupported), Error(file_unreadable)
VolumeMesh read_mesh(const std::filesystem::path& file);

/// The same from memory. `name` stands for the file in messages, its ending decides where the content does not.
VolumeMesh parse_mesh(std::string_view bytes, const std::string& name);

/// Writes a volume mesh with its regions and groups; read_mesh() gives it back bit for bit, but for what the format cannot hold
/// (OutputFormat::loses in mesh_formats.h).
/// @param format  a name of mesh_formats.h, e.g. "gmsh41-binary"; empty: the first format of the file's ending (.msh: Gmsh 2.2 ASCII)
/// @error Error(unsupported) naming the writable formats, Error(invalid_argument) for a mesh that contradicts itself,
///        Error(file_unreadable) where the file cannot be written
void write_mesh(const std::filesystem::path& file, const VolumeMesh& mesh, std::string_view format = {});

}  // namespace supple::io
