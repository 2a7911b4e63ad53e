#pragma once
/// Tangents of hyperelastic tetrahedra: stored, multiplied by a change of F, and written out as the ten stiffness blocks of an element. Kernel units only.
#include "supple/fem/tet4_hyper.h"
#include "supple/fem/tet4_lanes.h"
#include "supple/material/laws/principal.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

template <class T>
inline M3<T> times_transposed(const M3<T>& A, const M3<T>& B) {  // A B^T
    M3<T> C;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) C.m[i][j] = A.m[i][0] * B.m[j][0] + A.m[i][1] * B.m[j][1] + A.m[i][2] * B.m[j][2];
    return C;
}

/// d2W/dF2 of an isotropic law, in the principal frame: H = W_ij, and of each pair half the sum p and half the difference q of its quotients.
struct PrincipalTangent {
    static constexpr std::size_t kNumbers = kTangent;
    Matrix U, V;
    Lanes H[3][3];
    Lanes p[3][3], q[3][3];  ///< symmetric in their indices; the diagonals are not read

    /// dF~ = U^T dF V;  dP~_ii = sum_j H_ij dF~_jj,  dP~_ij = p dF~_ij + q dF~_ji;  dP = U dP~ V^T
    Matrix apply(const Matrix& dF) const {
        const Matrix X = transposed_product(U, dF) * V;
        Matrix Y;
        for (int i = 0; i < 3; ++i) {
            Y.m[i][i] = H[i][0] * X.m[0][0] + H[i][1] * X.m[1][1] + H[i][2] * X.m[2][2];
            for (int j = 0; j < 3; ++j) {
                if (j != i) Y.m[i][j] = p[i][j] * X.m[i][j] + q[i][j] * X.m[j][i];
            }
        }
        return times_transposed(U * Y, V);
    }
};

/// dP/dF of a tensor law, its second indices in the material frame Q0.
struct TensorTangent {
    static constexpr std::size_t kNumbers = kTensorTangent;
    Lanes C[9][9];
    Matrix Q0;

    TensorTangent() = default;
    TensorTangent(const Lanes from[9][9], const Matrix& frame) : Q0(frame) {
        for (int i = 0; i < 81; ++i) C[i / 9][i % 9] = from[i / 9][i % 9];
    }

    Matrix apply(const Matrix& dF) const {
        const Matrix X = dF * Q0;
        Matrix Y;
        for (int r = 0; r < 9; ++r) {
            Lanes sum = C[r][0] * X.m[0][0];
            for (int c = 1; c < 9; ++c) sum = sum + C[r][c] * X.m[c / 3][c % 3];
            Y.m[r / 3][r % 3] = sum;
        }
        return times_transposed(Y, Q0);
    }
};

inline PrincipalTangent make_tangent(const Matrix& U, const Matrix& V, const Principal& e) {
    const Lanes half(0.5);
    PrincipalTangent t{U, V, {}, {}, {}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) t.H[i][j] = e.second[i][j];
    for (int k = 0; k < 3; ++k) {
        const int i = kPairI[k], j = kPairJ[k];
        t.p[i][j] = t.p[j][i] = half * (e.symmetric[k] + e.antisymmetric[k]);
        t.q[i][j] = t.q[j][i] = half * (e.symmetric[k] - e.antisymmetric[k]);
    }
    return t;
}

// -- storage ------------------------------------------------------------------------------------------

/// Visits the numbers of a tangent with their place in the stored field.
template <class T, class Visit>
    requires(T::kNumbers == kTangent)
inline void for_each_number(T& t, Visit&& visit) {
    constexpr int kI[6] = {0, 1, 2, 0, 1, 2}, kJ[6] = {0, 1, 2, 1, 2, 0};
    for (int i = 0; i < 9; ++i) visit(i, t.U.m[i / 3][i % 3]);
    for (int i = 0; i < 9; ++i) visit(9 + i, t.V.m[i / 3][i % 3]);
    for (int i = 0; i < 6; ++i) visit(18 + i, t.H[kI[i]][kJ[i]]);
    for (int k = 0; k < 3; ++k) visit(24 + k, t.p[kPairI[k]][kPairJ[k]]);
    for (int k = 0; k < 3; ++k) visit(27 + k, t.q[kPairI[k]][kPairJ[k]]);
}

template <class T, class Visit>
    requires(T::kNumbers == kTensorTangent)
