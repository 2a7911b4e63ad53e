#pragma once
/// Hyperelastic hexahedra without volumetric locking, compiled once per instruction set by hex8_hyper_kernels_<isa>.cpp.
///
/// 2x2x2 Gauss points q of weight w. The volume ratio J = det F of each point is replaced by the element's mean (F-bar after de Souza Neto et al. 1996, with the mean
/// dilatation in place of the centre's, and from an energy, so that the force has no work of its own and the tangent is symmetric):
///     E = sum_q w W(Fb),    Fb = c F,    c = (r(t) / r(J))^(1/3),    t = sum_q w J / sum_q w.
/// r(J) = J above 0.1; below it goes on with the same slope towards 0.05, so that crushed and inverted points stay finite and are pushed back. Then det Fb = t above 0.1.
/// With P = dW/dFb, p = (P : Fb)/3, l = ln r, C = dJ/dF (the cofactors), t_a = dt/dx_a = sum_q w C g_a / sum_q w:
///     f_a = -sum_q w (c P - p l'(J) C) g_a - H t_a,        H = sum_q w p l'(t).
/// Stress: sigma = (c P - p l'(J) C) F^T / J + H / sum_q w, the mean over the points: one pressure for the element.
/// Tangent, for a change dF of the points and dt = sum_a t_a.dx_a:
///     dFb = c (dF + F db),   db = (l'(t) dt - l'(J) dJ)/3,   dJ = C : dF,   dP = d2W : dFb,   3 dp = dP : Fb + P : dFb
///     df_a = -sum_q w (c dP + c db P - (dp l'(J) + p l''(J) dJ) C + (H / sum_q w - p l'(J)) dC) g_a - sum_q w (dp l'(t) + p l''(t) dt) t_a.
/// Families of fibres (laws/fibres.h) are a part of W: they see Fb. A tensor law sees Fb Q0, Q0 = [f s n] its material frame, and says dP and the nine by nine of d2W itself.
/// Made positive semidefinite, it is the sum of w dFb : d2W+ : dFb alone, d2W+ projected as in tetrahedra: the terms with P, p and dC fall away, and so they do at rest.
#include "supple/fem/hex8_hyper.h"
#include "supple/fem/hex8_lanes.h"
#include "supple/fem/principal_laws.h"
#include "supple/fem/tet4_hyper_tangents.h"
#include "supple/material/laws/costa.h"
#include "supple/material/laws/fibres.h"
#include "supple/material/laws/tensor_inversion.h"
#include "supple/math/lane_polar.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

/// ln r(J) with its derivatives.
struct LogRatio {
    Lanes value, first, second;
};

inline LogRatio log_ratio(Lanes J) {
    constexpr double kFrom = 0.1, kRange = 0.05;
    const Lanes one(1.0), zero(0.0);
    const LaneMask small = J < Lanes(kFrom);
    Lanes r = J, d = one, dd = zero;
    if (any_of(small)) {
        const Lanes decay = exponential(choose(small, (J - Lanes(kFrom)) / Lanes(kRange), zero));
        r = choose(small, Lanes(kFrom - kRange) + Lanes(kRange) * decay, J);
        d = choose(small, decay, one);
        dd = choose(small, decay / Lanes(kRange), zero);
    }
    const Lanes slope = d / r;
    return {logarithm(r), slope, dd / r - slope * slope};
}

inline Vector column_of(const Matrix& A, int j) { return {A.m[0][j], A.m[1][j], A.m[2][j]}; }

inline void set_column(Matrix& A, int j, const Vector& v) {
    A.m[0][j] = v.x;
    A.m[1][j] = v.y;
    A.m[2][j] = v.z;
}

/// dJ/dF
inline Matrix cofactors(const Matrix& F) {
    Matrix C;
    for (int j = 0; j < 3; ++j) set_column(C, j, cross(column_of(F, (j + 1) % 3), column_of(F, (j + 2) % 3)));
    return C;
}

