#pragma once
/// What tetrahedra and hexahedra in a frame share: symmetric tensors, the twist stiffness of the polar factor, plastic flow. Kernel units only.
#include "supple/fem/tet4_lanes.h"
#include "supple/math/lane_eigen.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

constexpr int kVoigtRow[6] = {0, 1, 2, 0, 1, 2}, kVoigtColumn[6] = {0, 1, 2, 1, 2, 0};

/// A symmetric tensor kept as [xx yy zz xy yz zx][lane].
inline Matrix load_symmetric(const double* field) {
    Matrix A;
    for (int c = 0; c < 6; ++c) {
        A.m[kVoigtRow[c]][kVoigtColumn[c]] = A.m[kVoigtColumn[c]][kVoigtRow[c]] = load(field + std::size_t(c) * kBlock);
    }
    return A;
}

/// w of skew(A) = [w]x.
inline Vector axial(const Matrix& A) {
    const Lanes half(0.5);
    return {half * (A.m[2][1] - A.m[1][2]), half * (A.m[0][2] - A.m[2][0]), half * (A.m[1][0] - A.m[0][1])};
}

/// T of tet4_kernels_impl.h, from G = R^T F; mean = lambda tr(S - I), the stress that no shear modulus has part in. Projected: not below zero, and s_i + s_j not below 0.1, where T would grow without bound near inversion.
inline Matrix twist_stiffness(const Matrix& G, Lanes mu, Lanes mean, bool project) {
    const Lanes zero(0.0), two(2.0), half(0.5);
    Matrix S, Q;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) S.m[i][j] = half * (G.m[i][j] + G.m[j][i]);
    symmetric_eigen(S, Q);
    Lanes t[3];
    for (int k = 0; k < 3; ++k) {
        Lanes sum = S.m[(k + 1) % 3][(k + 1) % 3] + S.m[(k + 2) % 3][(k + 2) % 3];
        if (project) sum = larger(sum, Lanes(0.1));
        t[k] = two * mu + two * (mean - two * mu) / sum;
        if (project) t[k] = larger(t[k], zero);
    }
    Matrix T;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) {
            T.m[i][j] = T.m[j][i] = t[0] * Q.m[i][0] * Q.m[j][0] + t[1] * Q.m[i][1] * Q.m[j][1] + t[2] * Q.m[i][2] * Q.m[j][2];
        }
    return T;
}

/// Adds the columns of [a]x^T X [b]x:  (X (b x e_j)) x a.  x: the columns of X.
template <class R4>
inline void add_twist(const R4 x[3], R4 a, R4 b, R4 column[3]) {
    const R4 y[3] = {x[1] * splat<2>(b) - x[2] * splat<1>(b), x[2] * splat<0>(b) - x[0] * splat<2>(b), x[0] * splat<1>(b) - x[1] * splat<0>(b)};
    for (int j = 0; j < 3; ++j) {
        column[j] += R4{y[j][1] * a[2] - y[j][2] * a[1], y[j][2] * a[0] - y[j][0] * a[2], y[j][0] * a[1] - y[j][1] * a[0], 0};
    }
}

/// Plastic flow (Tet4Flow) of the elements in the lanes. G = R^T F; parameter: yield, cap, flow; plastic: in and out.
inline void flow_strain(const Matrix& G, const double* parameter, double* plastic) {
    const Lanes zero(0.0), one(1.0), half(0.5), third(1.0 / 3.0), tiny(1e-150);
    const Lanes yield = load(parameter), cap = load(parameter + kBlock), rate = load(parameter + 2 * kBlock);
    const Matrix before = load_symmetric(plastic);
    const Lanes mean = third * (G.m[0][0] + G.m[1][1] + G.m[2][2]);
    Lanes e[6], square = zero;
    for (int c = 0; c < 6; ++c) {
        const int i = kVoigtRow[c], j = kVoigtColumn[c];
        e[c] = half * (G.m[i][j] + G.m[j][i]) - before.m[i][j];
        if (i == j) e[c] = e[c] - mean;
        square = square + (i == j ? one : Lanes(2.0)) * e[c] * e[c];
    }
    const Lanes norm = root(square), factor = rate * larger(norm - yield, zero) / larger(norm, tiny);
    square = zero;
    for (int c = 0; c < 6; ++c) {
        e[c] = before.m[kVoigtRow[c]][kVoigtColumn[c]] + factor * e[c];
        square = square + (c < 3 ? one : Lanes(2.0)) * e[c] * e[c];
    }
    const Lanes size = root(square), shrink = choose(size > cap, cap / larger(size, tiny), one);
    for (int c = 0; c < 6; ++c) store(plastic + std::size_t(c) * kBlock, shrink * e[c]);
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
