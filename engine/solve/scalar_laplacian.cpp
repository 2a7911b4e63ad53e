#include "supple/solve/scalar_laplacian.h"

#include <Eigen/SparseCholesky>
#include <cmath>

namespace supple::solve {

template <class Real>
bool ScalarLaplacian<Real>::build(const Bsr3<Real>& A, std::span<const std::uint8_t> held) {
    using Sparse = Eigen::SparseMatrix<double>;
    const Bsr3Pattern& p = *A.pattern;
    held_.assign(held.begin(), held.end());
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i < rows_; ++i) {
        for (std::int32_t b = p.row_start[i]; b < p.row_start[i + 1]; ++b) {
            const auto j = std::size_t(p.column[std::size_t(b)]);
            if (j > i) continue;
            double sum = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                if (!((held[i] | held[j]) >> c & 1)) sum += double(A.value[std::size_t(b) * 12 + 5 * c]);
            }
            if (i == j && held[i] == 7) sum = 3;
            if (sum != 0) entries.emplace_back(int(i), int(j), sum / 3);
        }
    }
    Sparse S{Eigen::Index(rows_), Eigen::Index(rows_)};
    S.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLLT<Sparse> solver(S);
    if (solver.info() != Eigen::Success) return false;

    const Sparse L = solver.matrixL();
    place_.resize(rows_);
    for (std::size_t i = 0; i < rows_; ++i) place_[i] = solver.permutationP().size() > 0 ? solver.permutationP().indices()[Eigen::Index(i)] : int(i);
    start_.assign(1, 0);
    below_.clear();
    factor_.clear();
    inverse_diagonal_.resize(rows_);
    for (Eigen::Index column = 0; column < L.cols(); ++column) {
        for (Sparse::InnerIterator it(L, column); it; ++it) {
            if (it.row() == column) {
                inverse_diagonal_[std::size_t(column)] = Real(1 / it.value());
            } else {
                below_.push_back(std::int32_t(it.row()));
                factor_.push_back(Real(it.value()));
            }
        }
        start_.push_back(std::int32_t(below_.size()));
    }
    work_.assign(rows_ * 4, Real(0));
    for (const Real d : inverse_diagonal_) {
        if (!(d > 0) || !std::isfinite(d)) return false;
    }
    return true;
}

template <class Real>
double ScalarLaplacian<Real>::apply(Team&, const Real* r, Real* z) {
    for (std::size_t i = 0; i < rows_; ++i) {
        Real* to = work_.data() + std::size_t(place_[i]) * 4;
        for (std::size_t c = 0; c < 4; ++c) to[c] = c < 3 && !(held_[i] >> c & 1) ? r[4 * i + c] : Real(0);
    }
    // L y = r, column by column; then L^T x = y, row by row of L^T.
    for (std::size_t j = 0; j < rows_; ++j) {
        Real* x = work_.data() + 4 * j;
        for (std::size_t c = 0; c < 4; ++c) x[c] *= inverse_diagonal_[j];
        for (std::int32_t k = start_[j]; k < start_[j + 1]; ++k) {
            Real* y = work_.data() + std::size_t(below_[std::size_t(k)]) * 4;
            const Real l = factor_[std::size_t(k)];
            for (std::size_t c = 0; c < 4; ++c) y[c] -= l * x[c];
        }
    }
    for (std::size_t j = rows_; j-- > 0;) {
        Real* x = work_.data() + 4 * j;
        Real sum[4] = {x[0], x[1], x[2], x[3]};
        for (std::int32_t k = start_[j]; k < start_[j + 1]; ++k) {
            const Real* y = work_.data() + std::size_t(below_[std::size_t(k)]) * 4;
            const Real l = factor_[std::size_t(k)];
            for (std::size_t c = 0; c < 4; ++c) sum[c] -= l * y[c];
        }
        for (std::size_t c = 0; c < 4; ++c) x[c] = sum[c] * inverse_diagonal_[j];
    }
    double dot = 0;
    for (std::size_t i = 0; i < rows_; ++i) {
        const Real* from = work_.data() + std::size_t(place_[i]) * 4;
        for (std::size_t c = 0; c < 4; ++c) z[4 * i + c] = c < 3 && !(held_[i] >> c & 1) ? from[c] : Real(0);
        for (std::size_t c = 0; c < 3; ++c) dot += double(r[4 * i + c]) * double(z[4 * i + c]);
    }
    return dot;
}

template class ScalarLaplacian<float>;
template class ScalarLaplacian<double>;

}  // namespace supple::solve
