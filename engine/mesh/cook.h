#pragma once
#include <string>
#include <vector>

#include "supple/mesh/isosurface_stuffing.h"
#include "supple/mesh/quality.h"
#include "supple/mesh/solid_region.h"

namespace supple {

enum class CookKind {
    tets,   ///< isosurface stuffing: tetrahedra whose boundary is snapped to the surface, dihedral angles in [8.9, 158.8] degrees
    hexes,  ///< the cubes of a lattice, those on the boundary partly filled (VolumeMesh::fill)
    cage,   ///< tetrahedra that hold all of the surface, partly filled: for coarse meshes that move a fine skin
};

struct CookDef {
    CookKind kind = CookKind::tets;
    std::size_t elements = 20000;  ///< about so many, 1..2^28; met within 5 % where the shape is resolved
    double edge_m = 0;             ///< > 0: this lattice edge instead
};

struct CookReport {
    double edge_m = 0;               ///< of the lattice
    double volume_m3 = 0;            ///< of the elements' filled parts
    double region_volume_m3 = 0;     ///< of the points where the winding number is above one half
    bool was_inside_out = false;     ///< the surface was wound clockwise and has been turned
    std::size_t dropped_tets = 0;    ///< of crumbs: parts of less than 1/1000 of the volume that hung on what the lattice cannot resolve
    std::size_t components = 0;      ///< parts of the mesh
    MeshQuality quality;             ///< of tets
    StuffingReport stuffing;         ///< of tets and cages

    /// Plain sentences about what the user should know; empty where all went well.
    std::vector<std::string> sentences() const;
};

/// Fills what a surface encloses (SolidRegion) with elements. The surface may have holes, cross itself or hold several parts. Seconds for 50,000 elements;
/// the same mesh for the same surface from any team.
/// @error Error(invalid_argument) for an illegal definition or index, a surface that encloses nothing, or an edge longer than the shape
VolumeMesh cook(const mesh::TriangleMesh& surface, const CookDef& def, Team& team, CookReport* report = nullptr);

/// The same for the region of a surface that is at hand, with its volume().
VolumeMesh cook(const SolidRegion& region, const mesh::TriangleMesh& surface, double region_volume_m3, const CookDef& def, Team& team, CookReport* report = nullptr);

}  // namespace supple
