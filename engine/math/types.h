#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace supple {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Mat34 = Eigen::Matrix<double, 3, 4, Eigen::DontAlign>;  ///< affine map [A | t]

/// Symmetric tensor in Voigt order xx yy zz xy yz zx. Stresses hold tensor shears; strains hold engineering shears.
using Voigt = std::array<double, 6>;

}  // namespace supple
