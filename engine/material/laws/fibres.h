#pragma once
/// One family of fibres, added to any hyperelastic law:  W = k/(2b) (exp(b (I4 - 1)^2) - 1) where I4 > 1, else 0: fibres pull, they never push.
/// I4 = f.C f is the squared stretch of the fibre in the full C (not the isochoric one, so a swelling body stretches its fibres too); f the unit
/// direction at rest. Parameters: k [Pa], b [1]. Small strain: along a stretched fibre Young's modulus grows by 4 k, against compression by nothing; mu
/// and K stay those of the law. Legal: k >= 0, b > 0. Defined for any F. Source: Holzapfel, Gasser, Ogden 2000 (their energy, with I4 of C).
///
/// With a = F f:  P = 2 W4 a f^T,  dP = M dF f f^T,  M = 2 W4 I + 4 W44 a a^T.  W4 >= 0 and W44 >= 0, so M is never indefinite: nothing to project.
#include "supple/math/lane_mat3.h"
#include "supple/material/laws/bounded_exponential.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

struct FibreTerm {
    Lanes W;
    V3<Lanes> traction;  ///< 2 W4 a: P = traction f^T
    Lanes M[6];          ///< 00 11 22 01 12 20
};

/// @param a  F f
inline FibreTerm fibre_term(Lanes k, Lanes b, const V3<Lanes>& a) {
    const Lanes zero(0.0), one(1.0), two(2.0), four(4.0), half(0.5);
    const Lanes x = larger(dot(a, a) - one, zero);
    const LaneMask pulls = x > zero;
    const BoundedExponential e = bounded_exponential(b * x * x);
    // W = k/(2b) (e - 1), W4 = k x e', W44 = k (e' + 2 b x^2 e'')
    const Lanes twice_W4 = two * k * x * e.first;
    const Lanes four_W44 = choose(pulls, four * k * (e.first + two * b * x * x * e.second), zero);
    return {half * k / b * (e.value - one),
            {twice_W4 * a.x, twice_W4 * a.y, twice_W4 * a.z},
            {twice_W4 + four_W44 * a.x * a.x, twice_W4 + four_W44 * a.y * a.y, twice_W4 + four_W44 * a.z * a.z, four_W44 * a.x * a.y, four_W44 * a.y * a.z,
             four_W44 * a.z * a.x}};
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
