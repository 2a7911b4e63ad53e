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
/// A tensor law takes F Q0 instead of the stretches in step 2, Q0 its material frame, and gives P and the nine by nine of dP/dF (laws/tensor_inversion.h).
/// Families of fibres add their terms to any law (laws/fibres.h).
#include "supple/fem/principal_laws.h"
#include "supple/fem/tet4_hyper_tangents.h"
#include "supple/material/laws/costa.h"
#include "supple/material/laws/fibres.h"
#include "supple/material/laws/tensor_inversion.h"
#include "supple/math/lane_eigen.h"
#include "supple/math/lane_polar.h"
#include "supple/math/lanes4.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

/// Step 1, of the elements in the lanes from `at` on.
struct Kinematics {
    Vector g[3];  ///< rest gradients
    Lanes volume;
    Matrix F, U, V;
    Lanes s[3];
};

[[gnu::noinline]] Kinematics kinematics(const Tet4HyperPass& pass, std::size_t at) {
    const std::size_t block = at / kBlock, lane = at % kBlock;
    Kinematics k;
    Vector d[3];
    corner_differences(pass.position, pass.vertex + block * 4 * kBlock + lane, d);
    load_gradients(pass.gradient + block * 9 * kBlock + lane, k.g);
    k.volume = load(pass.volume + at);
    k.F = gradient(d, k.g);

    double* quaternion = pass.quaternion + block * 4 * kBlock + lane;
    Quat<Lanes> turn{load(quaternion), load(quaternion + kBlock), load(quaternion + 2 * kBlock), load(quaternion + 3 * kBlock)};
    const Matrix R = polar_rotation(k.F, turn);
    store(quaternion, turn.w);
    store(quaternion + kBlock, turn.x);
    store(quaternion + 2 * kBlock, turn.y);
    store(quaternion + 3 * kBlock, turn.z);
    Matrix S = transposed_product(R, k.F);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) S.m[i][j] = S.m[j][i] = Lanes(0.5) * (S.m[i][j] + S.m[j][i]);
    symmetric_eigen(S, k.V);
    k.U = R * k.V;
    for (int i = 0; i < 3; ++i) k.s[i] = S.m[i][i];
    return k;
}

/// What every law says in the end.
struct Response {
    Matrix P;
    Lanes W;
};

/// Adds the families of fibres to P and W, and stores their tangents where asked.
[[gnu::noinline]] void add_fibres(const Tet4HyperPass& pass, std::size_t at, const Matrix& F, Response& r) {
    const std::size_t block = at / kBlock, lane = at % kBlock;
    for (std::size_t family = 0; family < pass.families; ++family) {
        const double* p = pass.fibre + (block * pass.families + family) * kFibre * kBlock + lane;
        const Vector f{load(p + 2 * kBlock), load(p + 3 * kBlock), load(p + 4 * kBlock)};
        const FibreTerm term = fibre_term(load(p), load(p + kBlock), F * f);
        r.W = r.W + term.W;
        const Lanes t[3] = {term.traction.x, term.traction.y, term.traction.z}, direction[3] = {f.x, f.y, f.z};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) r.P.m[i][j] = r.P.m[i][j] + t[i] * direction[j];
        if (pass.tangent == nullptr) continue;
        double* M = pass.fibre_tangent + (block * pass.families + family) * kFibreTangent * kBlock + lane;
        for (int n = 0; n < int(kFibreTangent); ++n) store(M + std::size_t(n) * kBlock, term.M[n]);
    }
}

