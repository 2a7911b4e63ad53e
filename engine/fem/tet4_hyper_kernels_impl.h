#pragma once
/// Hyperelastic tetrahedra, compiled once per instruction set by tet4_hyper_kernels_<isa>.cpp.
///
/// Three steps, of which only the second knows the law:
///   1. F = U diag(s) V^T with det U = det V = +1: R by Newton from the last step, then the eigenvectors of R^T F = V diag(s) V^T, U = R V.
///   2. the law: W, W_i, W_ij and the two quotients of each pair (material/laws/principal.h), made positive where asked.
///   3. P = U diag(W_i) V^T and, with g~_a = V^T g_a, the stiffness block  K_ab = V_e U K~ U^T  where
///          K~_ii = H_ii ga_i gb_i + sum_{j != i} p_ij ga_j gb_j,     K~_ij = H_ij ga_i gb_j + q_ij ga_j gb_i,
///      H = W_ij, p = (symmetric + antisymmetric)/2, q = (symmetric - antisymmetric)/2: the eigen-system of d2W/dF2 written out
///      (Smith, De Goes, Kim, Analytic Eigensystems for Isotropic Distortion Energies, 2019).
#include "supple/fem/tet4_hyper.h"
#include "supple/fem/principal_laws.h"
#include "supple/fem/tet4_lanes.h"
#include "supple/math/lane_polar.h"
#include "supple/math/lane_svd.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

/// What a tangent needs, loaded or just made.
struct Tangent {
    Matrix U, V;
    Lanes H[3][3];
    Lanes p[3][3], q[3][3];  ///< symmetric in their indices; the diagonals are not read
};

inline Tangent make_tangent(const Matrix& U, const Matrix& V, const Principal& e) {
    const Lanes half(0.5);
    Tangent t{U, V, {}, {}, {}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) t.H[i][j] = e.second[i][j];
    for (int k = 0; k < 3; ++k) {
        const int i = kPairI[k], j = kPairJ[k];
        t.p[i][j] = t.p[j][i] = half * (e.symmetric[k] + e.antisymmetric[k]);
        t.q[i][j] = t.q[j][i] = half * (e.symmetric[k] - e.antisymmetric[k]);
    }
    return t;
}

/// Visits the numbers of a tangent with their place in the stored field.
template <class T, class Visit>
inline void for_each_number(T& t, Visit&& visit) {
    constexpr int kI[6] = {0, 1, 2, 0, 1, 2}, kJ[6] = {0, 1, 2, 1, 2, 0};
    for (int i = 0; i < 9; ++i) visit(i, t.U.m[i / 3][i % 3]);
    for (int i = 0; i < 9; ++i) visit(9 + i, t.V.m[i / 3][i % 3]);
    for (int i = 0; i < 6; ++i) visit(18 + i, t.H[kI[i]][kJ[i]]);
    for (int k = 0; k < 3; ++k) visit(24 + k, t.p[kPairI[k]][kPairJ[k]]);
    for (int k = 0; k < 3; ++k) visit(27 + k, t.q[kPairI[k]][kPairJ[k]]);
}

inline Matrix rotated(const Matrix& U, const Matrix& X) {  // U X U^T
    const Matrix T = U * X;
    Matrix K;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) K.m[i][j] = T.m[i][0] * U.m[j][0] + T.m[i][1] * U.m[j][1] + T.m[i][2] * U.m[j][2];
    return K;
}

/// Step 3, stiffness: the ten blocks of the element, times its volume.
template <class Real>
inline void store_blocks(const Tangent& t, const Vector g[3], Lanes volume, Real* out) {
    Lanes h[3][3];  // g~
    for (int a = 0; a < 3; ++a) {
        const Lanes v[3] = {g[a].x, g[a].y, g[a].z};
        for (int i = 0; i < 3; ++i) h[a][i] = t.V.m[0][i] * v[0] + t.V.m[1][i] * v[1] + t.V.m[2][i] * v[2];
    }
    Matrix K[4][4];  // a <= b
    for (int a = 0; a < 3; ++a) {
        for (int b = a; b < 3; ++b) {
            Matrix X;
            for (int i = 0; i < 3; ++i) {
                Lanes diagonal = t.H[i][i] * h[a][i] * h[b][i];
                for (int j = 0; j < 3; ++j) {
                    if (j == i) continue;
                    diagonal = diagonal + t.p[i][j] * h[a][j] * h[b][j];
                    X.m[i][j] = volume * (t.H[i][j] * h[a][i] * h[b][j] + t.q[i][j] * h[a][j] * h[b][i]);
                }
                X.m[i][i] = volume * diagonal;
            }
            K[a + 1][b + 1] = rotated(t.U, X);
        }
    }
    const auto entry = [&](int a, int b, int i, int j) { return a <= b ? K[a][b].m[i][j] : K[b][a].m[j][i]; };
    for (int b = 1; b < 4; ++b)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) K[0][b].m[i][j] = Lanes(0.0) - (entry(1, b, i, j) + entry(2, b, i, j) + entry(3, b, i, j));
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) K[0][0].m[i][j] = Lanes(0.0) - (K[0][1].m[i][j] + K[0][2].m[i][j] + K[0][3].m[i][j]);
    int place = 0;
    for (int a = 0; a < 4; ++a) {
        for (int b = a; b < 4; ++b, ++place) {
            alignas(64) double s[9][kLanes];
            for (int i = 0; i < 9; ++i) store(s[i], K[a][b].m[i / 3][i % 3]);
            for (int lane = 0; lane < kLanes; ++lane) {
                Real* to = out + std::size_t(lane) * kElementBlocks + std::size_t(place) * 12;
                for (int c = 0; c < 3; ++c) {
                    for (int i = 0; i < 3; ++i) to[4 * c + i] = Real(s[3 * i + c][lane]);
                    to[4 * c + 3] = Real(0);
                }
            }
        }
    }
}

