#pragma once
#include "supple/mesh/volume_mesh.h"

namespace supple {

/// Shape of one tetrahedron; the same for every size and place, and for both windings.
struct TetQuality {
    double min_dihedral_deg = 0;  ///< smallest angle between two faces, (0, 70.53]; 0 for a flat tet
    double max_dihedral_deg = 0;  ///< largest angle between two faces, [70.53, 180)
    double radius_ratio = 0;      ///< 3 x inscribed radius / circumscribed radius, 0 (flat) to 1 (regular)
};

TetQuality tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Worst and mean shape over the tetrahedra of a mesh.
struct MeshQuality {
    double min_dihedral_deg = 0;
    double max_dihedral_deg = 0;
    double min_radius_ratio = 0;
    double mean_radius_ratio = 0;
    std::int32_t worst_tet = -1;  ///< the one of least radius ratio
};

/// @pre vertex indices in range. All zero and worst_tet = -1 for a mesh without tets.
MeshQuality tet_mesh_quality(const VolumeMesh& mesh);

/// Least over the corners of a hexahedron of the determinant of its three edges there, each of unit length: 1 for a box, 0 or less where folded.
double hex_scaled_jacobian(const std::array<Vec3, 8>& x);

}  // namespace supple
