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
#include "supple/math/lane_mat3.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

inline constexpr int kMaxPolarIterations = 40;

/// @param F  deformation gradient, any determinant, zero allowed
/// @param q  in: unit quaternion to start from; out: that of R. Finite and unit for any finite F.
/// @return   R
template <class T>
inline M3<T> polar_rotation(const M3<T>& F, Quat<T>& q) {
    T FF(0.0);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) FF = FF + F.m[i][j] * F.m[i][j];
    const T tiny(1e-150), half(0.5), one(1.0), zero(0.0);
    const T inv_norm = one / larger(root(FF), tiny);
    M3<T> A;  // F / |F|: all thresholds below are relative
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) A.m[i][j] = inv_norm * F.m[i][j];

    M3<T> R = rotation_matrix(q);
    for (int iteration = 0; iteration < kMaxPolarIterations; ++iteration) {
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
        if (!any_of(dot(t, t) > T(1e-16))) break;  // the next turn would be below 1e-15
    }
    return R;
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
