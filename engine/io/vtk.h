#pragma once
#include <string>
#include <string_view>

#include "supple/mesh/volume_mesh.h"

namespace supple::io {

/// Reads tetrahedra, hexahedra and voxels of a VTK unstructured grid from memory (formats: "VTK File Formats", the VTK User's Guide, and
/// the description of version 5.1 in VTK's documentation). Cells of lower dimension and all data arrays are skipped; there are no regions
/// and groups.
/// @error Error(parse) at "name:line"; Error(surface_mesh) for PolyData and where nothing fills a volume; Error(unsupported) for binary or
///        compressed data, other kinds of data sets and other volume cells
VolumeMesh parse_vtk_legacy(std::string_view text, const std::string& name);
VolumeMesh parse_vtk_xml(std::string_view text, const std::string& name);

}  // namespace supple::io
