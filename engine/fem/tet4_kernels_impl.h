#pragma once
/// The kernels of linear tetrahedra, compiled once per instruction set by tet4_kernels_<isa>.cpp.
///
/// Linear elasticity in the frame R of an element, rest gradients g_a, F = sum_a x_a g_a^T:
///     e   = sym(R^T F) - I,                    s = 2 mu e + lambda tr(e) I
///     W   = V (mu e:e + lambda/2 tr(e)^2)      (an energy of x where R is I or the polar factor)
///     P   = R s,                               f_a = -V P g_a,      sigma = R s R^T
///     K_ab (R held) = V (lambda g'_a g'_b^T + mu g'_b g'_a^T + mu (g_a.g_b) I),   g' = R g
/// With plastic strain e_p, e is sym(R^T F) - I - e_p.
///
/// With r_a = sqrt(mu V) g'_a the first two terms are (lambda/mu) r_a r_b^T + r_b r_a^T: what assemble() sums. Where lambda/mu is the same everywhere, one sum of r_a r_b^T gives both.
///
/// The derivative of the polar factor R adds a stiffness to the twist of F alone. With S = R^T F, G = R^T dF, skew(G) = [w]x and dR = R [r]x:
///     (tr(S) I - S) r = 2 w,      R^T dP = mu (G + G^T) + lambda tr(G) I + [T w]x,
///     T = 2 mu I + 2 (lambda tr(S - I) - 2 mu) (tr(S) I - S)^-1,
/// eigenvalues 2 mu + 2 (lambda tr(S - I) - 2 mu)/(s_i + s_j) in the axes of S: the only ones of d2W/dF2 that can be negative. In corners:
///     K_ab += V/2 [g'_a]x^T (R T R^T) [g'_b]x.
#include "supple/fem/frame_lanes.h"
#include "supple/math/lane_polar.h"
#include "supple/math/lane_svd.h"
#include "supple/math/lanes4.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

/// R of an element, and its quaternion. d: current edges from corner 0; g: rest gradients.
template <Frame frame>
inline Matrix find_rotation(const Matrix& F, const Vector d[3], const Vector g[3], Quat<Lanes>& q) {
    if constexpr (frame == Frame::rest) {
        q = {Lanes(1.0), Lanes(0.0), Lanes(0.0), Lanes(0.0)};
    } else if constexpr (frame == Frame::large) {
        // The rest edges are the columns of the inverse of the gradients' matrix: along g2 x g3 and g3 x g1.
        q = quaternion(turn_of(edge_frame(d[0], d[1]), edge_frame(cross(g[1], g[2]), cross(g[2], g[0]))));
    } else {
        if constexpr (frame == Frame::svd) q = quaternion(svd_rotation(F));
        return polar_rotation(F, q);
    }
    return rotation_matrix(q);
}

template <class Real>
inline void store_twist(Real* out, const Matrix& T, Lanes scale) {
    alignas(64) double s[6][kLanes];
    for (int c = 0; c < 6; ++c) store(s[c], scale * T.m[kVoigtRow[c]][kVoigtColumn[c]]);
    for (int lane = 0; lane < kLanes; ++lane)
        for (int c = 0; c < 6; ++c) out[std::size_t(lane) * kTwistRecord + std::size_t(c)] = Real(s[c][lane]);
}

