#pragma once
#include "supple/mesh/volume_mesh.h"

namespace supple {

/// A box [min, max] cut into cells[0] x cells[1] x cells[2] equal cells; vertex (i,j,k) has index i + (nx+1)(j + (ny+1)k).
/// Elements run in the same order, x fastest. The last layer lies exactly on max_m.
struct BoxDef {
    Vec3 min_m = Vec3::Zero();
    Vec3 max_m = Vec3::Ones();          ///< greater than min_m in every coordinate
    std::array<int, 3> cells{1, 1, 1};  ///< each >= 1
};

/// Six tets per cell around the diagonal (0,0,0)-(1,1,1) (Kuhn), conforming across cells; every tet runs from the low corner of
/// its cell to the high one.
/// @error Error(invalid_argument) for a cell count below 1, an empty or non-finite box, or a mesh beyond 2^31 - 1 vertices or elements
VolumeMesh make_tet_box(const BoxDef& def);

/// One hex per cell. Errors as make_tet_box().
VolumeMesh make_hex_box(const BoxDef& def);

}  // namespace supple
