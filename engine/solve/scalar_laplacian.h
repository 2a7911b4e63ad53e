#pragma once
#include <vector>

#include "supple/solve/preconditioner.h"

namespace supple::solve {

/// S (x) 1 with S_ij a third of the trace of block ij: for isotropic elasticity that is the mass plus (lambda + 4 mu) / 3 times the Laplacian of the mesh, which no rotation
/// of the elements changes. Factored once by Cholesky and solved for x, y and z together; held coordinates are left out. Insensitive to slivers; for meshes up to some
/// fifteen thousand vertices, whose factors stay small.
template <class Real>
class ScalarLaplacian final : public Preconditioner<Real> {
public:
    explicit ScalarLaplacian(std::size_t rows) : rows_(rows) {}

    /// Factors; allocates.
    /// @param held  [row] bit c: coordinate c is held; such rows and columns of A are identity
    /// @return      false if the traces make no positive definite matrix: the preconditioner must then not be used
    bool build(const Bsr3<Real>& A, std::span<const std::uint8_t> held);

    void update(Team&, const Bsr3<Real>&, std::span<const AppendedRow>) override {}  ///< nothing: it is constant
    bool takes_operator() const override { return true; }
    void update(Team&, Operator<Real>&, std::span<const AppendedRow>) override {}
    double apply(Team& team, const Real* r, Real* z) override;
    Preconditioner<Real>::Traffic traffic() const override {
        return {0, 2.0 * double(factor_.size()) * (sizeof(Real) + sizeof(std::int32_t)) + double(rows_) * 26 * sizeof(Real)};
    }

private:
    std::size_t rows_;
    std::vector<std::uint8_t> held_;
    std::vector<std::int32_t> place_;         ///< [row] where the ordering puts it
    std::vector<std::int32_t> start_, below_; ///< factor by columns, the diagonal left out
    std::vector<Real> factor_, inverse_diagonal_;
    AlignedVector<Real> work_;                ///< [place][x y z 0]
};

}  // namespace supple::solve
