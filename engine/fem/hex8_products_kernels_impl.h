#pragma once
/// Products of hexahedra in a frame without a matrix, compiled once per instruction set by hex8_products_kernels_<isa>.cpp.
///
/// With q = sqrt(factor) R:   y = q K0 q^T x,   and where the tangent has the derivative of R:   y = q (K0 u + (T w) x b),  u = q^T x,  w = 1/2 sum_b b_b x u_b
/// (top of hex8_kernels_impl.h; b and T of unit size). K0 is the same for the sixteen elements of nearly all groups of a lattice: its entries are read once for all of them.
#include "supple/fem/hex8_products.h"
#include "supple/math/wide_lanes.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

template <class Real>
void turn_groups(const HexTurns& from, const HexProductView<Real>& to, std::size_t begin, std::size_t end) {
    constexpr int kRow[6] = {0, 1, 2, 0, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 0};
    for (std::size_t group = begin; group < end; ++group) {
        for (std::size_t lane = 0; lane < kProductLanes; lane += std::size_t(kLanes)) {
            const std::size_t block = 2 * group + lane / kBlock, at = lane % kBlock;
            const bool any = block < from.blocks;  // else the free half of the last group
            M3<Lanes> R{}, T{};
            Lanes s(0.0);
            if (any) {
                const double* q = from.quaternion + block * 4 * kBlock + at;
                R = rotation_matrix(Quat<Lanes>{load(q), load(q + kBlock), load(q + 2 * kBlock), load(q + 3 * kBlock)});
                const Lanes scale = load(from.scale + block * kBlock + at);
                s = root(Lanes(from.factor) * scale);
                if (to.twist != nullptr) {
                    const Lanes size = load(from.size + block * kBlock + at);
                    const Lanes unit = Lanes(1.0) / larger(scale * size * size, Lanes(1e-300));  // zero scale: nothing comes of it
                    const double* t = from.twist + block * 6 * kBlock + at;
                    for (std::size_t c = 0; c < 6; ++c) T.m[kRow[c]][kColumn[c]] = choose(scale > Lanes(0.0), unit * load(t + c * kBlock), Lanes(0.0));
                }
            }
            alignas(64) double value[15][kLanes];
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j) store(value[3 * i + j], s * R.m[i][j]);
            for (std::size_t c = 0; c < 6; ++c) store(value[9 + c], T.m[kRow[c]][kColumn[c]]);
            for (std::size_t n = 0; n < (to.twist != nullptr ? 15u : 9u); ++n) {
                Real* out = n < 9 ? to.turn + (group * 9 + n) * kProductLanes + lane : to.twist + (group * 6 + n - 9) * kProductLanes + lane;
                for (std::size_t k = 0; k < std::size_t(kLanes); ++k) out[k] = Real(value[n][k]);
            }
        }
    }
}

/// Tables of a group: one for all lanes, or the lanes' own.
template <class Real>
struct OneClass {
    const HexProductClass<Real>& k;
    WideOf<Real> stiffness(std::size_t n) const { return WideOf<Real>(k.stiffness[n]); }
    WideOf<Real> diagonal(std::size_t a, std::size_t c) const { return WideOf<Real>(k.diagonal[a][c]); }
    WideOf<Real> gradient(std::size_t a, std::size_t i) const { return WideOf<Real>(k.gradient[a][i]); }
};
template <class Real>
struct Mixed {
    const HexProductMix<Real>& k;
    std::size_t lane;
    WideOf<Real> stiffness(std::size_t n) const { return get(k.stiffness[n] + lane); }
    WideOf<Real> diagonal(std::size_t a, std::size_t c) const { return get(k.diagonal[a][c] + lane); }
    WideOf<Real> gradient(std::size_t a, std::size_t i) const { return get(k.gradient[a][i] + lane); }
};

template <class Real>
inline M3<WideOf<Real>> turn_at(const HexProductView<Real>& K, std::size_t group, std::size_t lane) {
    M3<WideOf<Real>> q;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) q.m[i][j] = get(K.turn + (group * 9 + 3 * i + j) * kProductLanes + lane);
    return q;
}
template <class Real>
inline M3<WideOf<Real>> twist_at(const HexProductView<Real>& K, std::size_t group, std::size_t lane) {
    const auto n = [&](std::size_t c) { return get(K.twist + (group * 6 + c) * kProductLanes + lane); };
    const WideOf<Real> xy = n(3), yz = n(4), zx = n(5);
    return {{{n(0), xy, zx}, {xy, n(1), yz}, {zx, yz, n(2)}}};
}
template <class T>
inline V3<T> turned_back(const M3<T>& q, const V3<T>& v) {
    return {q.m[0][0] * v.x + q.m[1][0] * v.y + q.m[2][0] * v.z, q.m[0][1] * v.x + q.m[1][1] * v.y + q.m[2][1] * v.z,
            q.m[0][2] * v.x + q.m[1][2] * v.y + q.m[2][2] * v.z};
}