/// Change of the cofactors with F by e_k g^T.
inline Matrix cofactor_change(const Matrix& F, int k, const Vector& g) {
    const Lanes zero(0.0), one(1.0), gj[3] = {g.x, g.y, g.z};
    const Vector e{k == 0 ? one : zero, k == 1 ? one : zero, k == 2 ? one : zero};
    Matrix C;
    for (int j = 0; j < 3; ++j) {
        const int m = (j + 1) % 3, n = (j + 2) % 3;
        set_column(C, j, gj[m] * cross(e, column_of(F, n)) - gj[n] * cross(e, column_of(F, m)));
    }
    return C;
}

/// One Gauss point of the elements in the lanes: what every law has.
struct HexPointState {
    Vector g[7];
    Lanes weight, J, c, p, W;
    LogRatio l;
    Matrix F, C, P;
    FibreTerm fibre[2];
};

/// Of a law in principal stretches.
struct PrincipalPoint : HexPointState {
    Matrix U, V;
    Principal e;
};

/// Of a tensor law: dP/dFb, its second indices in the material frame.
struct TensorPoint : HexPointState {
    Lanes D[9][9];
};

template <Law law>
struct PointOf {
    using Type = PrincipalPoint;
};
template <>
struct PointOf<Law::costa> {
    using Type = TensorPoint;
};

struct HexFibre {
    Lanes k, b;
    Vector f;
};

/// What the points of an element share.
struct HexShared {
    Lanes volume = Lanes(0.0), t = Lanes(0.0), H = Lanes(0.0), energy = Lanes(0.0);  // braces would make a list of one lane
    LogRatio l;
    Vector t_a[7];
    std::size_t families = 0;
    HexFibre fibre[2];
    Matrix Q0;  ///< of tensor laws
};

template <class Point>
inline void read_points(const Hex8HyperPass& pass, std::size_t block, std::size_t lane, const Vector d[7], Point points[8], HexShared& shared) {
    const Lanes zero(0.0);
    for (Vector& v : shared.t_a) v = {zero, zero, zero};
    for (std::size_t q = 0; q < kHexPoints; ++q) {
        HexPointState& s = points[q];
        const double* point = pass.point + (block * kHexPoints + q) * kHexPoint * kBlock + lane;
        load_vectors<7>(point, s.g);
        s.weight = load(point + 21 * kBlock);
        s.F = hex_gradient(d, s.g);
        s.C = cofactors(s.F);
        s.J = dot(column_of(s.F, 0), column_of(s.C, 0));
        shared.volume = shared.volume + s.weight;
        shared.t = shared.t + s.weight * s.J;
        for (int a = 0; a < 7; ++a) shared.t_a[a] = shared.t_a[a] + s.weight * (s.C * s.g[a]);
    }
    const Lanes inv = Lanes(1.0) / shared.volume;
    shared.t = inv * shared.t;
    for (Vector& v : shared.t_a) v = inv * v;
    shared.l = log_ratio(shared.t);
    shared.families = pass.families;
    for (std::size_t n = 0; n < pass.families; ++n) {
        const double* p = pass.fibre + (block * pass.families + n) * kFibre * kBlock + lane;
        shared.fibre[n] = {load(p), load(p + kBlock), {load(p + 2 * kBlock), load(p + 3 * kBlock), load(p + 4 * kBlock)}};
    }
}

/// A += v f^T
inline void add_outer(Matrix& A, const Vector& v, const Vector& f) {
    const Lanes left[3] = {v.x, v.y, v.z}, right[3] = {f.x, f.y, f.z};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) A.m[i][j] = A.m[i][j] + left[i] * right[j];
}

