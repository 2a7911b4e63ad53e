#pragma once
#include <cstddef>
#include <cstdint>

#include "supple/math/isa.h"

namespace supple::solve {

/// A symmetric matrix of 3x3 blocks in 16-bit numbers, for preconditioners: A_ij = scale_i scale_j value_ij / 32767, with scale_i^2 the largest
/// diagonal entry of row i, so that a positive definite matrix has no |value| above 32767. Half the bytes of float32, and symmetric to the last bit.
/// The loops below see scaled vectors: x' = scale x, r' = r / scale. Vectors hold [row][x y z 0].
struct PackedRows {
    const std::int32_t* row_start = nullptr;
    const std::int32_t* column = nullptr;
    const std::int16_t* value = nullptr;    ///< [block][column][x y z pad]; four numbers more at the end, which wide loads read
    const float* inverse = nullptr;         ///< [row][column][x y z 0] inverse diagonal blocks, scaled
    const float* scale = nullptr;           ///< [row]
};

struct PackedKernels {
    /// out = b D^-1 r
    void (*first)(const PackedRows& A, float b, const float* r, float* out, std::size_t begin, std::size_t end);
    /// out = x + a (x - previous) + b D^-1 (r - A x); previous null stands for zero. Returns r . out.
    double (*relax)(const PackedRows& A, float a, float b, const float* r, const float* x, const float* previous, float* out,
                    std::size_t begin, std::size_t end);
    /// The same from a product that was made before: out = x + a (x - previous) + b D^-1 (r - product), D^-1 in columns [x y z 0].
    double (*relax_product)(const float* inverse, const float* product, float a, float b, const float* r, const float* x, const float* previous, float* out,
                            std::size_t begin, std::size_t end);
    /// t = scale (r - A x): the residual of the unscaled system.
    void (*residual)(const PackedRows& A, const float* r, const float* x, float* t, std::size_t begin, std::size_t end);
    /// out = sum of weight t over a row of a scalar matrix.
    void (*gather)(const std::int32_t* row_start, const std::int32_t* column, const float* weight, const float* t, float* out,
                   std::size_t begin, std::size_t end);
    /// x += scale * (sum of weight e)
    void (*prolong)(const std::int32_t* row_start, const std::int32_t* column, const float* weight, const float* e, const float* scale,
                    float* x, std::size_t begin, std::size_t end);
    /// value = 32767 A_ij / (scale_i scale_j), rounded, for the rows [begin, end); inverse_scale [row].
    void (*pack_f)(const std::int32_t* row_start, const std::int32_t* column, const float* A, const float* inverse_scale, std::int16_t* value,
                   std::size_t begin, std::size_t end);
    void (*pack_d)(const std::int32_t* row_start, const std::int32_t* column, const double* A, const float* inverse_scale, std::int16_t* value,
                   std::size_t begin, std::size_t end);
};

const PackedKernels& packed_kernels(Isa isa);

}  // namespace supple::solve
