#pragma once
#include "supple/fem/tet4.h"

namespace supple::fem {

/// Hyperelastic laws with a principal-stretch form (material/laws/<law>.h).
enum class Law { st_venant_kirchhoff, neo_hookean, stable_neo_hookean, mooney_rivlin, arruda_boyce, veronda_westman, ogden };
inline constexpr std::size_t kLaws = 7;

/// Numbers kept of an element's tangent: U and V of F = U diag(s) V^T, the 3x3 of W_ij (00 11 22 01 12 20), and of each pair half the sum
/// and half the difference of its two quotients.
inline constexpr std::size_t kTangent = 30;

/// An element's stiffness: its ten 3x3 blocks (a, b >= a), (0,0) (0,1) .. (3,3), each in columns [x y z 0].
inline constexpr std::size_t kElementBlocks = 120;

struct Tet4HyperPass {
    const std::int32_t* vertex = nullptr;
    const double* gradient = nullptr;
    const double* volume = nullptr;
    const double* parameter = nullptr;      ///< [block][parameter][lane]: the law's, after the stiffness k of its inversion
    std::size_t parameters = 0;             ///< per element
    const double* position = nullptr;
    bool project = true;                    ///< tangent made positive semidefinite: every eigenvalue of d2W/dF2 below zero is set to zero

    double* quaternion = nullptr;           ///< [block][w x y z][lane]: warm start in, rotation out
    double* corner_force = nullptr;         ///< as in Tet4Pass
    double* tangent = nullptr;              ///< out [block][kTangent][lane]
    float* block_f = nullptr;               ///< out [element][kElementBlocks], needs tangent
    double* block_d = nullptr;
    double* energy = nullptr;
    double* stress = nullptr;
};

struct Tet4HyperProduct {
    const std::int32_t* vertex = nullptr;
    const double* gradient = nullptr;
    const double* volume = nullptr;
    const double* tangent = nullptr;
    const double* field = nullptr;
    double* corner_force = nullptr;
};

/// As Tet4Assembly, from element blocks.
template <class Real>
struct BlockAssembly {
    const std::int32_t* row_start = nullptr;
    const std::int32_t* column = nullptr;
    const std::int32_t* mirror = nullptr;
    const std::int64_t* contribution_start = nullptr;
    const std::uint32_t* contribution = nullptr;
    const Real* block = nullptr;
    const double* diagonal_shift = nullptr;
    double stiffness_scale = 1;
    Real* value = nullptr;
};

struct Tet4HyperKernels {
    void (*elements[kLaws])(const Tet4HyperPass& pass, std::size_t begin, std::size_t end);
    void (*product)(const Tet4HyperProduct& pass, std::size_t begin, std::size_t end);
    void (*assemble_f)(const BlockAssembly<float>& pass, std::size_t begin, std::size_t end);
    void (*assemble_d)(const BlockAssembly<double>& pass, std::size_t begin, std::size_t end);
};

const Tet4HyperKernels& tet4_hyper_kernels(Isa isa);

}  // namespace supple::fem
