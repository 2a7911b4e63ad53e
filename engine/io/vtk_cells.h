#pragma once
#include <cstdint>
#include <span>

#include "supple/io/mesh_builder.h"

namespace supple::io {

/// Adds one cell to the builder.
/// @param type  VTK's number for the cell type
/// @param ids   its vertices, as the builder knows them
/// @error Error(unsupported) for volume cells other than tetrahedron, hexahedron and voxel, Error(parse) for a wrong number of vertices
void add_vtk_cell(const TextScanner& scanner, const char* position, MeshBuilder& builder, std::int64_t type, std::span<std::int64_t> ids);

}  // namespace supple::io
