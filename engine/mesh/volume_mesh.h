#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "supple/math/types.h"

namespace supple {

using Tet = std::array<std::int32_t, 4>;
using Hex = std::array<std::int32_t, 8>;
using Triangle = std::array<std::int32_t, 3>;

/// A named set of elements: a Gmsh physical group, a VTK cell label.
struct Region {
    std::string name;  ///< never empty: the group's name, or "region_<tag>"
    int tag = 0;       ///< the file's number
};

/// A named set of vertices: those of a physical group of any dimension (its volume, surface, curve or point elements).
struct VertexGroup {
    std::string name;
    std::vector<std::int32_t> vertices;  ///< ascending, no duplicates
};

/// A volume mesh of linear tetrahedra and hexahedra, in the user's order, which every public array keeps.
/// Tets: det(x1-x0, x2-x0, x3-x0) > 0. Hexes: VTK order. Elements are numbered tets first, then hexes.
struct VolumeMesh {
    std::vector<Vec3> vertices;  ///< rest positions [m]
    std::vector<Tet> tets;
    std::vector<Hex> hexes;
    std::vector<Region> regions;               ///< may be empty
    std::vector<std::int32_t> element_region;  ///< per element: index into regions, -1 for none; empty if there are no regions
    std::vector<double> fill;  ///< per element: the part of it that holds matter, (0, 1], multiplies stiffness and density; empty: all full
    std::vector<VertexGroup> groups;
    std::string source;  ///< file name or description, for messages

    std::size_t element_count() const { return tets.size() + hexes.size(); }
};

/// What check_and_repair() found. "Repaired" faults are mended in the mesh, "reported" ones are left as they are.
struct MeshReport {
    std::size_t flipped = 0;                ///< repaired: elements of negative volume, rewound
    std::size_t degenerate = 0;             ///< repaired: elements of (nearly) zero volume or with a repeated vertex, removed
    std::size_t duplicate_elements = 0;     ///< repaired: elements with the vertices of an earlier one, removed
    std::size_t unreferenced_vertices = 0;  ///< reported: vertices of no element; they keep their place and never move
    std::size_t duplicate_vertices = 0;     ///< reported: vertices at the very position of an earlier one (not welded: it may be a cut)
    std::size_t folded_hexes = 0;           ///< reported: hexes of positive volume with a corner whose Jacobian is not positive
    std::size_t overloaded_faces = 0;       ///< reported: faces shared by more than two elements, which then overlap
    std::size_t components = 0;             ///< face-connected parts
    double volume_m3 = 0;
    Vec3 min_m = Vec3::Zero(), max_m = Vec3::Zero();  ///< bounding box of the vertices that elements use

    /// Plain sentences, one per finding; empty where the mesh is clean.
    std::vector<std::string> sentences() const;
};

/// Rewinds, removes and counts as MeshReport says. Zero volume means |V| <= 1e-12 x (longest edge)^3.
/// Regions and groups keep their order and names; element_region and fill follow the elements that stay. Tets swap their last two
/// vertices to be rewound, hexes their bottom and top faces. O(n log n).
/// @error Error(surface_mesh) if there is no volume element or none is left; Error(invalid_argument) if an index is out of
///        range, or a coordinate is not finite or beyond 1e100 m. The mesh is unchanged when an index or coordinate is refused.
MeshReport check_and_repair(VolumeMesh& mesh);

/// Whether check_and_repair() would keep, as they are, the elements that an edit has made: those with old_element -1. [element]. Others are taken for granted.
bool keeps_new_elements(const VolumeMesh& mesh, std::span<const std::int32_t> old_element);

/// Vertices of an element, tets numbered before hexes: four or eight.
std::span<const std::int32_t> element_vertices(const VolumeMesh& mesh, std::size_t element);

/// Signed volume of one tetrahedron [m^3].
double tet_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Signed volume of one trilinear hexahedron, exact for warped faces [m^3].
double hex_volume(const std::array<Vec3, 8>& x);

}  // namespace supple
