#pragma once
/// Rotation of the polar decomposition, det R = +1, from a warm start, in every lane.
///
/// R maximises f(R) = tr(R^T F) over the rotations. In unit quaternions f is a quadratic form, so it has no local maximum but the
/// global one (for inverted F: the closest rotation): any ascent gets there. With G = R^T F, S = sym(G), a turn R exp([w]x) gives
///     f = tr G + a.w - 1/2 w.H w + O(w^3),     a = axial(G - G^T),  H = tr(S) I - S,
/// so Newton's turn is H w = a. H has the eigenvalues s_i + s_j at the optimum. Far from it we add |a|^2 / (2|F|) I (for a plain rotation by
/// t this makes the denominators 2 cos t + O(sin^2 t), which lands within a few degrees from 90), and where H is not positive definite
/// a Gershgorin shift makes it so. w is applied through the Cayley quaternion (1, w/2), whose turn is bounded by 180 degrees and equals
/// exp([w]x) to third order: convergence is quadratic from a warm start.
///
/// A half turn away a vanishes at a minimum or a saddle, and near one the turns are short: Newton may creep or stand still there. Lanes that have not
/// come to a maximum (H positive definite) are started again from the dominant eigenvector of the quadratic form, which knows no bad starts.
///
/// Near the answer no turns are needed at all (near_turn): in the frame of the start the quadratic form is [tr G, a^T; a, 2 S - tr(G) I], its greatest eigenvalue
/// tr G + d with d small, and the rest of the eigenvector (1, t) follows from (M + d I) t = a, M = 2 H. What remains is a quartic for d,
///     d det(M + d I) = a . adj(M + d I) a,
/// whose coefficients lose no digits by cancellation however small the turn is; from d = 0 three turns of Newton's leave d no error that counts.
#include "supple/math/lane_mat3.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

inline constexpr int kMaxPolarTurns = 12;
inline constexpr int kMaxPolishTurns = 20;     ///< after a fresh start; nearly degenerate maxima are flat
inline constexpr int kPolarSquarings = 22;     ///< the ratio of two eigenvalues to the power of four million

/// One turn of Newton's. @return the lanes that have arrived: the next turn would be below 1e-15, and H is positive definite
template <class T>
inline LaneMask polar_turn(const M3<T>& A, Quat<T>& q, M3<T>& R, LaneMask& moving) {
    const T tiny(1e-150), half(0.5), one(1.0), zero(0.0);
    const M3<T> G = transposed_product(R, A);
    const V3<T> a{G.m[2][1] - G.m[1][2], G.m[0][2] - G.m[2][0], G.m[1][0] - G.m[0][1]};
    const T aa = dot(a, a);
    const T off01 = half * (G.m[0][1] + G.m[1][0]), off02 = half * (G.m[0][2] + G.m[2][0]), off12 = half * (G.m[1][2] + G.m[2][1]);
    const T damp = half * aa;
    T h00 = G.m[1][1] + G.m[2][2] + damp, h11 = G.m[0][0] + G.m[2][2] + damp, h22 = G.m[0][0] + G.m[1][1] + damp;
    // Positive definite by leading minors; otherwise shift by Gershgorin's bound.
    const T floor(1e-6);
    const T minor2 = h00 * h11 - off01 * off01;
    const T det = h22 * minor2 - h00 * off12 * off12 - h11 * off02 * off02 - T(2.0) * off01 * off02 * off12;
    const T b01 = magnitude(off01), b02 = magnitude(off02), b12 = magnitude(off12);
    const T bound = smaller(smaller(h00 - b01 - b02, h11 - b01 - b12), h22 - b02 - b12);
    const LaneMask good = (h00 > floor) & (minor2 > floor * floor) & (det > floor * floor * floor);
    const T shift = choose(good, zero, larger(zero, T(1e-2) - bound));
    h00 = h00 + shift;
    h11 = h11 + shift;
    h22 = h22 + shift;
    // w = H^-1 a by the adjugate; H holds -S off the diagonal.
    const T c00 = h11 * h22 - off12 * off12, c01 = off02 * off12 + off01 * h22, c02 = off01 * off12 + off02 * h11;
    const T c11 = h00 * h22 - off02 * off02, c12 = off01 * off02 + off12 * h00, c22 = h00 * h11 - off01 * off01;
    const T inv_det = one / larger(h00 * c00 - off01 * c01 - off02 * c02, tiny);
    const T scale = half * inv_det;  // w/2
    const V3<T> t{scale * (c00 * a.x + c01 * a.y + c02 * a.z), scale * (c01 * a.x + c11 * a.y + c12 * a.z),
                  scale * (c02 * a.x + c12 * a.y + c22 * a.z)};
    // q <- q (1, t), renormalised.
    const Quat<T> p{q.w - q.x * t.x - q.y * t.y - q.z * t.z, q.x + q.w * t.x + q.y * t.z - q.z * t.y,
                    q.y + q.w * t.y + q.z * t.x - q.x * t.z, q.z + q.w * t.z + q.x * t.y - q.y * t.x};
    const T inv = one / root(p.w * p.w + p.x * p.x + p.y * p.y + p.z * p.z);
    q = {inv * p.w, inv * p.x, inv * p.y, inv * p.z};
    R = rotation_matrix(q);
    const T size = dot(t, t);
    moving = size > T(1e-16);
    return good & (size <= T(1e-16));
}

