#pragma once
/// Costa (Fung-type, orthotropic):  W = a/2 (exp(Qb) - 1) + K (J ln J - J + 1),  Qb = J^-4/3 Q,  Q = sum over i, j of b_ij E_ij^2 in the material frame
/// [f s n]: b_ff E_ff^2 + b_ss E_ss^2 + b_nn E_nn^2 + 2 (b_fs E_fs^2 + b_fn E_fn^2 + b_sn E_sn^2).   Parameters: a, K [Pa]; b_ff b_fs b_ss b_fn b_sn b_nn [1].
/// Small strain: shear moduli G_ij = a b_ij/2, C_ii = a b_ii + K, C_ij = K: K acts as Lame's lambda, and the bulk modulus is K + a (b_ff + b_ss + b_nn)/9; all b
/// equal is isotropic with mu = a b/2. Legal: a > 0, K > 0, every b > 0. Needs J > 0 (extended below stretches of 0.3, tensor_inversion.h). Large exponents: bounded_exponential.h.
/// Source: Costa, Holmes, McCulloch 2001; the isochoric exponent as SOFA's Costa has it. Guccione's law is a = C, b_ff = bf, b_ss = b_nn = b_sn = bt,
/// b_fs = b_fn = bfs at J = 1.
///
/// With m = J^-4/3, c = C^-1, (BE)_ij = b_ij E_ij, X = BE - 2/3 Q c, and e, e', e'' the exponential at Qb with its derivatives:
///     S = a m e' X + K J ln J c
///     D = 2 a m^2 e'' X X + a m e' [B - 4/3 (BE c + c BE) + 8/9 Q c c + 4/3 Q (c o c)] + K J (1 + ln J) c c - 2 K J ln J (c o c)
/// where AB is the dyad A_ij B_kl and (c o c)_ijkl = (c_ik c_jl + c_il c_jk)/2.
#include "supple/material/laws/bounded_exponential.h"
#include "supple/material/laws/tensor.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

/// @param p  a, K, b_ff b_fs b_ss b_fn b_sn b_nn
/// @param F  in the material frame, det F > 0
inline TensorLaw costa(const Lanes p[8], const M3<Lanes>& F) {
    const Lanes one(1.0), half(0.5), two(2.0);
    const Lanes a = p[0], K = p[1], b[6] = {p[2], p[4], p[7], p[3], p[6], p[5]};  // 00 11 22 01 12 20
    Lanes C[6], E[6], BE[6], c[6];
    for (int n = 0; n < 6; ++n) {
        const int i = kSymI[n], j = kSymJ[n];
        C[n] = F.m[0][i] * F.m[0][j] + F.m[1][i] * F.m[1][j] + F.m[2][i] * F.m[2][j];
        E[n] = half * (n < 3 ? C[n] - one : C[n]);
        BE[n] = b[n] * E[n];
    }
    const Lanes Q = E[0] * BE[0] + E[1] * BE[1] + E[2] * BE[2] + two * (E[3] * BE[3] + E[4] * BE[4] + E[5] * BE[5]);
    const Lanes J = F.m[0][0] * (F.m[1][1] * F.m[2][2] - F.m[1][2] * F.m[2][1]) - F.m[0][1] * (F.m[1][0] * F.m[2][2] - F.m[1][2] * F.m[2][0]) +
                    F.m[0][2] * (F.m[1][0] * F.m[2][1] - F.m[1][1] * F.m[2][0]);
    const Lanes inv_J2 = one / (J * J), log_J = logarithm(J), m = exponential(Lanes(-4.0 / 3.0) * log_J);
    c[0] = inv_J2 * (C[1] * C[2] - C[4] * C[4]);
    c[1] = inv_J2 * (C[0] * C[2] - C[5] * C[5]);
    c[2] = inv_J2 * (C[0] * C[1] - C[3] * C[3]);
    c[3] = inv_J2 * (C[4] * C[5] - C[3] * C[2]);
    c[4] = inv_J2 * (C[3] * C[5] - C[4] * C[0]);
    c[5] = inv_J2 * (C[3] * C[4] - C[5] * C[1]);

    const BoundedExponential e = bounded_exponential(m * Q);
    const Lanes volume = K * J * log_J, slope = a * m * e.first;
    TensorLaw law;
    law.W = half * a * (e.value - one) + K * (J * log_J - J + one);
    Lanes X[6];
    for (int n = 0; n < 6; ++n) {
        X[n] = BE[n] - Lanes(2.0 / 3.0) * Q * c[n];
        law.S[n] = slope * X[n] + volume * c[n];
    }
    const Lanes curvature = two * a * m * m * e.second, mixed = Lanes(-4.0 / 3.0) * slope;
    const Lanes dyad = Lanes(8.0 / 9.0) * slope * Q + K * J * (one + log_J), turned = Lanes(4.0 / 3.0) * slope * Q - two * volume;
    for (int n = 0; n < 6; ++n) {
        const int i = kSymI[n], j = kSymJ[n];
        for (int o = n; o < 6; ++o) {
            const int k = kSymI[o], l = kSymJ[o];
            const Lanes coc = half * (c[kSym[i][k]] * c[kSym[j][l]] + c[kSym[i][l]] * c[kSym[j][k]]);
            Lanes d = curvature * X[n] * X[o] + mixed * (BE[n] * c[o] + c[n] * BE[o]) + dyad * c[n] * c[o] + turned * coc;
            if (n == o) d = d + (n < 3 ? slope : half * slope) * b[n];  // dE_ij/dE_ij of a symmetric tensor: a half each way
            law.D[n][o] = law.D[o][n] = d;
        }
    }
    return law;
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
