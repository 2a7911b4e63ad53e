#pragma once
/// Neo-Hookean:  W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J.   Parameters: mu, lambda [Pa].
/// Small strain: shear modulus mu, bulk modulus lambda + 2 mu/3. Legal: mu > 0, lambda > -2 mu/3. Needs J > 0 (extended below, inversion.h).
/// Source: Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 1997, 5.4.3.
#include "supple/material/laws/principal.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

inline void neo_hookean(const Lanes p[], Principal& e) {
    const Lanes mu = p[0], lambda = p[1], half(0.5), one(1.0);
    const Invariants I = invariants(e.s);
    const Lanes log_J = logarithm(I.J), inv_J = one / I.J;
    InvariantLaw w{};
    w.W = half * mu * (I.I1 - Lanes(3.0)) - mu * log_J + half * lambda * log_J * log_J;
    w.W1 = half * mu;
    w.WJ = (lambda * log_J - mu) * inv_J;
    w.WJJ = (lambda * (one - log_J) + mu) * inv_J * inv_J;
    w.W2 = w.W11 = w.W22 = w.W12 = w.W1J = w.W2J = Lanes(0.0);
    fill(e, w);
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
