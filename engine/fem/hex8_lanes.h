#pragma once
/// What the kernels of hexahedra share. Kernel units only.
#include "supple/fem/hex8.h"
#include "supple/fem/tet4_lanes.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

/// sum_a d_a g_a^T over the corners 1..7.
inline Matrix hex_gradient(const Vector d[7], const Vector g[7]) {
    Matrix F = gradient(d, g);
    const Matrix second = gradient(d + 3, g + 3);
    const Lanes left[3] = {d[6].x, d[6].y, d[6].z}, right[3] = {g[6].x, g[6].y, g[6].z};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) F.m[i][j] = F.m[i][j] + second.m[i][j] + left[i] * right[j];
    return F;
}

/// Writes the values of the corners 1..7, and at corner 0 minus their sum: no net force. out: of the first lane.
inline void store_hex_corners(double* out, const Vector f[7]) {
    Vector sum = f[0];
    for (int k = 1; k < 7; ++k) sum = sum + f[k];
    sum = Lanes(-1.0) * sum;
    for (int a = 0; a < 8; ++a) {
        const Vector& v = a == 0 ? sum : f[a - 1];
        store_points(out + 4 * a, 32, v.x, v.y, v.z, Lanes(0.0));
    }
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
