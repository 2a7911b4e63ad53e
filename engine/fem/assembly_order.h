#pragma once
#include <cstdint>
#include <vector>

#include "supple/fem/elements.h"

namespace supple::fem {

/// The order in which matrix blocks are gathered: in each chunk of rows first those above the diagonal, then the diagonal ones, both by how many contributions they have. So the
/// processor foresees the ends of their loops, and all lists are read from front to back.
struct AssemblyOrder {
    struct Chunk {
        std::uint32_t first, diagonal, last;  ///< of the lists by block
        std::uint32_t contribution;           ///< of the first block
    };
    std::vector<Chunk> chunks;
    std::vector<std::uint32_t> block;         ///< [..] index of the matrix block
    std::vector<std::uint32_t> partner;       ///< [..] index of the transposed block; of diagonal blocks the row
    std::vector<std::uint16_t> count;         ///< [..] contributions
    std::vector<std::uint32_t> contribution;  ///< block by block, as in Contributions::pair
};

AssemblyOrder make_assembly_order(const MatrixPattern& pattern, const Contributions& contributions, std::size_t rows_in_chunk);

}  // namespace supple::fem
