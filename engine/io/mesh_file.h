#pragma once
#include <filesystem>

#include "supple/mesh/volume_mesh.h"

namespace supple::io {

/// Reads a volume mesh; the format is found from the content, not only the ending. Vertex order is that of the file.
/// Not yet checked or repaired: BodyTemplate::build() does that.
/// @error Error(parse) "file:line: ...", Error(surface_mesh), Error(unsupported), Error(file_unreadable)
VolumeMesh read_mesh(const std::filesystem::path& file);

/// Writes Gmsh 2.2 ASCII, coordinates with 17 digits, regions as physical groups.
void write_gmsh(const std::filesystem::path& file, const VolumeMesh& mesh);

}  // namespace supple::io
