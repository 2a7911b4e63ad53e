#pragma once
/// Eigenvectors of a symmetric 3x3 in every lane, without sweeps (after Eberly, A Robust Eigensolver for 3x3 Symmetric Matrices, 2014).
///
/// Of the deviator B, scaled to |B|^2 = 6, the eigenvalues solve x^3 - 3 x - 2 r = 0, r = det(B)/2 in [-1, 1]. Where r >= 0 the greatest lies in [root 3, 2], at least root 3 away
/// from the others; where r < 0 the same holds for -B. That root is well-conditioned, and so is its eigenvector, the longest column of adj(B - x I). What remains is a symmetric
/// 2x2 across it, for which one turn of Jacobi's is exact. However close the eigenvalues are, the vectors are orthonormal and diagonalise S, both to rounding of |S|.
#include "supple/math/lane_mat3.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

/// Eigenvectors of S as columns of V, det V = +1, in no order; S becomes diagonal. |S| between 1e-140 and 1e140, or zero.
template <class T>
inline void symmetric_eigen(M3<T>& S, M3<T>& V) {
    const T zero(0.0), one(1.0), two(2.0), three(3.0), third(1.0 / 3.0), tiny(1e-150);
    T mean = third * (S.m[0][0] + S.m[1][1] + S.m[2][2]);
    T b00 = S.m[0][0] - mean, b11 = S.m[1][1] - mean, b22 = S.m[2][2] - mean;
    const T b01 = S.m[0][1], b02 = S.m[0][2], b12 = S.m[1][2];
    // Near a multiple of the identity B is of the size of the mean's rounding; only what has no trace has the roots below.
    const T left = third * (b00 + b11 + b22);
    b00 = b00 - left;
    b11 = b11 - left;
    b22 = b22 - left;
    mean = mean + left;
    const T size = root(T(1.0 / 6.0) * (b00 * b00 + b11 * b11 + b22 * b22 + two * (b01 * b01 + b02 * b02 + b12 * b12)));
    const T inv = one / larger(size, tiny);
    T a00 = inv * b00, a11 = inv * b11, a22 = inv * b22, a01 = inv * b01, a02 = inv * b02, a12 = inv * b12;
    const T det = a00 * (a11 * a22 - a12 * a12) - a01 * (a01 * a22 - a12 * a02) + a02 * (a01 * a12 - a11 * a02);
    const T sign = choose(det < zero, T(-1.0), one);
    const T double_r = smaller(magnitude(det), two);
    // From a cubic with an error of 1e-4 two turns of Newton's reach rounding.
    T x = T(1.732133) + double_r * (T(0.1653305) + double_r * (T(-0.0203455) + double_r * T(0.002329875)));
    for (int turn = 0; turn < 2; ++turn) x = x - (x * (x * x - three) - double_r) / (three * (x * x - one));

    const T shift = sign * x;
    a00 = a00 - shift;
    a11 = a11 - shift;
    a22 = a22 - shift;
    const T c00 = a11 * a22 - a12 * a12, c11 = a00 * a22 - a02 * a02, c22 = a00 * a11 - a01 * a01;  // non-negative, their sum at least six
    const T c01 = a02 * a12 - a01 * a22, c02 = a01 * a12 - a02 * a11, c12 = a01 * a02 - a00 * a12;
    const LaneMask second = c11 > c00, last = c22 > larger(c00, c11);
    V3<T> n{choose(last, c02, choose(second, c01, c00)), choose(last, c12, choose(second, c11, c01)), choose(last, c22, choose(second, c12, c02))};
    n = (one / root(dot(n, n))) * n;

    // Two more axes that make a frame with it (Duff et al., Building an Orthonormal Basis, Revisited, 2017).
    const T side = choose(n.z < zero, T(-1.0), one), scale = T(-1.0) / (side + n.z), product = n.x * n.y * scale;
    const V3<T> u{one + side * n.x * n.x * scale, side * product, zero - side * n.x}, v{product, side + n.y * n.y * scale, zero - n.y};
    const auto times = [&](const V3<T>& w) {
        return V3<T>{b00 * w.x + b01 * w.y + b02 * w.z, b01 * w.x + b11 * w.y + b12 * w.z, b02 * w.x + b12 * w.y + b22 * w.z};
    };
    const V3<T> Bu = times(u), Bv = times(v);
    const T uu = dot(u, Bu), uv = dot(v, Bu), vv = dot(v, Bv);
    // As jacobi_turn (lane_svd.h).
    const T difference = vv - uu;
    const T denominator = magnitude(difference) + root(difference * difference + two * two * uv * uv);
    const T t = choose(difference < zero, T(-2.0), two) * uv / larger(denominator, tiny);
    const T c = one / root(one + t * t), s = t * c;
    V = {{{c * u.x - s * v.x, s * u.x + c * v.x, n.x}, {c * u.y - s * v.y, s * u.y + c * v.y, n.y}, {c * u.z - s * v.z, s * u.z + c * v.z, n.z}}};
    S = {{{mean + uu - t * uv, zero, zero}, {zero, mean + vv + t * uv, zero}, {zero, zero, mean + size * shift}}};
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