/// Forces, energy and stress. sigma = P F^T / J; a flat element keeps its sign and stays finite.
[[gnu::noinline]] void store_response(const Tet4HyperPass& pass, std::size_t at, const Kinematics& k, const Response& r) {
    const std::size_t block = at / kBlock, lane = at % kBlock;
    if (pass.corner_force != nullptr) {
        Vector f[4];
        corner_forces(r.P, k.g, k.volume, f);
        store_corners(pass.corner_force + (at - pass.corner_block * kBlock) * 16, f, Lanes(0.0), Lanes(0.0));
    }
    if (pass.energy != nullptr) store(pass.energy + at, k.volume * r.W);
    if (pass.stress == nullptr) return;
    const Lanes J = k.s[0] * k.s[1] * k.s[2], tiny(1e-12);
    const Lanes half_inv_J = Lanes(0.5) / choose(magnitude(J) < tiny, choose(J < Lanes(0.0), Lanes(0.0) - tiny, tiny), J);
    double* stress = pass.stress + block * 6 * kBlock + lane;
    for (int c = 0; c < 6; ++c) {
        const int i = kSymI[c], j = kSymJ[c];
        Lanes sum(0.0);
        for (int m = 0; m < 3; ++m) sum = sum + r.P.m[i][m] * k.F.m[j][m] + r.P.m[j][m] * k.F.m[i][m];
        store(stress + std::size_t(c) * kBlock, half_inv_J * sum);
    }
}

/// The blocks of the matrix that a tangent gives the elements in the lanes.
template <class T, class Real, class Tangent>
void make_blocks(const Tet4HyperPass& pass, std::size_t at, const Tangent& t, const Kinematics& k, Real* out) {
    const std::size_t block = at / kBlock, lane = at % kBlock;
    ElementStiffness<T> stiffness;
    inner_blocks(t, k.g, k.volume, stiffness.K);
    for (std::size_t family = 0; family < pass.families; ++family) {
        add_fibre_blocks(pass.fibre + (block * pass.families + family) * kFibre * kBlock + lane,
                         pass.fibre_tangent + (block * pass.families + family) * kFibreTangent * kBlock + lane, k.g, k.volume, stiffness.K);
    }
    outer_blocks(stiffness.K);
    store_blocks(stiffness, out + (at - pass.corner_block * kBlock) * kElementBlocks);
}

/// Stores a tangent, and the blocks of the matrix made from it.
template <class Tangent>
void store_tangent(const Tet4HyperPass& pass, std::size_t at, const Tangent& t, const Kinematics& k) {
    double* tangent = pass.tangent + at / kBlock * Tangent::kNumbers * kBlock + at % kBlock;
    for_each_number(t, [&](int i, const Lanes& value) { store(tangent + std::size_t(i) * kBlock, value); });
    if (pass.block_f != nullptr) make_blocks<Floats>(pass, at, t, k, pass.block_f);
    if (pass.block_d != nullptr) make_blocks<Lanes>(pass, at, t, k, pass.block_d);
}

[[gnu::noinline]] void finish_principal(const Tet4HyperPass& pass, std::size_t at, const Kinematics& k, Principal& e) {
    Response r;
    r.W = e.W;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            r.P.m[i][j] = k.U.m[i][0] * e.first[0] * k.V.m[j][0] + k.U.m[i][1] * e.first[1] * k.V.m[j][1] + k.U.m[i][2] * e.first[2] * k.V.m[j][2];
    if (pass.families > 0) add_fibres(pass, at, k.F, r);
    store_response(pass, at, k, r);
    if (pass.tangent == nullptr) return;
    if (pass.project) project(e);
    store_tangent(pass, at, make_tangent(k.U, k.V, e), k);
}

template <Law law>
void elements(const Tet4HyperPass& pass, std::size_t begin, std::size_t end) {
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        const Kinematics k = kinematics(pass, at);
        Principal e;
        for (int i = 0; i < 3; ++i) e.s[i] = k.s[i];
        apply_law<law>(pass.parameter + at / kBlock * pass.parameters * kBlock + at % kBlock, pass.parameters, e);
        finish_principal(pass, at, k, e);
    }
}

template <>
void elements<Law::costa>(const Tet4HyperPass& pass, std::size_t begin, std::size_t end) {
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        Kinematics k = kinematics(pass, at);
        const double* parameter = pass.parameter + at / kBlock * pass.parameters * kBlock + at % kBlock;
        const Matrix Q0 = load_frame(parameter, pass.parameters);
        Lanes p[8];
        for (int i = 0; i < 8; ++i) p[i] = load(parameter + std::size_t(i + 1) * kBlock);
        const TensorResponse t = tensor_response([&](const Matrix& F) { return costa(p, F); }, load(parameter), k.U, transposed_product(Q0, k.V), k.s,
                                                 k.F * Q0, pass.tangent != nullptr, pass.project);
        Response r{{}, t.W};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) r.P.m[i][j] = t.P.m[i][0] * Q0.m[j][0] + t.P.m[i][1] * Q0.m[j][1] + t.P.m[i][2] * Q0.m[j][2];
        if (pass.families > 0) add_fibres(pass, at, k.F, r);
        store_response(pass, at, k, r);
        if (pass.tangent != nullptr) store_tangent(pass, at, TensorTangent(t.C, Q0), k);
    }
}

