#pragma once
#include <array>
#include <span>

#include <Eigen/Core>

#include "supple/math/types.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::fem {

/// Corners of the reference cube [-1, 1]^3 in VTK order.
inline constexpr std::array<std::array<double, 3>, 8> kHexCorner{
    {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};

using HexShape = std::array<Vec3, 8>;                     ///< corner positions
using HexGradients = Eigen::Matrix<double, 8, 3>;         ///< row a: gradient of corner a's shape function

/// The trilinear map at a point of the reference cube.
struct HexPoint {
    Vec3 xi;
    Mat3 jacobian;            ///< dX/dxi
    double determinant = 0;
    HexGradients gradient;    ///< dN_a/dX [1/m]; not finite where the determinant is zero
};

/// N_a = (1 + xi xi_a)(1 + eta eta_a)(1 + zeta zeta_a)/8
double hex_shape_function(std::size_t corner, const Vec3& xi);
HexPoint hex_point(const HexShape& X, const Vec3& xi);
/// Point q of the 2x2x2 Gauss rule, weight 1: towards corner q.
Vec3 hex_gauss_point(std::size_t q);

/// Rest shape of an element, corner 0 at the origin.
struct Hex8Rest;
HexShape hex_shape(const Hex8Rest& rest, std::size_t element);
HexShape hex_shape(std::span<const Vec3> vertices, const Hex& hex);

}  // namespace supple::fem
