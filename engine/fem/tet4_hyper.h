#pragma once
#include "supple/fem/tet4.h"

namespace supple::fem {

/// Hyperelastic laws (material/laws/<law>.h): in principal stretches, but for the last, a tensor law in the material frame of each element.
enum class Law { st_venant_kirchhoff, neo_hookean, stable_neo_hookean, mooney_rivlin, arruda_boyce, veronda_westman, ogden, costa };
inline constexpr std::size_t kLaws = 8;
constexpr bool is_tensor_law(Law law) { return law == Law::costa; }

/// Numbers kept of an element's tangent: U and V of F = U diag(s) V^T, the 3x3 of W_ij (00 11 22 01 12 20), and of each pair half the sum
/// and half the difference of its two quotients.
inline constexpr std::size_t kTangent = 30;
/// The same of a tensor law: the upper triangle of dP/dF, row by row, its second indices in the material frame.
inline constexpr std::size_t kTensorTangent = 45;
/// Parameters of one family of fibres: stiffness k, exponent b, direction f. Numbers kept of its tangent: M = 2 W4 I + 4 W44 a a^T, a = F f.
inline constexpr std::size_t kFibre = 5;
inline constexpr std::size_t kFibreTangent = 6;

/// An element's stiffness: its 3x3 blocks of pairs of corners (0,1) (0,2) (0,3) (1,2) (1,3) (2,3), each in columns [x y z 0]. The rows of the whole sum to zero.
inline constexpr std::size_t kElementPairs = 6, kElementBlocks = 12 * kElementPairs;

struct Tet4HyperPass {
    const std::int32_t* vertex = nullptr;
    const double* gradient = nullptr;
    const double* volume = nullptr;
    const double* parameter = nullptr;      ///< [block][parameter][lane]: the law's, after the stiffness k of its inversion
    std::size_t parameters = 0;             ///< per element
    const double* position = nullptr;
    const double* fibre = nullptr;          ///< [block][family][kFibre][lane]
    std::size_t families = 0;               ///< of fibres, 0 to 2
    bool project = true;                    ///< tangent made positive semidefinite: every eigenvalue of d2W/dF2 below zero is set to zero (tensor
                                            ///< laws: a sufficient bound, material/laws/tensor.h)

    double* quaternion = nullptr;           ///< [block][w x y z][lane]: warm start in, rotation out
    double* corner_force = nullptr;         ///< as in Tet4Pass
    std::size_t corner_block = 0;
    double* tangent = nullptr;              ///< out [block][kTangent or kTensorTangent][lane]
    double* fibre_tangent = nullptr;        ///< out [block][family][kFibreTangent][lane], needs tangent
    float* block_f = nullptr;               ///< out [element][kElementBlocks] from the first element of corner_block on, needs tangent
    double* block_d = nullptr;
    double* energy = nullptr;
    double* stress = nullptr;
};

struct Tet4HyperProduct {
    const std::int32_t* vertex = nullptr;
    const double* gradient = nullptr;
    const double* volume = nullptr;
    const double* tangent = nullptr;
    const double* parameter = nullptr;      ///< tensor laws: the last nine hold the material frame
    std::size_t parameters = 0;
    const double* fibre = nullptr;
    const double* fibre_tangent = nullptr;
    std::size_t families = 0;
    const double* field = nullptr;
    double* corner_force = nullptr;
    std::size_t corner_block = 0;
};

/// Blocks summed: each the sum of `count[0]` of those at `entry` and of the transposes of the next `count[1]`.
template <class Real>
struct BlockAddition {
    const std::uint16_t* count = nullptr;   ///< [place][2]
    const std::uint16_t* entry = nullptr;
    std::size_t places = 0;
    const Real* from = nullptr;             ///< [..][column 0..2][x y z 0]
    Real* to = nullptr;                     ///< [place][column 0..2][x y z 0]
};

/// As Tet4Assembly, from blocks of places (BlockSums).
template <class Real>
struct BlockAssembly {
    const std::int32_t* row_start = nullptr;
    const std::int32_t* column = nullptr;
    const std::int32_t* mirror = nullptr;
    const std::int64_t* contribution_start = nullptr;
    const std::uint32_t* contribution = nullptr;  ///< a place
    const Real* place = nullptr;                  ///< [place][column 0..2][x y z 0]
    const double* diagonal_shift = nullptr;
    double stiffness_scale = 1;
    Real* value = nullptr;
};

struct Tet4HyperKernels {
    void (*elements[kLaws])(const Tet4HyperPass& pass, std::size_t begin, std::size_t end);
    void (*product)(const Tet4HyperProduct& pass, std::size_t begin, std::size_t end);
    void (*product_tensor)(const Tet4HyperProduct& pass, std::size_t begin, std::size_t end);
    void (*add_blocks_f)(const BlockAddition<float>& pass);
    void (*add_blocks_d)(const BlockAddition<double>& pass);
    void (*assemble_f)(const BlockAssembly<float>& pass, std::size_t begin, std::size_t end);
    void (*assemble_d)(const BlockAssembly<double>& pass, std::size_t begin, std::size_t end);
};

const Tet4HyperKernels& tet4_hyper_kernels(Isa isa);

}  // namespace supple::fem
