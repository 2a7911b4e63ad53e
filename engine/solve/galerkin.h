#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/parallel.h"
#include "supple/solve/lattice.h"

namespace supple::solve {

/// A symmetric matrix of 3x3 blocks that owns its pattern: [block][column][x y z 0], columns of a row ascending.
struct BlockRows {
    std::vector<std::int32_t> row_start{0};
    std::vector<std::int32_t> column;
    std::vector<float> value;
    std::size_t rows() const { return row_start.size() - 1; }
};

/// A fine matrix to be coarsened; value [block][column][x y z 0], float32 or float64.
template <class Real>
struct FineMatrix {
    std::span<const std::int32_t> row_start, column;
    const Real* value = nullptr;
    std::span<const std::uint8_t> held;   ///< [row] bit c: coordinate c takes no part; or empty
};

/// P^T A P, symmetric to the last bit; each sum is taken in a fixed order, whatever the team.
template <class Real>
BlockRows galerkin(Team& team, const FineMatrix<Real>& A, const LatticeInterpolation& P);

}  // namespace supple::solve
