#include "supple/fem/block_sums.h"

#include <algorithm>

#include "supple/fem/tet4_hyper.h"

namespace supple::fem {

namespace {

/// Contributions of one chunk to one matrix block.
struct Run {
    std::uint32_t block, row, column;
    std::uint32_t first, count, plain;  ///< in Contributions::pair; those as they are stored
};

bool is_plain(std::uint32_t pair) { return ((pair >> 2) & 3u) < (pair & 3u); }

/// Runs of matrix blocks above the diagonal, chunk by chunk, in a chunk by matrix block.
std::vector<Run> find_runs(const MatrixPattern& pattern, const Contributions& contributions, std::size_t elements_in_chunk, std::vector<std::uint32_t>& first) {
    std::vector<Run> found;
    const auto chunk_of = [&](std::uint32_t pair) { return (pair >> 4) / elements_in_chunk; };
    for (std::size_t row = 0; row < pattern.rows(); ++row) {
        for (std::int32_t block = pattern.row_start[row]; block < pattern.row_start[row + 1]; ++block) {
            const std::size_t b = std::size_t(block);
            if (std::size_t(pattern.column[b]) <= row) continue;
            for (std::size_t k = std::size_t(contributions.start[b]); k < std::size_t(contributions.start[b + 1]);) {
                Run run{std::uint32_t(b), std::uint32_t(row), std::uint32_t(pattern.column[b]), std::uint32_t(k), 0, 0};
                const std::size_t chunk = chunk_of(contributions.pair[k]);
                for (; k < std::size_t(contributions.start[b + 1]) && chunk_of(contributions.pair[k]) == chunk; ++k, ++run.count) run.plain += is_plain(contributions.pair[k]);
                found.push_back(run);
                ++first[chunk + 1];
            }
        }
    }
    for (std::size_t c = 0; c + 1 < first.size(); ++c) first[c + 1] += first[c];
    std::vector<Run> by_chunk(found.size());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (const Run& run : found) by_chunk[next[chunk_of(contributions.pair[run.first])]++] = run;
    return by_chunk;
}

}  // namespace

BlockSums make_block_sums(const MatrixPattern& pattern, const Contributions& contributions, std::size_t blocks, std::size_t chunk) {
    constexpr std::uint32_t kPairOf[4][4] = {{0, 0, 1, 2}, {0, 0, 3, 4}, {1, 3, 0, 5}, {2, 4, 5, 0}};
    const std::size_t chunks = (blocks + chunk - 1) / chunk;
    std::vector<std::uint32_t> first_run(chunks + 1, 0);
    std::vector<Run> runs = find_runs(pattern, contributions, chunk * kBlock, first_run);
    std::vector<std::uint32_t> diagonal_of(pattern.rows());
    for (std::size_t row = 0; row < pattern.rows(); ++row) {
        const auto* const from = pattern.column.data() + pattern.row_start[row];
        const auto* const to = pattern.column.data() + pattern.row_start[row + 1];
        diagonal_of[row] = std::uint32_t(std::lower_bound(from, to, std::int32_t(row)) - pattern.column.data());
    }
    BlockSums sums;
    sums.chunk = chunk;
    sums.first.push_back(0);
    std::vector<std::uint32_t> site;  // [place] its matrix block
    struct Touch {
        std::uint32_t row, place;
    };
    struct Row {
        std::uint32_t row, first, count;
    };
    std::vector<Touch> touches;
    std::vector<Row> rows;
    for (std::size_t c = 0; c < chunks; ++c) {
        const auto begin = runs.begin() + first_run[c], end = runs.begin() + first_run[c + 1];
        std::stable_sort(begin, end, [](const Run& a, const Run& b) { return a.plain != b.plain ? a.plain < b.plain : a.count < b.count; });
        const std::uint32_t first = sums.first.back();
        sums.first_entry.push_back(std::uint32_t(sums.entry.size()));
        touches.clear();
        for (auto run = begin; run != end; ++run) {
            const std::uint32_t place = std::uint32_t(site.size()) - first;
            site.push_back(run->block);
            sums.count.push_back(std::uint16_t(run->plain));
            sums.count.push_back(std::uint16_t(run->count - run->plain));
            for (const bool plain : {true, false}) {
                for (std::uint32_t k = run->first; k < run->first + run->count; ++k) {
                    const std::uint32_t pair = contributions.pair[k];
                    if (is_plain(pair) != plain) continue;
                    const std::uint32_t element = (pair >> 4) - std::uint32_t(c * chunk * kBlock);
                    sums.entry.push_back(std::uint16_t(element * kElementPairs + kPairOf[(pair >> 2) & 3u][pair & 3u]));
                }
            }
            touches.push_back({run->row, place});
            touches.push_back({run->column, place});
        }
        sums.diagonal.push_back(std::uint32_t(site.size()));
        sums.first_diagonal_entry.push_back(std::uint32_t(sums.entry.size()));
        std::sort(touches.begin(), touches.end(), [](const Touch& a, const Touch& b) { return a.row != b.row ? a.row < b.row : a.place < b.place; });
        rows.clear();
        for (std::uint32_t k = 0; k < touches.size(); ++k) {
            if (k == 0 || touches[k].row != touches[k - 1].row) rows.push_back({touches[k].row, k, 0});
            ++rows.back().count;
        }
        std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.count < b.count; });
        for (const Row& row : rows) {
            site.push_back(diagonal_of[row.row]);
            sums.count.push_back(std::uint16_t(row.count));
            sums.count.push_back(0);
            for (std::uint32_t k = row.first; k < row.first + row.count; ++k) sums.entry.push_back(std::uint16_t(touches[k].place));
        }
        sums.first.push_back(std::uint32_t(site.size()));
    }
    sums.start.assign(pattern.blocks() + 1, 0);
    for (const std::uint32_t block : site) ++sums.start[block + 1];
    for (std::size_t b = 0; b < pattern.blocks(); ++b) sums.start[b + 1] += sums.start[b];
    sums.place.resize(site.size());
    std::vector<std::int64_t> next(sums.start.begin(), sums.start.end() - 1);
    for (std::size_t p = 0; p < site.size(); ++p) sums.place[std::size_t(next[site[p]]++)] = std::uint32_t(p);
    return sums;
}

}  // namespace supple::fem
