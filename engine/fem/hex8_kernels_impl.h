#pragma once
/// Hexahedra in a frame, compiled once per instruction set by hex8_kernels_<isa>.cpp.
///
/// With the rest stiffness K0 of the element (fem/hex8_stiffness.h) and one rotation R for all of it:
///     f = -R K0 (R^T x - X),      K (R held) = R K0 R^T,      mean F = sum_a x_a b_a^T  (b_a: volume mean of the gradient of shape function a)
/// `polar`, `svd`: R is the polar factor of the mean F. `large`: R = Q(x) Q(X)^T, Q = [x y z] from the mean edges of the element: x along the mean of its four first edges,
/// z across the mean of its four second ones, y completes. Neither is the gradient of an energy: f lacks the term dR/dx, and leaves a small net torque.
/// Stress: sigma = R (2 mu (e - e_p) + lambda tr(e) I) R^T with e = sym(R^T F) - I of the mean F: the mean of the element's stress, since its inner modes have no mean strain.
///
/// Split y = R^T x into what is affine, S X_a with S = R^T F, and the rest z_a, which has no mean gradient: sum_a z_a b_a^T = 0. Of both integrations K0 keeps the two apart,
/// whatever the shape: a uniform strain e makes the forces V s b_a, s = 2 mu e + lambda tr(e) I, and those do no work on z (nor on the inner modes).
///   * Plastic strain e_p is uniform in an element, of the mean strain. It enters the condensed energy as  - V e_p : s + V/2 e_p : s_p, s_p = 2 mu e_p (e_p has no trace), so its
///     forces K0 (e_p X) are R V s_p b_a: they need no matrix, and none per class. Elements bend elastically about their mean: what yields in bending is resolved by layers.
///   * Derivative of R, dR = R [r]x, r = W dy: with p = K0 (y - X) the corner forces in the frame,   -R^T df = K0 dy + M W dy,   M r = r x p - K0 (r x y),   of rank three.
///     Its affine part is that of a tetrahedron of the same S (tet4_kernels_impl.h): with w = 1/2 sum_b b_b x dy_b, the twist of the mean gradient,   V (T w) x b_a,   that is
///         K_ab += V/2 [R b_a]x^T (R T R^T) [R b_b]x,
///     symmetric, T clamped as there. The rest, r x q - K0 (r x z) with q = K0 z, drives the forces of z by the twist and is driven by nothing: it is not symmetric, because bent
///     hexahedra have no energy (above), and is left out. So the tangent is exact where elements are strained uniformly, of any shape; where they are bent or twisted it lacks a
///     part proportional to z, which falls with the size of the elements, against the whole stress that the warped tangent lacks.
#include "supple/fem/frame_lanes.h"
#include "supple/fem/hex8_kernels.h"
#include "supple/fem/hex8_lanes.h"
#include "supple/math/lane_polar.h"
#include "supple/math/lane_svd.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

/// f = K0 u for the corners 1..7, u = 0 at corner 0. `number(pair7, n)`: number n = 3 column + row of an inner block.
template <class Number>
inline void multiply(const Vector u[7], Vector f[7], Number&& number) {
    for (std::size_t a = 0; a < 7; ++a) {
        Vector sum{Lanes(0.0), Lanes(0.0), Lanes(0.0)};
        for (std::size_t b = 0; b < a; ++b) {  // stored as (b, a)
            const std::size_t pair = hex_pair(b, a, 7);
            sum.x = sum.x + number(pair, 0) * u[b].x + number(pair, 1) * u[b].y + number(pair, 2) * u[b].z;
            sum.y = sum.y + number(pair, 3) * u[b].x + number(pair, 4) * u[b].y + number(pair, 5) * u[b].z;
            sum.z = sum.z + number(pair, 6) * u[b].x + number(pair, 7) * u[b].y + number(pair, 8) * u[b].z;
        }
        for (std::size_t b = a; b < 7; ++b) {
            const std::size_t pair = hex_pair(a, b, 7);
            sum.x = sum.x + number(pair, 0) * u[b].x + number(pair, 3) * u[b].y + number(pair, 6) * u[b].z;
            sum.y = sum.y + number(pair, 1) * u[b].x + number(pair, 4) * u[b].y + number(pair, 7) * u[b].z;
            sum.z = sum.z + number(pair, 2) * u[b].x + number(pair, 5) * u[b].y + number(pair, 8) * u[b].z;
        }
        f[a] = sum;
    }
}

