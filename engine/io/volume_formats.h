#pragma once
// The volume formats, one or a few .cpp each; mesh_formats.cpp lists them for everybody else. Readers fill a builder with what the file
// holds; their errors: Error(parse) at "name:line" (in bytes "name:byte N"), Error(unsupported) for elements and variants that are not
// read.
#include <string>
#include <vector>

#include "supple/io/mesh_source.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::io {

class MeshBuilder;

/// Gmsh 1 ($NOD/$ELM, ASCII), 2.x and 4.1, ASCII and binary of both byte orders (Gmsh reference manual, "Gmsh file formats"). Tetrahedra
/// and hexahedra are taken; their physical group becomes their region, in Gmsh 1 and 2 that is the first tag. Physical groups of points,
/// curves and surfaces become vertex groups. A volume in several physical groups (4.1) has the first as its region; each further one
/// becomes a vertex group. Names come from $PhysicalNames, otherwise "region_7", "surface_7", "curve_7", "point_7". Unknown sections are
/// skipped. Refused: version 4.0, partitioned meshes, prisms, pyramids and elements of higher order.
void read_gmsh(const MeshSource& source, MeshBuilder& builder);
/// Regions are written as physical groups of dimension 3, vertex groups as point elements in physical groups of dimension 0; 17 digits.
std::string format_gmsh22(const VolumeMesh& mesh);
std::string format_gmsh22_binary(const VolumeMesh& mesh);
std::string format_gmsh41(const VolumeMesh& mesh);
std::string format_gmsh41_binary(const VolumeMesh& mesh);

/// VTK legacy files, versions 1 to 5.1, ASCII and binary: unstructured grids and PolyData ("VTK File Formats" in the VTK User's Guide and,
/// for 5.1, in VTK's documentation). Regions: the first cell array of whole numbers that is called region, gmsh:physical, medit:ref,
/// CellEntityIds, MaterialIds, material, PartId or cell_tags; a field array "region:NAME" of one number names a tag. Point arrays
/// "group:NAME" mark vertex groups. Writers use exactly these.
void read_vtk_legacy(const MeshSource& source, MeshBuilder& builder);
std::string format_vtk(const VolumeMesh& mesh);         ///< version 3.0, float64
std::string format_vtk_binary(const VolumeMesh& mesh);  ///< big-endian

/// VTK XML unstructured grids and PolyData: ASCII, inline base64, appended raw and base64, with and without zlib, both byte orders and
/// sizes of the header; regions and groups as in the legacy files.
void read_vtk_xml(const MeshSource& source, MeshBuilder& builder);
enum class VtuEncoding { ascii, inline_base64, inline_zlib, appended_raw, appended_base64, appended_zlib };
std::string format_vtu(const VolumeMesh& mesh, VtuEncoding encoding);

/// Medit .mesh, ASCII (P. Frey, "Medit: an interactive mesh visualization software", INRIA RT-0253, 2001). References other than 0 become
/// regions ("region_4") of tetrahedra and hexahedra, and vertex groups ("surface_4", "curve_4", "point_4") of triangles and quadrilaterals,
/// edges and vertices. Sections that say nothing about the volume are skipped.
void read_medit(const MeshSource& source, MeshBuilder& builder);
std::string format_medit(const VolumeMesh& mesh);

/// TetGen's .node and .ele (H. Si, "TetGen", manual of version 1.5, section 5): either may be named, the other lies beside it. The first
/// attribute of a tetrahedron is its region; boundary markers of nodes other than 0 are vertex groups "point_3".
void read_tetgen(const MeshSource& source, MeshBuilder& builder);
/// The same from both texts; `source` is the .ele file.
void read_tetgen(const MeshSource& source, std::string_view nodes, const std::string& nodes_name, MeshBuilder& builder);
/// Writes both files, whichever of the two is named. @error Error(unsupported) for hexahedra
void write_tetgen(const std::filesystem::path& file, const VolumeMesh& mesh);

/// Vega FEM's .veg (J. Barbic, "Vega FEM library", user's manual 4.0): *VERTICES, *ELEMENTS of TET and CUBIC, *SET, *REGION, *INCLUDE.
/// Elements have the set that the first *REGION over them names as their region; without regions, sets are the regions.
void read_vega(const MeshSource& source, MeshBuilder& builder);

/// Abaqus and CalculiX .inp ("Abaqus Keywords Reference"; "CalculiX CrunchiX user's manual", chapter 7): *NODE, *ELEMENT of the families
/// C3D4 and C3D8, *NSET, *ELSET, GENERATE, *SOLID SECTION, *INCLUDE. The element sets of sections are the regions, without sections all
/// element sets; node sets and further element sets become vertex groups. One part; instances with their own position are refused.
void read_abaqus(const MeshSource& source, MeshBuilder& builder);

/// What every writer asks of a mesh.
/// @param writer  named in the message
/// @error Error(invalid_argument) naming the field: a name that is empty or has a line break, an index out of range, element_region of a
///        wrong length, a coordinate that is not finite
void require_writable_mesh(const VolumeMesh& mesh, const std::string& writer);
/// The tags that go into a file: those of the mesh where they are positive and unique, free numbers for the others.
std::vector<int> region_tags(const VolumeMesh& mesh);
/// Per element: tag of its region, 0 for none.
std::vector<int> element_tags(const VolumeMesh& mesh);

}  // namespace supple::io
