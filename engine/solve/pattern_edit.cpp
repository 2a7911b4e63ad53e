#include "supple/solve/pattern_edit.h"

#include <algorithm>

namespace supple::solve {

Bsr3Pattern change_pattern(const Bsr3Pattern& before, const RowChange& change, FunctionRef<void(std::int32_t vertex, std::vector<std::int32_t>& out)> append) {
    Bsr3Pattern p;
    p.rows = change.old_row.size();
    p.vertex.assign(change.order.begin(), change.order.end());
    p.row.resize(p.rows);
    for (std::size_t i = 0; i < p.rows; ++i) p.row[std::size_t(p.vertex[i])] = std::int32_t(i);
    p.row_start.reserve(p.rows + 1);
    p.row_start.push_back(0);
    p.diagonal.resize(p.rows);
    p.column.reserve(before.column.size() + before.column.size() / 8);
    std::vector<std::int32_t> row;
    for (std::size_t i = 0; i < p.rows; ++i) {
        const std::int32_t first = p.row_start.back(), old = change.old_row[i];
        if (old >= 0) {
            const std::int32_t start = before.row_start[std::size_t(old)], end = before.row_start[std::size_t(old) + 1];
            for (std::int32_t b = start; b < end; ++b) p.column.push_back(change.new_row[std::size_t(before.column[std::size_t(b)])]);
            p.diagonal[i] = first + before.diagonal[std::size_t(old)] - start;
        } else {
            row.assign(1, p.vertex[i]);
            append(p.vertex[i], row);
            for (std::int32_t& v : row) v = p.row[std::size_t(v)];
            std::sort(row.begin(), row.end());
            row.erase(std::unique(row.begin(), row.end()), row.end());
            p.diagonal[i] = first + std::int32_t(std::lower_bound(row.begin(), row.end(), std::int32_t(i)) - row.begin());
            p.column.insert(p.column.end(), row.begin(), row.end());
        }
        p.row_start.push_back(std::int32_t(p.column.size()));
    }
    p.mirror.resize(p.blocks());
    for (std::size_t i = 0; i < p.rows; ++i) {
        const std::int32_t old = change.old_row[i];
        for (std::int32_t b = p.row_start[i]; b < p.row_start[i + 1]; ++b) {
            const auto j = std::size_t(p.column[std::size_t(b)]);
            const std::int32_t old_j = change.old_row[j];
            if (old >= 0 && old_j >= 0) {  // both rows are as they were: so is the place in the other
                const std::int32_t was = before.mirror[std::size_t(before.row_start[std::size_t(old)] + b - p.row_start[i])];
                p.mirror[std::size_t(b)] = p.row_start[j] + was - before.row_start[std::size_t(old_j)];
            } else {
                p.mirror[std::size_t(b)] = std::int32_t(p.block(j, std::int32_t(i)));
            }
        }
    }
    return p;
}

template <std::size_t N>
GatherMap change_gather_map(const GatherMap& before, const Bsr3Pattern& was, const Bsr3Pattern& is, const RowChange& change, std::span<const std::int32_t> new_element,
                            std::span<const std::array<std::int32_t, N>> elements, FunctionRef<void(std::int32_t vertex, std::vector<std::int32_t>& out)> at_vertex) {
    GatherMap map;
    map.start.reserve(is.blocks() + 1);
    map.start.push_back(0);
    map.pair.reserve(before.pair.size() + before.pair.size() / 8);
    std::vector<std::int32_t> around;
    std::vector<std::pair<std::int32_t, std::uint32_t>> pairs;  // block, pair
    for (std::size_t i = 0; i < is.rows; ++i) {
        if (const std::int32_t old = change.old_row[i]; old >= 0) {
            for (std::int32_t b = was.row_start[std::size_t(old)]; b < was.row_start[std::size_t(old) + 1]; ++b) {
                for (std::int64_t k = before.start[std::size_t(b)]; k < before.start[std::size_t(b) + 1]; ++k) {
                    const std::uint32_t pair = before.pair[std::size_t(k)];
                    map.pair.push_back(std::uint32_t(new_element[pair / (N * N)]) * std::uint32_t(N * N) + pair % (N * N));
                }
                map.start.push_back(std::int64_t(map.pair.size()));
            }
            continue;
        }
        around.clear();
        at_vertex(is.vertex[i], around);
        pairs.clear();
        for (const std::int32_t e : around) {
            const auto& corners = elements[std::size_t(e)];
            const auto a = std::size_t(std::find(corners.begin(), corners.end(), is.vertex[i]) - corners.begin());
            for (std::size_t b = 0; b < N; ++b) {
                const std::int32_t column = is.row[std::size_t(corners[b])];
                if (column < std::int32_t(i)) continue;
                pairs.emplace_back(std::int32_t(is.block(i, column)), std::uint32_t((std::size_t(e) * N + a) * N + b));
            }
        }
        std::sort(pairs.begin(), pairs.end());
        auto next = pairs.begin();
        for (std::int32_t b = is.row_start[i]; b < is.row_start[i + 1]; ++b) {
            for (; next != pairs.end() && next->first == b; ++next) map.pair.push_back(next->second);
            map.start.push_back(std::int64_t(map.pair.size()));
        }
    }
    return map;
}

template GatherMap change_gather_map<4>(const GatherMap&, const Bsr3Pattern&, const Bsr3Pattern&, const RowChange&, std::span<const std::int32_t>,
                                        std::span<const std::array<std::int32_t, 4>>, FunctionRef<void(std::int32_t, std::vector<std::int32_t>&)>);
template GatherMap change_gather_map<8>(const GatherMap&, const Bsr3Pattern&, const Bsr3Pattern&, const RowChange&, std::span<const std::int32_t>,
                                        std::span<const std::array<std::int32_t, 8>>, FunctionRef<void(std::int32_t, std::vector<std::int32_t>&)>);

}  // namespace supple::solve