template <Frame frame>
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
        const Matrix R = find_rotation<frame>(F, d, g, q);
        store(quaternion, q.w);
        store(quaternion + kBlock, q.x);
        store(quaternion + 2 * kBlock, q.y);
        store(quaternion + 3 * kBlock, q.z);

        const Matrix G = transposed_product(R, F);
        const Lanes trace = G.m[0][0] + G.m[1][1] + G.m[2][2] - Lanes(3.0);  // of the whole strain: plastic strain has none
        Matrix S;  // s, the stress in the frame
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                S.m[i][j] = mu * (G.m[i][j] + G.m[j][i]);
                if (i == j) S.m[i][j] = two * mu * (G.m[i][i] - one) + lambda * trace;
            }
        if (pass.plastic != nullptr) {
            const Matrix plastic = load_symmetric(pass.plastic + block * 6 * kBlock + lane);
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) S.m[i][j] = S.m[i][j] - two * mu * plastic.m[i][j];
        }
        Lanes mean = lambda * trace;
        if (pass.pressure != nullptr) {
            const Lanes pressure = load(pass.pressure + at);
            mean = mean + pressure;
            for (int i = 0; i < 3; ++i) S.m[i][i] = S.m[i][i] + pressure;
        }
        const Matrix P = R * S;

        if (pass.dilatation != nullptr) store(pass.dilatation + at, trace);
        if (pass.corner_force != nullptr) {
            Vector f[4];
            corner_forces(P, g, V, f);
            store_corners(pass.corner_force + (at - pass.corner_block * kBlock) * 16, f, Lanes(0.0), Lanes(0.0));
        }
        if (pass.record_f != nullptr || pass.record_d != nullptr) {
            Vector r[4];
            const LaneMask stiff = mu * V > Lanes(0.0);
            const Lanes size = root(mu * V), inverse = choose(stiff, one / choose(stiff, size, one), Lanes(0.0));
            const Lanes ratio = choose(stiff, lambda / choose(stiff, mu, one), Lanes(0.0));
            for (int k = 0; k < 3; ++k) r[k + 1] = size * (R * g[k]);
            r[0] = Lanes(-1.0) * (r[1] + r[2] + r[3]);
            if (pass.record_f != nullptr) store_corners(pass.record_f + at * kRecord, r, ratio, inverse);
            if (pass.record_d != nullptr) store_corners(pass.record_d + at * kRecord, r, ratio, inverse);
        }
        if constexpr (frame == Frame::polar || frame == Frame::svd) {
            if (pass.twist != nullptr) {
                const Matrix T = twist_stiffness(G, mu, mean, pass.project);
                double* twist = pass.twist + block * 6 * kBlock + lane;
                for (int c = 0; c < 6; ++c) store(twist + std::size_t(c) * kBlock, T.m[kVoigtRow[c]][kVoigtColumn[c]]);
                const Matrix turned = turn_of(R * T, R);  // R T R^T
                const Lanes share = choose(mu > Lanes(0.0), half / choose(mu > Lanes(0.0), mu, one), Lanes(0.0));  // V/2, and the record's vectors have sqrt(mu V)
                if (pass.twist_f != nullptr) store_twist(pass.twist_f + at * kTwistRecord, turned, share);
                if (pass.twist_d != nullptr) store_twist(pass.twist_d + at * kTwistRecord, turned, share);
            }
        }
        if (pass.energy != nullptr) {
            Lanes ee(0.0);
            Matrix plastic{};
            if (pass.plastic != nullptr) plastic = load_symmetric(pass.plastic + block * 6 * kBlock + lane);
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) {
                    Lanes e = half * (G.m[i][j] + G.m[j][i]) - (i == j ? one : Lanes(0.0));
                    if (pass.plastic != nullptr) e = e - plastic.m[i][j];
                    ee = ee + e * e;
                }
            store(pass.energy + at, V * (mu * ee + half * lambda * trace * trace));
        }
        if (pass.stress != nullptr) {
            double* stress = pass.stress + block * 6 * kBlock + lane;
            for (int c = 0; c < 6; ++c) {
                const int i = kVoigtRow[c], j = kVoigtColumn[c];
                store(stress + std::size_t(c) * kBlock, P.m[i][0] * R.m[j][0] + P.m[i][1] * R.m[j][1] + P.m[i][2] * R.m[j][2]);
            }
        }
    }
}

template <Frame frame>
inline void flow(const Tet4Flow& pass, std::size_t begin, std::size_t end) {
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        const std::size_t block = at / kBlock, lane = at % kBlock;
        Vector d[3], g[3];
        corner_differences(pass.position, pass.vertex + block * 4 * kBlock + lane, d);
        load_gradients(pass.gradient + block * 9 * kBlock + lane, g);
        double* quaternion = pass.quaternion + block * 4 * kBlock + lane;
        const Matrix F = gradient(d, g);
        Quat<Lanes> q{load(quaternion), load(quaternion + kBlock), load(quaternion + 2 * kBlock), load(quaternion + 3 * kBlock)};
        const Matrix G = transposed_product(find_rotation<frame>(F, d, g, q), F);
        store(quaternion, q.w);
        store(quaternion + kBlock, q.x);
        store(quaternion + 2 * kBlock, q.y);
        store(quaternion + 3 * kBlock, q.z);

        flow_strain(G, pass.parameter + block * kFlowParameters * kBlock + lane, pass.plastic + block * 6 * kBlock + lane);
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
        const Lanes trace = G.m[0][0] + G.m[1][1] + G.m[2][2];
        if (pass.dilatation != nullptr) {
            store(pass.dilatation + at, trace);
            continue;
        }
        Lanes pressure = lambda * trace;
        if (pass.pressure != nullptr) pressure = pressure + load(pass.pressure + at);
        Matrix S;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                S.m[i][j] = mu * (G.m[i][j] + G.m[j][i]);
                if (i == j) S.m[i][j] = S.m[i][j] + pressure;
            }
        if (pass.twist != nullptr) {  // + [T w]x, [w]x = skew(G)
            const Vector t = load_symmetric(pass.twist + block * 6 * kBlock + lane) * axial(G);
            S.m[2][1] = S.m[2][1] + t.x;
            S.m[1][2] = S.m[1][2] - t.x;
            S.m[0][2] = S.m[0][2] + t.y;
            S.m[2][0] = S.m[2][0] - t.y;
            S.m[1][0] = S.m[1][0] + t.z;
            S.m[0][1] = S.m[0][1] - t.z;
        }
        Vector f[4];
        corner_forces(R * S, g, Lanes(0.0) - V, f);
        store_corners(pass.corner_force + (at - pass.corner_block * kBlock) * 16, f, Lanes(0.0), Lanes(0.0));
    }
}

