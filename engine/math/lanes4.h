#pragma once
/// Four numbers side by side, x y z and a pad: the shape of a vertex and of a block column. GCC's and Clang's vector type, which
/// becomes one SSE, AVX or NEON register or two, as the unit's instruction set allows. Kernel units only, like lanes.h.
#ifndef SUPPLE_ISA
#error "only kernel units include this: define SUPPLE_ISA first"
#endif

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

typedef float Float4 __attribute__((vector_size(16)));
typedef double Double4 __attribute__((vector_size(32)));

template <class Real>
struct Four;
template <>
struct Four<float> {
    using type = Float4;
};
template <>
struct Four<double> {
    using type = Double4;
};
template <class Real>
using FourOf = typename Four<Real>::type;

/// Aligned to sixteen bytes (float) or thirty-two (double).
template <class Real>
inline FourOf<Real> load4(const Real* p) { return *reinterpret_cast<const FourOf<Real>*>(p); }
template <class Real>
inline void store4(Real* p, FourOf<Real> v) { *reinterpret_cast<FourOf<Real>*>(p) = v; }

template <int i, class V>
inline V splat(V v) { return __builtin_shufflevector(v, v, i, i, i, i); }

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