/// Place of an inner block among all of an element: pair (a + 1, b + 1) of eight, in columns of four.
inline constexpr auto kInnerBlock = [] {
    struct Table {
        std::size_t at[28];
    } table{};
    for (std::size_t a = 0; a < 7; ++a)
        for (std::size_t b = a; b < 7; ++b) table.at[hex_pair(a, b, 7)] = hex_pair(a + 1, b + 1) * 12;
    return table;
}();

inline void multiply(const HexStiffnessView& k, std::size_t block, std::size_t lane, const Vector u[7], Vector f[7]) {
    const std::int64_t place = k.place[block];
    if (place >= 0) {
        const double* shared = k.shared + std::size_t(place) * kHexBlocks;
        multiply(u, f, [&](std::size_t pair, std::size_t n) { return Lanes(shared[kInnerBlock.at[pair] + n / 3 * 4 + n % 3]); });
    } else {
        const double* own = k.own + std::size_t(-1 - place) * (kHexInner * kBlock) + lane;
        multiply(u, f, [&](std::size_t pair, std::size_t n) { return load(own + (pair * 9 + n) * kBlock); });
    }
}

/// Four times the mean of the edges in the first and second direction. d: corners from corner 0.
inline void mean_edges(const Vector d[7], Vector& first, Vector& second) {
    first = d[0] + (d[1] - d[2]) + (d[4] - d[3]) + (d[5] - d[6]);
    second = d[2] + (d[1] - d[0]) + (d[6] - d[3]) + (d[5] - d[4]);
}

template <Frame frame>
inline Matrix hex_rotation(const Matrix& F, const Vector d[7], const Vector D[7], Quat<Lanes>& q) {
    if constexpr (frame == Frame::rest) {
        q = {Lanes(1.0), Lanes(0.0), Lanes(0.0), Lanes(0.0)};
    } else if constexpr (frame == Frame::large) {
        Vector x, y, X, Y;
        mean_edges(d, x, y);
        mean_edges(D, X, Y);
        q = quaternion(turn_of(edge_frame(x, y), edge_frame(X, Y)));
    } else {
        if constexpr (frame == Frame::svd) q = quaternion(svd_rotation(F));
        return polar_rotation(F, q);
    }
    return rotation_matrix(q);
}

inline Vector turned_back(const Matrix& R, const Vector& v) {  // R^T v
    return {R.m[0][0] * v.x + R.m[1][0] * v.y + R.m[2][0] * v.z, R.m[0][1] * v.x + R.m[1][1] * v.y + R.m[2][1] * v.z,
            R.m[0][2] * v.x + R.m[1][2] * v.y + R.m[2][2] * v.z};
}

template <class Real>
inline void store_record(const Matrix& R, Lanes scale, Real* out) {
    for (int j = 0; j < 3; ++j) store_points(out + 4 * j, kHexRecord, R.m[0][j], R.m[1][j], R.m[2][j], j == 0 ? scale : Lanes(0.0));
}

/// R (2 mu (e - e_p) + lambda tr(e) I) R^T, e = sym(G) - I.
inline void store_stress(const Matrix& R, const Matrix& G, const Matrix& plastic, Lanes lambda, Lanes mu, double* stress) {
    const Lanes pressure = lambda * (G.m[0][0] + G.m[1][1] + G.m[2][2] - Lanes(3.0));
    Matrix S;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) S.m[i][j] = mu * (G.m[i][j] + G.m[j][i] - Lanes(2.0) * plastic.m[i][j]);
    for (int i = 0; i < 3; ++i) S.m[i][i] = Lanes(2.0) * mu * (G.m[i][i] - Lanes(1.0) - plastic.m[i][i]) + pressure;
    const Matrix P = R * S;
    for (int c = 0; c < 6; ++c) {
        const int i = kVoigtRow[c], j = kVoigtColumn[c];
        store(stress + std::size_t(c) * kBlock, P.m[i][0] * R.m[j][0] + P.m[i][1] * R.m[j][1] + P.m[i][2] * R.m[j][2]);
    }
}

