#pragma once
#include <cstdint>
#include <vector>

#include "supple/base/aligned.h"
#include "supple/fem/elements.h"

namespace supple::fem {

/// Stiffness of tetrahedra summed while it is in the cache, as CornerSums does with forces. The blocks K_ab, a < b, of the elements of a chunk are summed into one place per matrix block
/// above the diagonal that the chunk touches, and matrix blocks gather places. Diagonal blocks take none from the elements: a rigid shift makes no force, so in each chunk the
/// block of a vertex is minus the sum of its row.
struct BlockSums {
    std::size_t chunk = 0;                  ///< blocks of elements in a chunk, at most kCornerChunk
    std::vector<std::uint32_t> first;       ///< [chunk + 1] where the places of a chunk begin
    std::vector<std::uint32_t> diagonal;    ///< [chunk] where those of diagonal blocks begin; these sum places of the chunk
    std::vector<std::uint32_t> first_entry, first_diagonal_entry;  ///< [chunk]
    std::vector<std::uint16_t> count;       ///< [place][2] entries that it sums: as they are, and transposed. Ascending, so that loops are foreseen by the processor
    std::vector<std::uint16_t> entry;       ///< place by place: element of the chunk * kElementPairs + pair, of diagonals a place of the chunk
    std::vector<std::int64_t> start;        ///< [matrix block + 1] places of a matrix block; none below the diagonal
    std::vector<std::uint32_t> place;       ///< of diagonal blocks: their sums S stand for -(S + S^T)/2
    std::size_t places() const { return count.size() / 2; }
};

/// @param contributions  of a group of tetrahedra
/// @param blocks         of eight elements in the group
BlockSums make_block_sums(const MatrixPattern& pattern, const Contributions& contributions, std::size_t blocks, std::size_t chunk);

}  // namespace supple::fem