[[gnu::noinline]] void add_hex_fibres(const HexShared& shared, const Matrix& Fb, HexPointState& s) {
    for (std::size_t n = 0; n < shared.families; ++n) {
        const Vector a = Fb * shared.fibre[n].f;
        s.fibre[n] = fibre_term(shared.fibre[n].k, shared.fibre[n].b, a);
        s.W = s.W + s.fibre[n].W;
        s.p = s.p + Lanes(1.0 / 3) * dot(s.fibre[n].traction, a);
        add_outer(s.P, s.fibre[n].traction, shared.fibre[n].f);
    }
}

/// Fb = U diag(stretch) V^T of a point.
struct HexStretch {
    Matrix Fb, U, V;
    Lanes stretch[3];
};

inline HexStretch stretch_of(const HexShared& shared, Quat<Lanes> turn, HexPointState& s) {
    HexStretch k;
    s.l = log_ratio(s.J);
    s.c = exponential(Lanes(1.0 / 3) * (shared.l.value - s.l.value));
    for (int i = 0; i < 9; ++i) k.Fb.m[i / 3][i % 3] = s.c * s.F.m[i / 3][i % 3];
    const Matrix R = polar_rotation(k.Fb, turn);
    Matrix S = transposed_product(R, k.Fb);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) S.m[i][j] = S.m[j][i] = Lanes(0.5) * (S.m[i][j] + S.m[j][i]);
    jacobi_eigen(S, k.V);
    k.U = R * k.V;
    for (int i = 0; i < 3; ++i) k.stretch[i] = S.m[i][i];
    return k;
}

/// The law at a point: W, P and p, and what its tangent is made of.
template <Law law>
inline void respond(const Hex8HyperPass& pass, const double* parameter, const HexShared& shared, Quat<Lanes> turn, PrincipalPoint& s) {
    const HexStretch k = stretch_of(shared, turn, s);
    s.U = k.U;
    s.V = k.V;
    for (int i = 0; i < 3; ++i) s.e.s[i] = k.stretch[i];
    apply_law<law>(parameter, pass.parameters, s.e);
    s.W = s.e.W;
    s.p = Lanes(1.0 / 3) * (s.e.first[0] * s.e.s[0] + s.e.first[1] * s.e.s[1] + s.e.first[2] * s.e.s[2]);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            s.P.m[i][j] = s.U.m[i][0] * s.e.first[0] * s.V.m[j][0] + s.U.m[i][1] * s.e.first[1] * s.V.m[j][1] + s.U.m[i][2] * s.e.first[2] * s.V.m[j][2];
    if (shared.families > 0) add_hex_fibres(shared, k.Fb, s);
}

inline Lanes double_dot(const Matrix& A, const Matrix& B) {
    Lanes sum(0.0);
    for (int i = 0; i < 9; ++i) sum = sum + A.m[i / 3][i % 3] * B.m[i / 3][i % 3];
    return sum;
}

template <Law law>
[[gnu::noinline]] void respond(const Hex8HyperPass& pass, const double* parameter, const HexShared& shared, Quat<Lanes> turn, TensorPoint& s) {
    const HexStretch k = stretch_of(shared, turn, s);
    Lanes p[8];
    for (int i = 0; i < 8; ++i) p[i] = load(parameter + std::size_t(i + 1) * kBlock);
    const bool tangent = pass.inner != nullptr;
    const TensorResponse t = tensor_response([&](const Matrix& A) { return costa(p, A); }, load(parameter), k.U, transposed_product(shared.Q0, k.V), k.stretch,
                                             k.Fb * shared.Q0, tangent, pass.project);
    s.W = t.W;
    s.P = times_transposed(t.P, shared.Q0);
    s.p = Lanes(1.0 / 3) * double_dot(s.P, k.Fb);
    if (tangent) {
        for (int i = 0; i < 81; ++i) s.D[i / 9][i % 9] = t.C[i / 9][i % 9];
    }
    if (shared.families > 0) add_hex_fibres(shared, k.Fb, s);
}

