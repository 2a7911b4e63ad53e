#include "supple/solve/galerkin.h"

#include <algorithm>

namespace supple::solve {

namespace {

constexpr std::size_t kFineChunk = 512, kCoarseChunk = 64;

/// Sums blocks by column; a row at a time.
class RowSum {
public:
    explicit RowSum(std::size_t columns) : slot_(columns, -1) {}

    float* block(std::int32_t column) {
        std::int32_t& slot = slot_[std::size_t(column)];
        if (slot < 0) {
            slot = std::int32_t(column_.size());
            column_.push_back(column);
            value_.resize(value_.size() + 12, 0.0f);
        }
        return value_.data() + std::size_t(slot) * 12;
    }
    /// Appends the row, columns ascending, and begins the next.
    void flush(BlockRows& out) {
        std::sort(column_.begin(), column_.end());
        for (const std::int32_t c : column_) {
            const float* from = value_.data() + std::size_t(slot_[std::size_t(c)]) * 12;
            out.column.push_back(c);
            out.value.insert(out.value.end(), from, from + 12);
            slot_[std::size_t(c)] = -1;
        }
        out.row_start.push_back(std::int32_t(out.column.size()));
        column_.clear();
        value_.clear();
    }

private:
    std::vector<std::int32_t> slot_, column_;
    std::vector<float> value_;
};

/// Rows made chunk by chunk, one after the other.
template <class Rows>
BlockRows by_chunks(Team& team, std::size_t rows, std::size_t grain, Rows&& make_rows) {
    std::vector<BlockRows> piece((rows + grain - 1) / grain);
    team.for_chunks(piece.size(), [&](std::size_t chunk) { make_rows(chunk * grain, std::min(rows, (chunk + 1) * grain), piece[chunk]); });
    BlockRows all;
    std::size_t blocks = 0;
    for (const BlockRows& p : piece) blocks += p.column.size();
    all.row_start.reserve(rows + 1);
    all.column.reserve(blocks);
    all.value.reserve(blocks * 12);
    for (BlockRows& p : piece) {
        const auto first = std::int32_t(all.column.size());
        for (std::size_t i = 1; i < p.row_start.size(); ++i) all.row_start.push_back(first + p.row_start[i]);
        all.column.insert(all.column.end(), p.column.begin(), p.column.end());
        all.value.insert(all.value.end(), p.value.begin(), p.value.end());
        p = {};
    }
    return all;
}

/// Block of A with the rows and columns of held coordinates zero.
template <class Real>
void read_free(const FineMatrix<Real>& A, std::size_t row, std::size_t block, float* out) {
    const Real* from = A.value + block * 12;
    for (std::size_t k = 0; k < 12; ++k) out[k] = float(from[k]);
    if (A.held.empty()) return;
    const std::uint8_t r = A.held[row], c = A.held[std::size_t(A.column[block])];
    if ((r | c) == 0) return;
    for (std::size_t k = 0; k < 12; ++k) {
        if ((r >> (k % 4) & 1) || (c >> (k / 4) & 1)) out[k] = 0;
    }
}

/// Blocks below the diagonal become the transposes of those above.
void mirror(BlockRows& A) {
    for (std::size_t i = 0; i < A.rows(); ++i) {
        for (std::int32_t b = A.row_start[i]; b < A.row_start[i + 1]; ++b) {
            const std::int32_t j = A.column[std::size_t(b)];
            if (std::size_t(j) < i) continue;
            const auto first = A.column.begin() + A.row_start[std::size_t(j)], last = A.column.begin() + A.row_start[std::size_t(j) + 1];
            const auto other = std::size_t(std::lower_bound(first, last, std::int32_t(i)) - A.column.begin());
            float* up = A.value.data() + std::size_t(b) * 12;
            float* down = A.value.data() + other * 12;
            if (up == down) {  // the diagonal block itself
                for (std::size_t r = 0; r < 3; ++r)
                    for (std::size_t c = r + 1; c < 3; ++c) up[4 * c + r] = up[4 * r + c] = 0.5f * (up[4 * c + r] + up[4 * r + c]);
                continue;
            }
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c) down[4 * r + c] = up[4 * c + r];
        }
    }
}

}  // namespace

template <class Real>
BlockRows galerkin(Team& team, const FineMatrix<Real>& A, const LatticeInterpolation& P) {
    const ScalarRows& to = P.to_points;
    const std::size_t coarse = P.node.size();
    // A P, then P^T of it: two gathers.
    const BlockRows AP = by_chunks(team, A.row_start.size() - 1, kFineChunk, [&](std::size_t begin, std::size_t end, BlockRows& out) {
        RowSum sum(coarse);
        for (std::size_t i = begin; i < end; ++i) {
            const bool active = to.row_start[i] < to.row_start[i + 1];  // other rows are never asked for
            for (std::int32_t b = active ? A.row_start[i] : A.row_start[i + 1]; b < A.row_start[i + 1]; ++b) {
                const auto j = std::size_t(A.column[std::size_t(b)]);
                float block[12];
                read_free(A, i, std::size_t(b), block);
                for (std::int32_t k = to.row_start[j]; k < to.row_start[j + 1]; ++k) {
                    float* into = sum.block(to.column[std::size_t(k)]);
                    const float w = to.weight[std::size_t(k)];
                    for (std::size_t e = 0; e < 12; ++e) into[e] += w * block[e];
                }
            }
            sum.flush(out);
        }
    });
    const ScalarRows& from = P.to_nodes;
    BlockRows coarse_matrix = by_chunks(team, coarse, kCoarseChunk, [&](std::size_t begin, std::size_t end, BlockRows& out) {
        RowSum sum(coarse);
        for (std::size_t node = begin; node < end; ++node) {
            for (std::int32_t k = from.row_start[node]; k < from.row_start[node + 1]; ++k) {
                const auto i = std::size_t(from.column[std::size_t(k)]);
                const float w = from.weight[std::size_t(k)];
                for (std::int32_t b = AP.row_start[i]; b < AP.row_start[i + 1]; ++b) {
                    float* into = sum.block(AP.column[std::size_t(b)]);
                    const float* block = AP.value.data() + std::size_t(b) * 12;
                    for (std::size_t e = 0; e < 12; ++e) into[e] += w * block[e];
                }
            }
            sum.flush(out);
        }
    });
    mirror(coarse_matrix);
    return coarse_matrix;
}

template BlockRows galerkin(Team& team, const FineMatrix<float>& A, const LatticeInterpolation& P);
template BlockRows galerkin(Team& team, const FineMatrix<double>& A, const LatticeInterpolation& P);

}  // namespace supple::solve
