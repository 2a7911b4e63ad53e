#pragma once
#include "supple/math/lanes.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

/// Three numbers and three-by-three numbers in every lane; row-major.
template <class T>
struct V3 {
    T x, y, z;
};

template <class T>
struct M3 {
    T m[3][3];
};

template <class T>
inline V3<T> operator+(const V3<T>& a, const V3<T>& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
template <class T>
inline V3<T> operator-(const V3<T>& a, const V3<T>& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
template <class T>
inline V3<T> operator*(const T& s, const V3<T>& a) { return {s * a.x, s * a.y, s * a.z}; }
template <class T>
inline T dot(const V3<T>& a, const V3<T>& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

template <class T>
inline V3<T> operator*(const M3<T>& A, const V3<T>& v) {
    return {A.m[0][0] * v.x + A.m[0][1] * v.y + A.m[0][2] * v.z, A.m[1][0] * v.x + A.m[1][1] * v.y + A.m[1][2] * v.z,
            A.m[2][0] * v.x + A.m[2][1] * v.y + A.m[2][2] * v.z};
}

/// A^T B
template <class T>
inline M3<T> transposed_product(const M3<T>& A, const M3<T>& B) {
    M3<T> C;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) C.m[i][j] = A.m[0][i] * B.m[0][j] + A.m[1][i] * B.m[1][j] + A.m[2][i] * B.m[2][j];
    return C;
}

template <class T>
inline M3<T> operator*(const M3<T>& A, const M3<T>& B) {
    M3<T> C;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) C.m[i][j] = A.m[i][0] * B.m[0][j] + A.m[i][1] * B.m[1][j] + A.m[i][2] * B.m[2][j];
    return C;
}

/// sum over k of d_k g_k^T: the gradient of a field with differences d_k (columns) and rest gradients g_k.
template <class T>
inline M3<T> gradient(const V3<T> d[3], const V3<T> g[3]) {
    M3<T> F;
    const T dx[3] = {d[0].x, d[1].x, d[2].x}, dy[3] = {d[0].y, d[1].y, d[2].y}, dz[3] = {d[0].z, d[1].z, d[2].z};
    const T* row[3] = {dx, dy, dz};
    for (int i = 0; i < 3; ++i) {
        F.m[i][0] = row[i][0] * g[0].x + row[i][1] * g[1].x + row[i][2] * g[2].x;
        F.m[i][1] = row[i][0] * g[0].y + row[i][1] * g[1].y + row[i][2] * g[2].y;
        F.m[i][2] = row[i][0] * g[0].z + row[i][1] * g[1].z + row[i][2] * g[2].z;
    }
    return F;
}

template <class T>
inline V3<T> cross(const V3<T>& a, const V3<T>& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
template <class T>
inline V3<T> choose3(LaneMask m, const V3<T>& yes, const V3<T>& no) { return {choose(m, yes.x, no.x), choose(m, yes.y, no.y), choose(m, yes.z, no.z)}; }

template <class T>
struct Quat {
    T w, x, y, z;
};

/// Unit quaternion of a rotation matrix, from the largest of its four squared components; finite and unit for any finite matrix.
template <class T>
inline Quat<T> quaternion(const M3<T>& R) {
    const T one(1.0);
    const T w = one + R.m[0][0] + R.m[1][1] + R.m[2][2], x = one + R.m[0][0] - R.m[1][1] - R.m[2][2];
    const T y = one - R.m[0][0] + R.m[1][1] - R.m[2][2], z = one - R.m[0][0] - R.m[1][1] + R.m[2][2];
    const T wx = R.m[2][1] - R.m[1][2], wy = R.m[0][2] - R.m[2][0], wz = R.m[1][0] - R.m[0][1];
    const T xy = R.m[0][1] + R.m[1][0], yz = R.m[1][2] + R.m[2][1], zx = R.m[2][0] + R.m[0][2];
    // Row k of 4 q q^T, k the largest.
    Quat<T> q{w, wx, wy, wz};
    T best = w;
    const LaneMask take_x = x > best;
    q = {choose(take_x, wx, q.w), choose(take_x, x, q.x), choose(take_x, xy, q.y), choose(take_x, zx, q.z)};
    best = larger(best, x);
    const LaneMask take_y = y > best;
    q = {choose(take_y, wy, q.w), choose(take_y, xy, q.x), choose(take_y, y, q.y), choose(take_y, yz, q.z)};
    best = larger(best, y);
    const LaneMask take_z = z > best;
    q = {choose(take_z, wz, q.w), choose(take_z, zx, q.x), choose(take_z, yz, q.y), choose(take_z, z, q.z)};
    const T norm2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
    const LaneMask ok = norm2 > T(1e-200);
    const T inv = one / root(choose(ok, norm2, one));
    return {choose(ok, inv * q.w, one), choose(ok, inv * q.x, T(0.0)), choose(ok, inv * q.y, T(0.0)), choose(ok, inv * q.z, T(0.0))};
}

/// Rotation matrix of a unit quaternion.
template <class T>
inline M3<T> rotation_matrix(const Quat<T>& q) {
    const T two(2.0), one(1.0);
    const T xx = two * q.x * q.x, yy = two * q.y * q.y, zz = two * q.z * q.z;
    const T xy = two * q.x * q.y, yz = two * q.y * q.z, zx = two * q.z * q.x;
    const T wx = two * q.w * q.x, wy = two * q.w * q.y, wz = two * q.w * q.z;
    return {{{one - yy - zz, xy - wz, zx + wy}, {xy + wz, one - xx - zz, yz - wx}, {zx - wy, yz + wx, one - xx - yy}}};
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