/// 2 mu V (e_p : e_p / 2 - e_p : e)
inline Lanes plastic_energy(const Matrix& G, const Matrix& plastic, Lanes two_mu_volume) {
    Lanes sum(0.0);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) sum = sum + plastic.m[i][j] * (Lanes(0.5) * plastic.m[i][j] - G.m[i][j] + Lanes(i == j ? 1.0 : 0.0));
    return two_mu_volume * sum;
}

template <class Real>
inline void store_hex_twist(const Matrix& R, const Vector b[7], const Matrix& X, Real* out) {
    Vector turned[8];
    for (int a = 0; a < 7; ++a) turned[a + 1] = R * b[a];
    turned[0] = turned[1];
    for (int a = 2; a < 8; ++a) turned[0] = turned[0] + turned[a];
    turned[0] = Lanes(-1.0) * turned[0];
    for (int a = 0; a < 8; ++a) {
        const Lanes fourth = a < 6 ? X.m[kVoigtRow[a]][kVoigtColumn[a]] : Lanes(0.0);
        store_points(out + 4 * a, kHexTwist, turned[a].x, turned[a].y, turned[a].z, fourth);
    }
}

/// The twist stiffness of the mean strain.
inline void store_twist_stiffness(const Hex8Pass& pass, std::size_t at, const Matrix& R, const Matrix& G, const Vector b[7], Lanes lambda, Lanes mu) {
    const Lanes V = load(pass.volume + at), mean = lambda * (G.m[0][0] + G.m[1][1] + G.m[2][2] - Lanes(3.0));
    Matrix T = twist_stiffness(G, mu, mean, pass.project);
    double* twist = pass.twist + at / kBlock * 6 * kBlock + at % kBlock;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) T.m[i][j] = V * T.m[i][j];
    for (int c = 0; c < 6; ++c) store(twist + std::size_t(c) * kBlock, T.m[kVoigtRow[c]][kVoigtColumn[c]]);
    if (pass.twist_f == nullptr && pass.twist_d == nullptr) return;
    Matrix X = turn_of(R * T, R);  // R T R^T
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) X.m[i][j] = Lanes(0.5) * X.m[i][j];
    if (pass.twist_f != nullptr) store_hex_twist(R, b, X, pass.twist_f + at * kHexTwist);
    if (pass.twist_d != nullptr) store_hex_twist(R, b, X, pass.twist_d + at * kHexTwist);
}

/// Where the elements of some lanes are: corners from corner 0, at rest and mean gradients too, and the rotation found.
struct HexPlace {
    Vector d[7], D[7], b[7];
    Matrix F, R;
};

template <Frame frame, class Pass>
inline void find_place(const Pass& pass, std::size_t at, HexPlace& e) {
    const std::size_t block = at / kBlock, lane = at % kBlock;
    differences<8>(pass.position, pass.vertex + block * 8 * kBlock + lane, e.d);
    load_vectors<7>(pass.edge + block * 21 * kBlock + lane, e.D);
    load_vectors<7>(pass.gradient + block * 21 * kBlock + lane, e.b);
    double* quaternion = pass.quaternion + block * 4 * kBlock + lane;
    e.F = hex_gradient(e.d, e.b);
    Quat<Lanes> q{load(quaternion), load(quaternion + kBlock), load(quaternion + 2 * kBlock), load(quaternion + 3 * kBlock)};
    e.R = hex_rotation<frame>(e.F, e.d, e.D, q);
    store(quaternion, q.w);
    store(quaternion + kBlock, q.x);
    store(quaternion + 2 * kBlock, q.y);
    store(quaternion + 3 * kBlock, q.z);
}

