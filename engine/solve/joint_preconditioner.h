#pragma once
#include <array>

#include "supple/solve/chunked_sum.h"
#include "supple/solve/preconditioner.h"
#include "supple/solve/skyline.h"

namespace supple::solve {

/// One of the matrices of a joint system, as its preconditioner sees it.
template <class Real>
struct JointPart {
    const Bsr3<Real>* A = nullptr;
    std::size_t first_row = 0;
    Preconditioner<Real>* own = nullptr;     ///< at work on this part, up to date with the diagonals of the appended rows; null: block-Jacobi
    std::span<const Mat3> coupling_diagonal; ///< [row] of what lies beside the matrix; empty: none
    std::span<const Vec3> points;            ///< [vertex] where they lie now: their common motions are the coarse level
    std::span<const std::int32_t> owner;     ///< [vertex * 3 + axis] -1: free; else held, and identity in the matrix
};

/// Preconditioner of matrices that appended rows tie together: two levels, added.
///
/// Level 0 is D + sum J^T K J, D the diagonal blocks of the matrices, inverted exactly: with K = L L^T it is D^-1 - D^-1 J^T L S^-1 L^T J D^-1,
/// S = 1 + L^T J D^-1 J^T L (Woodbury), a small sparse matrix over the rows that share vertices. x.(A + J^T K J)x / x.(D + J^T K J)x lies between x.A x / x.D x and 1, so
/// that rows of any stiffness leave the system no worse than the matrices are by themselves. Their diagonals alone would slow what both sides of a stiff row do in
/// common by as much as it is stiff.
/// Level 1 is the Galerkin product with the affine motions of each part, twelve a part: what a heap does as a whole (Nicolaides 1987).
///
/// Parts with a preconditioner of their own keep it, with the diagonals of what touches them; rows that reach such a part are diagonals on all sides.
template <class Real>
class JointPreconditioner {
public:
    explicit JointPreconditioner(Isa isa) : kernels_(bsr3_kernels<Real>(isa)) {}

    /// What it is given stays with the caller, until the next update. Allocates only to grow.
    /// @param parts          cover all rows, in their order
    /// @param same_matrices  since the last update only appended rows and eliminated bodies have changed
    void update(Team& team, std::span<const JointPart<Real>> parts, std::span<const AppendedRow> appended, std::span<const EliminatedBody> eliminated, bool same_matrices);
    /// z = P^-1 r; returns r . z, or what is not positive of a part though it has a residual.
    double apply(Team& team, const Real* r, Real* z);
    std::size_t bytes() const;  ///< memory that it holds
    Preconditioner<Real>::Traffic traffic() const;

private:
    static constexpr std::size_t kMotions = 12;
    using Coarse = Eigen::Matrix<double, kMotions, kMotions, Eigen::DontAlign>;
    using Motion = std::array<double, 4>;

    /// An appended row of several vertices, K = L L^T.
    struct Link {
        std::int32_t extra;  ///< which of the appended rows
        Mat3 L;
    };
    struct Place {
        std::int32_t row, link, slot;
    };

    void take_diagonals(Team& team);
    void take_motions(Team& team);
    void invert(std::size_t row);
    bool link_rows(bool pairs);
    bool factor_links();
    bool factor_coarse(std::span<const EliminatedBody> eliminated);
    void add_coarse(std::size_t p, std::size_t q, const Coarse& block);
    void gather(const Real* r, std::size_t begin, std::size_t end, double* sum) const;
    void spread(const double* y, std::size_t begin, std::size_t end, Real* z) const;

    const Bsr3Kernels<Real>& kernels_;
    std::span<const JointPart<Real>> parts_;
    std::span<const AppendedRow> appended_;
    std::size_t rows_ = 0;
    std::vector<std::int32_t> part_of_;     ///< [row]
    std::vector<Mat3> diagonal_, inverse_d_;  ///< [row] of the matrices; of D
    AlignedVector<Real> inverse_;           ///< the same, as kernels read it
    std::vector<Mat3> extra_;               ///< [row] diagonals of appended rows that are no links; zero between updates
    std::vector<std::int32_t> changed_;     ///< rows with such
    std::vector<RowPiece> pieces_;
    std::vector<double> partial_, moved_;   ///< [piece]; [piece * 12 + motion]

    std::vector<Link> links_;
    std::vector<Place> at_row_;             ///< of the links, by row
    std::vector<std::int32_t> start_, neighbour_, place_, queue_, first_;
    Skyline S_;
    std::vector<double> t_, u_;             ///< [place of a link * 3 + i]

    std::vector<Motion> motion_;            ///< [row] 1 and the place about its part's middle over the part's size
    std::vector<std::uint8_t> free_;        ///< [row] a bit for each coordinate that is not held
    std::vector<Coarse> galerkin_;          ///< [part] of its matrix
    std::vector<std::array<std::int32_t, 2>> meets_;  ///< parts that something ties
    std::vector<std::int32_t> coarse_place_;
    std::vector<Eigen::Matrix<double, kMotions, 6, Eigen::DontAlign>> reach_;  ///< [part] of an eliminated body
    Skyline E_;
    bool coarse_ = false;
    std::vector<double> c_, y_;             ///< [part * 12 + motion]
};

}  // namespace supple::solve
