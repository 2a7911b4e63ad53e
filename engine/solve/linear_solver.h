#pragma once
#include <array>
#include <memory>
#include <span>

#include "supple/base/function_ref.h"
#include "supple/solve/chunked_sum.h"
#include "supple/solve/preconditioner.h"

namespace supple::solve {

template <class Real>
class JointPreconditioner;

struct LinearSolveDef {
    double target = 0;             ///< stop at |r| <= target, in float64
    double energy_target = 0;      ///< with a joint preconditioner: and at sqrt(r . P^-1 r) <= this. Stiff rows make |b| large, and their residual is the first to go
    double energy_tolerance = 0;   ///< with a joint preconditioner: energy_target is no less than this part of sqrt(b . P^-1 b)
    int max_iterations = 2000;     ///< over all passes
    bool only_definite = false;    ///< end, without a solution, as soon as the matrix proves to be indefinite
    std::int64_t deadline_ns = 0;  ///< on the clock of now_ns(), base/clock.h: no iteration begins after it; 0 = none
};

struct LinearSolveResult {
    int iterations = 0;
    double start_residual = 0;     ///< of the best start
    double residual = 0;           ///< |b - A x|, from the true float64 residual
    double energy_target = 0;      ///< that the solve went to, 0: none
    double bytes = 0;              ///< read and written by matrices, preconditioners and vectors, had the caches nothing of it; without true_residual
    bool converged = false;
    bool stalled = false;          ///< a pass no longer lowers the true residual: the precision of the matrix is used up
    bool breakdown = false;        ///< the preconditioner was not positive: nothing wrong with x, but another one must go on
    bool indefinite = false;       ///< only_definite: the matrix is not positive definite; x is of no use
    bool out_of_time = false;      ///< the deadline passed first
};

/// One of the matrices along the diagonal of a system, over rows [first_row, first_row + its rows): a body among those that are solved together.
template <class Real>
struct SystemPart {
    const Bsr3<Real>* A = nullptr;
    Preconditioner<Real>* preconditioner = nullptr;  ///< of this part; up to date
    Coupling<Real>* coupling = nullptr;              ///< beside the matrix, or null
    std::size_t first_row = 0;
    Operator<Real>* elements = nullptr;              ///< takes the place of the matrix, of which then the pattern alone counts; or null
};

/// Solves A x = b for a symmetric positive definite A by preconditioned conjugate gradients inside iterative refinement. A is one matrix, or several along the
/// diagonal; appended rows and eliminated bodies tie what they name together, wherever it lies.
///
/// The matrix, its vectors and the recurrence are Real (float32 or float64); x, b and the residual that decides are float64 and
/// the residual is evaluated by the caller's own operator, so it does not share the rounding of the matrix. Each pass solves A d = r to what is
/// missing, adds d to x and looks at the true residual again.
template <class Real>
class LinearSolver {
public:
    LinearSolver(std::size_t rows, Isa isa);

    /// For another number of rows. Allocates only to grow.
    void resize(std::size_t rows);

    /// @param parts         cover all rows, in their order; held rows and columns are identity
    /// @param b             [row] right-hand side, zero on held rows
    /// @param guesses       up to two earlier solutions, newest first (zero on held rows): the start is the best of 0, g0 and 2 g0 - g1
    /// @param x             out; what it holds on entry is added to the solution (held rows: their prescribed values)
    /// @param true_residual writes b - A x in float64 into its second argument; must be zero on held rows
    LinearSolveResult solve(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended,
                            std::span<const Vec3> b, std::span<const std::span<const Vec3>> guesses, const LinearSolveDef& def,
                            FunctionRef<void(const Vec3* x, Vec3* r)> true_residual, std::span<Vec3> x, std::span<Vec3> residual);

    /// Eliminated bodies of the solves to come; they stay with the caller.
    void set_eliminated(std::span<const EliminatedBody> eliminated) { eliminated_ = eliminated; }

    /// Takes the place of the parts' preconditioners in the solves to come, up to date; null: nothing does. It stays with the caller.
    void set_joint(JointPreconditioner<Real>* joint) { joint_ = joint; }

    /// y = (A + appended + coupling) x; returns x . y.  [row][x y z 0]
    double multiply(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended, const Real* x, Real* y);

private:
    /// pieces_ of the parts, for product().
    void cut(std::span<const SystemPart<Real>> parts);
    double product(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended, const Real* x, Real* y);
    void warm_start(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended,
                    std::span<const std::span<const Vec3>> guesses, std::span<Vec3> x);
    void conjugate_gradients(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended,
                             double target, double energy_target, const LinearSolveDef& def, LinearSolveResult& result);
    void import(Team& team, std::span<const Vec3> from, Real* to) const;
    double square(Team& team, const Real* v);
    /// Bytes of a start and of an iteration.
    std::array<double, 2> traffic(std::span<const SystemPart<Real>> parts, bool warm) const;

    /// y += what lies beside the matrices times x; returns its x . y.
    double add_beside(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended, const Real* x, Real* y);
    /// z = P^-1 r part by part; returns r . z, or the first that is not positive though its part has a residual.
    double precondition(Team& team, std::span<const SystemPart<Real>> parts, const Real* r, Real* z);

    std::span<const EliminatedBody> eliminated_;
    JointPreconditioner<Real>* joint_ = nullptr;
    const Bsr3Kernels<Real>& kernels_;
    std::size_t rows_;
    AlignedVector<Real> d_, r_, p_, q_, z_;  ///< [row][x y z 0]
    std::vector<double> partial_;
    std::vector<RowPiece> pieces_;           ///< of the system being solved
};

}  // namespace supple::solve
