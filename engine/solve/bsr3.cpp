#include "supple/solve/bsr3.h"

#include <algorithm>
#include <numeric>

#include "supple/base/assert.h"

namespace supple::solve {

namespace {

/// The elements around each vertex.
template <class Elements>
struct Around {
    Around(std::size_t vertices, Elements given) : elements(given), start(vertices + 1, 0) {
        for (const auto& element : elements)
            for (const std::int32_t v : element) ++start[std::size_t(v) + 1];
        for (std::size_t i = 0; i < vertices; ++i) start[i + 1] += start[i];
        around.resize(std::size_t(start.back()));
        std::vector<std::int64_t> next(start.begin(), start.end() - 1);
        for (std::size_t e = 0; e < elements.size(); ++e)
            for (const std::int32_t v : elements[e]) around[std::size_t(next[std::size_t(v)]++)] = std::uint32_t(e);
    }
    /// Appends the rows of the vertices of the elements around a vertex.
    void append(std::size_t vertex, const std::vector<std::int32_t>& row_of, std::vector<std::int32_t>& out) const {
        for (std::int64_t k = start[vertex]; k < start[vertex + 1]; ++k) {
            for (const std::int32_t v : elements[around[std::size_t(k)]]) out.push_back(row_of[std::size_t(v)]);
        }
    }
    Elements elements;
    std::vector<std::int64_t> start;
    std::vector<std::uint32_t> around;
};

template <std::size_t corners>
GatherMap gather_map(const Bsr3Pattern& pattern, std::span<const std::array<std::int32_t, corners>> elements) {
    GatherMap map;
    map.start.assign(pattern.blocks() + 1, 0);
    std::vector<std::int32_t> block_of_pair(elements.size() * corners * corners, -1);
    for (std::size_t e = 0; e < elements.size(); ++e) {
        for (std::size_t a = 0; a < corners; ++a) {
            for (std::size_t b = 0; b < corners; ++b) {
                const std::int32_t row = pattern.row[std::size_t(elements[e][a])], column = pattern.row[std::size_t(elements[e][b])];
                if (column < row) continue;
                const std::size_t block = pattern.block(std::size_t(row), column);
                block_of_pair[(e * corners + a) * corners + b] = std::int32_t(block);
                ++map.start[block + 1];
            }
        }
    }
    for (std::size_t b = 0; b < pattern.blocks(); ++b) map.start[b + 1] += map.start[b];
    map.pair.resize(std::size_t(map.start.back()));
    std::vector<std::int64_t> next(map.start.begin(), map.start.end() - 1);
    for (std::size_t pair = 0; pair < block_of_pair.size(); ++pair) {
        if (block_of_pair[pair] >= 0) map.pair[std::size_t(next[std::size_t(block_of_pair[pair])]++)] = std::uint32_t(pair);
    }
    return map;
}

}  // namespace

std::size_t Bsr3Pattern::block(std::size_t of_row, std::int32_t of_column) const {
    const auto first = column.begin() + row_start[of_row], last = column.begin() + row_start[of_row + 1];
    const auto at = std::lower_bound(first, last, of_column);
    SUPPLE_ASSERT(at != last && *at == of_column);
    return std::size_t(at - column.begin());
}

Bsr3Pattern make_pattern(std::size_t rows, Fours fours, Eights eights, std::span<const std::int32_t> order) {
    // A row is the sorted union of those of the vertices of the elements around it.
    const Around<Fours> around_fours(rows, fours);
    const Around<Eights> around_eights(rows, eights);
    Bsr3Pattern p;
    p.rows = rows;
    p.vertex.assign(order.begin(), order.end());
    if (order.empty()) {
        p.vertex.resize(rows);
        std::iota(p.vertex.begin(), p.vertex.end(), 0);
    }
    SUPPLE_ASSERT(p.vertex.size() == rows);
    p.row.resize(rows);
    for (std::size_t i = 0; i < rows; ++i) p.row[std::size_t(p.vertex[i])] = std::int32_t(i);
    p.row_start.reserve(rows + 1);
    p.row_start.push_back(0);
    p.diagonal.resize(rows);
    std::vector<std::int32_t> row;
    for (std::size_t i = 0; i < rows; ++i) {
        row.assign(1, std::int32_t(i));
        around_fours.append(std::size_t(p.vertex[i]), p.row, row);
        around_eights.append(std::size_t(p.vertex[i]), p.row, row);
        std::sort(row.begin(), row.end());
        row.erase(std::unique(row.begin(), row.end()), row.end());
        const auto diagonal = std::lower_bound(row.begin(), row.end(), std::int32_t(i));
        p.diagonal[i] = std::int32_t(p.column.size()) + std::int32_t(diagonal - row.begin());
        p.column.insert(p.column.end(), row.begin(), row.end());
        p.row_start.push_back(std::int32_t(p.column.size()));
    }
    p.mirror.resize(p.blocks());
    for (std::size_t i = 0; i < rows; ++i) {
        for (std::int32_t b = p.row_start[i]; b < p.row_start[i + 1]; ++b) {
            p.mirror[std::size_t(b)] = std::int32_t(p.block(std::size_t(p.column[std::size_t(b)]), std::int32_t(i)));
        }
    }
    return p;
}

GatherMap make_gather_map(const Bsr3Pattern& pattern, Fours elements) { return gather_map<4>(pattern, elements); }
GatherMap make_gather_map(const Bsr3Pattern& pattern, Eights elements) { return gather_map<8>(pattern, elements); }

}  // namespace supple::solve