inline void for_each_number(T& t, Visit&& visit) {
    int place = 0;
    for (int i = 0; i < 9; ++i)
        for (int j = i; j < 9; ++j) visit(place++, t.C[i][j]);
}

/// The other triangles, which are not stored.
inline void mirror(PrincipalTangent& t) {
    for (int k = 0; k < 3; ++k) {
        const int i = kPairI[k], j = kPairJ[k];  // (0,1) (1,2) (2,0)
        t.H[j][i] = t.H[i][j];
        t.p[j][i] = t.p[i][j];
        t.q[j][i] = t.q[i][j];
    }
}
inline void mirror(TensorTangent& t) {
    for (int i = 0; i < 9; ++i)
        for (int j = 0; j < i; ++j) t.C[i][j] = t.C[j][i];
}

/// Material frame Q0 = [f s n] by rows: the last nine parameters.
inline Matrix load_frame(const double* parameter, std::size_t parameters) {
    Matrix Q0;
    for (std::size_t i = 0; i < 9; ++i) Q0.m[i / 3][i % 3] = load(parameter + (parameters - 9 + i) * kBlock);
    return Q0;
}

template <class Tangent>
inline Tangent load_tangent(const Tet4HyperProduct& pass, std::size_t at) {
    const std::size_t block = at / kBlock, lane = at % kBlock;
    Tangent t;
    const double* tangent = pass.tangent + block * Tangent::kNumbers * kBlock + lane;
    for_each_number(t, [&](int i, Lanes& value) { value = load(tangent + std::size_t(i) * kBlock); });
    mirror(t);
    if constexpr (Tangent::kNumbers == kTensorTangent) t.Q0 = load_frame(pass.parameter + block * pass.parameters * kBlock + lane, pass.parameters);
    return t;
}

// -- stiffness blocks ---------------------------------------------------------------------------------

/// Blocks for a float32 matrix are made of floats, as far as they hold no differences of large numbers: T is Lanes or Floats.
template <class T>
struct ElementStiffness {
    M3<T> K[4][4];  ///< a < b, and those (a, a) of the corners 1 to 3
};

inline void convert(const Lanes& from, Lanes& to) { to = from; }
inline void convert(const Lanes& from, Floats& to) { to = to_floats(from); }
template <class T>
inline void convert(const Matrix& from, M3<T>& to) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) convert(from.m[i][j], to.m[i][j]);
}
template <class T>
inline void convert(const Vector& from, V3<T>& to) {
    convert(from.x, to.x);
    convert(from.y, to.y);
    convert(from.z, to.z);
}

/// A^T v
inline Vector transposed_times(const Matrix& A, const Vector& v) {
    return {A.m[0][0] * v.x + A.m[1][0] * v.y + A.m[2][0] * v.z, A.m[0][1] * v.x + A.m[1][1] * v.y + A.m[2][1] * v.z,
            A.m[0][2] * v.x + A.m[1][2] * v.y + A.m[2][2] * v.z};
}

/// Blocks of the corners 1 to 3, times the volume.
template <class T>
inline void inner_blocks(const PrincipalTangent& t, const Vector g[3], Lanes volume, M3<T> K[4][4]) {
    T h[3][3], H[3][3], p[3][3], q[3][3];  // h = V^T g; the others times the volume
    for (int a = 0; a < 3; ++a) {
        const Vector v = transposed_times(t.V, g[a]);
        convert(v.x, h[a][0]);
        convert(v.y, h[a][1]);
        convert(v.z, h[a][2]);
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = i; j < 3; ++j) {
            convert(volume * t.H[i][j], H[i][j]);
            H[j][i] = H[i][j];
            if (i == j) continue;
            convert(volume * t.p[i][j], p[i][j]);
            convert(volume * t.q[i][j], q[i][j]);
            p[j][i] = p[i][j];
            q[j][i] = q[i][j];
        }
    }
    M3<T> U;
    convert(t.U, U);
    for (int a = 0; a < 3; ++a) {
        for (int b = a; b < 3; ++b) {
            M3<T> X;
            for (int i = 0; i < 3; ++i) {
                X.m[i][i] = H[i][i] * h[a][i] * h[b][i];
                for (int j = 0; j < 3; ++j) {
                    if (j == i) continue;
                    X.m[i][i] = X.m[i][i] + p[i][j] * h[a][j] * h[b][j];
                    X.m[i][j] = H[i][j] * h[a][i] * h[b][j] + q[i][j] * h[a][j] * h[b][i];
                }
            }
            K[a + 1][b + 1] = times_transposed(U * X, U);
        }
    }
}

