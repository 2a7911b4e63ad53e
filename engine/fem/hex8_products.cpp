#include "supple/fem/hex8_products.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "supple/base/assert.h"
#include "supple/fem/hex8_stiffness.h"

namespace supple::fem {

extern const HexProductKernels hex_product_kernels_scalar, hex_product_kernels_baseline;
#if defined(SUPPLE_X86_KERNELS)
extern const HexProductKernels hex_product_kernels_avx2, hex_product_kernels_avx512;
#endif

const HexProductKernels& hex_product_kernels(Isa isa) {
    SUPPLE_ASSERT(is_supported(isa));
    switch (isa) {
#if defined(SUPPLE_X86_KERNELS)
        case Isa::avx2: return hex_product_kernels_avx2;
        case Isa::avx512: return hex_product_kernels_avx512;
#endif
        case Isa::scalar: return hex_product_kernels_scalar;
        default: return hex_product_kernels_baseline;
    }
}

namespace {

using LaneClasses = std::array<std::int32_t, kProductLanes>;

/// Of the sixteen elements of a group; free lanes are like its last element.
LaneClasses classes_in(const HexStiffness& stiffness, std::size_t group) {
    LaneClasses classes;
    for (std::size_t lane = 0; lane < kProductLanes; ++lane) {
        classes[lane] = stiffness.class_of[std::min(group * kProductLanes + lane, stiffness.class_of.size() - 1)];
    }
    return classes;
}

bool all_alike(const LaneClasses& classes) {
    return std::all_of(classes.begin(), classes.end(), [&](std::int32_t c) { return c == classes[0]; });
}

std::size_t group_count(std::size_t elements) { return (elements + kProductLanes - 1) / kProductLanes; }

HexProductLists make_lists(const Hex8Rest& rest, const HexStiffness& stiffness, std::span<const std::int32_t> row_of) {
    HexProductLists lists;
    lists.elements = rest.elements;
    std::map<LaneClasses, std::int64_t> mixes;
    for (std::size_t group = 0; group < group_count(rest.elements); ++group) {
        const LaneClasses classes = classes_in(stiffness, group);
        if (all_alike(classes)) {
            lists.class_of.push_back(classes[0]);
            continue;
        }
        const auto [found, is_new] = mixes.try_emplace(classes, std::int64_t(lists.mixed.size()));
        if (is_new) lists.mixed.push_back(classes);
        lists.class_of.push_back(-1 - found->second);
    }
    const auto row = [&](std::size_t element, std::size_t a) {
        const std::size_t e = std::min(element, rest.elements - 1);
        return row_of[std::size_t(rest.vertex[(e / kBlock * 8 + a) * kBlock + e % kBlock])];
    };
    lists.corner.resize(lists.groups() * 8 * kProductLanes);
    lists.first.push_back(0);
    std::vector<std::int32_t> touched;
    for (std::size_t begin = 0; begin < lists.groups(); begin += kProductChunk) {
        const std::size_t end = std::min(begin + kProductChunk, lists.groups());
        touched.clear();
        for (std::size_t e = begin * kProductLanes; e < end * kProductLanes; ++e)
            for (std::size_t a = 0; a < 8; ++a) touched.push_back(row(e, a));
        std::sort(touched.begin(), touched.end());
        touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
        for (std::size_t e = begin * kProductLanes; e < end * kProductLanes; ++e)
            for (std::size_t a = 0; a < 8; ++a) {
                const auto at = std::lower_bound(touched.begin(), touched.end(), row(e, a));
                lists.corner[(e / kProductLanes * 8 + a) * kProductLanes + e % kProductLanes] = std::uint16_t(at - touched.begin());
            }
        lists.row.insert(lists.row.end(), touched.begin(), touched.end());
        lists.first.push_back(std::uint32_t(lists.row.size()));
    }
    lists.start.assign(row_of.size() + 1, 0);
    for (const std::int32_t r : lists.row) ++lists.start[std::size_t(r) + 1];
    for (std::size_t r = 0; r < row_of.size(); ++r) lists.start[r + 1] += lists.start[r];
    lists.place.resize(lists.row.size());
    std::vector<std::int32_t> next(lists.start.begin(), lists.start.end() - 1);
    for (std::size_t p = 0; p < lists.row.size(); ++p) lists.place[std::size_t(next[std::size_t(lists.row[p])]++)] = std::uint32_t(p);
    return lists;
}

template <class Real>
HexProductClass<Real> make_class(const double* blocks, const double* gradient, double size) {
    HexProductClass<Real> out;
    const auto K = [&](std::size_t i, std::size_t j) {  // coordinates of the corners 1..7
        const std::size_t a = i / 3 + 1, b = j / 3 + 1;
        return a <= b ? blocks[hex_pair(a, b) * 12 + j % 3 * 4 + i % 3] : blocks[hex_pair(b, a) * 12 + i % 3 * 4 + j % 3];
    };
    for (std::size_t part = 0; part < 3; ++part)
        for (std::size_t j = 0; j < 21; ++j)
            for (std::size_t i = 0; i < 7; ++i) out.stiffness[part * 147 + j * 7 + i] = Real(K(part * 7 + i, j));
    constexpr std::size_t kRow[6] = {0, 1, 2, 0, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 0};
    for (std::size_t a = 0; a < 8; ++a)
        for (std::size_t c = 0; c < 6; ++c) out.diagonal[a][c] = Real(blocks[hex_pair(a, a) * 12 + kColumn[c] * 4 + kRow[c]]);
    for (std::size_t a = 0; a < 7; ++a)
        for (std::size_t i = 0; i < 3; ++i) out.gradient[a][i] = Real(size * gradient[(3 * a + i) * kBlock]);
    return out;
}

}  // namespace

double shared_part(const HexStiffness& stiffness) {
    const std::size_t groups = group_count(stiffness.class_of.size());
    std::size_t alike = 0;
    for (std::size_t group = 0; group < groups; ++group) alike += all_alike(classes_in(stiffness, group)) ? 1 : 0;
    return groups == 0 ? 0 : double(alike) / double(groups);
}

template <class Real>
HexProducts<Real>::HexProducts(const Hex8Rest& rest, const HexStiffness& stiffness, std::span<const std::int32_t> row, Isa isa)
    : kernels_(hex_product_kernels(isa).of<Real>()), lists_(make_lists(rest, stiffness, row)) {
    size_.resize(rest.blocks() * kBlock);
    for (std::size_t e = 0; e < size_.size(); ++e) {
        for (std::size_t n = 0; n < 21; ++n) size_[e] = std::max(size_[e], std::fabs(rest.edge[(e / kBlock * 21 + n) * kBlock + e % kBlock]));
    }
    const std::size_t count = stiffness.shared_d.size() / kHexBlocks;
    std::vector<std::int32_t> example(count, -1);
    for (std::size_t e = rest.elements; e-- > 0;) example[std::size_t(stiffness.class_of[e])] = std::int32_t(e);
    for (std::size_t c = 0; c < count; ++c) {
        const auto e = std::size_t(example[c]);
        classes_.push_back(make_class<Real>(stiffness.shared_d.data() + c * kHexBlocks, rest.gradient.data() + e / kBlock * 21 * kBlock + e % kBlock, size_[e]));
    }
    mixes_.resize(lists_.mixed.size());
    for (std::size_t m = 0; m < mixes_.size(); ++m) {
        for (std::size_t lane = 0; lane < kProductLanes; ++lane) {
            const HexProductClass<Real>& from = classes_[std::size_t(lists_.mixed[m][lane])];
            for (std::size_t n = 0; n < kDense; ++n) mixes_[m].stiffness[n][lane] = from.stiffness[n];
            for (std::size_t a = 0; a < 8; ++a)
                for (std::size_t c = 0; c < 6; ++c) mixes_[m].diagonal[a][c][lane] = from.diagonal[a][c];
            for (std::size_t a = 0; a < 7; ++a)
                for (std::size_t i = 0; i < 3; ++i) mixes_[m].gradient[a][i][lane] = from.gradient[a][i];
        }
    }
    turn_.resize(lists_.groups() * 9 * kProductLanes);
    value_.resize(lists_.row.size() * 4);
    diagonal_.resize(lists_.row.size() * kHexDiagonal);
}

template <class Real>
HexProductView<Real> HexProducts<Real>::view() {
    HexProductView<Real> v;
    v.first = lists_.first.data();
    v.row = lists_.row.data();
    v.corner = lists_.corner.data();
    v.class_of = lists_.class_of.data();
    v.classes = classes_.data();
    v.mixes = mixes_.data();
    v.turn = turn_.data();
    v.twist = twisted_ ? twist_.data() : nullptr;
    v.groups = lists_.groups();
    return v;
}

template <class Real>
void HexProducts<Real>::turn(Team& team, const double* quaternion, const double* twist, const HexStiffness& stiffness, double factor) {
    twisted_ = twist != nullptr;
    if (twisted_) twist_.resize(lists_.groups() * 6 * kProductLanes);
    const HexTurns from{quaternion, twist, stiffness.scale.data(), size_.data(), size_.size() / kBlock, factor};
    const HexProductView<Real> to = view();
    team.for_range(lists_.groups(), kProductChunk, [&](std::size_t begin, std::size_t end) { kernels_.turn(from, to, begin, end); });
}

template <class Real>
void HexProducts<Real>::multiply(Team& team, const Real* x) {
    const HexProductView<Real> K = view();
    team.for_range(lists_.chunks(), 1, [&](std::size_t begin, std::size_t end) { kernels_.multiply(K, x, value_.data(), begin, end); });
}

template <class Real>
double HexProducts<Real>::rows(const Real* mass, const Real* x, Real* y, std::size_t begin, std::size_t end) const {
    return kernels_.rows({lists_.start.data(), lists_.place.data(), value_.data(), mass}, x, y, begin, end);
}

template <class Real>
void HexProducts<Real>::diagonal(Team& team, const Real* mass, Real* block) {
    const HexProductView<Real> K = view();
    team.for_range(lists_.chunks(), 1, [&](std::size_t begin, std::size_t end) { kernels_.diagonal(K, diagonal_.data(), begin, end); });
    constexpr std::size_t kRows = 512;
    team.for_range(row_count(), kRows, [&](std::size_t begin, std::size_t end) {
        kernels_.diagonal_rows({lists_.start.data(), lists_.place.data(), diagonal_.data(), mass}, block, begin, end);
    });
}

template <class Real>
double HexProducts<Real>::traffic() const {
    // Rotations and corners of the elements; each place in and out; the sums of the rows.
    const double element = double(kProductLanes * lists_.groups()) * (9 * sizeof(Real) + 8 * sizeof(std::uint16_t));
    return element + double(lists_.place.size()) * (2 * sizeof(std::int32_t) + 12 * sizeof(Real)) + double(row_count()) * (9 * sizeof(Real) + sizeof(std::int32_t));
}

template class HexProducts<float>;
template class HexProducts<double>;

}  // namespace supple::fem
