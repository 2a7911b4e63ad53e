#pragma once
#include <string>
#include <string_view>

#include "supple/mesh/volume_mesh.h"

namespace supple::io {

/// Reads a Medit .mesh file, ASCII, from memory (format: P. Frey, "Medit: an interactive mesh visualization software", INRIA RT-0253,
/// 2001). References other than 0 become regions ("region_4") of tetrahedra and hexahedra, and vertex groups ("surface_4", "curve_4",
/// "point_4") of triangles and quadrilaterals, edges and vertices. Sections that say nothing about the volume are skipped.
/// @error as parse_gmsh(): Error(parse) at "name:line", Error(surface_mesh), Error(unsupported) for other volume elements
VolumeMesh parse_medit(std::string_view text, const std::string& name);

}  // namespace supple::io
