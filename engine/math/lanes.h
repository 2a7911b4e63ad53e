#pragma once
/// The lane type of the kernels. A kernel unit defines SUPPLE_ISA (a namespace name) before it includes this, and is compiled with
/// the flags of that instruction set; `Lanes` is then the widest batch of doubles, or plain double for the scalar oracle.
/// Everything here lives in an inline namespace named after the instruction set, and unnamed inside it: no two units share a symbol,
/// and no function compiled for a wide machine can be picked by the linker for a narrow one.
#ifndef SUPPLE_ISA
#error "only kernel units include this: define SUPPLE_ISA first"
#endif

#if defined(SUPPLE_SCALAR_LANES)
#include <cmath>
#else
#include <xsimd/xsimd.hpp>
#endif

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

#if defined(SUPPLE_SCALAR_LANES)

using Lanes = double;
using LaneMask = bool;
inline constexpr int kLanes = 1;

inline Lanes load(const double* p) { return *p; }
inline void store(double* p, Lanes x) { *p = x; }
inline Lanes root(Lanes x) { return std::sqrt(x); }
inline Lanes smaller(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes larger(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes magnitude(Lanes x) { return std::fabs(x); }
inline Lanes choose(LaneMask m, Lanes yes, Lanes no) { return m ? yes : no; }
inline bool any_of(LaneMask m) { return m; }
inline Lanes logarithm(Lanes x) { return std::log(x); }
inline Lanes exponential(Lanes x) { return std::exp(x); }

using Floats = float;
inline Floats to_floats(Lanes x) { return float(x); }

#else

using Lanes = xsimd::batch<double>;
using LaneMask = Lanes::batch_bool_type;
inline constexpr int kLanes = int(Lanes::size);

inline Lanes load(const double* p) { return Lanes::load_aligned(p); }
inline void store(double* p, Lanes x) { x.store_aligned(p); }
inline Lanes root(Lanes x) { return xsimd::sqrt(x); }
inline Lanes smaller(Lanes a, Lanes b) { return xsimd::min(a, b); }
inline Lanes larger(Lanes a, Lanes b) { return xsimd::max(a, b); }
inline Lanes magnitude(Lanes x) { return xsimd::abs(x); }
inline Lanes choose(LaneMask m, Lanes yes, Lanes no) { return xsimd::select(m, yes, no); }
inline bool any_of(LaneMask m) { return xsimd::any(m); }
inline Lanes logarithm(Lanes x) { return xsimd::log(x); }
inline Lanes exponential(Lanes x) { return xsimd::exp(x); }

/// As many floats: half a register, for what is stored as float32 in the end.
typedef float Floats __attribute__((vector_size(4 * kLanes)));
inline Floats to_floats(const Lanes& x) {
    typedef double Doubles __attribute__((vector_size(8 * kLanes)));
    return __builtin_convertvector((Doubles)x.data, Floats);
}

#endif

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
