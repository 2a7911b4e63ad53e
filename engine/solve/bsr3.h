#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/aligned.h"

namespace supple::solve {

/// Sparsity of a symmetric matrix of 3x3 blocks, rows sorted, the diagonal always present; built once per mesh. Its rows lie in an order of their own, so that
/// neighbours are near one another in memory however the mesh numbers them.
struct Bsr3Pattern {
    std::size_t rows = 0;
    std::vector<std::int32_t> vertex;     ///< [row] whose it is
    std::vector<std::int32_t> row;        ///< [vertex]
    std::vector<std::int32_t> row_start;  ///< [row + 1]
    std::vector<std::int32_t> column;     ///< [block]
    std::vector<std::int32_t> diagonal;   ///< [row] block index of (row, row)
    std::vector<std::int32_t> mirror;     ///< [block] index of the transposed block
    std::size_t blocks() const { return column.size(); }
    /// Of two rows whose vertices share an element.
    std::size_t block(std::size_t of_row, std::int32_t of_column) const;
};

/// Which element pairs make up each block on or above the diagonal: assembly as a gather, deterministic and without atomics.
struct GatherMap {
    std::vector<std::int64_t> start;       ///< [block + 1]; empty ranges below the diagonal
    std::vector<std::uint32_t> pair;       ///< (element * N + corner_of_row) * N + corner_of_column of elements with N corners, elements ascending
};

/// Index lists of elements with four and with eight vertices: at most 2^28 and 2^26.
using Fours = std::span<const std::array<std::int32_t, 4>>;
using Eights = std::span<const std::array<std::int32_t, 8>>;

/// @param order  [row] the vertices, each once, in the order that their rows are to have; empty: that of the vertices
Bsr3Pattern make_pattern(std::size_t rows, Fours fours, Eights eights = {}, std::span<const std::int32_t> order = {});
/// Of elements that the pattern was made with, all or some of one kind.
GatherMap make_gather_map(const Bsr3Pattern& pattern, Fours elements);
GatherMap make_gather_map(const Bsr3Pattern& pattern, Eights elements);

/// Rows per chunk of every loop over rows: fixed, so that sums are the same for any number of threads.
inline constexpr std::size_t kRowChunk = 512;

/// Values of vertices in the order of their rows.
template <class T>
std::vector<T> by_row(const Bsr3Pattern& pattern, std::span<const T> of_vertex) {
    std::vector<T> of_row;
    of_row.reserve(pattern.rows);
    for (const std::int32_t v : pattern.vertex) of_row.push_back(of_vertex[std::size_t(v)]);
    return of_row;
}

/// Values of a matrix: [block][column 0..2][x y z 0]; the pad makes a column one register.
template <class Real>
struct Bsr3 {
    const Bsr3Pattern* pattern = nullptr;
    AlignedVector<Real> value;
};

}  // namespace supple::solve