/// K_ab,ik = V g_aJ C_iJkL g_bL
template <class T>
inline void inner_blocks(const TensorTangent& t, const Vector g[3], Lanes volume, M3<T> K[4][4]) {
    T C[9][9];
    for (int i = 0; i < 9; ++i) {
        for (int j = i; j < 9; ++j) {
            convert(t.C[i][j], C[i][j]);
            C[j][i] = C[i][j];
        }
    }
    V3<T> turned[3];
    for (int a = 0; a < 3; ++a) convert(transposed_times(t.Q0, g[a]), turned[a]);
    T V;
    convert(volume, V);
    for (int b = 0; b < 3; ++b) {
        const V3<T> gb = V * turned[b];
        T Cg[9][3];  // sum over L, of (iJ, k)
        for (int r = 0; r < 9; ++r)
            for (int k = 0; k < 3; ++k) Cg[r][k] = C[r][3 * k] * gb.x + C[r][3 * k + 1] * gb.y + C[r][3 * k + 2] * gb.z;
        for (int a = 0; a <= b; ++a) {
            const V3<T>& ga = turned[a];
            for (int i = 0; i < 3; ++i)
                for (int k = 0; k < 3; ++k) K[a + 1][b + 1].m[i][k] = ga.x * Cg[3 * i][k] + ga.y * Cg[3 * i + 1][k] + ga.z * Cg[3 * i + 2][k];
        }
    }
}

inline Matrix load_fibre_tangent(const double* fibre_tangent) {
    const auto M = [&](std::size_t n) { return load(fibre_tangent + n * kBlock); };
    return {{{M(0), M(3), M(5)}, {M(3), M(1), M(4)}, {M(5), M(4), M(2)}}};
}

inline Vector load_direction(const double* fibre) { return {load(fibre + 2 * kBlock), load(fibre + 3 * kBlock), load(fibre + 4 * kBlock)}; }

/// K_ab += V (f.g_a) (f.g_b) M
template <class T>
inline void add_fibre_blocks(const double* fibre, const double* fibre_tangent, const Vector g[3], Lanes volume, M3<T> K[4][4]) {
    M3<T> M;
    convert(load_fibre_tangent(fibre_tangent), M);
    const Vector f = load_direction(fibre);
    const Lanes h[3] = {dot(f, g[0]), dot(f, g[1]), dot(f, g[2])};
    for (int a = 0; a < 3; ++a) {
        for (int b = a; b < 3; ++b) {
            T w;
            convert(volume * h[a] * h[b], w);
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) K[a + 1][b + 1].m[i][j] = K[a + 1][b + 1].m[i][j] + w * M.m[i][j];
        }
    }
}

/// dP += M (dF f) f^T
inline void add_fibre_product(const double* fibre, const double* fibre_tangent, const Matrix& dF, Matrix& dP) {
    const Vector f = load_direction(fibre), t = load_fibre_tangent(fibre_tangent) * (dF * f);
    const Lanes traction[3] = {t.x, t.y, t.z}, direction[3] = {f.x, f.y, f.z};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) dP.m[i][j] = dP.m[i][j] + traction[i] * direction[j];
}

/// Corner 0 of the pairs: a rigid shift makes no force, so columns sum to zero.
template <class T>
inline void outer_blocks(M3<T> K[4][4]) {
    const auto entry = [&](int a, int b, int i, int j) { return a <= b ? K[a][b].m[i][j] : K[b][a].m[j][i]; };
    for (int b = 1; b < 4; ++b)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) K[0][b].m[i][j] = -(entry(1, b, i, j) + entry(2, b, i, j) + entry(3, b, i, j));
}

/// Lane by lane: the blocks of the six pairs in columns [x y z 0].
template <class Real, class T>
inline void store_blocks(const ElementStiffness<T>& stiffness, Real* out) {
    T zero;
    convert(Lanes(0.0), zero);
    int place = 0;
    for (int a = 0; a < 4; ++a) {
        for (int b = a + 1; b < 4; ++b, ++place) {
            const M3<T>& K = stiffness.K[a][b];
            for (int c = 0; c < 3; ++c) store_points(out + 12 * place + 4 * c, kElementBlocks, K.m[0][c], K.m[1][c], K.m[2][c], zero);
        }
    }
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
