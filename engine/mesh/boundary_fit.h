#pragma once
#include "supple/mesh/solid_region.h"
#include "supple/mesh/volume_mesh.h"

namespace supple {

/// Moves the boundary of a mesh of tets, whose vertices lie on a curved surface, out (or in) by what its flat triangles cut off on average, so that the mesh holds
/// the volume of the region: inscribed, a tube of radius r loses about edge^2 / (8 r^2) of it. Flat sides and sharp edges stay where they are, and so does every
/// vertex whose tets would leave dihedral angles of 8.9 to 158.8 degrees. The same for every team.
/// @param surface  the one that `region` was made of
/// @param edge_m   of the mesh's lattice; no vertex moves farther than a tenth of it
/// @return how many vertices were moved
std::size_t fit_boundary(VolumeMesh& mesh, const SolidRegion& region, const mesh::TriangleMesh& surface, double edge_m, Team& team);

}  // namespace supple
