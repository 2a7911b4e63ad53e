#pragma once
/// The kernels of linear tetrahedra, compiled once per instruction set by tet4_kernels_<isa>.cpp.
///
/// Corotational linear elasticity on one element, rest gradients g_a, R = rotation of F = sum_a x_a g_a^T:
///     W   = V (mu |F - R|^2 + lambda/2 tr(R^T F - I)^2)
///     P   = 2 mu (F - R) + lambda tr(R^T F - I) R,        f_a = -V P g_a
///     K_ab (R held) = V (lambda g'_a g'_b^T + mu g'_b g'_a^T + mu (g_a.g_b) I),   g' = R g
///     sigma = R (2 mu e + lambda tr(e) I) R^T,            e = sym(R^T F) - I
#include "supple/fem/tet4.h"
#include "supple/math/lane_polar.h"
#include "supple/math/lanes4.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

using Vector = V3<Lanes>;
using Matrix = M3<Lanes>;

/// Values of a vertex field at the corners of the elements in some lanes of a block, as differences to corner 0.
inline void corner_differences(const double* field, const std::int32_t* vertex, Vector d[3]) {
    alignas(64) double c[4][3][kLanes];
    for (int a = 0; a < 4; ++a) {
        for (int lane = 0; lane < kLanes; ++lane) {
            const double* p = field + 3 * std::size_t(vertex[a * int(kBlock) + lane]);
            c[a][0][lane] = p[0];
            c[a][1][lane] = p[1];
            c[a][2][lane] = p[2];
        }
    }
    const Vector c0{load(c[0][0]), load(c[0][1]), load(c[0][2])};
    for (int k = 0; k < 3; ++k) d[k] = Vector{load(c[k + 1][0]), load(c[k + 1][1]), load(c[k + 1][2])} - c0;
}

inline void load_gradients(const double* gradient, Vector g[3]) {
    for (int k = 0; k < 3; ++k) {
        const double* p = gradient + std::size_t(3 * k) * kBlock;
        g[k] = {load(p), load(p + kBlock), load(p + 2 * kBlock)};
    }
}

/// Writes four vectors per lane as [lane][corner][x y z w]; w given for corners 0 and 1, zero for the others.
template <class Real>
inline void store_corners(Real* out, const Vector v[4], Lanes w0, Lanes w1) {
    alignas(64) double s[16][kLanes];
    const Lanes zero(0.0);
    for (int a = 0; a < 4; ++a) {
        store(s[4 * a], v[a].x);
        store(s[4 * a + 1], v[a].y);
        store(s[4 * a + 2], v[a].z);
        store(s[4 * a + 3], a == 0 ? w0 : a == 1 ? w1 : zero);
    }
    for (int lane = 0; lane < kLanes; ++lane)
        for (int i = 0; i < 16; ++i) out[std::size_t(lane) * 16 + std::size_t(i)] = Real(s[i][lane]);
}

/// f_a = -scale P g_a for the four corners.
inline void corner_forces(const Matrix& P, const Vector g[3], Lanes scale, Vector f[4]) {
    for (int k = 0; k < 3; ++k) f[k + 1] = (Lanes(0.0) - scale) * (P * g[k]);
    f[0] = Lanes(-1.0) * (f[1] + f[2] + f[3]);  // the four cancel to the last bit but one: no net force
}

inline void elements(const Tet4Pass& pass, std::size_t begin, std::size_t end) {
    const Lanes one(1.0), two(2.0), half(0.5);
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        const std::size_t block = at / kBlock, lane = at % kBlock;
        Vector d[3], g[3];
        corner_differences(pass.position, pass.vertex + block * 4 * kBlock + lane, d);
        load_gradients(pass.gradient + block * 9 * kBlock + lane, g);
        const Lanes V = load(pass.volume + at);
        const double* moduli = pass.moduli + block * 2 * kBlock + lane;
        const Lanes lambda = load(moduli), mu = load(moduli + kBlock);
        double* quaternion = pass.quaternion + block * 4 * kBlock + lane;

        const Matrix F = gradient(d, g);
        Quat<Lanes> q{load(quaternion), load(quaternion + kBlock), load(quaternion + 2 * kBlock), load(quaternion + 3 * kBlock)};
        const Matrix R = polar_rotation(F, q);
        store(quaternion, q.w);
        store(quaternion + kBlock, q.x);
        store(quaternion + 2 * kBlock, q.y);
        store(quaternion + 3 * kBlock, q.z);

        Lanes trace(-3.0);  // tr(R^T F - I)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) trace = trace + R.m[i][j] * F.m[i][j];

        if (pass.corner_force != nullptr) {
            Matrix P;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) P.m[i][j] = two * mu * (F.m[i][j] - R.m[i][j]) + lambda * trace * R.m[i][j];
            Vector f[4];
            corner_forces(P, g, V, f);
            store_corners(pass.corner_force + at * 16, f, Lanes(0.0), Lanes(0.0));
        }
        if (pass.record_f != nullptr || pass.record_d != nullptr) {
            Vector r[4];
            for (int k = 0; k < 3; ++k) r[k + 1] = R * g[k];
            r[0] = Lanes(-1.0) * (r[1] + r[2] + r[3]);
            if (pass.record_f != nullptr) store_corners(pass.record_f + at * kRecord, r, lambda * V, mu * V);
            if (pass.record_d != nullptr) store_corners(pass.record_d + at * kRecord, r, lambda * V, mu * V);
        }
        if (pass.energy != nullptr) {
            Lanes dd(0.0);
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) dd = dd + (F.m[i][j] - R.m[i][j]) * (F.m[i][j] - R.m[i][j]);
            store(pass.energy + at, V * (mu * dd + half * lambda * trace * trace));
        }
        if (pass.stress != nullptr) {
            const Matrix G = transposed_product(R, F);
            Matrix S;  // unrotated stress
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) {
                    S.m[i][j] = mu * (G.m[i][j] + G.m[j][i]);
                    if (i == j) S.m[i][j] = S.m[i][j] - two * mu * one + lambda * trace;
                }
            const Matrix RS = R * S;
            constexpr int kRow[6] = {0, 1, 2, 0, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 0};
            double* stress = pass.stress + block * 6 * kBlock + lane;
            for (int c = 0; c < 6; ++c) {
                const int i = kRow[c], j = kColumn[c];
                store(stress + std::size_t(c) * kBlock, RS.m[i][0] * R.m[j][0] + RS.m[i][1] * R.m[j][1] + RS.m[i][2] * R.m[j][2]);
            }
        }
    }
}

