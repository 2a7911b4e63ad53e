#pragma once
#include "supple/mesh/solid_region.h"
#include "supple/mesh/volume_mesh.h"

namespace supple {

struct LatticeHexDef {
    double edge_m = 0.1;        ///< of the cubes, > 0
    Vec3 shift = Vec3::Zero();  ///< moves the lattice by this part of an edge, -0.5..0.5; 0 centres it in the region's box
    double least_fill = 0.02;   ///< cubes filled less than this are left out, [0, 1)
    int depth = 1;              ///< cubes on the boundary are measured in 8^depth parts, 0..6
};

/// How many cubes fill_with_hexes() keeps.
std::size_t count_hexes(const SolidRegion& region, const LatticeHexDef& def, Team& team);

/// The cubes of a lattice that a region fills at least in part, VolumeMesh::fill saying how much. Cubes are joined across a face only where the region passes
/// through that face: parts that come near each other, like two fingers, stay apart. Deterministic for any team.
/// @error Error(invalid_argument) for an illegal definition, more than 2^30 cells in the box, or where no cube is filled
VolumeMesh fill_with_hexes(const SolidRegion& region, const LatticeHexDef& def, Team& team);

}  // namespace supple
