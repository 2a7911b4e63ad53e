#pragma once
/// Mooney-Rivlin:  W = c1 (Ib1 - 3) + c2 (Ib2 - 3) + K/2 ln^2 J.   Parameters: c1, c2, K [Pa].
/// Small strain: shear modulus 2 (c1 + c2), bulk modulus K. Legal: c1 + c2 > 0, K > 0. Needs J > 0 (extended below, inversion.h).
/// Source: Mooney 1940, Rivlin 1948; isochoric form as in Holzapfel 2000, 6.5.
#include "supple/material/laws/isochoric.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

inline void mooney_rivlin(const Lanes p[], Principal& e) {
    const Isochoric x = isochoric(e.s);
    const Lanes three(3.0);
    fill_isochoric(e, x, p[0] * (x.Ib1 - three) + p[1] * (x.Ib2 - three), p[0], p[1], Lanes(0.0), p[2]);
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
