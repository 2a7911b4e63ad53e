#include "supple/solve/lattice.h"

#include <algorithm>

#include "supple/base/disjoint_sets.h"
#include "supple/math/morton.h"

namespace supple::solve {

namespace {

constexpr float kSmallestWeight = 1e-3f;  // smaller ones widen the coarse matrix and interpolate nothing

/// Corner c of a cell, as an offset: bit 0 is x.
int offset(std::size_t corner, std::size_t axis) { return int(corner >> axis & 1); }

/// Which part of its cell each point belongs to: parts are numbered over all cells in the order of their first points.
std::vector<std::int32_t> find_parts(std::span<const LatticePoint> points, std::span<const std::int32_t> row_start,
                                     std::span<const std::int32_t> column, std::vector<std::array<std::int32_t, 3>>& cell_of_part) {
    DisjointSets sets(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::int32_t k = row_start[i]; k < row_start[i + 1]; ++k) {
            const std::int32_t j = column[std::size_t(k)];
            if (std::size_t(j) < i && points[std::size_t(j)].cell == points[i].cell) sets.join(i, std::size_t(j));
        }
    }
    std::vector<std::int32_t> part(points.size(), -1);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t root = sets.root(i);
        if (root == i) {
            part[i] = std::int32_t(cell_of_part.size());
            cell_of_part.push_back(points[i].cell);
        } else {
            part[i] = part[root];  // roots come first
        }
    }
    return part;
}

/// Unites the corners that two parts share, for every pair of parts that an edge joins.
void join_corners(DisjointSets& corners, std::span<const std::int32_t> part, std::span<const std::array<std::int32_t, 3>> cell_of_part,
                  std::span<const std::int32_t> row_start, std::span<const std::int32_t> column) {
    std::vector<std::uint64_t> pairs;
    for (std::size_t i = 0; i < part.size(); ++i) {
        std::uint64_t last = ~std::uint64_t(0);
        for (std::int32_t k = row_start[i]; k < row_start[i + 1]; ++k) {
            const std::int32_t other = part[std::size_t(column[std::size_t(k)])];
            if (other >= part[i]) continue;
            const std::uint64_t pair = std::uint64_t(part[i]) << 32 | std::uint32_t(other);
            if (pair != last) pairs.push_back(pair);
            last = pair;
        }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    for (const std::uint64_t pair : pairs) {
        const auto a = std::size_t(pair >> 32), b = std::size_t(pair & 0xffffffffu);
        for (std::size_t corner = 0; corner < 8; ++corner) {
            std::size_t same = 0;
            bool shared = true;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const int at = cell_of_part[a][axis] + offset(corner, axis) - cell_of_part[b][axis];
                shared = shared && (at == 0 || at == 1);
                same |= std::size_t(at == 1) << axis;
            }
            if (shared) corners.join(a * 8 + corner, b * 8 + same);
        }
    }
}

/// Weights of the eight corners of its cell at a point, small ones dropped, the rest summing to one.
std::array<float, 8> corner_weights(const LatticePoint& point) {
    std::array<float, 8> weight;
    float sum = 0;
    for (std::size_t corner = 0; corner < 8; ++corner) {
        float w = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) w *= offset(corner, axis) ? point.fraction[axis] : 1 - point.fraction[axis];
        weight[corner] = w > kSmallestWeight ? w : 0;
        sum += weight[corner];
    }
    for (float& w : weight) w /= sum;
    return weight;
}

}  // namespace

ScalarRows transpose(const ScalarRows& matrix, std::size_t columns) {
    ScalarRows t;
    t.row_start.assign(columns + 1, 0);
    for (const std::int32_t c : matrix.column) ++t.row_start[std::size_t(c) + 1];
    for (std::size_t c = 0; c < columns; ++c) t.row_start[c + 1] += t.row_start[c];
    t.column.resize(matrix.column.size());
    t.weight.resize(matrix.column.size());
    std::vector<std::int32_t> next(t.row_start.begin(), t.row_start.end() - 1);
    for (std::size_t row = 0; row < matrix.rows(); ++row) {
        for (std::int32_t k = matrix.row_start[row]; k < matrix.row_start[row + 1]; ++k) {
            const auto at = std::size_t(next[std::size_t(matrix.column[std::size_t(k)])]++);
            t.column[at] = std::int32_t(row);
            t.weight[at] = matrix.weight[std::size_t(k)];
        }
    }
    return t;
}

LatticeInterpolation make_interpolation(std::span<const LatticePoint> points, std::span<const std::int32_t> row_start,
                                        std::span<const std::int32_t> column) {
    std::vector<std::array<std::int32_t, 3>> cell_of_part;
    const std::vector<std::int32_t> part = find_parts(points, row_start, column, cell_of_part);
    DisjointSets corners(cell_of_part.size() * 8);
    join_corners(corners, part, cell_of_part, row_start, column);

    // Nodes are the corners that carry weight.
    struct Used {
        std::uint64_t key;
        std::int32_t root;
        std::array<std::int32_t, 3> index;
    };
    std::vector<Used> used;
    std::vector<std::int32_t> node_of(cell_of_part.size() * 8, -1);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points[i].active) continue;
        const std::array<float, 8> weight = corner_weights(points[i]);
        for (std::size_t corner = 0; corner < 8; ++corner) {
            if (weight[corner] == 0) continue;
            const auto root = std::int32_t(corners.root(std::size_t(part[i]) * 8 + corner));
            if (node_of[std::size_t(root)] >= 0) continue;
            node_of[std::size_t(root)] = 0;
            std::array<std::int32_t, 3> index = points[i].cell;
            for (std::size_t axis = 0; axis < 3; ++axis) index[axis] += offset(corner, axis);
            used.push_back({morton_key(std::uint64_t(index[0]), std::uint64_t(index[1]), std::uint64_t(index[2])), root, index});
        }
    }
    std::sort(used.begin(), used.end(), [](const Used& a, const Used& b) { return a.key != b.key ? a.key < b.key : a.root < b.root; });

    LatticeInterpolation out;
    for (const Used& u : used) {
        node_of[std::size_t(u.root)] = std::int32_t(out.node.size());
        out.node.push_back(u.index);
    }
    std::array<std::pair<std::int32_t, float>, 8> row;
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::size_t count = 0;
        if (points[i].active) {
            const std::array<float, 8> weight = corner_weights(points[i]);
            for (std::size_t corner = 0; corner < 8; ++corner) {
                if (weight[corner] != 0) row[count++] = {node_of[std::size_t(corners.root(std::size_t(part[i]) * 8 + corner))], weight[corner]};
            }
        }
        for (std::size_t a = 1; a < count; ++a) {
            for (std::size_t b = a; b > 0 && row[b].first < row[b - 1].first; --b) std::swap(row[b], row[b - 1]);
        }
        for (std::size_t k = 0; k < count; ++k) {
            out.to_points.column.push_back(row[k].first);
            out.to_points.weight.push_back(row[k].second);
        }
        out.to_points.row_start.push_back(std::int32_t(out.to_points.column.size()));
    }
    out.to_nodes = transpose(out.to_points, out.node.size());
    return out;
}

std::vector<LatticePoint> coarser_points(std::span<const std::array<std::int32_t, 3>> nodes) {
    std::vector<LatticePoint> points(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            points[i].cell[axis] = nodes[i][axis] / 2;
            points[i].fraction[axis] = nodes[i][axis] % 2 == 1 ? 0.5f : 0.0f;
        }
    }
    return points;
}

}  // namespace supple::solve