/// c P - p l'(J) C
inline Matrix point_force(const HexPointState& s) {
    const Lanes pull = s.p * s.l.first;
    Matrix G;
    for (int i = 0; i < 9; ++i) G.m[i / 3][i % 3] = s.c * s.P.m[i / 3][i % 3] - pull * s.C.m[i / 3][i % 3];
    return G;
}

/// d2W : dFb of the law alone.
inline Matrix law_derivative(const PrincipalPoint& s, const HexShared&, const Matrix& dF) {
    const Lanes half(0.5);
    const Matrix X = transposed_product(s.U, dF) * s.V;
    Matrix Y;
    for (int i = 0; i < 3; ++i) Y.m[i][i] = s.e.second[i][0] * X.m[0][0] + s.e.second[i][1] * X.m[1][1] + s.e.second[i][2] * X.m[2][2];
    for (int k = 0; k < 3; ++k) {
        const int i = kPairI[k], j = kPairJ[k];
        const Lanes sum = half * s.e.symmetric[k] * (X.m[i][j] + X.m[j][i]), difference = half * s.e.antisymmetric[k] * (X.m[i][j] - X.m[j][i]);
        Y.m[i][j] = sum + difference;
        Y.m[j][i] = sum - difference;
    }
    return times_transposed(s.U * Y, s.V);
}

inline Matrix law_derivative(const TensorPoint& s, const HexShared& shared, const Matrix& dF) { return times_transposed(times(s.D, dF * shared.Q0), shared.Q0); }

template <class Point>
inline Matrix second_derivative(const Point& s, const HexShared& shared, const Matrix& dF) {
    Matrix P = law_derivative(s, shared, dF);
    for (std::size_t n = 0; n < shared.families; ++n) {
        const Lanes* M = s.fibre[n].M;
        const Vector& f = shared.fibre[n].f;
        add_outer(P, Matrix{{{M[0], M[3], M[5]}, {M[3], M[1], M[4]}, {M[5], M[4], M[2]}}} * (dF * f), f);
    }
    return P;
}

/// Column (corner b, axis k) of the inner stiffness, rows a <= b.
template <class Point>
[[gnu::noinline]] void stiffness_column(const Point points[8], const HexShared& shared, bool exact, int b, int k, Vector out[7]) {
    const Lanes zero(0.0), third(1.0 / 3);
    const auto part = [&](const Vector& v) { return k == 0 ? v.x : k == 1 ? v.y : v.z; };
    const Lanes dt = part(shared.t_a[b]), mean_pull = shared.H / shared.volume;
    for (int a = 0; a <= b; ++a) out[a] = {zero, zero, zero};
    Lanes dH(0.0);
    for (int q = 0; q < 8; ++q) {
        const Point& s = points[q];
        const Lanes g[3] = {s.g[b].x, s.g[b].y, s.g[b].z};
        const Lanes dJ = s.C.m[k][0] * g[0] + s.C.m[k][1] * g[1] + s.C.m[k][2] * g[2];
        const Lanes db = third * (shared.l.first * dt - s.l.first * dJ);
        Matrix dFb;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) dFb.m[i][j] = s.c * (db * s.F.m[i][j] + (i == k ? g[j] : zero));
        const Matrix dP = second_derivative(s, shared, dFb);
        Lanes dp = third * s.c * double_dot(dP, s.F);
        Lanes pull = dp * s.l.first;
        if (exact) {
            const Lanes more = third * double_dot(s.P, dFb);
            dp = dp + more;
            pull = dp * s.l.first + s.p * s.l.second * dJ;
        }
        Matrix G;
        for (int i = 0; i < 9; ++i) G.m[i / 3][i % 3] = s.weight * (s.c * dP.m[i / 3][i % 3] - pull * s.C.m[i / 3][i % 3]);
        dH = dH + s.weight * dp * shared.l.first;
        if (exact) {
            const Matrix dC = cofactor_change(s.F, k, s.g[b]);
            const Lanes first = s.weight * s.c * db, second = s.weight * (mean_pull - s.p * s.l.first);
            for (int i = 0; i < 9; ++i) G.m[i / 3][i % 3] = G.m[i / 3][i % 3] + first * s.P.m[i / 3][i % 3] + second * dC.m[i / 3][i % 3];
            dH = dH + s.weight * s.p * shared.l.second * dt;
        }
        for (int a = 0; a <= b; ++a) out[a] = out[a] + G * s.g[a];
    }
    for (int a = 0; a <= b; ++a) out[a] = out[a] + dH * shared.t_a[a];
}

