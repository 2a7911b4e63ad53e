#pragma once
#include <Eigen/Core>

#include "supple/fem/hex8.h"
#include "supple/fem/hex8_geometry.h"
#include "supple/material/material.h"

namespace supple::fem {

using Mat24 = Eigen::Matrix<double, 24, 24>;

/// Stiffness of a hexahedron at rest, coordinate 3 a + i [N/m]; symmetric, its null space the six rigid motions.
/// @param X  as accepted by make_hex_rest()
Mat24 hex_stiffness(const HexShape& X, const Lame& lame, Integration integration);

/// Stiffnesses of many hexahedra. Where shapes repeat (the cells of a lattice) so do the stiffnesses, times size and shear modulus: they are kept once, as a class.
struct HexStiffness {
    AlignedVector<double> shared_d;           ///< [class][kHexBlocks] of unit size and unit shear modulus
    AlignedVector<float> shared_f;            ///< the same, where a float32 matrix needs it
    AlignedVector<double> own;                ///< [..][kHexInner][lane]: of the blocks whose eight elements are not of one class
    std::vector<std::int32_t> class_of;       ///< [element]
    std::vector<std::int64_t> place;          ///< [block] index of the class that its elements share, or -1 - index into `own`
    AlignedVector<double> scale;              ///< [block][lane] size times shear modulus; zero in the free lanes
};

/// @param lame         one per element
/// @param integration  one per element
HexStiffness make_hex_stiffness(const Hex8Rest& rest, std::span<const Lame> lame, std::span<const Integration> integration, bool single_precision);

}  // namespace supple::fem
