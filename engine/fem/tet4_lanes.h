#pragma once
/// What the kernels of linear tetrahedra share: reading corners and gradients of a batch, writing forces. Kernel units only.
#include "supple/fem/tet4.h"
#include "supple/math/lane_mat3.h"
#include "supple/math/lane_transpose.h"
#include "supple/math/lanes4.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

using Vector = V3<Lanes>;
using Matrix = M3<Lanes>;

/// Values of a vertex field at the corners of the elements in some lanes of a block, as differences to corner 0: d[corners - 1].
template <int corners>
inline void differences(const double* field, const std::int32_t* vertex, Vector* d) {
    Vector c0;
    load_points(field, vertex, c0.x, c0.y, c0.z);
    for (int k = 0; k + 1 < corners; ++k) {
        Vector c;
        load_points(field, vertex + (k + 1) * int(kBlock), c.x, c.y, c.z);
        d[k] = c - c0;
    }
}

/// Vectors of a block, [..][x y z][lane].
template <int count>
inline void load_vectors(const double* from, Vector* v) {
    for (int k = 0; k < count; ++k) {
        const double* p = from + std::size_t(3 * k) * kBlock;
        v[k] = {load(p), load(p + kBlock), load(p + 2 * kBlock)};
    }
}

inline void corner_differences(const double* field, const std::int32_t* vertex, Vector d[3]) { differences<4>(field, vertex, d); }
inline void load_gradients(const double* gradient, Vector g[3]) { load_vectors<3>(gradient, g); }

/// Columns: x along the first edge, z across the plane of the first two, y completes; zero columns where an edge is gone.
inline Matrix edge_frame(const Vector& first, const Vector& second) {
    const Lanes one(1.0), tiny(1e-150);
    const Vector x = (one / larger(root(dot(first, first)), tiny)) * first;
    const Vector normal = cross(x, second);
    const Vector z = (one / larger(root(dot(normal, normal)), tiny)) * normal;
    const Vector y = cross(z, x);
    return {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
}

/// The rotation from one frame to another, now rest^T.
inline Matrix turn_of(const Matrix& now, const Matrix& rest) {
    Matrix R;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) R.m[i][j] = now.m[i][0] * rest.m[j][0] + now.m[i][1] * rest.m[j][1] + now.m[i][2] * rest.m[j][2];
    return R;
}

/// Writes four vectors per lane as [lane][corner][x y z w]; w given for corners 0 and 1, zero for the others.
template <class Real>
inline void store_corners(Real* out, const Vector v[4], Lanes w0, Lanes w1) {
    for (int a = 0; a < 4; ++a) store_points(out + 4 * a, 16, v[a].x, v[a].y, v[a].z, a == 0 ? w0 : a == 1 ? w1 : Lanes(0.0));
}

/// f_a = -scale P g_a for the four corners.
inline void corner_forces(const Matrix& P, const Vector g[3], Lanes scale, Vector f[4]) {
    for (int k = 0; k < 3; ++k) f[k + 1] = (Lanes(0.0) - scale) * (P * g[k]);
    f[0] = Lanes(-1.0) * (f[1] + f[2] + f[3]);  // the four cancel to the last bit but one: no net force
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
