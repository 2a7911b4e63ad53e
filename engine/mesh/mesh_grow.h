#pragma once
#include "supple/mesh/mesh_edit.h"

namespace supple {

// Edits that close and grow a mesh (those that open it: mesh_edit.h).

struct HealDef {
    double gap_m = 1e-3;             ///< corners of two lips that are now so near are glued, > 0
    Vec3 centre_m = Vec3::Zero();    ///< only faces whose corners all lie in this ball now ...
    double radius_m = 0;             ///< ... of this radius; 0: everywhere
};

struct HealReport {
    std::size_t faces = 0;    ///< glued: no longer of the boundary
    std::size_t merged = 0;   ///< vertices that went into another one
    std::size_t left = 0;     ///< faces near enough that stay open, since the boundary would touch itself there
};

/// Glues the lips of cuts and tears: boundary faces that coincide at rest and are now within a gap of one another, corner by corner. Their vertices become one, a mean of what they were by
/// `weight`; the rest shape stays. Vertices of a merged one all map to it (TopologyDelta::vertex_to_new), elements keep their numbers. The boundary stays a closed manifold. O(n).
/// @param positions  [vertex] now [m]
/// @param weight     [vertex] > 0: masses; infinite ones (held vertices) decide alone
/// @return           the identity where nothing is glued
/// @error Error(invalid_argument) for positions or weights of another count or not finite, a gap or radius out of range
MeshEdit heal(const VolumeMesh& mesh, std::span<const Vec3> positions, std::span<const double> weight, const HealDef& def, HealReport* report = nullptr);

/// Elements to add to a mesh.
struct AddedElements {
    std::vector<Vec3> vertices;        ///< new vertices at rest [m], numbered after those of the mesh; each used by a new element
    std::vector<Tet> tets;             ///< of old and new vertices; rewound where they are inside out
    std::vector<Hex> hexes;
    std::vector<std::int32_t> source;  ///< an element of the mesh, of the same kind, whose region, fill and matter it takes over: one per new element (tets first), or one for all
};

/// Adds elements, tets behind the tets, hexes behind the hexes. They join the mesh by the vertices that they share. A new vertex is as deformed and moves as the source of the first new element
/// that has it, continued linearly to its place: weights of its four parents may be negative. Shares of new elements are 0. O(n).
/// @pre new elements do not overlap others
/// @error Error(invalid_argument) naming the element: an index or source out of range, of the wrong kind, or not given; a vertex repeated or in no new element; too flat; the vertices
///        of another element; a face that two elements have already; a boundary that would touch itself at a vertex or edge
MeshEdit add_elements(const VolumeMesh& mesh, const AddedElements& added);

}  // namespace supple
