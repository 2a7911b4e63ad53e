#include "supple/fem/assembly_order.h"

#include <algorithm>

namespace supple::fem {

AssemblyOrder make_assembly_order(const MatrixPattern& pattern, const Contributions& contributions, std::size_t rows_in_chunk) {
    // Counting sorts, since a mesh under the knife asks for it in every frame.
    struct Entry {
        std::uint32_t block, partner, count;
    };
    std::vector<Entry> off, on;
    std::vector<std::uint32_t> of_count;
    AssemblyOrder order;
    const std::size_t most = (pattern.blocks() + pattern.rows()) / 2;
    order.block.reserve(most);
    order.partner.reserve(most);
    order.count.reserve(most);
    order.contribution.reserve(contributions.pair.size());
    std::vector<Entry> sorted;
    const auto append = [&](const std::vector<Entry>& entries) {
        std::uint32_t largest = 0;
        for (const Entry& e : entries) largest = std::max(largest, e.count);
        of_count.assign(largest + 2, 0);
        for (const Entry& e : entries) ++of_count[e.count + 1];
        for (std::size_t k = 0; k + 1 < of_count.size(); ++k) of_count[k + 1] += of_count[k];
        sorted.resize(entries.size());
        for (const Entry& e : entries) sorted[of_count[e.count]++] = e;
        for (const Entry& e : sorted) {
            order.block.push_back(e.block);
            order.partner.push_back(e.partner);
            order.count.push_back(std::uint16_t(e.count));
            const auto* const from = contributions.pair.data() + contributions.start[e.block];
            order.contribution.insert(order.contribution.end(), from, from + e.count);
        }
    };
    for (std::size_t begin = 0; begin < pattern.rows(); begin += rows_in_chunk) {
        off.clear();
        on.clear();
        for (std::size_t row = begin; row < std::min(begin + rows_in_chunk, pattern.rows()); ++row) {
            for (std::int32_t block = pattern.row_start[row]; block < pattern.row_start[row + 1]; ++block) {
                const std::size_t b = std::size_t(block), column = std::size_t(pattern.column[b]);
                if (column < row) continue;
                const std::uint32_t count = std::uint32_t(contributions.start[b + 1] - contributions.start[b]);
                if (column == row) {
                    on.push_back({std::uint32_t(b), std::uint32_t(row), count});
                } else {
                    off.push_back({std::uint32_t(b), std::uint32_t(pattern.mirror[b]), count});
                }
            }
        }
        AssemblyOrder::Chunk chunk{std::uint32_t(order.block.size()), 0, 0, std::uint32_t(order.contribution.size())};
        append(off);
        chunk.diagonal = std::uint32_t(order.block.size());
        append(on);
        chunk.last = std::uint32_t(order.block.size());
        order.chunks.push_back(chunk);
    }
    return order;
}

}  // namespace supple::fem
