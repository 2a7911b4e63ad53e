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

template <class Real>
double multiply(const std::int32_t* row_start, const std::int32_t* column, const Real* value, const Real* x, Real* y, std::size_t begin,
                std::size_t end) {
    using R4 = FourOf<Real>;
    double sum = 0;
    for (std::size_t row = begin; row < end; ++row) {
        R4 s0 = {0, 0, 0, 0}, s1 = s0, s2 = s0;  // three chains: an addition's latency is several products long
        const std::int32_t last = row_start[row + 1];
        for (std::int32_t block = row_start[row]; block < last; ++block) {
            const Real* a = value + std::size_t(block) * 12;
            const R4 v = load4(x + std::size_t(column[block]) * 4);
            s0 += load4(a) * splat<0>(v);
            s1 += load4(a + 4) * splat<1>(v);
            s2 += load4(a + 8) * splat<2>(v);
        }
        const R4 s = s0 + s1 + s2;
        store4(y + row * 4, s);
        sum += dot4(load4(x + row * 4), s);
    }
    return sum;
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
inline constexpr Bsr3Kernels<Real> kKernels{multiply<Real>, advance<Real>, block_diagonal<Real>, turn<Real>};

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::solve
