#pragma once
/// Stable Neo-Hookean:  W = mu/2 (I1 - 3) + (lambda + mu)/2 (J - a)^2 - mu^2/(2 (lambda + mu)),  a = 1 + mu/(lambda + mu).   Parameters: mu, lambda [Pa].
/// The Lame parameters are those of small strain (reparametrised): shear modulus mu, bulk modulus lambda + 2 mu/3. Legal: mu > 0, lambda > -2 mu/3.
/// Defined, and restoring, for any F. The constant makes W(I) = 0. Source: Smith, De Goes, Kim, Stable Neo-Hookean Flesh Simulation, 2018 (without the log barrier).
#include "supple/material/laws/principal.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

inline void stable_neo_hookean(const Lanes p[], Principal& e) {
    const Lanes mu = p[0], k = p[1] + p[0], half(0.5);
    const Invariants I = invariants(e.s);
    const Lanes excess = I.J - Lanes(1.0) - mu / k;
    InvariantLaw w{};
    w.W = half * mu * (I.I1 - Lanes(3.0)) + half * k * excess * excess - half * mu * mu / k;
    w.W1 = half * mu;
    w.WJ = k * excess;
    w.WJJ = k;
    w.W2 = w.W11 = w.W22 = w.W12 = w.W1J = w.W2J = Lanes(0.0);
    fill(e, w);
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
