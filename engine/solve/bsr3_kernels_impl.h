#pragma once
/// Row loops over 3x3 block matrices, compiled once per instruction set by bsr3_kernels_<isa>.cpp.
#include "supple/math/lanes4.h"
#include "supple/solve/bsr3_kernels.h"

namespace supple::solve {
inline namespace SUPPLE_ISA {
namespace {

/// a.b over x y z in float64: the pads are zero.
template <class R4>
inline double dot4(R4 a, R4 b) {
    return (double(a[0]) * double(b[0]) + double(a[1]) * double(b[1])) + double(a[2]) * double(b[2]);
}

/// Sum over the blocks [first, last) of one row of value[block] x[column[block]].
template <class Value, class Real>
inline FourOf<Real> block_row(const Value* value, const std::int32_t* column, std::int32_t first, std::int32_t last, const Real* x) {
    BlockSum<Real> even, odd;
    std::int32_t block = first;
    for (; block + 1 < last; block += 2) {
        even.add(value + std::size_t(block) * 12, x + std::size_t(column[block]) * 4);
        odd.add(value + std::size_t(block) * 12 + 12, x + std::size_t(column[block + 1]) * 4);
    }
    if (block < last) even.add(value + std::size_t(block) * 12, x + std::size_t(column[block]) * 4);
    even.merge(odd);
    return even.total();
}

template <class Real>
double multiply(const std::int32_t* row_start, const std::int32_t* column, const Real* value, const Real* x, Real* y, std::size_t begin,
                std::size_t end) {
    double sum = 0;
    for (std::size_t row = begin; row < end; ++row) {
        const auto s = block_row(value, column, row_start[row], row_start[row + 1], x);
        store4(y + row * 4, s);
        sum += dot4(load4(x + row * 4), s);
    }
    return sum;
}

template <class Real>
void multiply_two(const std::int32_t* row_start, const std::int32_t* column, const Real* value, const Real* x, const Real* u, Real* y, Real* v,
                  std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
        BlockSum<Real> first, second;
        for (std::int32_t block = row_start[row]; block < row_start[row + 1]; ++block) {
            const Real* a = value + std::size_t(block) * 12;
            first.add(a, x + std::size_t(column[block]) * 4);
            second.add(a, u + std::size_t(column[block]) * 4);
        }
        store4(y + row * 4, first.total());
        store4(v + row * 4, second.total());
    }
}

template <class Real>
double advance(Real alpha, const Real* p, const Real* q, Real* x, Real* r, std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t row = begin; row < end; ++row) {
        store4(x + row * 4, load4(x + row * 4) + alpha * load4(p + row * 4));
        const auto s = load4(r + row * 4) - alpha * load4(q + row * 4);
        store4(r + row * 4, s);
        sum += dot4(s, s);
    }
    return sum;
}

template <class Real>
double block_diagonal(const Real* inverse, const Real* r, Real* z, std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t row = begin; row < end; ++row) {
        const Real* d = inverse + row * 12;
        const auto v = load4(r + row * 4);
        const auto s = load4(d) * splat<0>(v) + load4(d + 4) * splat<1>(v) + load4(d + 8) * splat<2>(v);
        store4(z + row * 4, s);
        sum += dot4(v, s);
    }
    return sum;
}

template <class Real>
void turn(Real beta, const Real* z, Real* p, std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) store4(p + row * 4, load4(z + row * 4) + beta * load4(p + row * 4));
}

template <class Real>
inline constexpr Bsr3Kernels<Real> kKernels{multiply<Real>, multiply_two<Real>, advance<Real>, block_diagonal<Real>, turn<Real>};

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::solve