template <Frame frame>
void hex_elements(const Hex8Pass& pass, std::size_t begin, std::size_t end) {
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        const std::size_t block = at / kBlock, lane = at % kBlock;
        HexPlace e;
        find_place<frame>(pass, at, e);
        const Lanes scale = load(pass.stiffness.scale + at);
        const double* moduli = pass.moduli + block * 2 * kBlock + lane;
        const Lanes lambda = load(moduli), mu = load(moduli + kBlock), two_mu_volume = Lanes(2.0) * mu * load(pass.volume + at);
        const Matrix G = transposed_product(e.R, e.F);
        Matrix plastic{};
        if (pass.plastic != nullptr) plastic = load_symmetric(pass.plastic + block * 6 * kBlock + lane);
        if (pass.corner_force != nullptr || pass.energy != nullptr) {
            Vector u[7], f[7];
            for (int a = 0; a < 7; ++a) u[a] = turned_back(e.R, e.d[a]) - e.D[a];
            multiply(pass.stiffness, block, lane, u, f);
            if (pass.energy != nullptr) {
                Lanes work(0.0);
                for (int a = 0; a < 7; ++a) work = work + dot(u[a], f[a]);
                Lanes energy = Lanes(0.5) * scale * work;
                if (pass.plastic != nullptr) energy = energy + plastic_energy(G, plastic, two_mu_volume);
                store(pass.energy + at, energy);
            }
            if (pass.corner_force != nullptr) {
                for (int a = 0; a < 7; ++a) {
                    f[a] = (Lanes(0.0) - scale) * f[a];
                    if (pass.plastic != nullptr) f[a] = f[a] + two_mu_volume * (plastic * e.b[a]);
                    f[a] = e.R * f[a];
                }
                store_hex_corners(pass.corner_force + at * 32, f);
            }
        }
        if (pass.record_f != nullptr) store_record(e.R, scale, pass.record_f + at * kHexRecord);
        if (pass.record_d != nullptr) store_record(e.R, scale, pass.record_d + at * kHexRecord);
        if constexpr (frame == Frame::polar || frame == Frame::svd) {
            if (pass.twist != nullptr) store_twist_stiffness(pass, at, e.R, G, e.b, lambda, mu);
        }
        if (pass.stress != nullptr) store_stress(e.R, G, plastic, lambda, mu, pass.stress + block * 6 * kBlock + lane);
    }
}

template <Frame frame>
void hex_flow(const Hex8Flow& pass, std::size_t begin, std::size_t end) {
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        const std::size_t block = at / kBlock, lane = at % kBlock;
        HexPlace e;
        find_place<frame>(pass, at, e);
        flow_strain(transposed_product(e.R, e.F), pass.parameter + block * kFlowParameters * kBlock + lane, pass.plastic + block * 6 * kBlock + lane);
    }
}

inline void hex_product(const Hex8Product& pass, std::size_t begin, std::size_t end) {
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        const std::size_t block = at / kBlock, lane = at % kBlock;
        Vector d[7], f[7];
        differences<8>(pass.field, pass.vertex + block * 8 * kBlock + lane, d);
        if (pass.quaternion == nullptr) {
            multiply(pass.stiffness, block, lane, d, f);
        } else {
            const double* quaternion = pass.quaternion + block * 4 * kBlock + lane;
            const Matrix R = rotation_matrix(Quat<Lanes>{load(quaternion), load(quaternion + kBlock), load(quaternion + 2 * kBlock), load(quaternion + 3 * kBlock)});
            const Lanes scale = load(pass.stiffness.scale + at);
            for (int a = 0; a < 7; ++a) d[a] = turned_back(R, d[a]);
            multiply(pass.stiffness, block, lane, d, f);
            for (int a = 0; a < 7; ++a) f[a] = scale * f[a];
            if (pass.twist != nullptr) {  // + (V T w) x b
                Vector b[7];
                load_vectors<7>(pass.gradient + block * 21 * kBlock + lane, b);
                const Vector t = load_symmetric(pass.twist + block * 6 * kBlock + lane) * axial(hex_gradient(d, b));
                for (int a = 0; a < 7; ++a) f[a] = f[a] + cross(t, b[a]);
            }
            for (int a = 0; a < 7; ++a) f[a] = R * f[a];
        }
        store_hex_corners(pass.corner_force + at * 32, f);
    }
}