/// Unit quaternion that maximises tr(R(q)^T A) to about five digits, |A| = 1: Davenport's matrix (math/polar.h), shifted to be positive and
/// squared again and again, tends to the projector on its dominant eigenvectors; the longest column is one of them.
template <class T>
inline Quat<T> dominant_quaternion(const M3<T>& A) {
    const T two(2.0), one(1.0);
    const auto& m = A.m;
    T B[4][4];
    B[0][0] = two + m[0][0] + m[1][1] + m[2][2];
    B[1][1] = two + m[0][0] - m[1][1] - m[2][2];
    B[2][2] = two + m[1][1] - m[0][0] - m[2][2];
    B[3][3] = two + m[2][2] - m[0][0] - m[1][1];
    B[0][1] = m[2][1] - m[1][2];
    B[0][2] = m[0][2] - m[2][0];
    B[0][3] = m[1][0] - m[0][1];
    B[1][2] = m[0][1] + m[1][0];
    B[1][3] = m[0][2] + m[2][0];
    B[2][3] = m[1][2] + m[2][1];
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < i; ++j) B[i][j] = B[j][i];
    for (int squaring = 0; squaring < kPolarSquarings; ++squaring) {
        const T scale = one / (B[0][0] + B[1][1] + B[2][2] + B[3][3]);
        T C[4][4];
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) C[i][j] = scale * B[i][j];
        for (int i = 0; i < 4; ++i) {
            for (int j = i; j < 4; ++j) {
                B[i][j] = C[i][0] * C[0][j] + C[i][1] * C[1][j] + C[i][2] * C[2][j] + C[i][3] * C[3][j];
                B[j][i] = B[i][j];
            }
        }
    }
    T longest = B[0][0];
    Quat<T> q{B[0][0], B[1][0], B[2][0], B[3][0]};
    for (int i = 1; i < 4; ++i) {
        const LaneMask longer = B[i][i] > longest;
        longest = choose(longer, B[i][i], longest);
        q = {choose(longer, B[0][i], q.w), choose(longer, B[1][i], q.x), choose(longer, B[2][i], q.y), choose(longer, B[3][i], q.z)};
    }
    const T inv = one / root(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return {inv * q.w, inv * q.x, inv * q.y, inv * q.z};
}

/// tr(A^T B)
template <class T>
inline T inner_product(const M3<T>& A, const M3<T>& B) {
    T sum(0.0);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) sum = sum + A.m[i][j] * B.m[i][j];
    return sum;
}

/// The rare lanes that the first turns left behind: from a fresh start where that is better, then polished. Kept out of the hot loop.
template <class T>
[[gnu::noinline, gnu::cold]] void finish_polar(const M3<T>& A, Quat<T>& q, M3<T>& R, const LaneMask& arrived) {
    // A lane keeps its own answer unless the fresh start is better: flat and collapsed elements have many equally good ones.
    const Quat<T> fresh = dominant_quaternion(A);
    const LaneMask better = (inner_product(rotation_matrix(fresh), A) > inner_product(R, A) + T(1e-9)) & !arrived;
    q = {choose(better, fresh.w, q.w), choose(better, fresh.x, q.x), choose(better, fresh.y, q.y), choose(better, fresh.z, q.z)};
    R = rotation_matrix(q);
    LaneMask moving;
    for (int turn = 0; turn < kMaxPolishTurns; ++turn) {
        polar_turn(A, q, R, moving);
        if (!any_of(moving)) break;
    }
}

