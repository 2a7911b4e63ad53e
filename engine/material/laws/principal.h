#pragma once
/// What a hyperelastic law says of one element in its principal frame, F = U diag(s) V^T (signed: s3 < 0 where inverted). A law reads the
/// stretches and its parameters and fills in the energy density, its derivatives, and the two quotients of each pair (i, j):
///     symmetric      (W_i - W_j) / (s_i - s_j)
///     antisymmetric  (W_i + W_j) / (s_i + s_j)
/// which are eigenvalues of d2W/dF2 on the modes U (e_i e_j^T +- e_j e_i^T) V^T / sqrt 2. Written so that equal stretches need no limit.
/// Kernel units only, like math/lanes.h.
#include "supple/math/lane_mat3.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

/// Pairs (0,1), (1,2), (2,0), and the third index of each.
inline constexpr int kPairI[3] = {0, 1, 2}, kPairJ[3] = {1, 2, 0}, kPairK[3] = {2, 0, 1};

struct Principal {
    Lanes s[3];              ///< in
    Lanes W;                 ///< energy density [J/m^3]
    Lanes first[3];          ///< W_i [Pa]
    Lanes second[3][3];      ///< W_ij [Pa]
    Lanes symmetric[3], antisymmetric[3];  ///< per pair [Pa]
};

/// Derivatives of an energy of I1 = tr C, I2 = (I1^2 - tr C^2)/2 and J.
struct InvariantLaw {
    Lanes W, W1, W2, WJ;
    Lanes W11, W22, WJJ, W12, W1J, W2J;
};

struct Invariants {
    Lanes I1, I2, J;
};

inline Invariants invariants(const Lanes s[3]) {
    const Lanes a = s[0] * s[0], b = s[1] * s[1], c = s[2] * s[2];
    return {a + b + c, a * b + b * c + c * a, s[0] * s[1] * s[2]};
}

/// Chain rule to the stretches:  I1_i = 2 s_i,  I2_i = 2 s_i (I1 - s_i^2),  J_i = s_j s_k.
inline void fill(Principal& e, const InvariantLaw& w) {
    const Lanes two(2.0), four(4.0);
    const Lanes I1 = e.s[0] * e.s[0] + e.s[1] * e.s[1] + e.s[2] * e.s[2];
    Lanes a[3], b[3], c[3];
    for (int i = 0; i < 3; ++i) {
        a[i] = two * e.s[i];
        b[i] = a[i] * (I1 - e.s[i] * e.s[i]);
        c[i] = e.s[(i + 1) % 3] * e.s[(i + 2) % 3];
    }
    e.W = w.W;
    for (int i = 0; i < 3; ++i) {
        e.first[i] = w.W1 * a[i] + w.W2 * b[i] + w.WJ * c[i];
        for (int j = i; j < 3; ++j) {
            Lanes h = w.W11 * a[i] * a[j] + w.W22 * b[i] * b[j] + w.WJJ * c[i] * c[j] + w.W12 * (a[i] * b[j] + b[i] * a[j]) +
                      w.W1J * (a[i] * c[j] + c[i] * a[j]) + w.W2J * (b[i] * c[j] + c[i] * b[j]);
            if (i == j) {
                h = h + two * w.W1 + two * w.W2 * (I1 - e.s[i] * e.s[i]);
            } else {
                h = h + four * w.W2 * e.s[i] * e.s[j] + w.WJ * e.s[3 - i - j];
            }
            e.second[i][j] = e.second[j][i] = h;
        }
    }
    for (int p = 0; p < 3; ++p) {
        const Lanes si = e.s[kPairI[p]], sj = e.s[kPairJ[p]], sk = e.s[kPairK[p]];
        const Lanes squares = si * si + sj * sj, product = si * sj;
        e.symmetric[p] = two * w.W1 + two * w.W2 * (I1 - squares - product) - w.WJ * sk;
        e.antisymmetric[p] = two * w.W1 + two * w.W2 * (I1 - squares + product) + w.WJ * sk;
    }
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