/// All blocks of the elements from their inner ones: those of corner 0 make every row sum zero.
template <class Real>
inline void store_hex_blocks(const double* inner, Real* out) {
    for (int lane = 0; lane < kLanes; ++lane, out += kHexBlocks) {
        const auto number = [&](std::size_t a, std::size_t b, std::size_t n) {  // block (a, b) of corners 1..7, counted from 0
            const std::size_t at = a <= b ? hex_pair(a, b, 7) * 9 + n : hex_pair(b, a, 7) * 9 + n % 3 * 3 + n / 3;
            return inner[at * kBlock + std::size_t(lane)];
        };
        double corner[9] = {};
        for (std::size_t b = 0; b < 7; ++b) {
            Real* to = out + hex_pair(0, b + 1) * 12;
            for (std::size_t n = 0; n < 9; ++n) {
                double sum = 0;
                for (std::size_t a = 0; a < 7; ++a) sum += number(a, b, n);
                to[n / 3 * 4 + n % 3] = Real(-sum);
                corner[n] += sum;
                for (std::size_t a = 0; a <= b; ++a) out[hex_pair(a + 1, b + 1) * 12 + n / 3 * 4 + n % 3] = Real(number(a, b, n));
            }
        }
        for (std::size_t n = 0; n < 9; ++n) out[n / 3 * 4 + n % 3] = Real(corner[n]);
        for (std::size_t pair = 0; pair < kHexPairs; ++pair)
            for (std::size_t j = 0; j < 3; ++j) out[pair * 12 + j * 4 + 3] = Real(0);
    }
}

template <class Point>
inline void store_hex_tangent(const Hex8HyperPass& pass, std::size_t at, Point points[8], const HexShared& shared, Lanes live) {
    const std::size_t block = at / kBlock, lane = at % kBlock;
    if constexpr (std::is_same_v<Point, PrincipalPoint>) {  // a tensor law has done it
        if (pass.project) {
            for (int q = 0; q < 8; ++q) project(points[q].e);
        }
    }
    double* inner = pass.inner + block * kHexInner * kBlock + lane;
    for (int b = 0; b < 7; ++b) {
        for (int k = 0; k < 3; ++k) {
            Vector column[7];
            stiffness_column(points, shared, !pass.project, b, k, column);
            for (int a = 0; a <= b; ++a) {
                double* to = inner + (hex_pair(std::size_t(a), std::size_t(b), 7) * 9 + std::size_t(3 * k)) * kBlock;
                store(to, live * column[a].x);
                store(to + kBlock, live * column[a].y);
                store(to + 2 * kBlock, live * column[a].z);
            }
        }
    }
    if (pass.block_f != nullptr) store_hex_blocks(inner, pass.block_f + at * kHexBlocks);
    if (pass.block_d != nullptr) store_hex_blocks(inner, pass.block_d + at * kHexBlocks);
}