/// c += s R K R^T, columns of four.
template <class Real>
inline void add_turned(const Real* k, const Real* record, FourOf<Real> c[3]) {
    using R4 = FourOf<Real>;
    const R4 r0 = load4(record), r1 = load4(record + 4), r2 = load4(record + 8);
    const Real s = record[3];
    R4 t[3];  // s R K
    for (int j = 0; j < 3; ++j) {
        const R4 column = load4(k + 4 * j) * s;
        t[j] = r0 * splat<0>(column) + r1 * splat<1>(column) + r2 * splat<2>(column);
    }
    c[0] += t[0] * splat<0>(r0) + t[1] * splat<0>(r1) + t[2] * splat<0>(r2);
    c[1] += t[0] * splat<1>(r0) + t[1] * splat<1>(r1) + t[2] * splat<1>(r2);
    c[2] += t[0] * splat<2>(r0) + t[1] * splat<2>(r1) + t[2] * splat<2>(r2);
}

template <class Real>
void hex_assemble(const Hex8Assembly<Real>& pass, std::size_t begin, std::size_t end) {
    using R4 = FourOf<Real>;
    const bool add = pass.diagonal_shift == nullptr;
    const Real scale = Real(pass.stiffness_scale);
    for (std::size_t row = begin; row < end; ++row) {
        for (std::int32_t block = pass.row_start[row]; block < pass.row_start[row + 1]; ++block) {
            const std::size_t column = std::size_t(pass.column[block]);
            if (column < row) continue;
            if (add && pass.contribution_start[block] == pass.contribution_start[block + 1]) continue;
            R4 c[3] = {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}, t[3] = {c[0], c[0], c[0]};
            for (std::int64_t i = pass.contribution_start[block]; i < pass.contribution_start[block + 1]; ++i) {
                const std::uint32_t pair = pass.contribution[i];
                const std::size_t element = pair >> 6, a = (pair >> 3) & 7u, b = pair & 7u;
                const std::size_t kind = pass.class_of == nullptr ? element : std::size_t(pass.class_of[element]);
                const Real* k = pass.stiffness + kind * kHexBlocks + hex_pair(a < b ? a : b, a < b ? b : a) * 12;
                R4* to = a <= b ? c : t;  // t gathers what is stored as the other triangle
                if (pass.twist != nullptr) {
                    const Real* X = pass.twist + element * kHexTwist;
                    const R4 x[3] = {{X[3], X[15], X[23], 0}, {X[15], X[7], X[19], 0}, {X[23], X[19], X[11], 0}};
                    add_twist(x, load4(X + 4 * a), load4(X + 4 * b), c);
                }
                if (pass.record != nullptr) {
                    add_turned(k, pass.record + element * kHexRecord, to);
                } else {
                    for (int j = 0; j < 3; ++j) to[j] += load4(k + 4 * j);
                }
            }
            Real* value = pass.value + std::size_t(block) * 12;
            Real* mirror = pass.value + std::size_t(pass.mirror[block]) * 12;
            Real m[3][3];
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) m[i][j] = scale * (c[j][i] + t[i][j]) + (add ? value[4 * j + i] : Real(0));
                if (column == row && !add) m[i][i] += Real(pass.diagonal_shift[row]);
            }
            for (int j = 0; j < 3; ++j) {
                if (column != row) store4(mirror + 4 * j, R4{m[j][0], m[j][1], m[j][2], 0});
                store4(value + 4 * j, R4{m[0][j], m[1][j], m[2][j], 0});
            }
        }
    }
}

inline constexpr Hex8Kernels kHexKernels{{hex_elements<Frame::rest>, hex_elements<Frame::large>, hex_elements<Frame::polar>, hex_elements<Frame::svd>},
                                         {hex_flow<Frame::rest>, hex_flow<Frame::large>, hex_flow<Frame::polar>, hex_flow<Frame::svd>},
                                         hex_product,
                                         hex_assemble<float>,
                                         hex_assemble<double>};

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
