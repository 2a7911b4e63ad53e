#pragma once
/// exp(q) as the exponential laws use it: from q = 30 on it is continued by its Taylor parabola there, so that value, slope and curvature stay
/// continuous, positive and consistent with each other, and a wild configuration gives a huge force instead of an infinite one (float32
/// matrices included). At q = 30 the stress is 1e13 times the law's own modulus: nothing that exists gets there.
#include "supple/math/lanes.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

struct BoundedExponential {
    Lanes value, first, second;  ///< and its first two derivatives
};

inline BoundedExponential bounded_exponential(Lanes q) {
    const Lanes most(30.0), one(1.0), half(0.5), zero(0.0);
    const Lanes over = larger(q - most, zero), e = exponential(smaller(q, most));
    return {e * (one + over + half * over * over), e * (one + over), e};
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