template <class Tangent>
void product(const Tet4HyperProduct& pass, std::size_t begin, std::size_t end) {
    for (std::size_t at = begin * kBlock; at < end * kBlock; at += kLanes) {
        const std::size_t block = at / kBlock, lane = at % kBlock;
        Vector d[3], g[3];
        corner_differences(pass.field, pass.vertex + block * 4 * kBlock + lane, d);
        load_gradients(pass.gradient + block * 9 * kBlock + lane, g);
        const Matrix dF = gradient(d, g);
        const Matrix dP = load_tangent<Tangent>(pass, at).apply(dF);
        Matrix P = dP;
        for (std::size_t family = 0; family < pass.families; ++family) {
            add_fibre_product(pass.fibre + (block * pass.families + family) * kFibre * kBlock + lane,
                              pass.fibre_tangent + (block * pass.families + family) * kFibreTangent * kBlock + lane, dF, P);
        }
        Vector f[4];
        corner_forces(P, g, Lanes(0.0) - load(pass.volume + at), f);
        store_corners(pass.corner_force + (at - pass.corner_block * kBlock) * 16, f, Lanes(0.0), Lanes(0.0));
    }
}

template <class Real>
void add_blocks(const BlockAddition<Real>& pass) {
    const std::uint16_t* entry = pass.entry;
    for (std::size_t place = 0; place < pass.places; ++place) {
        const std::uint16_t* const plain = entry + pass.count[2 * place];
        const std::uint16_t* const turned = plain + pass.count[2 * place + 1];
        Block3<Real> sum, transposed;
        for (; entry != plain; ++entry) sum.add(pass.from + std::size_t(*entry) * 12);
        for (; entry != turned; ++entry) transposed.add(pass.from + std::size_t(*entry) * 12);
        sum.add(transposed.transposed());
        sum.store(pass.to + place * 12);
    }
}

template <class Real>
void assemble(const BlockAssembly<Real>& pass, std::size_t begin, std::size_t end) {
    const Real scale = Real(pass.stiffness_scale);
    for (std::size_t row = begin; row < end; ++row) {
        for (std::int32_t block = pass.row_start[row]; block < pass.row_start[row + 1]; ++block) {
            const std::size_t column = std::size_t(pass.column[block]);
            if (column < row) continue;  // written as a mirror
            const bool add = pass.diagonal_shift == nullptr;
            if (add && pass.contribution_start[block] == pass.contribution_start[block + 1]) continue;
            Block3<Real> sum;
            for (std::int64_t i = pass.contribution_start[block]; i < pass.contribution_start[block + 1]; ++i) sum.add(pass.place + std::size_t(pass.contribution[i]) * 12);
            if (column == row) sum.add(sum.transposed());
            sum.scale(column == row ? Real(-0.5) * scale : scale);
            if (column == row && !add) sum.add_to_diagonal(Real(pass.diagonal_shift[row]));
            Real* value = pass.value + std::size_t(block) * 12;
            if (add) sum.add(value);
            sum.store(value);
            if (column != row) sum.transposed().store(pass.value + std::size_t(pass.mirror[block]) * 12);
        }
    }
}

inline constexpr Tet4HyperKernels kHyperKernels{
    {elements<Law::st_venant_kirchhoff>, elements<Law::neo_hookean>, elements<Law::stable_neo_hookean>, elements<Law::mooney_rivlin>,
     elements<Law::arruda_boyce>, elements<Law::veronda_westman>, elements<Law::ogden>, elements<Law::costa>},
    product<PrincipalTangent>,
    product<TensorTangent>,
    add_blocks<float>,
    add_blocks<double>,
    assemble<float>,
    assemble<double>};

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
