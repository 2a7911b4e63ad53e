#pragma once
/// Arruda-Boyce:  W = mu sum_{i=1..5} c_i N^(1-i) (Ib1^i - 3^i) + K/2 ln^2 J,  c = 1/2, 1/20, 11/1050, 19/7000, 519/673750,  N = lambda_m^2 = 8.
/// Parameters: mu, K [Pa]. Small strain: shear modulus 1.0851367 mu, bulk modulus K. Legal: mu > 0, K > 0. Needs J > 0 (extended below, inversion.h).
/// Source: Arruda and Boyce 1993, inverse Langevin function to five terms.
#include "supple/material/laws/isochoric.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

inline void arruda_boyce(const Lanes p[], Principal& e) {
    constexpr double kN = 8;
    constexpr double c[5] = {1.0 / 2, 1.0 / 20 / kN, 11.0 / 1050 / (kN * kN), 19.0 / 7000 / (kN * kN * kN), 519.0 / 673750 / (kN * kN * kN * kN)};
    constexpr double power3[5] = {3, 9, 27, 81, 243};
    const Isochoric x = isochoric(e.s);
    Lanes f(0.0), f1(0.0), f11(0.0), power(1.0), lower(0.0);  // Ib1^(i-1), Ib1^(i-2)
    for (int i = 1; i <= 5; ++i) {
        f = f + Lanes(c[i - 1]) * (power * x.Ib1 - Lanes(power3[i - 1]));
        f1 = f1 + Lanes(i * c[i - 1]) * power;
        f11 = f11 + Lanes(i * (i - 1) * c[i - 1]) * lower;
        lower = power;
        power = power * x.Ib1;
    }
    fill_isochoric(e, x, p[0] * f, p[0] * f1, Lanes(0.0), p[0] * f11, p[1]);
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
