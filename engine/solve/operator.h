#pragma once
#include <span>

#include "supple/base/parallel.h"

namespace supple::solve {

/// A symmetric matrix of 3x3 blocks that nobody has assembled: it is known by its products and its diagonal blocks. Held rows and columns are identity, as in a matrix;
/// vectors are [row][x y z 0], zero in the pad and at held coordinates.
template <class Real>
class Operator {
public:
    virtual ~Operator() = default;
    /// First part of y = A x: what all rows need before any of them can be summed. @param x  must stay as it is until the rows are asked for
    virtual void begin_product(Team& team, const Real* x) = 0;
    /// Second part: y on the rows [begin, end), from any thread; returns x . y over them.
    virtual double product_rows(const Real* x, Real* y, std::size_t begin, std::size_t end) const = 0;
    /// [row][column][x y z 0]
    virtual std::span<const Real> diagonal() const = 0;
    /// What a product reads and writes, had the caches nothing of it [bytes].
    virtual double traffic() const = 0;
};

}  // namespace supple::solve
