#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "supple/base/assert.h"
#include "supple/base/parallel.h"
#include "supple/math/types.h"
#include "supple/solve/bsr3.h"
#include "supple/solve/bsr3_kernels.h"
#include "supple/solve/operator.h"

namespace supple::solve {

/// A compliant coupling that lives beside the matrix, never in its pattern: adds J^T K J with (J x)_c = sum_i weight_i,c x_row(i),c.
/// Drag springs, contacts and attachments enter the system so.
struct AppendedRow {
    std::span<const std::int32_t> row;
    std::span<const Vec3> weight;    ///< per row and coordinate; zero where the coordinate is held
    Mat3 stiffness = Mat3::Zero();   ///< symmetric positive semidefinite
};

using Mat36 = Eigen::Matrix<double, 3, 6, Eigen::DontAlign>;
using Mat66 = Eigen::Matrix<double, 6, 6, Eigen::DontAlign>;

/// Something with six unknowns that appended rows couple to the matrix, already eliminated: subtracts B A^-1 B^T, A its own matrix with its share of the
/// rows' stiffness. With the rows it is positive semidefinite. A rigid body that touches the soft one enters so.
struct EliminatedBody {
    std::span<const std::int32_t> row;   ///< may repeat
    std::span<const Mat36> block;        ///< of B; zero rows where the coordinate is held
    Mat66 inverse = Mat66::Zero();       ///< of A
};

/// What the matrix lacks because its pattern cannot hold it: a symmetric positive semidefinite operator beside it.
template <class Real>
class Coupling {
public:
    virtual ~Coupling() = default;
    /// y += B x; returns x . B x.  [row][x y z 0]
    virtual double multiply_add(Team& team, const Real* x, Real* y) = 0;
};

/// z = P^-1 r for conjugate gradients: symmetric positive definite, the same in every call between two updates.
template <class Real>
class Preconditioner {
public:
    virtual ~Preconditioner() = default;
    /// Takes in a matrix whose values have changed.
    virtual void update(Team& team, const Bsr3<Real>& A, std::span<const AppendedRow> appended) = 0;
    /// Whether it can do without the entries of the matrix.
    virtual bool takes_operator() const { return false; }
    /// The same from an operator. @pre takes_operator()
    virtual void update(Team&, Operator<Real>&, std::span<const AppendedRow>) { SUPPLE_ASSERT(takes_operator()); }
    /// @param r, z  [row][x y z 0]
    /// @return      r . z
    virtual double apply(Team& team, const Real* r, Real* z) = 0;
    /// False where the last update has shown that its matrix is not positive definite.
    virtual bool is_definite() const { return true; }
    /// What update() and apply() each read and write, had the caches nothing of it [bytes].
    struct Traffic {
        double update = 0, apply = 0;
    };
    virtual Traffic traffic() const = 0;

    /// Diagonal blocks of a Coupling, one per row, taken in with every update; empty: none. They stay with the caller.
    std::span<const Mat3> coupling_diagonal;
};

/// Inverse of each 3x3 diagonal block.
template <class Real>
class BlockJacobi final : public Preconditioner<Real> {
public:
    BlockJacobi(std::size_t rows, Isa isa);
    void update(Team& team, const Bsr3<Real>& A, std::span<const AppendedRow> appended) override;
    bool takes_operator() const override { return true; }
    void update(Team& team, Operator<Real>& A, std::span<const AppendedRow> appended) override;
    double apply(Team& team, const Real* r, Real* z) override;
    Preconditioner<Real>::Traffic traffic() const override { return {double(rows_) * 24 * sizeof(Real), double(rows_) * 20 * sizeof(Real)}; }

private:
    template <class Block>
    void invert(Team& team, std::span<const AppendedRow> appended, Block&& block);

    const Bsr3Kernels<Real>& kernels_;
    std::size_t rows_;
    AlignedVector<Real> inverse_;   ///< [row][column][x y z 0]
    std::vector<Mat3> appended_;    ///< [row] diagonal of appended rows; zero between updates
    std::vector<double> partial_;
};

/// Sparse Cholesky factor of the matrix itself, made anew in every update: one or two iterations, at the price of a factor. One thread.
template <class Real>
class Cholesky final : public Preconditioner<Real> {
public:
    explicit Cholesky(const Bsr3Pattern& pattern);
    ~Cholesky() override;
    using Preconditioner<Real>::update;
    void update(Team& team, const Bsr3<Real>& A, std::span<const AppendedRow> appended) override;
    double apply(Team& team, const Real* r, Real* z) override;
    bool is_definite() const override;
    Preconditioner<Real>::Traffic traffic() const override;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace supple::solve
