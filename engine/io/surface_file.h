#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "supple/mesh/triangle_mesh.h"

namespace supple::io {

/// Reads a surface; the format is found from the content, then from the ending. mesh_formats.h lists the formats: OBJ, STL, PLY, OFF,
/// glTF (where built with assimp), and what Gmsh, Medit, VTK, VTU, VTP and Abaqus files hold of triangles and quadrangles. Polygons are cut
/// into triangles. Vertices keep their order, also those that no triangle uses; the formats that repeat a vertex per triangle or per normal
/// (STL, glTF) are welded where positions are equal. All indices of the result are in range; nothing else is checked (mesh/surface_check.h
/// does).
/// @error Error(parse) "file:line: ..." (binary parts: "file:byte N"), Error(unsupported), Error(file_unreadable)
mesh::TriangleMesh read_surface(const std::filesystem::path& file);

/// The same from memory. `name` stands for the file in messages, its ending decides where the content does not.
mesh::TriangleMesh parse_surface(std::string_view bytes, const std::string& name);

/// Writes a surface.
/// @param format  a name of mesh_formats.h, e.g. "stl-ascii"; empty: the first format of the file's ending
/// @error Error(unsupported) naming the writable formats, Error(invalid_argument) for an index out of range, Error(file_unreadable)
void write_surface(const std::filesystem::path& file, const mesh::TriangleMesh& mesh, std::string_view format = {});

}  // namespace supple::io
