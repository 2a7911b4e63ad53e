#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "supple/mesh/volume_mesh.h"

namespace supple::io {

/// Reads a volume mesh; the format is found from the content, not only the ending. Vertex order is that of the file.
/// Read, as ASCII: Gmsh 1, 2.x and 4.1 (gmsh.h), Medit .mesh (medit.h), VTK legacy and VTU unstructured grids (vtk.h). Every other common
/// format is refused by its name, with what to do. Not yet checked or repaired: BodyTemplate::build() does that.
/// @error Error(parse) "file:line: ...", Error(surface_mesh), Error(unsupported), Error(file_unreadable)
VolumeMesh read_mesh(const std::filesystem::path& file);

/// The same from memory. `name` stands for the file in messages, its ending decides where the content does not.
VolumeMesh parse_mesh(std::string_view bytes, const std::string& name);

/// Writes Gmsh 2.2 ASCII, coordinates with 17 digits, regions as physical groups of dimension 3, vertex groups as point elements in
/// physical groups of dimension 0. read_mesh() gives the same mesh back, bit for bit.
/// @error Error(invalid_argument) for a mesh that contradicts itself, Error(file_unreadable) where the file cannot be written
void write_gmsh(const std::filesystem::path& file, const VolumeMesh& mesh);

}  // namespace supple::io
