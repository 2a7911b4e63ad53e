#pragma once
#include <memory>
#include <span>
#include <vector>

#include "supple/base/byte_stream.h"
#include "supple/base/function_ref.h"
#include "supple/solve/galerkin.h"
#include "supple/solve/packed_level.h"
#include "supple/solve/preconditioner.h"

namespace supple::solve {

/// Writes the rotation (unit quaternion w x y z) that goes by a number which the caller gave out: an element's frame.
using RotationLookup = FunctionRef<void(std::int32_t id, double* wxyz)>;

/// What a lattice hierarchy is built from, besides the matrix.
struct LatticeDef {
    std::span<const Vec3> points;                                  ///< [row] rest positions
    std::span<const std::uint8_t> held;                            ///< [row] bit c: coordinate c is held
    std::span<const std::array<std::int32_t, 3>> rotation_of_row;  ///< [row] up to three rotations near the point, then -1
    double volume = 0;                                             ///< of the body, sets the lattice spacing: with n rows, spacing * (volume / n)^(1/3)
    double spacing = 2.5;
    int degree = 2;                                                ///< of the smoother, 1 or 2
};

/// Where the rows of an edited matrix come from.
struct LatticeChange {
    std::span<const std::array<std::int32_t, 4>> parent;  ///< [row] rows before of which it is a weighted mean; -1 behind them
    std::span<const std::array<double, 4>> weight;        ///< [row]
    std::span<const std::int32_t> new_rotation;           ///< [rotation before] its number now, -1: gone
};

/// A V-cycle over lattices laid through the rest shape.
///
/// Level 0 is the matrix of the current step; the levels below it are P^T A P of the matrix that the hierarchy was built from, and stay: each node of the first lattice
/// carries a rotation, and what passes to and from the frozen levels is turned by the rotation since the build. All levels smooth by Chebyshev polynomials of 16-bit
/// matrices, the last one is solved directly. Symmetric and positive definite whatever the frozen levels have become: at worst they help little.
template <class Real>
class LatticeMultigrid final : public Preconditioner<Real> {
public:
    LatticeMultigrid(const Bsr3Pattern& pattern, Isa isa);
    ~LatticeMultigrid() override;

    /// Builds the levels; allocates. The rows of `def` may go afterwards.
    /// @param A  matrix in the configuration of `rotation`; held rows and columns are identity
    void build(Team& team, const LatticeDef& def, const Bsr3<Real>& A, RotationLookup rotation);
    bool built() const;

    /// Takes over the levels below the finest from the hierarchy of a matrix before an edit: each row is interpolated as its parents were. The smoother of the finest level is set by
    /// the next update(). Nothing is left of `before`. A stand-in until another one is built: of what the edit changed the levels below know nothing.
    void follow(LatticeMultigrid& before, const LatticeChange& change);

    /// All that build() and follow() have made, without what update(), turn() and hold() do in every step. @pre built()
    void save(ByteWriter& out) const;
    /// @error Error(corrupt_snapshot) if it does not fit the pattern
    void load(Team& team, ByteReader& in, std::size_t rotations);

    /// Leaves coordinates out that are held now: those held when it was built, fewer or more. [row] bit c: coordinate c is held
    void hold(std::span<const std::uint8_t> held);

    /// Takes in the rotations of a step; call before update().
    void turn(Team& team, RotationLookup rotation);
    void update(Team& team, const Bsr3<Real>& A, std::span<const AppendedRow> appended) override;
    /// Float32 alone: the smoother's products are.
    bool takes_operator() const override { return sizeof(Real) == 4; }
    void update(Team& team, Operator<Real>& A, std::span<const AppendedRow> appended) override;
    double apply(Team& team, const Real* r, Real* z) override;

    std::vector<std::size_t> level_rows() const;  ///< rows of each level, the finest first
    std::size_t bytes() const;  ///< memory that it holds
    Preconditioner<Real>::Traffic traffic() const override;

private:
    struct Hierarchy;
    void lay_level0();
    void gather_appended(std::span<const AppendedRow> appended);
    void finish_update(Team& team);
    void lay_below(Team& team);
    void down(Team& team, std::size_t level);
    void cycle(Team& team, std::size_t level);

    const Bsr3Pattern& pattern_;
    Isa isa_;
    std::unique_ptr<Hierarchy> h_;
};

}  // namespace supple::solve
