#pragma once
#include <string>
#include <string_view>

#include "supple/mesh/volume_mesh.h"

namespace supple::io {

/// Reads Gmsh 1 ($NOD/$ELM), 2.x and 4.1, ASCII, from memory (format: Gmsh reference manual, chapter "Gmsh file formats").
/// Tetrahedra and hexahedra are taken; their physical group becomes their region, in Gmsh 1 and 2 that is the first tag. Physical groups of
/// points, curves and surfaces become vertex groups. A volume in several physical groups (4.1) has the first as its region; each further
/// one becomes a vertex group. Names come from $PhysicalNames, otherwise "region_7", "surface_7", "curve_7", "point_7". Unknown sections
/// are skipped.
/// @param name  file name for messages and VolumeMesh::source
/// @error Error(parse) at "name:line"; Error(surface_mesh) where nothing fills a volume; Error(unsupported) for binary files, version 4.0,
///        partitioned meshes, prisms, pyramids and elements of higher order
VolumeMesh parse_gmsh(std::string_view text, const std::string& name);

/// The text that write_gmsh() writes.
/// @error Error(invalid_argument) naming the field: a name with a line break, an index out of range, element_region of a wrong length
std::string format_gmsh(const VolumeMesh& mesh);

}  // namespace supple::io
