#pragma once
#include <cstddef>

#include "supple/base/parallel.h"

namespace supple::fem {

/// A body's stiffness and mass as an operator, element by element: factor K + mass, K the tangent of the last evaluation. No matrix is made. Vectors are [row][x y z 0], rows those of the matrix.
template <class Real>
class ElementProducts {
public:
    virtual ~ElementProducts() = default;
    /// The products of the elements with x, for rows() to sum.
    virtual void multiply(Team& team, const Real* x) = 0;
    /// y = mass x + factor K x on the rows [begin, end), after multiply(); returns x . y there. Any rows from any thread. @param mass  [row]
    virtual double rows(const Real* mass, const Real* x, Real* y, std::size_t begin, std::size_t end) const = 0;
    /// block = mass + factor K of each row with itself, [row][column][x y z 0].
    virtual void diagonal(Team& team, const Real* mass, Real* block) = 0;
    /// What a product reads and writes, had the caches nothing of it [bytes].
    virtual double traffic() const = 0;
};

}  // namespace supple::fem
