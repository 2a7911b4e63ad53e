#pragma once
/// Carries a tensor law that needs det F > 0 through flat and inverted elements: inversion.h for laws that are not isotropic.
///
/// Below the floor s* = 0.3 the energy goes on from F^ = U diag(t) V^T, t_i = max(s_i, s*), along its tangent, with a spring k:
///     W(F) = W(F^) + P(F^):(F - F^) + k/2 |F - F^|^2
/// F^ is an isotropic function of F: dF^ = L dF, where in the principal frame L takes dF_ii to (0 where clamped, else 1) dF_ii, and of each pair (i, j) the
/// symmetric part to (t_i - t_j)/(s_i - s_j), the antisymmetric to (t_i + t_j)/(s_i + s_j) times itself. L is self-adjoint and L (F - F^) = 0, so
///     P = P(F^) + k (F - F^) + L (C(F^):(F - F^)),      C = dP/dF of the law,
/// exactly the gradient of W. As tangent we take L C L + k (I - L): the spring's part is exact; of the law's, what bends with the third derivatives
/// of W is left out, and so it is positive semidefinite where C is. For elements within the floor only; C itself is exact above it.
#include "supple/material/laws/inversion.h"
#include "supple/material/laws/tensor.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

/// Energy, stress and tangent of a tensor law for any F; second indices in the material frame.
struct TensorResponse {
    Lanes W;
    M3<Lanes> P;
    Lanes C[9][9];  ///< dP/dF, row-major indices; filled only when asked for
};

/// C_iJkL = F_iP D_PJQL F_kQ + d_ik S_JL
inline void fill_stiffness(const TensorLaw& law, const M3<Lanes>& F, Lanes C[9][9]) {
    for (int J = 0; J < 3; ++J) {
        for (int L = J; L < 3; ++L) {
            M3<Lanes> D;  // D_PJQL over P, Q
            for (int P = 0; P < 3; ++P)
                for (int Q = 0; Q < 3; ++Q) D.m[P][Q] = law.D[kSym[P][J]][kSym[Q][L]];
            const M3<Lanes> FD = F * D;
            for (int i = 0; i < 3; ++i) {
                for (int k = 0; k < 3; ++k) {
                    Lanes c = FD.m[i][0] * F.m[k][0] + FD.m[i][1] * F.m[k][1] + FD.m[i][2] * F.m[k][2];
                    if (i == k) c = c + law.S[kSym[J][L]];
                    C[3 * i + J][3 * k + L] = C[3 * k + L][3 * i + J] = c;
                }
            }
        }
    }
}

inline M3<Lanes> times(const Lanes C[9][9], const M3<Lanes>& X) {
    M3<Lanes> Y;
    for (int r = 0; r < 9; ++r) {
        Lanes sum = C[r][0] * X.m[0][0];
        for (int c = 1; c < 9; ++c) sum = sum + C[r][c] * X.m[c / 3][c % 3];
        Y.m[r / 3][r % 3] = sum;
    }
    return Y;
}

/// An isotropic operator on matrices in the frame of U and V: factors of the diagonal and of the symmetric and antisymmetric part of each pair.
struct PrincipalOperator {
    const M3<Lanes>&U, &V;
    Lanes diagonal[3], symmetric[3], antisymmetric[3];

    M3<Lanes> operator()(const M3<Lanes>& X) const {
        const Lanes half(0.5);
        const M3<Lanes> Z = transposed_product(U, X) * V;
        M3<Lanes> Y;
        for (int i = 0; i < 3; ++i) Y.m[i][i] = diagonal[i] * Z.m[i][i];
        for (int p = 0; p < 3; ++p) {
            const int i = kPairI[p], j = kPairJ[p];
            const Lanes even = half * symmetric[p] * (Z.m[i][j] + Z.m[j][i]), odd = half * antisymmetric[p] * (Z.m[i][j] - Z.m[j][i]);
            Y.m[i][j] = even + odd;
            Y.m[j][i] = even - odd;
        }
        const M3<Lanes> T = U * Y;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) Y.m[i][j] = T.m[i][0] * V.m[j][0] + T.m[i][1] * V.m[j][1] + T.m[i][2] * V.m[j][2];
        return Y;
    }
};

struct Clamping {
    Lanes s[3], t[3];
    LaneMask clamped[3], any;
};

inline Clamping clamp_stretches(const Lanes s[3]) {
    const Lanes floor(kExponentialFloor);
    Clamping c{{s[0], s[1], s[2]},
               {larger(s[0], floor), larger(s[1], floor), larger(s[2], floor)},
               {s[0] < floor, s[1] < floor, s[2] < floor},
               s[0] < floor};
    c.any = c.clamped[0] | c.clamped[1] | c.clamped[2];
    return c;
}

