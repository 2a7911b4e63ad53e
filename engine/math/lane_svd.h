#pragma once
/// Rotation of the signed singular value decomposition in every lane, without a starting guess.
///
/// V from the eigenvectors of F^T F (cyclic Jacobi), singular values descending; the columns of F V are orthogonal, so U is found by normalising the first,
/// orthonormalising the second, and u3 = u1 x u2: det U = det V = +1 by construction and an inverted F gets a negative third singular value
/// (Irving, Teran, Fedkiw 2004). R = U V^T is the closest rotation to F.
#include "supple/math/lane_mat3.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

/// One Jacobi turn that zeroes S[p][q]; V gathers the turns.
template <int p, int q, class T>
inline void jacobi_turn(M3<T>& S, M3<T>& V) {
    constexpr int r = 3 - p - q;
    const T one(1.0), two(2.0), zero(0.0), tiny(1e-300);
    const T apq = S.m[p][q], difference = S.m[q][q] - S.m[p][p];
    // t = tan of the turn: the smaller root of t^2 + 2 tau t - 1 = 0, tau = difference / (2 apq), written without dividing by apq.
    const T hypotenuse = root(difference * difference + two * two * apq * apq);
    const T denominator = magnitude(difference) + hypotenuse;
    const T sign = choose(difference < zero, T(-1.0), one);
    const T t = sign * two * apq / larger(denominator, tiny);
    const T c = one / root(one + t * t), s = t * c;
    S.m[p][p] = S.m[p][p] - t * apq;
    S.m[q][q] = S.m[q][q] + t * apq;
    S.m[p][q] = S.m[q][p] = zero;
    const T rp = S.m[r][p], rq = S.m[r][q];
    S.m[r][p] = S.m[p][r] = c * rp - s * rq;
    S.m[r][q] = S.m[q][r] = s * rp + c * rq;
    for (int i = 0; i < 3; ++i) {
        const T vp = V.m[i][p], vq = V.m[i][q];
        V.m[i][p] = c * vp - s * vq;
        V.m[i][q] = s * vp + c * vq;
    }
}

/// Eigenvectors of a symmetric S as columns of V, det V = +1; S becomes diagonal. Five sweeps reach rounding from any start.
template <class T>
inline void jacobi_eigen(M3<T>& S, M3<T>& V) {
    const T one(1.0), zero(0.0);
    V = {{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}};
    for (int sweep = 0; sweep < 5; ++sweep) {
        jacobi_turn<0, 1>(S, V);
        jacobi_turn<0, 2>(S, V);
        jacobi_turn<1, 2>(S, V);
    }
}

/// Swaps columns p and q (with a sign, so that det V stays) where the eigenvalue of q is the larger.
template <int p, int q, class T>
inline void order_columns(V3<T>& values, M3<T>& V) {
    T* value[3] = {&values.x, &values.y, &values.z};
    const LaneMask swap = *value[q] > *value[p];
    const T a = *value[p], b = *value[q];
    *value[p] = choose(swap, b, a);
    *value[q] = choose(swap, a, b);
    for (int i = 0; i < 3; ++i) {
        const T vp = V.m[i][p], vq = V.m[i][q];
        V.m[i][p] = choose(swap, vq, vp);
        V.m[i][q] = choose(swap, T(0.0) - vp, vq);
    }
}

template <class T>
inline V3<T> column(const M3<T>& A, int j) { return {A.m[0][j], A.m[1][j], A.m[2][j]}; }

/// Any vector across the unit vector u.
template <class T>
inline V3<T> across(const V3<T>& u) {
    const T zero(0.0);
    const LaneMask x_small = magnitude(u.x) < T(0.6);
    return {choose(x_small, zero, T(0.0) - u.y), choose(x_small, u.z, u.x), choose(x_small, T(0.0) - u.y, zero)};
}

/// Rotation U V^T of F = U diag(s) V^T; the identity for F = 0.
template <class T>
inline M3<T> svd_rotation(const M3<T>& F) {
    const T tiny(1e-150), one(1.0);
    T size(0.0);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) size = larger(size, magnitude(F.m[i][j]));
    const T inv_size = one / larger(size, tiny);
    M3<T> A;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) A.m[i][j] = inv_size * F.m[i][j];
    M3<T> S = transposed_product(A, A), V;
    jacobi_eigen(S, V);
    V3<T> values{S.m[0][0], S.m[1][1], S.m[2][2]};
    order_columns<0, 1>(values, V);
    order_columns<1, 2>(values, V);
    order_columns<0, 1>(values, V);

    const V3<T> b0 = A * column(V, 0), b1 = A * column(V, 1);
    const T n0 = root(dot(b0, b0));
    const LaneMask dead = n0 < T(1e-100);
    const V3<T> v0 = column(V, 0);
    const T inv0 = one / larger(n0, tiny);
    const V3<T> u0{choose(dead, v0.x, inv0 * b0.x), choose(dead, v0.y, inv0 * b0.y), choose(dead, v0.z, inv0 * b0.z)};
    V3<T> u1 = b1 - dot(u0, b1) * u0;
    const LaneMask flat = root(dot(u1, u1)) < T(1e-12);
    const V3<T> other = choose3(dead, column(V, 1), across(u0));
    u1 = choose3(flat, other, u1);
    u1 = u1 - dot(u0, u1) * u0;
    u1 = (one / larger(root(dot(u1, u1)), tiny)) * u1;
    const V3<T> u2 = cross(u0, u1);
    M3<T> R;
    const V3<T> u[3] = {u0, u1, u2};
    for (int j = 0; j < 3; ++j) {
        R.m[0][j] = u[0].x * V.m[j][0] + u[1].x * V.m[j][1] + u[2].x * V.m[j][2];
        R.m[1][j] = u[0].y * V.m[j][0] + u[1].y * V.m[j][1] + u[2].y * V.m[j][2];
        R.m[2][j] = u[0].z * V.m[j][0] + u[1].z * V.m[j][1] + u[2].z * V.m[j][2];
    }
    return R;
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
