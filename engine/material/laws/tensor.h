#pragma once
/// What a law that is not isotropic says of one element: stress and stiffness as tensors in its material frame, with F' = F Q0, Q0 = [f s n].
/// Symmetric tensors are six numbers in the order 00 11 22 01 12 20.
#include "supple/math/lane_eigen.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

inline constexpr int kSymI[6] = {0, 1, 2, 0, 1, 2}, kSymJ[6] = {0, 1, 2, 1, 2, 0};
inline constexpr int kSym[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};  ///< place of (i, j)

struct TensorLaw {
    Lanes W;        ///< energy density [J/m^3]
    Lanes S[6];     ///< second Piola-Kirchhoff stress dW/dE [Pa]
    Lanes D[6][6];  ///< dS/dE: D[I][J] = dS_ij/dE_kl, the plain components [Pa]
};

/// Eigenvectors of a symmetric 6x6 as columns of Q, its eigenvalues left on the diagonal of A: cyclic Jacobi.
[[gnu::noinline, gnu::cold]] inline void jacobi_eigen6(Lanes A[6][6], Lanes Q[6][6]) {
    const Lanes one(1.0), two(2.0), zero(0.0), tiny(1e-300);
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) Q[i][j] = i == j ? one : zero;
    for (int sweep = 0; sweep < 8; ++sweep) {
        for (int p = 0; p < 5; ++p) {
            for (int q = p + 1; q < 6; ++q) {
                // as jacobi_turn (math/lane_svd.h)
                const Lanes apq = A[p][q], difference = A[q][q] - A[p][p];
                const Lanes denominator = magnitude(difference) + root(difference * difference + two * two * apq * apq);
                const Lanes t = choose(difference < zero, Lanes(-2.0), two) * apq / larger(denominator, tiny);
                const Lanes c = one / root(one + t * t), s = t * c;
                A[p][p] = A[p][p] - t * apq;
                A[q][q] = A[q][q] + t * apq;
                A[p][q] = A[q][p] = zero;
                for (int r = 0; r < 6; ++r) {
                    if (r != p && r != q) {
                        const Lanes rp = A[r][p], rq = A[r][q];
                        A[r][p] = A[p][r] = c * rp - s * rq;
                        A[r][q] = A[q][r] = s * rp + c * rq;
                    }
                    const Lanes vp = Q[r][p], vq = Q[r][q];
                    Q[r][p] = c * vp - s * vq;
                    Q[r][q] = s * vp + c * vq;
                }
            }
        }
        Lanes off = zero, on = zero;
        for (int i = 0; i < 6; ++i) {
            on = on + A[i][i] * A[i][i];
            for (int j = 0; j < i; ++j) off = off + A[i][j] * A[i][j];
        }
        if (!any_of(off > Lanes(1e-32) * on)) break;
    }
}

/// True in the lanes where a symmetric 6x6 is safely positive definite: its LDL^T has pivots above 1e-12 of its largest diagonal entry.
inline LaneMask is_positive6(const Lanes A[6][6]) {
    Lanes L[6][6], largest = A[0][0];
    for (int i = 1; i < 6; ++i) largest = larger(largest, A[i][i]);
    const Lanes least = Lanes(1e-12) * magnitude(largest);
    LaneMask good = largest > Lanes(0.0);
    for (int j = 0; j < 6; ++j) {
        Lanes pivot = A[j][j];
        for (int k = 0; k < j; ++k) pivot = pivot - L[j][k] * L[j][k] * L[k][k];
        good = good & (pivot > least);
        L[j][j] = pivot;
        const Lanes inv = Lanes(1.0) / choose(good, pivot, Lanes(1.0));
        for (int i = j + 1; i < 6; ++i) {
            Lanes sum = A[i][j];
            for (int k = 0; k < j; ++k) sum = sum - L[i][k] * L[j][k] * L[k][k];
            L[i][j] = inv * sum;
        }
    }
    return good;
}

/// Makes dP = F (D : sym(F^T dF)) + dF S positive semidefinite for any F: negative eigenvalues of D and of S are set to zero. Sufficient, not
/// necessary: where one part is negative and the sum is not, some true stiffness is lost, never stability. D is clamped in Mandel's scaling (root 2 on
/// the shears), in which a rotation of the axes is orthogonal: so the result does not depend on the axes.
inline void project(TensorLaw& law) {
    const Lanes zero(0.0), one(1.0), root2(1.4142135623730951);
    const auto scale = [&](int i) { return i < 3 ? one : root2; };
    Lanes A[6][6];
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) A[i][j] = scale(i) * scale(j) * law.D[i][j];
    const LaneMask keep = is_positive6(A);
    if (any_of(!keep)) {
        Lanes Q[6][6];
        jacobi_eigen6(A, Q);
        for (int i = 0; i < 6; ++i) {
            for (int j = i; j < 6; ++j) {
                Lanes sum = zero;
                for (int k = 0; k < 6; ++k) sum = sum + larger(A[k][k], zero) * Q[i][k] * Q[j][k];
                sum = sum / (scale(i) * scale(j));
                law.D[i][j] = law.D[j][i] = choose(keep, law.D[i][j], sum);
            }
        }
    }
    M3<Lanes> S, V;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) S.m[i][j] = law.S[kSym[i][j]];
    symmetric_eigen(S, V);
    for (int n = 0; n < 6; ++n) {
        law.S[n] = zero;
        for (int k = 0; k < 3; ++k) law.S[n] = law.S[n] + larger(S.m[k][k], zero) * V.m[kSymI[n]][k] * V.m[kSymJ[n]][k];
    }
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
