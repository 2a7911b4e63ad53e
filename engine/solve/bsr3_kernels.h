#pragma once
#include <cstddef>
#include <cstdint>

#include "supple/math/isa.h"

namespace supple::solve {

/// Rows of the loops of conjugate gradients. Vectors hold [row][x y z 0]; the pad stays zero. Sums are taken in float64.
template <class Real>
struct Bsr3Kernels {
    /// y = A x on the rows [begin, end); returns x . y over them.
    double (*multiply)(const std::int32_t* row_start, const std::int32_t* column, const Real* value, const Real* x, Real* y,
                       std::size_t begin, std::size_t end);
    /// y = A x and v = A u, reading the matrix once.
    void (*multiply_two)(const std::int32_t* row_start, const std::int32_t* column, const Real* value, const Real* x, const Real* u, Real* y,
                         Real* v, std::size_t begin, std::size_t end);
    /// x += alpha p, r -= alpha q; returns r . r.
    double (*advance)(Real alpha, const Real* p, const Real* q, Real* x, Real* r, std::size_t begin, std::size_t end);
    /// z = D r with 3x3 blocks D in columns, as in Bsr3::value; returns r . z.
    double (*block_diagonal)(const Real* inverse, const Real* r, Real* z, std::size_t begin, std::size_t end);
    /// p = z + beta p.
    void (*turn)(Real beta, const Real* z, Real* p, std::size_t begin, std::size_t end);
};

template <class Real>
const Bsr3Kernels<Real>& bsr3_kernels(Isa isa);
template <>
const Bsr3Kernels<float>& bsr3_kernels<float>(Isa isa);
template <>
const Bsr3Kernels<double>& bsr3_kernels<double>(Isa isa);

}  // namespace supple::solve
