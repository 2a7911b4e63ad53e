#pragma once
/// St. Venant-Kirchhoff:  W = lambda/2 (tr E)^2 + mu tr E^2,  E = (C - I)/2.   Parameters: mu, lambda [Pa].
/// Small strain: shear modulus mu, bulk modulus lambda + 2 mu/3. Legal: mu > 0, lambda > -2 mu/3. Softens to nothing under compression: the force
/// goes through zero at an edge of 0.58 of its length. Defined for any F. Source: Holzapfel, Nonlinear Solid Mechanics, 2000, 6.5.
#include "supple/material/laws/principal.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

/// tr E = (I1 - 3)/2 and tr E^2 = (I1^2 - 2 I2 - 2 I1 + 3)/4.
inline void st_venant_kirchhoff(const Lanes p[], Principal& e) {
    const Lanes mu = p[0], lambda = p[1], half(0.5), quarter(0.25), one(1.0), three(3.0);
    const Invariants I = invariants(e.s);
    const Lanes t = half * (I.I1 - three);
    InvariantLaw w{};
    w.W = half * lambda * t * t + quarter * mu * (I.I1 * I.I1 - Lanes(2.0) * I.I2 - Lanes(2.0) * I.I1 + three);
    w.W1 = half * lambda * t + half * mu * (I.I1 - one);
    w.W2 = Lanes(-0.5) * mu;
    w.W11 = quarter * lambda + half * mu;
    w.WJ = w.W22 = w.WJJ = w.W12 = w.W1J = w.W2J = Lanes(0.0);
    fill(e, w);
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
