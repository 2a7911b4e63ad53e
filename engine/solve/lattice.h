#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace supple::solve {

/// A sparse matrix of numbers in rows, columns ascending.
struct ScalarRows {
    std::vector<std::int32_t> row_start{0};
    std::vector<std::int32_t> column;
    std::vector<float> weight;
    std::size_t rows() const { return row_start.size() - 1; }
};

ScalarRows transpose(const ScalarRows& matrix, std::size_t columns);

/// A point of a lattice: the cell it lies in and where in it, each coordinate in [0, 1).
struct LatticePoint {
    std::array<std::int32_t, 3> cell{};
    std::array<float, 3> fraction{};
    bool active = true;  ///< false: takes part in what hangs together, but is not interpolated (a held vertex)
};

/// Trilinear interpolation from the corners of lattice cells to points.
struct LatticeInterpolation {
    std::vector<std::array<std::int32_t, 3>> node;  ///< lattice coordinates, in Morton order
    ScalarRows to_points;                           ///< [point] weights that sum to one; inactive points: none
    ScalarRows to_nodes;                            ///< the transpose
};

/// Interpolation that glues nothing: a cell in which the graph of the points falls apart has corners of its own for every part, and corners of neighbouring cells are one node
/// only where an edge of the graph joins the parts.
/// @param graph  neighbours of each point (rows of a symmetric pattern)
LatticeInterpolation make_interpolation(std::span<const LatticePoint> points, std::span<const std::int32_t> row_start,
                                        std::span<const std::int32_t> column);

/// The nodes of a lattice as points of the lattice of twice the spacing.
std::vector<LatticePoint> coarser_points(std::span<const std::array<std::int32_t, 3>> nodes);

}  // namespace supple::solve
