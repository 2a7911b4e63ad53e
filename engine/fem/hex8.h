#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "supple/base/aligned.h"
#include "supple/fem/tet4.h"
#include "supple/material/material.h"
#include "supple/math/types.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::fem {

inline constexpr std::size_t kHexPoints = 8;    ///< of the 2x2x2 Gauss rule; point q lies towards corner q
inline constexpr std::size_t kHexPairs = 36;    ///< 3x3 blocks (a, b >= a) of an element's stiffness, (0,0) (0,1) .. (7,7)
inline constexpr std::size_t kHexBlocks = kHexPairs * 12;  ///< numbers of an element's stiffness, each block in columns [x y z 0]
inline constexpr std::size_t kHexInner = 28 * 9;  ///< its blocks (a, b >= a) of the corners 1..7, nine numbers each by columns: all that a product needs

/// Place of block (a, b), a <= b, among those of n corners.
constexpr std::size_t hex_pair(std::size_t a, std::size_t b, std::size_t n = 8) { return a * n - a * (a + 1) / 2 + b; }

/// Rest shape of trilinear hexahedra (corners in VTK order), ready for the kernels. Padded as Tet4Rest.
struct Hex8Rest {
    std::size_t elements = 0;
    std::size_t blocks() const { return (elements + kBlock - 1) / kBlock; }

    AlignedVector<std::int32_t> vertex;  ///< [block][corner 0..7][lane]
    AlignedVector<double> edge;          ///< [block][e1x e1y .. e7z][lane] X_a - X_0 [m]
    AlignedVector<double> gradient;      ///< [block][b1x b1y .. b7z][lane] volume mean of the gradient of corner a's shape function [1/m]; b0 = -sum
    AlignedVector<double> volume;        ///< [block][lane] [m^3]
};

/// @error Error(invalid_argument) naming the first element (from first_number on) whose Jacobian is not positive at an integration point
/// @param before, old  where a hex is the same as old[i] of `before` (-1: none), its rest shape is copied
Hex8Rest make_hex_rest(std::span<const Vec3> vertices, std::span<const Hex> hexes, std::span<const std::int32_t> numbers, const std::string& where,
                       const Hex8Rest* before = nullptr, std::span<const std::int32_t> old = {});

/// Adds the trace of the diagonal stiffness block of each vertex at rest, fully integrated [N/m]. lame: one per element.
void add_stiffness_trace(const Hex8Rest& rest, std::span<const Lame> lame, std::span<double> trace);

}  // namespace supple::fem