/// The sum of the contributions of a block.
template <bool uniform, class Real>
inline Block3<Real> sum_pairs(const Tet4Assembly<Real>& pass, const std::uint32_t* first, const std::uint32_t* last) {
    if constexpr (uniform) {
        DyadSum<Real> sum;
        for (const std::uint32_t* entry = first; entry != last; ++entry) {
            const Real* record = pass.record + std::size_t(*entry >> 4) * kRecord;
            sum.add(record + (*entry & 12u), record + (*entry & 3u) * 4);
        }
        Block3<Real> block = sum.block();
        const Block3<Real> back = block.transposed();
        block.scale(Real(pass.ratio));
        block.add(back);
        return block;
    } else {
        PairSum<Real> sum;
        for (const std::uint32_t* entry = first; entry != last; ++entry) {
            const Real* record = pass.record + std::size_t(*entry >> 4) * kRecord;
            sum.add(record + (*entry & 12u), record + (*entry & 3u) * 4, record[3]);
        }
        return sum.block();
    }
}

template <bool uniform, class Real>
inline void assemble_blocks(const Tet4Assembly<Real>& pass) {
    using R4 = FourOf<Real>;
    const bool add = pass.diagonal_shift == nullptr;
    const std::uint32_t* next = pass.contribution;
    for (std::size_t i = 0; i < pass.above + pass.diagonal; ++i) {
        const std::uint32_t* const first = next;
        next += pass.count[i];
        if (add && first == next) continue;
        Block3<Real> sum = sum_pairs<uniform>(pass, first, next);
        if (pass.twist != nullptr) {
            R4 column[3] = {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}};
            for (const std::uint32_t* entry = first; entry != next; ++entry) {
                const Real* record = pass.record + std::size_t(*entry >> 4) * kRecord;
                const R4 a = load4(record + (*entry & 12u)), b = load4(record + (*entry & 3u) * 4);
                const Real* X = pass.twist + std::size_t(*entry >> 4) * kTwistRecord;
                const R4 x[3] = {{X[0], X[3], X[5], 0}, {X[3], X[1], X[4], 0}, {X[5], X[4], X[2], 0}};
                add_twist(x, a, b, column);
            }
            alignas(64) Real twist[12];
            for (int c = 0; c < 3; ++c) store4(twist + 4 * c, column[c]);
            sum.add(twist);
        }
        sum.scale(Real(pass.stiffness_scale));
        const bool on_diagonal = i >= pass.above;
        sum.add_to_diagonal(Real(pass.stiffness_scale * pass.laplacian[i] + (on_diagonal && !add ? pass.diagonal_shift[pass.partner[i]] : 0.0)));
        Real* value = pass.value + std::size_t(pass.block[i]) * 12;
        if (add) sum.add(value);
        sum.store(value);
        if (!on_diagonal) sum.transposed().store(pass.value + std::size_t(pass.partner[i]) * 12);
    }
}

template <class Real>
void assemble(const Tet4Assembly<Real>& pass) {
    return pass.uniform ? assemble_blocks<true>(pass) : assemble_blocks<false>(pass);
}

inline constexpr Tet4Kernels kKernels{{elements<Frame::rest>, elements<Frame::large>, elements<Frame::polar>, elements<Frame::svd>},
                                      {flow<Frame::rest>, flow<Frame::large>, flow<Frame::polar>, flow<Frame::svd>},
                                      product,
                                      assemble<float>,
                                      assemble<double>};

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