/// The answer from a start that is near it: up to about 8 degrees away where no two stretches nearly cancel.
/// @param R  in: rotation_matrix(q)
/// @return   the lanes for which that holds; the others are left with numbers of no meaning
template <class T>
inline LaneMask near_turn(const M3<T>& F, Quat<T>& q, M3<T>& R) {
    const T one(1.0), zero(0.0), two(2.0), three(3.0);
    const M3<T> G = transposed_product(R, F);
    const V3<T> a{G.m[2][1] - G.m[1][2], G.m[0][2] - G.m[2][0], G.m[1][0] - G.m[0][1]};
    const T m00 = two * (G.m[1][1] + G.m[2][2]), m11 = two * (G.m[0][0] + G.m[2][2]), m22 = two * (G.m[0][0] + G.m[1][1]);
    const T m01 = zero - (G.m[0][1] + G.m[1][0]), m02 = zero - (G.m[0][2] + G.m[2][0]), m12 = zero - (G.m[1][2] + G.m[2][1]);
    const T c00 = m11 * m22 - m12 * m12, c01 = m02 * m12 - m01 * m22, c02 = m01 * m12 - m02 * m11;
    const T c11 = m00 * m22 - m02 * m02, c12 = m01 * m02 - m00 * m12, c22 = m00 * m11 - m01 * m01;
    // det(M + d I) = d0 + d1 d + d2 d^2 + d^3;  adj(M + d I) a = adj a + d linear + d^2 a
    const T d0 = m00 * c00 + m01 * c01 + m02 * c02, d1 = c00 + c11 + c22, d2 = m00 + m11 + m22;
    const V3<T> adj{c00 * a.x + c01 * a.y + c02 * a.z, c01 * a.x + c11 * a.y + c12 * a.z, c02 * a.x + c12 * a.y + c22 * a.z};
    const V3<T> linear{(m11 + m22) * a.x - m01 * a.y - m02 * a.z, (m00 + m22) * a.y - m01 * a.x - m12 * a.z, (m00 + m11) * a.z - m02 * a.x - m12 * a.y};
    // d^4 + d2 d^3 + p2 d^2 + p1 d - p0 = 0
    const T p0 = dot(a, adj), p1 = d0 - dot(a, linear), p2 = d1 - dot(a, a);
    T d = p0 / p1;
    // M is positive definite where its three invariants are positive, by a margin; then this is the greatest eigenvalue. d d1 / p1 is about three times the square of t: Newton's
    // errors relative to d are its third and seventh power. d2 is within bounds whose sixth power is a number.
    const LaneMask sure = (d2 > T(1e-20)) & (d2 < T(1e20)) & (d1 > zero) & (p1 > zero) & (d0 > T(1e-4) * (d2 * d2 * d2)) & (d * d1 < T(0.02) * p1);
    for (int turn = 0; turn < 2; ++turn) {
        const T value = (((d + d2) * d + p2) * d + p1) * d - p0, slope = ((T(4.0) * d + three * d2) * d + two * p2) * d + p1;
        d = d - value / slope;
    }
    const T s = ((d + d2) * d + d1) * d + d0;
    const V3<T> t = adj + d * (linear + d * a);
    const Quat<T> p{q.w * s - q.x * t.x - q.y * t.y - q.z * t.z, q.x * s + q.w * t.x + q.y * t.z - q.z * t.y,
                    q.y * s + q.w * t.y + q.z * t.x - q.x * t.z, q.z * s + q.w * t.z + q.x * t.y - q.y * t.x};
    const T inv = one / root(p.w * p.w + p.x * p.x + p.y * p.y + p.z * p.z);
    q = {inv * p.w, inv * p.x, inv * p.y, inv * p.z};
    R = rotation_matrix(q);
    return sure;
}

/// The answer from any start.
template <class T>
[[gnu::noinline]] void far_turn(const M3<T>& F, Quat<T>& q, M3<T>& R) {
    const T tiny(1e-150), one(1.0);
    const T inv_norm = one / larger(root(inner_product(F, F)), tiny);
    M3<T> A;  // F / |F|: all thresholds are relative
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) A.m[i][j] = inv_norm * F.m[i][j];

    R = rotation_matrix(q);
    LaneMask moving, arrived;
    for (int turn = 0; turn < kMaxPolarTurns; ++turn) {
        arrived = polar_turn(A, q, R, moving);
        if (!any_of(moving)) break;
    }
    if (any_of(!arrived)) finish_polar(A, q, R, arrived);
}

/// @param F  deformation gradient, any determinant, zero allowed
/// @param q  in: unit quaternion to start from; out: that of R. Finite and unit for any finite F.
/// @return   R
template <class T>
inline M3<T> polar_rotation(const M3<T>& F, Quat<T>& q) {
    const Quat<T> start = q;
    M3<T> R = rotation_matrix(q);
    if (any_of(!near_turn(F, q, R))) {
        q = start;
        far_turn(F, q, R);
    }
    return R;
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