template <class Real, class Table>
inline void multiply_group(const HexProductView<Real>& K, std::size_t group, std::size_t lane, const Table& k, const Real* x, Real* value) {
    using W = WideOf<Real>;
    const std::uint16_t* corner = K.corner + group * 8 * kProductLanes + lane;
    const M3<W> q = turn_at(K, group, lane);
    V3<W> first;
    take_points(x, corner, first);
    W u[21], f[21];
    for (std::size_t a = 0; a < 7; ++a) {
        V3<W> at;
        take_points(x, corner + (a + 1) * kProductLanes, at);
        const V3<W> d = turned_back(q, at - first);
        u[3 * a] = d.x;
        u[3 * a + 1] = d.y;
        u[3 * a + 2] = d.z;
    }
#pragma GCC unroll 3
    for (std::size_t part = 0; part < 3; ++part) {  // seven sums at a time stay in registers beside u
        W sum[7];
#pragma GCC unroll 7
        for (std::size_t i = 0; i < 7; ++i) sum[i] = k.stiffness(part * 147 + i) * u[0];
#pragma GCC unroll 20
        for (std::size_t j = 1; j < 21; ++j) {
#pragma GCC unroll 7
            for (std::size_t i = 0; i < 7; ++i) sum[i] = sum[i] + k.stiffness(part * 147 + j * 7 + i) * u[j];
        }
#pragma GCC unroll 7
        for (std::size_t i = 0; i < 7; ++i) f[part * 7 + i] = sum[i];
    }
    if (K.twist != nullptr) {
        V3<W> w{W(Real(0)), W(Real(0)), W(Real(0))}, b[7];
        for (std::size_t a = 0; a < 7; ++a) {
            b[a] = {k.gradient(a, 0), k.gradient(a, 1), k.gradient(a, 2)};
            w = w + cross(b[a], V3<W>{u[3 * a], u[3 * a + 1], u[3 * a + 2]});
        }
        const V3<W> t = W(Real(0.5)) * (twist_at(K, group, lane) * w);
        for (std::size_t a = 0; a < 7; ++a) {
            const V3<W> more = cross(t, b[a]);
            f[3 * a] = f[3 * a] + more.x;
            f[3 * a + 1] = f[3 * a + 1] + more.y;
            f[3 * a + 2] = f[3 * a + 2] + more.z;
        }
    }
    const W zero(Real(0));
    V3<W> rest{zero, zero, zero};  // corner 0: no net force
    for (std::size_t a = 0; a < 7; ++a) {
        const V3<W> force = q * V3<W>{f[3 * a], f[3 * a + 1], f[3 * a + 2]};
        rest = rest - force;
        add_points(value, 4, corner + (a + 1) * kProductLanes, force, zero);
    }
    add_points(value, 4, corner, rest, zero);
}

template <class Real>
void multiply_chunks(const HexProductView<Real>& K, const Real* x, Real* value, std::size_t begin, std::size_t end) {
    alignas(64) Real at[kChunkPlaces * 4];
    for (std::size_t chunk = begin; chunk < end; ++chunk) {
        const std::size_t first = K.first[chunk], places = K.first[chunk + 1] - first;
        Real* sum = value + 4 * first;
        const FourOf<Real> zero = {0, 0, 0, 0};
        for (std::size_t p = 0; p < places; ++p) {
            store4(at + 4 * p, load4(x + 4 * std::size_t(K.row[first + p])));
            store4(sum + 4 * p, zero);
        }
        const std::size_t last = (chunk + 1) * kProductChunk < K.groups ? (chunk + 1) * kProductChunk : K.groups;
        for (std::size_t group = chunk * kProductChunk; group < last; ++group) {
            const std::int64_t which = K.class_of[group];
            for (std::size_t lane = 0; lane < kProductLanes; lane += kWide<Real>) {
                if (which >= 0) {
                    multiply_group(K, group, lane, OneClass<Real>{K.classes[which]}, at, sum);
                } else {
                    multiply_group(K, group, lane, Mixed<Real>{K.mixes[-1 - which], lane}, at, sum);
                }
            }
        }
    }
}