template <class Point>
inline void store_hex_stress(const Point points[8], const HexShared& shared, double* stress) {
    const Lanes tiny(1e-12), zero(0.0), inv_volume = Lanes(1.0) / shared.volume;
    Lanes sum[6] = {zero, zero, zero, zero, zero, zero};
    constexpr int kRow[6] = {0, 1, 2, 0, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 0};
    for (int q = 0; q < 8; ++q) {
        const HexPointState& s = points[q];
        const Lanes J = choose(magnitude(s.J) < tiny, choose(s.J < zero, zero - tiny, tiny), s.J);  // a flat point keeps its sign and stays finite
        const Lanes share = s.weight * inv_volume / J, half(0.5);
        const Matrix G = point_force(s);
        for (int c = 0; c < 6; ++c) {
            const int i = kRow[c], j = kColumn[c];
            Lanes t(0.0);
            for (int m = 0; m < 3; ++m) t = t + G.m[i][m] * s.F.m[j][m] + G.m[j][m] * s.F.m[i][m];
            sum[c] = sum[c] + share * half * t;
        }
    }
    for (int c = 0; c < 6; ++c) store(stress + std::size_t(c) * kBlock, c < 3 ? sum[c] + shared.H * inv_volume : sum[c]);
}

template <Law law>
void hex_hyper_elements(const Hex8HyperPass& pass, std::size_t begin, std::size_t end) {
    const Lanes zero(0.0), one(1.0);
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        const std::size_t block = at / kBlock, lane = at % kBlock;
        Vector d[7], mean[7];
        differences<8>(pass.position, pass.vertex + block * 8 * kBlock + lane, d);
        load_vectors<7>(pass.gradient + block * 21 * kBlock + lane, mean);
        double* quaternion = pass.quaternion + block * 4 * kBlock + lane;
        Quat<Lanes> turn{load(quaternion), load(quaternion + kBlock), load(quaternion + 2 * kBlock), load(quaternion + 3 * kBlock)};
        polar_rotation(hex_gradient(d, mean), turn);
        store(quaternion, turn.w);
        store(quaternion + kBlock, turn.x);
        store(quaternion + 2 * kBlock, turn.y);
        store(quaternion + 3 * kBlock, turn.z);

        using Point = typename PointOf<law>::Type;
        Point points[8];
        HexShared shared;
        read_points(pass, block, lane, d, points, shared);
        const double* parameter = pass.parameter + block * pass.parameters * kBlock + lane;
        if constexpr (is_tensor_law(law)) shared.Q0 = load_frame(parameter, pass.parameters);
        for (Point& s : points) {
            respond<law>(pass, parameter, shared, turn, s);
            shared.H = shared.H + s.weight * s.p * shared.l.first;
            shared.energy = shared.energy + s.weight * s.W;
        }
        const Lanes live = choose(load(pass.volume + at) > zero, one, zero);
        if (pass.corner_force != nullptr) {
            Vector f[7];
            for (int a = 0; a < 7; ++a) f[a] = (zero - shared.H) * shared.t_a[a];
            for (const HexPointState& s : points) {
                const Matrix G = point_force(s);
                for (int a = 0; a < 7; ++a) f[a] = f[a] - s.weight * (G * s.g[a]);
            }
            for (int a = 0; a < 7; ++a) f[a] = live * f[a];
            store_hex_corners(pass.corner_force + at * 32, f);
        }
        if (pass.energy != nullptr) store(pass.energy + at, live * shared.energy);
        if (pass.stress != nullptr) store_hex_stress(points, shared, pass.stress + block * 6 * kBlock + lane);
        if (pass.inner != nullptr) store_hex_tangent(pass, at, points, shared, live);
    }
}

inline constexpr Hex8HyperKernels kHexHyperKernels{{hex_hyper_elements<Law::st_venant_kirchhoff>, hex_hyper_elements<Law::neo_hookean>,
                                                    hex_hyper_elements<Law::stable_neo_hookean>, hex_hyper_elements<Law::mooney_rivlin>,
                                                    hex_hyper_elements<Law::arruda_boyce>, hex_hyper_elements<Law::veronda_westman>,
                                                    hex_hyper_elements<Law::ogden>, hex_hyper_elements<Law::costa>}};

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
