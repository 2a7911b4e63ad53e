#pragma once
#include "supple/fem/hex8.h"
#include "supple/fem/tet4.h"

namespace supple::fem {

/// A stiffness as HexStiffness keeps it.
struct HexStiffnessView {
    const double* shared = nullptr;      ///< [class][kHexBlocks]
    const double* own = nullptr;         ///< [..][kHexInner][lane]
    const std::int64_t* place = nullptr; ///< [block]
    const double* scale = nullptr;       ///< [block][lane]
};

/// What a pass over hexahedra in a frame reads and writes; null outputs are not computed. Arrays as in Hex8Rest and Tet4Pass.
struct Hex8Pass {
    const std::int32_t* vertex = nullptr;
    const double* edge = nullptr;
    const double* gradient = nullptr;
    const double* volume = nullptr;
    const double* moduli = nullptr;      ///< [block][lambda mu][lane], for the stress
    HexStiffnessView stiffness;
    const double* position = nullptr;

    double* quaternion = nullptr;        ///< [block][w x y z][lane]
    double* corner_force = nullptr;      ///< out [element][corner][x y z 0]
    float* record_f = nullptr;           ///< out [element][kHexRecord]
    double* record_d = nullptr;
    double* energy = nullptr;            ///< out [block][lane]: half of forces times displacements; their energy where the frame does not turn
    double* stress = nullptr;            ///< out [block][xx yy zz xy yz zx][lane]: volume mean, Cauchy
};

/// What turns an element's stiffness: the columns of R in [x y z 0] each, the scale in the fourth place of the first.
inline constexpr std::size_t kHexRecord = 16;

struct Hex8Product {
    const std::int32_t* vertex = nullptr;
    HexStiffnessView stiffness;
    const double* quaternion = nullptr;  ///< null: the stiffness is not turned
    const double* field = nullptr;
    double* corner_force = nullptr;
};

/// As Tet4Assembly; contribution: element * 64 + corner_of_row * 8 + corner_of_column.
template <class Real>
struct Hex8Assembly {
    const std::int32_t* row_start = nullptr;
    const std::int32_t* column = nullptr;
    const std::int32_t* mirror = nullptr;
    const std::int64_t* contribution_start = nullptr;
    const std::uint32_t* contribution = nullptr;
    const Real* stiffness = nullptr;     ///< [class][kHexBlocks]
    const std::int32_t* class_of = nullptr;  ///< [element]; null: each is its own
    const Real* record = nullptr;        ///< null: the stiffness is not turned
    const double* diagonal_shift = nullptr;
    double stiffness_scale = 1;
    Real* value = nullptr;
};

struct Hex8Kernels {
    void (*elements[kFrames])(const Hex8Pass& pass, std::size_t begin, std::size_t end);
    void (*product)(const Hex8Product& pass, std::size_t begin, std::size_t end);
    void (*assemble_f)(const Hex8Assembly<float>& pass, std::size_t begin, std::size_t end);
    void (*assemble_d)(const Hex8Assembly<double>& pass, std::size_t begin, std::size_t end);
};

const Hex8Kernels& hex8_kernels(Isa isa);

}  // namespace supple::fem