inline void product(const Tet4Product& pass, std::size_t begin, std::size_t end) {
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        const std::size_t block = at / kBlock, lane = at % kBlock;
        Vector d[3], g[3];
        corner_differences(pass.field, pass.vertex + block * 4 * kBlock + lane, d);
        load_gradients(pass.gradient + block * 9 * kBlock + lane, g);
        const Lanes V = load(pass.volume + at);
        const double* moduli = pass.moduli + block * 2 * kBlock + lane;
        const Lanes lambda = load(moduli), mu = load(moduli + kBlock);
        const double* quaternion = pass.quaternion + block * 4 * kBlock + lane;
        const Quat<Lanes> q{load(quaternion), load(quaternion + kBlock), load(quaternion + 2 * kBlock), load(quaternion + 3 * kBlock)};
        const Matrix R = rotation_matrix(q);

        // dP = R (mu (G + G^T) + lambda tr(G) I), G = R^T dF
        const Matrix G = transposed_product(R, gradient(d, g));
        const Lanes pressure = lambda * (G.m[0][0] + G.m[1][1] + G.m[2][2]);
        Matrix S;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                S.m[i][j] = mu * (G.m[i][j] + G.m[j][i]);
                if (i == j) S.m[i][j] = S.m[i][j] + pressure;
            }
        Vector f[4];
        corner_forces(R * S, g, Lanes(0.0) - V, f);
        store_corners(pass.corner_force + at * 16, f, Lanes(0.0), Lanes(0.0));
    }
}

template <class Real>
inline void assemble(const Tet4Assembly<Real>& pass, std::size_t begin, std::size_t end) {
    using R4 = FourOf<Real>;
    const R4 xyz = {Real(1), Real(1), Real(1), Real(0)};
    const Real scale = Real(pass.stiffness_scale);
    for (std::size_t row = begin; row < end; ++row) {
        for (std::int32_t block = pass.row_start[row]; block < pass.row_start[row + 1]; ++block) {
            const std::size_t column = std::size_t(pass.column[block]);
            if (column < row) continue;  // written as a mirror
            const Real shift = Real(pass.stiffness_scale * pass.laplacian[block] + (column == row ? pass.diagonal_shift[row] : 0.0));
            R4 c0 = {0, 0, 0, 0}, c1 = c0, c2 = c0;
            const std::uint32_t* entry = pass.contribution + pass.contribution_start[block];
            const std::uint32_t* const last = pass.contribution + pass.contribution_start[block + 1];
            for (; entry != last; ++entry) {
                const Real* record = pass.record + std::size_t(*entry >> 4) * kRecord;
                const R4 a = load4(record + ((*entry >> 2) & 3u) * 4), b = load4(record + (*entry & 3u) * 4);
                const Real lambda = record[3], mu = record[7];
                const R4 la = a * lambda, mb = b * mu;
                c0 += la * splat<0>(b) + mb * splat<0>(a);
                c1 += la * splat<1>(b) + mb * splat<1>(a);
                c2 += la * splat<2>(b) + mb * splat<2>(a);
            }
            c0 *= xyz * scale;
            c1 *= xyz * scale;
            c2 *= xyz * scale;
            c0[0] += shift;
            c1[1] += shift;
            c2[2] += shift;
            Real* value = pass.value + std::size_t(block) * 12;
            store4(value, c0);
            store4(value + 4, c1);
            store4(value + 8, c2);
            if (column != row) {
                Real* mirror = pass.value + std::size_t(pass.mirror[block]) * 12;
                store4(mirror, R4{c0[0], c1[0], c2[0], 0});
                store4(mirror + 4, R4{c0[1], c1[1], c2[1], 0});
                store4(mirror + 8, R4{c0[2], c1[2], c2[2], 0});
            }
        }
    }
}

inline constexpr Tet4Kernels kKernels{elements, product, assemble<float>, assemble<double>};

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