template <Law law>
void elements(const Tet4HyperPass& pass, std::size_t begin, std::size_t end) {
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        const std::size_t block = at / kBlock, lane = at % kBlock;
        Vector d[3], g[3];
        corner_differences(pass.position, pass.vertex + block * 4 * kBlock + lane, d);
        load_gradients(pass.gradient + block * 9 * kBlock + lane, g);
        const Lanes volume = load(pass.volume + at);
        double* quaternion = pass.quaternion + block * 4 * kBlock + lane;

        const Matrix F = gradient(d, g);
        Quat<Lanes> turn{load(quaternion), load(quaternion + kBlock), load(quaternion + 2 * kBlock), load(quaternion + 3 * kBlock)};
        const Matrix R = polar_rotation(F, turn);
        store(quaternion, turn.w);
        store(quaternion + kBlock, turn.x);
        store(quaternion + 2 * kBlock, turn.y);
        store(quaternion + 3 * kBlock, turn.z);
        Matrix S = transposed_product(R, F), V;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < i; ++j) S.m[i][j] = S.m[j][i] = Lanes(0.5) * (S.m[i][j] + S.m[j][i]);
        jacobi_eigen(S, V);
        const Matrix U = R * V;

        Principal e;
        for (int i = 0; i < 3; ++i) e.s[i] = S.m[i][i];
        apply_law<law>(pass.parameter + block * pass.parameters * kBlock + lane, pass.parameters, e);

        if (pass.corner_force != nullptr) {
            Matrix P;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    P.m[i][j] = U.m[i][0] * e.first[0] * V.m[j][0] + U.m[i][1] * e.first[1] * V.m[j][1] + U.m[i][2] * e.first[2] * V.m[j][2];
            Vector f[4];
            corner_forces(P, g, volume, f);
            store_corners(pass.corner_force + at * 16, f, Lanes(0.0), Lanes(0.0));
        }
        if (pass.energy != nullptr) store(pass.energy + at, volume * e.W);
        if (pass.stress != nullptr) {
            // sigma_i = W_i s_i / J; a flat element keeps its sign and stays finite
            const Lanes J = e.s[0] * e.s[1] * e.s[2], tiny(1e-12);
            const Lanes inv_J = Lanes(1.0) / choose(magnitude(J) < tiny, choose(J < Lanes(0.0), Lanes(0.0) - tiny, tiny), J);
            Matrix sigma;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) sigma.m[i][j] = i == j ? e.first[i] * e.s[i] * inv_J : Lanes(0.0);
            sigma = rotated(U, sigma);
            constexpr int kRow[6] = {0, 1, 2, 0, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 0};
            double* stress = pass.stress + block * 6 * kBlock + lane;
            for (int c = 0; c < 6; ++c) store(stress + std::size_t(c) * kBlock, sigma.m[kRow[c]][kColumn[c]]);
        }
        if (pass.tangent != nullptr) {
            if (pass.project) project(e);
            const Tangent t = make_tangent(U, V, e);
            double* tangent = pass.tangent + block * kTangent * kBlock + lane;
            for_each_number(t, [&](int i, const Lanes& value) { store(tangent + std::size_t(i) * kBlock, value); });
            if (pass.block_f != nullptr) store_blocks(t, g, volume, pass.block_f + at * kElementBlocks);
            if (pass.block_d != nullptr) store_blocks(t, g, volume, pass.block_d + at * kElementBlocks);
        }
    }
}

