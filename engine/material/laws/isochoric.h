#pragma once
/// Laws W = f(Ib1, Ib2) + K/2 ln^2 J of the isochoric invariants Ib1 = J^-2/3 I1, Ib2 = J^-4/3 I2. Needs J > 0.
#include "supple/material/laws/principal.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

struct Isochoric {
    Lanes Ib1, Ib2, log_J;
    Lanes m, n, inv_J;  ///< J^-2/3, J^-4/3, 1/J
};

inline Isochoric isochoric(const Lanes s[3]) {
    const Invariants I = invariants(s);
    Isochoric x;
    x.log_J = logarithm(I.J);
    x.inv_J = Lanes(1.0) / I.J;
    x.m = exponential(Lanes(-2.0 / 3.0) * x.log_J);
    x.n = x.m * x.m;
    x.Ib1 = x.m * I.I1;
    x.Ib2 = x.n * I.I2;
    return x;
}

/// f and its derivatives f1, f2, f11 by Ib1 and Ib2 (no law here has f12 or f22), with the volumetric term.
inline void fill_isochoric(Principal& e, const Isochoric& x, Lanes f, Lanes f1, Lanes f2, Lanes f11, Lanes bulk) {
    const Lanes half(0.5), one(1.0);
    const Lanes Ib1_J = Lanes(-2.0 / 3.0) * x.Ib1 * x.inv_J, Ib2_J = Lanes(-4.0 / 3.0) * x.Ib2 * x.inv_J;
    const Lanes inv_J2 = x.inv_J * x.inv_J;
    InvariantLaw w;
    w.W = f + half * bulk * x.log_J * x.log_J;
    w.W1 = f1 * x.m;
    w.W2 = f2 * x.n;
    w.WJ = f1 * Ib1_J + f2 * Ib2_J + bulk * x.log_J * x.inv_J;
    w.W11 = f11 * x.m * x.m;
    w.W22 = w.W12 = Lanes(0.0);
    w.W1J = f11 * x.m * Ib1_J - Lanes(2.0 / 3.0) * f1 * x.m * x.inv_J;
    w.W2J = Lanes(-4.0 / 3.0) * f2 * x.n * x.inv_J;
    w.WJJ = f11 * Ib1_J * Ib1_J + Lanes(10.0 / 9.0) * f1 * x.Ib1 * inv_J2 + Lanes(28.0 / 9.0) * f2 * x.Ib2 * inv_J2 +
            bulk * (one - x.log_J) * inv_J2;
    fill(e, w);
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
