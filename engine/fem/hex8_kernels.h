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
    const double* plastic = nullptr;     ///< as in Tet4Pass: of the element's mean strain
    bool project = true;                 ///< twist: eigenvalues below zero are set to zero

    double* quaternion = nullptr;        ///< [block][w x y z][lane]
    double* corner_force = nullptr;      ///< out [element][corner][x y z 0]
    float* record_f = nullptr;           ///< out [element][kHexRecord]
    double* record_d = nullptr;
    double* twist = nullptr;             ///< out [block][xx yy zz xy yz zx][lane] twist stiffness times volume, in the frame; polar and svd only [J]
    float* twist_f = nullptr;            ///< out [element][kHexTwist], with twist
    double* twist_d = nullptr;
    double* energy = nullptr;            ///< out [block][lane]: of the strain in the frame. The forces are its derivative where the frame does not turn
    double* stress = nullptr;            ///< out [block][xx yy zz xy yz zx][lane]: volume mean, Cauchy
};

/// What turns an element's stiffness: the columns of R in [x y z 0] each, the scale in the fourth place of the first.
inline constexpr std::size_t kHexRecord = 16;

/// What the exact tangent adds to a pair of corners: [corner][x y z] the turned mean gradients R b_a, and in the fourth places V/2 R T R^T, xx yy zz xy yz zx.
inline constexpr std::size_t kHexTwist = 32;

/// As Tet4Flow, of the mean strain of each element.
struct Hex8Flow {
    const std::int32_t* vertex = nullptr;
    const double* edge = nullptr;
    const double* gradient = nullptr;
    const double* position = nullptr;
    const double* parameter = nullptr;
    double* quaternion = nullptr;
    double* plastic = nullptr;
};

struct Hex8Product {
    const std::int32_t* vertex = nullptr;
    const double* gradient = nullptr;    ///< with twist
    HexStiffnessView stiffness;
    const double* twist = nullptr;       ///< as in Hex8Pass, or null
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
    const Real* twist = nullptr;         ///< [element][kHexTwist], or null
    const double* diagonal_shift = nullptr;
    double stiffness_scale = 1;
    Real* value = nullptr;
};

struct Hex8Kernels {
    void (*elements[kFrames])(const Hex8Pass& pass, std::size_t begin, std::size_t end);
    void (*flow[kFrames])(const Hex8Flow& pass, std::size_t begin, std::size_t end);
    void (*product)(const Hex8Product& pass, std::size_t begin, std::size_t end);
    void (*assemble_f)(const Hex8Assembly<float>& pass, std::size_t begin, std::size_t end);
    void (*assemble_d)(const Hex8Assembly<double>& pass, std::size_t begin, std::size_t end);
};

const Hex8Kernels& hex8_kernels(Isa isa);

}  // namespace supple::fem