/// L of the head of this file.
inline PrincipalOperator clamped_part(const Clamping& c, const M3<Lanes>& U, const M3<Lanes>& V) {
    const Lanes zero(0.0), one(1.0), half(0.5), near(1e-3);
    PrincipalOperator L{U, V, {}, {}, {}};
    for (int i = 0; i < 3; ++i) L.diagonal[i] = choose(c.clamped[i], zero, one);
    for (int p = 0; p < 3; ++p) {
        const int i = kPairI[p], j = kPairJ[p];
        const Lanes difference = c.s[i] - c.s[j], sum = c.s[i] + c.s[j];
        const LaneMask equal = magnitude(difference) < near;
        L.symmetric[p] = choose(equal, half * (L.diagonal[i] + L.diagonal[j]), (c.t[i] - c.t[j]) / choose(equal, one, difference));
        // s_i = -s_j: infinite; bound its denominator away from zero
        L.antisymmetric[p] = (c.t[i] + c.t[j]) / choose(magnitude(sum) < near, choose(sum < zero, zero - near, near), sum);
    }
    return L;
}

/// @param law      F -> TensorLaw, called with det F > 0
/// @param k        stiffness of the spring [Pa]
/// @param U, V, s  signed singular values of F = U diag(s) V^T
/// @param tangent  fill C;  @param positive  made positive semidefinite
template <class Law>
inline TensorResponse tensor_response(Law&& law, Lanes k, const M3<Lanes>& U, const M3<Lanes>& V, const Lanes s[3], const M3<Lanes>& F, bool tangent,
                                      bool positive) {
    const Clamping clamping = clamp_stretches(s);
    const bool any = any_of(clamping.any);
    M3<Lanes> Fh = F;  // F^
    if (any) {
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                Lanes sum(0.0);
                for (int m = 0; m < 3; ++m) sum = sum + clamping.t[m] * U.m[i][m] * V.m[j][m];
                Fh.m[i][j] = choose(clamping.any, sum, F.m[i][j]);
            }
        }
    }
    TensorLaw at = law(Fh);
    TensorResponse r;
    r.W = at.W;
    M3<Lanes> S;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) S.m[i][j] = at.S[kSym[i][j]];
    r.P = Fh * S;
    if (any) {
        const PrincipalOperator L = clamped_part(clamping, U, V);
        M3<Lanes> D;  // F - F^
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) D.m[i][j] = F.m[i][j] - Fh.m[i][j];
        fill_stiffness(at, Fh, r.C);
        const M3<Lanes> bend = L(times(r.C, D));
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                r.W = r.W + D.m[i][j] * (r.P.m[i][j] + Lanes(0.5) * k * D.m[i][j]);
            }
        }
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) r.P.m[i][j] = choose(clamping.any, r.P.m[i][j] + k * D.m[i][j] + bend.m[i][j], r.P.m[i][j]);
    }
    if (!tangent) return r;
    if (positive) project(at);
    fill_stiffness(at, Fh, r.C);
    if (any) {
        const Lanes zero(0.0), one(1.0);
        const PrincipalOperator L = clamped_part(clamping, U, V);
        PrincipalOperator rest = L;  // k (I - L)
        for (int p = 0; p < 3; ++p) {
            for (Lanes* factor : {&rest.diagonal[p], &rest.symmetric[p], &rest.antisymmetric[p]}) {
                *factor = k * (positive ? larger(one - *factor, zero) : one - *factor);
            }
        }
        // L C L from its factors, dE^T D dE + dF S dF: the products of huge numbers that cancel are never formed.
        M3<Lanes> step[9], turned[9], spring[9];
        Lanes strain[9][6], stressed[9][6];
        for (int n = 0; n < 9; ++n) {
            M3<Lanes> unit;
            for (int m = 0; m < 9; ++m) unit.m[m / 3][m % 3] = m == n ? one : zero;
            step[n] = L(unit);
            spring[n] = rest(unit);
            for (int i = 0; i < 3; ++i)
                for (int J = 0; J < 3; ++J) S.m[i][J] = at.S[kSym[i][J]];
            turned[n] = step[n] * S;
            const M3<Lanes> G = transposed_product(Fh, step[n]);
            for (int I = 0; I < 6; ++I) {  // as sum over I of D[.][I] strain[I]: shears count twice
                strain[n][I] = I < 3 ? G.m[I][I] : G.m[kSymI[I]][kSymJ[I]] + G.m[kSymJ[I]][kSymI[I]];
            }
            for (int I = 0; I < 6; ++I) {
                stressed[n][I] = zero;
                for (int K = 0; K < 6; ++K) stressed[n][I] = stressed[n][I] + at.D[I][K] * strain[n][K];
            }
        }
        for (int m = 0; m < 9; ++m) {
            for (int n = m; n < 9; ++n) {
                Lanes sum = Lanes(0.5) * (spring[n].m[m / 3][m % 3] + spring[m].m[n / 3][n % 3]);
                for (int I = 0; I < 6; ++I) sum = sum + strain[m][I] * stressed[n][I];
                for (int i = 0; i < 9; ++i) sum = sum + step[m].m[i / 3][i % 3] * turned[n].m[i / 3][i % 3];
                r.C[m][n] = r.C[n][m] = choose(clamping.any, sum, r.C[m][n]);
            }
        }
    }
    return r;
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
