#pragma once
#include <span>

#include "supple/base/aligned.h"
#include "supple/base/parallel.h"
#include "supple/math/types.h"
#include "supple/solve/operator.h"
#include "supple/solve/packed_kernels.h"

namespace supple::solve {

/// A matrix in 16-bit blocks with its Chebyshev smoother: one level of a multigrid. Or an operator in its place, whose vectors are not scaled (all scales are one then).
class PackedLevel {
public:
    /// The pattern must outlive the level.
    PackedLevel(Isa isa, std::span<const std::int32_t> row_start, std::span<const std::int32_t> column);

    std::size_t rows() const { return row_start_.size() - 1; }
    std::size_t blocks() const { return column_.size(); }
    std::size_t bytes() const;
    /// What a visit of a cycle reads and writes here: both smoothings and the residual between them.
    double traffic() const;
    /// The same of the last pack() from numbers of so many bytes, or take().
    double pack_traffic(std::size_t number) const { return double(rows()) * 68 + (operator_ != nullptr ? 0 : double(blocks()) * (12 * double(number) + 28)); }
    std::size_t chunk() const { return chunk_; }          ///< rows per piece of work
    std::size_t chunks() const { return (rows() + chunk_ - 1) / chunk_; }
    const float* scale() const { return scale_.data(); }
    const float* inverse_scale() const { return inverse_scale_.data(); }

    /// Takes in new values, [block][column][x y z 0]; `diagonal` [row] is the block index of (row, row). extra[i] is added to the diagonal block of extra_row[i] (each row at most once).
    template <class Real>
    void pack(Team& team, const Real* value, std::span<const std::int32_t> diagonal, std::span<const std::int32_t> extra_row = {},
              std::span<const Mat3> extra = {});

    /// Takes an operator in the matrix's place, until the next pack(); extra blocks as there. It must outlive the products.
    void take(Team& team, Operator<float>& A, std::span<const std::int32_t> extra_row, std::span<const Mat3> extra);

    /// Bounds the eigenvalues of D^-1 A by power steps and sets the smoother's polynomial: Chebyshev of the given degree (1 or 2) on
    /// the upper nine tenths. Uses the work vectors.
    /// @param held  [row] bit c: coordinate c is held; empty: none is. An operator wants zero there
    void set_smoother(Team& team, int degree, std::span<const std::uint8_t> held = {});
    /// The same with a bound that is known.
    void set_smoother(float largest_eigenvalue, int degree);
    float largest_eigenvalue() const { return lambda_; }
    int degree() const { return degree_; }

    /// Comes before each of the row loops below that multiply by the matrix, with what they multiply.
    void begin_product(Team& team, const float* of) {
        if (operator_ != nullptr) operator_->begin_product(team, of);
    }

    // Rows [begin, end) of the smoother; vectors are scaled, [row][x y z 0].
    void smooth_first(std::size_t begin, std::size_t end);                 ///< x = c D^-1 r
    void smooth_second(std::size_t begin, std::size_t end);                ///< y from x, as the second term of the polynomial from zero
    double restart_first(std::size_t begin, std::size_t end);              ///< x from y; returns r . x
    double restart_second(std::size_t begin, std::size_t end);             ///< y from x and y; returns r . y
    void residual(const float* of, std::size_t begin, std::size_t end);    ///< t = residual of `of`, unscaled

    AlignedVector<float> r, x, y, t;

private:
    PackedRows view() const { return {row_start_.data(), column_.data(), value_.data(), inverse_.data(), scale_.data()}; }

    double relax(float a, float b, const float* from, const float* previous, float* out, std::size_t begin, std::size_t end);
    void product(const float* of, std::size_t begin, std::size_t end);

    const PackedKernels& kernels_;
    std::span<const std::int32_t> row_start_, column_;
    AlignedVector<std::int16_t> value_;
    AlignedVector<float> inverse_, scale_, inverse_scale_;
    Operator<float>* operator_ = nullptr;
    AlignedVector<float> product_;               ///< of the operator
    std::vector<std::int32_t> extra_row_;        ///< beside the operator, ascending
    std::vector<Mat3> extra_;
    std::vector<std::size_t> extra_order_;
    std::size_t chunk_ = 1;
    int degree_ = 2;
    float lambda_ = 2, first_ = 0, momentum_ = 0, second_ = 0;
};

}  // namespace supple::solve
