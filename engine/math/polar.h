#pragma once
#include "supple/math/types.h"

namespace supple {

/// Unit quaternion (w, x, y, z) of the rotation R nearest to F (maximises tr(R^T F), det R = +1), without a starting guess, for any finite F.
/// @source the dominant eigenvector of Davenport's 4x4 matrix (Davenport 1968; Horn 1987)
std::array<double, 4> polar_quaternion(const Mat3& F);

Mat3 rotation_matrix(const std::array<double, 4>& wxyz);

}  // namespace supple
