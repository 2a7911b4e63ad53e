#pragma once
/// Veronda-Westman:  W = c1 (exp(c2 (Ib1 - 3)) - 1) - c1 c2/2 (Ib2 - 3) + K/2 ln^2 J.   Parameters: c1 [Pa], c2 [1], K [Pa].
/// Small strain: shear modulus c1 c2, bulk modulus K. Legal: c1 > 0, c2 > 0, K > 0. Needs J > 0 (extended below stretches of 0.3, inversion.h). Large
/// exponents: bounded_exponential.h. Source: Veronda and Westmann 1970.
#include "supple/material/laws/bounded_exponential.h"
#include "supple/material/laws/isochoric.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

inline void veronda_westman(const Lanes p[], Principal& e) {
    const Isochoric x = isochoric(e.s);
    const Lanes three(3.0), c1 = p[0], c2 = p[1];
    const BoundedExponential growth = bounded_exponential(c2 * (x.Ib1 - three));
    fill_isochoric(e, x, c1 * (growth.value - Lanes(1.0)) - Lanes(0.5) * c1 * c2 * (x.Ib2 - three), c1 * c2 * growth.first, Lanes(-0.5) * c1 * c2,
                   c1 * c2 * c2 * growth.second, p[2]);
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
