#pragma once
/// Row loops over 16-bit block matrices, compiled once per instruction set by packed_kernels_<isa>.cpp.
#include "supple/math/lanes4.h"
#include "supple/solve/packed_kernels.h"

namespace supple::solve {
inline namespace SUPPLE_ISA {
namespace {

constexpr float kUnit = 1.0f / 32767.0f;

/// 32767 A x on one row.
inline Float4 packed_row(const PackedRows& A, std::size_t row, const float* x) {
    BlockSum<float> even, odd;
    const std::int32_t last = A.row_start[row + 1];
    std::int32_t block = A.row_start[row];
    for (; block + 1 < last; block += 2) {
        even.add(A.value + std::size_t(block) * 12, x + std::size_t(A.column[block]) * 4);
        odd.add(A.value + std::size_t(block) * 12 + 12, x + std::size_t(A.column[block + 1]) * 4);
    }
    if (block < last) even.add(A.value + std::size_t(block) * 12, x + std::size_t(A.column[block]) * 4);
    even.merge(odd);
    return even.total();
}

inline Float4 block_times(const float* d, Float4 v) { return load4(d) * splat<0>(v) + load4(d + 4) * splat<1>(v) + load4(d + 8) * splat<2>(v); }

/// The pads of a packed block may hold anything.
inline Float4 without_pad(Float4 v) {
    const Float4 zero = {0, 0, 0, 0};
    return __builtin_shufflevector(v, zero, 0, 1, 2, 4);
}

void first(const PackedRows& A, float b, const float* r, float* out, std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) store4(out + row * 4, b * block_times(A.inverse + row * 12, load4(r + row * 4)));
}

double relax(const PackedRows& A, float a, float b, const float* r, const float* x, const float* previous, float* out, std::size_t begin,
             std::size_t end) {
    double sum = 0;
    for (std::size_t row = begin; row < end; ++row) {
        const Float4 force = load4(r + row * 4), at = load4(x + row * 4);
        const Float4 rest = without_pad(force - kUnit * packed_row(A, row, x));
        Float4 step = at;
        if (previous != nullptr) step -= load4(previous + row * 4);
        const Float4 next = at + a * step + b * block_times(A.inverse + row * 12, rest);
        store4(out + row * 4, next);
        sum += (double(force[0]) * double(next[0]) + double(force[1]) * double(next[1])) + double(force[2]) * double(next[2]);
    }
    return sum;
}

double relax_product(const float* inverse, const float* product, float a, float b, const float* r, const float* x, const float* previous, float* out,
                     std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t row = begin; row < end; ++row) {
        const Float4 force = load4(r + row * 4), at = load4(x + row * 4);
        Float4 step = at;
        if (previous != nullptr) step -= load4(previous + row * 4);
        const Float4 next = at + a * step + b * block_times(inverse + row * 12, force - load4(product + row * 4));
        store4(out + row * 4, next);
        sum += (double(force[0]) * double(next[0]) + double(force[1]) * double(next[1])) + double(force[2]) * double(next[2]);
    }
    return sum;
}

void residual(const PackedRows& A, const float* r, const float* x, float* t, std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
        store4(t + row * 4, A.scale[row] * without_pad(load4(r + row * 4) - kUnit * packed_row(A, row, x)));
    }
}

inline Float4 weighted_row(const std::int32_t* row_start, const std::int32_t* column, const float* weight, const float* t, std::size_t row) {
    Float4 s0 = {0, 0, 0, 0}, s1 = s0;
    const std::int32_t last = row_start[row + 1];
    std::int32_t k = row_start[row];
    for (; k + 1 < last; k += 2) {
        s0 += weight[k] * load4(t + std::size_t(column[k]) * 4);
        s1 += weight[k + 1] * load4(t + std::size_t(column[k + 1]) * 4);
    }
    if (k < last) s0 += weight[k] * load4(t + std::size_t(column[k]) * 4);
    return s0 + s1;
}

void gather(const std::int32_t* row_start, const std::int32_t* column, const float* weight, const float* t, float* out, std::size_t begin,
            std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) store4(out + row * 4, weighted_row(row_start, column, weight, t, row));
}

void prolong(const std::int32_t* row_start, const std::int32_t* column, const float* weight, const float* e, const float* scale, float* x,
             std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
        store4(x + row * 4, load4(x + row * 4) + scale[row] * weighted_row(row_start, column, weight, e, row));
    }
}

template <class Real>
void pack(const std::int32_t* row_start, const std::int32_t* column, const Real* A, const float* inverse_scale, std::int16_t* value,
          std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
        for (std::int32_t block = row_start[row]; block < row_start[row + 1]; ++block) {
            // The same bits above and below the diagonal: the product of the two scales comes first.
            const float factor = 32767.0f * (inverse_scale[row] * inverse_scale[column[block]]);
            store_rounded12(value + std::size_t(block) * 12, A + std::size_t(block) * 12, factor);
        }
    }
}

inline constexpr PackedKernels kPackedKernels{first, relax, relax_product, residual, gather, prolong, pack<float>, pack<double>};

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::solve
