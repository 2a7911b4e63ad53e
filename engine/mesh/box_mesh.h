#pragma once
#include "supple/mesh/volume_mesh.h"

namespace supple {

/// A box [min, max] cut into cells[0] x cells[1] x cells[2] equal cells; vertex (i,j,k) has index i + (nx+1)(j + (ny+1)k).
struct BoxDef {
    Vec3 min_m = Vec3::Zero();
    Vec3 max_m = Vec3::Ones();
    std::array<int, 3> cells{1, 1, 1};  ///< each >= 1
};

/// Six tets per cell around the diagonal (0,0,0)-(1,1,1) (Kuhn), conforming across cells.
VolumeMesh make_tet_box(const BoxDef& def);

/// One hex per cell.
VolumeMesh make_hex_box(const BoxDef& def);

}  // namespace supple
