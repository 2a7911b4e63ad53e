#pragma once
/// Ogden:  W = sum over terms (mu/a^2) (sum_i sb_i^a - 3) + K/2 ln^2 J,  sb_i = J^-1/3 s_i.   Parameters: mu, a of a term; K [Pa].
/// Small strain: shear modulus sum of mu/2, bulk modulus K. Legal: sum mu > 0, a not 0, K > 0. Needs s_i > 0 (extended below, inversion.h).
/// Source: Ogden 1972. With x_i = sb_i^a, M = sum x, g_i = x_i - M/3:
///     W_i  = (mu/a) g_i/s_i + K ln J/s_i
///     W_ij = (mu/(s_i s_j)) [d_ij x_i - (x_i + x_j)/3 + M/9] + K/(s_i s_j) - d_ij [(mu/a) g_i + K ln J]/s_i^2
/// The symmetric quotient needs (x_i/s_i - x_j/s_j)/(s_i - s_j); with L = ln(s_i/s_j) it is x_j/(s_i s_j) ((e^(aL) - 1) - (e^L - 1))/(e^L - 1),
/// and (e^(aL) - 1)/(e^L - 1) tends to a.
#include "supple/material/laws/principal.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

/// One term added to e; the volumetric part comes with ogden_volume.
inline void ogden_term(Lanes mu, Lanes a, Principal& e) {
    const Lanes one(1.0), third(1.0 / 3.0), ninth(1.0 / 9.0), half(0.5), two(2.0);
    Lanes log_s[3], x[3];
    for (int i = 0; i < 3; ++i) log_s[i] = logarithm(e.s[i]);
    const Lanes mean = third * (log_s[0] + log_s[1] + log_s[2]);
    for (int i = 0; i < 3; ++i) x[i] = exponential(a * (log_s[i] - mean));
    const Lanes M = x[0] + x[1] + x[2], b = mu / a;
    e.W = e.W + (b / a) * (M - Lanes(3.0));
    Lanes g[3];
    for (int i = 0; i < 3; ++i) {
        g[i] = b * (x[i] - third * M);
        e.first[i] = e.first[i] + g[i] / e.s[i];
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            Lanes h = mu * (ninth * M - third * (x[i] + x[j]));
            if (i == j) h = h + mu * x[i] - g[i];
            e.second[i][j] = e.second[i][j] + h / (e.s[i] * e.s[j]);
        }
    }
    for (int p = 0; p < 3; ++p) {
        const int i = kPairI[p], j = kPairJ[p];
        const Lanes L = log_s[i] - log_s[j], inv = one / (e.s[i] * e.s[j]);
        // (x_i s_j - x_j s_i)/(s_i - s_j) = x_j (q - 1), q = (e^(aL) - 1)/(e^L - 1) = a (1 + (a-1)L/2 + (a-1)(2a-1)L^2/12 + ...)
        const LaneMask close = magnitude(L) < Lanes(1e-4);
        const Lanes series = a * (one + half * (a - one) * L + (one / Lanes(12.0)) * (a - one) * (two * a - one) * L * L);
        const Lanes safe = choose(close, one, L);
        const Lanes q = choose(close, series, (exponential(a * safe) - one) / (exponential(safe) - one));
        // (g_i/s_i - g_j/s_j)/(s_i - s_j) = b/(s_i s_j) [x_j (q - 1) + M/3]
        e.symmetric[p] = e.symmetric[p] + b * inv * (x[j] * (q - one) + third * M);
        e.antisymmetric[p] = e.antisymmetric[p] + (g[i] * e.s[j] + g[j] * e.s[i]) * inv / (e.s[i] + e.s[j]);
    }
}

/// Sets e to K/2 ln^2 J.
inline void ogden_volume(Lanes bulk, Principal& e) {
    const Lanes one(1.0);
    const Lanes J = e.s[0] * e.s[1] * e.s[2], log_J = logarithm(J), inv_J = one / J;
    InvariantLaw w{};
    w.W = Lanes(0.5) * bulk * log_J * log_J;
    w.WJ = bulk * log_J * inv_J;
    w.WJJ = bulk * (one - log_J) * inv_J * inv_J;
    w.W1 = w.W2 = w.W11 = w.W22 = w.W12 = w.W1J = w.W2J = Lanes(0.0);
    fill(e, w);
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