inline void product(const Tet4HyperProduct& pass, std::size_t begin, std::size_t end) {
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        const std::size_t block = at / kBlock, lane = at % kBlock;
        Vector d[3], g[3];
        corner_differences(pass.field, pass.vertex + block * 4 * kBlock + lane, d);
        load_gradients(pass.gradient + block * 9 * kBlock + lane, g);
        Tangent t;
        const double* tangent = pass.tangent + block * kTangent * kBlock + lane;
        for_each_number(t, [&](int i, Lanes& value) { value = load(tangent + std::size_t(i) * kBlock); });
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < i; ++j) {
                // stored once per pair: (0,1) (1,2) (2,0)
                const bool stored = i == 2 && j == 0;
                t.H[stored ? j : i][stored ? i : j] = t.H[stored ? i : j][stored ? j : i];
                t.p[stored ? j : i][stored ? i : j] = t.p[stored ? i : j][stored ? j : i];
                t.q[stored ? j : i][stored ? i : j] = t.q[stored ? i : j][stored ? j : i];
            }
        }
        // dF~ = U^T dF V;  dP~_ii = sum_j H_ij dF~_jj,  dP~_ij = p dF~_ij + q dF~_ji;  dP = U dP~ V^T
        const Matrix X = transposed_product(t.U, gradient(d, g)) * t.V;
        Matrix Y;
        for (int i = 0; i < 3; ++i) {
            Y.m[i][i] = t.H[i][0] * X.m[0][0] + t.H[i][1] * X.m[1][1] + t.H[i][2] * X.m[2][2];
            for (int j = 0; j < 3; ++j) {
                if (j != i) Y.m[i][j] = t.p[i][j] * X.m[i][j] + t.q[i][j] * X.m[j][i];
            }
        }
        const Matrix UY = t.U * Y;
        Matrix P;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) P.m[i][j] = UY.m[i][0] * t.V.m[j][0] + UY.m[i][1] * t.V.m[j][1] + UY.m[i][2] * t.V.m[j][2];
        Vector f[4];
        corner_forces(P, g, Lanes(0.0) - load(pass.volume + at), f);
        store_corners(pass.corner_force + at * 16, f, Lanes(0.0), Lanes(0.0));
    }
}

/// Place of block (a, b), a <= b, among the ten of an element.
inline constexpr std::uint8_t kPlace[16] = {0, 1, 2, 3, 1, 4, 5, 6, 2, 5, 7, 8, 3, 6, 8, 9};

template <class Real>
void assemble(const BlockAssembly<Real>& pass, std::size_t begin, std::size_t end) {
    using R4 = FourOf<Real>;
    for (std::size_t row = begin; row < end; ++row) {
        for (std::int32_t block = pass.row_start[row]; block < pass.row_start[row + 1]; ++block) {
            const std::size_t column = std::size_t(pass.column[block]);
            if (column < row) continue;
            const bool add = pass.diagonal_shift == nullptr;
            if (add && pass.contribution_start[block] == pass.contribution_start[block + 1]) continue;
            R4 c[3] = {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}, t[3] = {c[0], c[0], c[0]};
            for (std::int64_t i = pass.contribution_start[block]; i < pass.contribution_start[block + 1]; ++i) {
                const std::uint32_t pair = pass.contribution[i];
                const Real* k = pass.block + std::size_t(pair >> 4) * kElementBlocks + std::size_t(kPlace[pair & 15u]) * 12;
                R4* to = ((pair >> 2) & 3u) <= (pair & 3u) ? c : t;  // t gathers what is stored as the other triangle
                for (int j = 0; j < 3; ++j) to[j] += load4(k + 4 * j);
            }
            const Real scale = Real(pass.stiffness_scale);
            Real m[3][3];
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) m[i][j] = scale * (c[j][i] + t[i][j]);
            if (column == row && !add) {
                for (int i = 0; i < 3; ++i) m[i][i] += Real(pass.diagonal_shift[row]);
            }
            Real* value = pass.value + std::size_t(block) * 12;
            if (add) {
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j) m[i][j] += value[4 * j + i];
            }
            Real* mirror = pass.value + std::size_t(pass.mirror[block]) * 12;
            for (int j = 0; j < 3; ++j) {
                if (column != row) store4(mirror + 4 * j, R4{m[j][0], m[j][1], m[j][2], 0});
                store4(value + 4 * j, R4{m[0][j], m[1][j], m[2][j], 0});
            }
        }
    }
}

inline constexpr Tet4HyperKernels kHyperKernels{
    {elements<Law::st_venant_kirchhoff>, elements<Law::neo_hookean>, elements<Law::stable_neo_hookean>, elements<Law::mooney_rivlin>,
     elements<Law::arruda_boyce>, elements<Law::veronda_westman>, elements<Law::ogden>},
    product,
    assemble<float>,
    assemble<double>};

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
