#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/aligned.h"

namespace supple::solve {

/// Order of a graph's nodes that keeps neighbours near one another (Cuthill and McKee 1969, reversed): few entries between the first of a row and its diagonal.
/// @param start, neighbour  neighbours of node i are neighbour[start[i]] .. neighbour[start[i + 1] - 1]; both directions are there
/// @param place             out, [node] its place
/// @param queue             scratch
void narrow_order(std::span<const std::int32_t> start, std::span<const std::int32_t> neighbour, std::vector<std::int32_t>& place, std::vector<std::int32_t>& queue);

/// Symmetric positive definite matrix whose rows are kept from their first entry to the diagonal, and its Cholesky factor in the same place (George and Liu 1981,
/// chapter 4). float64. Allocates only to grow.
class Skyline {
public:
    /// All zero. @param first  [row] column of its first entry, at most the row itself
    void shape(std::span<const std::int32_t> first);
    std::size_t rows() const { return first_.size(); }
    /// Entry of the lower triangle inside the profile.
    double& at(std::size_t row, std::size_t column) { return value_[row_[row] + column - std::size_t(first_[row])]; }
    /// False if it is not positive definite; the factor is then of no use.
    bool factor();
    std::size_t bytes() const;  ///< memory that it holds
    /// x = A^-1 x.
    void solve(double* x) const;

private:
    std::vector<std::int32_t> first_;
    std::vector<std::size_t> row_;   ///< where a row begins
    AlignedVector<double> value_, inverse_diagonal_;
};

}  // namespace supple::solve