template <class Real, class Table>
inline void diagonal_group(const HexProductView<Real>& K, std::size_t group, std::size_t lane, const Table& k, Real* value) {
    using W = WideOf<Real>;
    const std::uint16_t* corner = K.corner + group * 8 * kProductLanes + lane;
    const M3<W> q = turn_at(K, group, lane);
    const W zero(Real(0)), half(Real(0.5));
    M3<W> T{};
    if (K.twist != nullptr) T = twist_at(K, group, lane);
    V3<W> rest{zero, zero, zero};
    for (std::size_t n = 0; n < 8; ++n) {
        const std::size_t a = n < 7 ? n + 1 : 0;  // corner 0 comes last: its gradient is minus the sum
        const W xy = k.diagonal(a, 3), yz = k.diagonal(a, 4), zx = k.diagonal(a, 5);
        M3<W> D{{{k.diagonal(a, 0), xy, zx}, {xy, k.diagonal(a, 1), yz}, {zx, yz, k.diagonal(a, 2)}}};
        if (K.twist != nullptr) {
            const V3<W> b = a == 0 ? rest : V3<W>{k.gradient(a - 1, 0), k.gradient(a - 1, 1), k.gradient(a - 1, 2)};
            rest = rest - b;
            // [b]x^T T [b]x / 2, by columns: (T (b x e_j)) x b
            const V3<W> across[3] = {{zero, b.z, zero - b.y}, {zero - b.z, zero, b.x}, {b.y, zero - b.x, zero}};
            for (std::size_t j = 0; j < 3; ++j) {
                const V3<W> column = cross(T * across[j], b);
                D.m[0][j] = D.m[0][j] + half * column.x;
                D.m[1][j] = D.m[1][j] + half * column.y;
                D.m[2][j] = D.m[2][j] + half * column.z;
            }
        }
        const M3<W> M = q * D;
        const auto entry = [&](int i, int j) { return M.m[i][0] * q.m[j][0] + M.m[i][1] * q.m[j][1] + M.m[i][2] * q.m[j][2]; };
        const std::uint16_t* id = corner + a * kProductLanes;
        add_points(value, kHexDiagonal, id, V3<W>{entry(0, 0), entry(1, 1), entry(2, 2)}, entry(0, 1));
        add_points(value + 4, kHexDiagonal, id, V3<W>{entry(1, 2), entry(2, 0), zero}, zero);
    }
}

template <class Real>
void diagonal_chunks(const HexProductView<Real>& K, Real* value, std::size_t begin, std::size_t end) {
    for (std::size_t chunk = begin; chunk < end; ++chunk) {
        const std::size_t first = K.first[chunk], places = K.first[chunk + 1] - first;
        Real* sum = value + kHexDiagonal * first;
        for (std::size_t n = 0; n < kHexDiagonal * places; ++n) sum[n] = 0;
        const std::size_t last = (chunk + 1) * kProductChunk < K.groups ? (chunk + 1) * kProductChunk : K.groups;
        for (std::size_t group = chunk * kProductChunk; group < last; ++group) {
            const std::int64_t which = K.class_of[group];
            for (std::size_t lane = 0; lane < kProductLanes; lane += kWide<Real>) {
                if (which >= 0) {
                    diagonal_group(K, group, lane, OneClass<Real>{K.classes[which]}, sum);
                } else {
                    diagonal_group(K, group, lane, Mixed<Real>{K.mixes[-1 - which], lane}, sum);
                }
            }
        }
    }
}

template <class Real>
double product_rows(const HexProductRows<Real>& from, const Real* x, Real* y, std::size_t begin, std::size_t end) {
    double dot = 0;
    for (std::size_t row = begin; row < end; ++row) {
        const FourOf<Real> at = load4(x + 4 * row);
        FourOf<Real> sum = from.mass[row] * at;
        for (std::int32_t k = from.start[row]; k < from.start[row + 1]; ++k) sum += load4(from.value + 4 * std::size_t(from.place[k]));
        store4(y + 4 * row, sum);
        dot += (double(at[0]) * double(sum[0]) + double(at[1]) * double(sum[1])) + double(at[2]) * double(sum[2]);
    }
    return dot;
}

template <class Real>
void product_diagonal(const HexProductRows<Real>& from, Real* block, std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
        const Real m = from.mass[row];
        FourOf<Real> a = {m, m, m, 0}, b = {0, 0, 0, 0};
        for (std::int32_t k = from.start[row]; k < from.start[row + 1]; ++k) {
            const Real* v = from.value + kHexDiagonal * std::size_t(from.place[k]);
            a += load4(v);
            b += load4(v + 4);
        }
        store4(block + 12 * row, FourOf<Real>{a[0], a[3], b[1], 0});
        store4(block + 12 * row + 4, FourOf<Real>{a[3], a[1], b[0], 0});
        store4(block + 12 * row + 8, FourOf<Real>{b[1], b[0], a[2], 0});
    }
}

inline constexpr HexProductKernels kHexProductKernels{
    {turn_groups<float>, multiply_chunks<float>, diagonal_chunks<float>, product_rows<float>, product_diagonal<float>},
    {turn_groups<double>, multiply_chunks<double>, diagonal_chunks<double>, product_rows<double>, product_diagonal<double>}};

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
