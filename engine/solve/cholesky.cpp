#include <Eigen/SparseCholesky>

#include "supple/solve/preconditioner.h"

namespace supple::solve {

/// The factor, kept out of the header. Eigen's simplicial LLT with approximate minimum degree ordering, float64.
template <class Real>
struct Cholesky<Real>::Impl {
    using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int32_t>;
    Matrix lower;
    Eigen::SimplicialLLT<Matrix, Eigen::Lower> factor;
    Eigen::VectorXd x;
    bool analysed = false;
    bool definite = true;
};

template <class Real>
Cholesky<Real>::Cholesky(const Bsr3Pattern& pattern) : impl_(std::make_unique<Impl>()) {
    const Eigen::Index n = Eigen::Index(3 * pattern.rows);
    std::vector<Eigen::Triplet<double, std::int32_t>> entries;
    entries.reserve(pattern.blocks() * 6);
    for (std::size_t row = 0; row < pattern.rows; ++row) {
        for (std::int32_t b = pattern.row_start[row]; b < pattern.row_start[row + 1]; ++b) {
            const std::int32_t i0 = std::int32_t(3 * row), j0 = 3 * pattern.column[std::size_t(b)];
            for (std::int32_t i = 0; i < 3; ++i)
                for (std::int32_t j = 0; j < 3; ++j) {
                    if (i0 + i >= j0 + j) entries.emplace_back(i0 + i, j0 + j, 1.0);
                }
        }
    }
    impl_->lower.resize(n, n);
    impl_->lower.setFromTriplets(entries.begin(), entries.end());
    impl_->x.resize(n);
}

template <class Real>
Cholesky<Real>::~Cholesky() = default;

template <class Real>
void Cholesky<Real>::update(Team&, const Bsr3<Real>& A, std::span<const AppendedRow> appended) {
    const Bsr3Pattern& p = *A.pattern;
    auto& lower = impl_->lower;
    double* value = lower.valuePtr();
    // Column by column: the lower entries of block column `row`, read from its mirrors in block row `row`.
    for (std::size_t row = 0; row < p.rows; ++row) {
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::int32_t b = p.diagonal[row]; b < p.row_start[row + 1]; ++b) {
                const std::size_t block = std::size_t(p.mirror[std::size_t(b)]);  // (column, row): its column c lies below the diagonal
                for (std::size_t i = b == p.diagonal[row] ? c : 0; i < 3; ++i) *value++ = double(A.value[block * 12 + 4 * c + i]);
            }
        }
    }
    for (const AppendedRow& extra : appended) {
        for (std::size_t i = 0; i < extra.row.size(); ++i) {
            const Mat3 D = extra.weight[i].asDiagonal() * extra.stiffness * extra.weight[i].asDiagonal();
            const auto first = Eigen::Index(3 * extra.row[i]);
            for (Eigen::Index r = 0; r < 3; ++r)
                for (Eigen::Index c = 0; c <= r; ++c) lower.coeffRef(first + r, first + c) += D(r, c);
        }
    }
    if (!impl_->analysed) impl_->factor.analyzePattern(lower);
    impl_->analysed = true;
    impl_->factor.factorize(lower);
    impl_->definite = impl_->factor.info() == Eigen::Success;
    if (impl_->definite) return;
    // Not positive definite to rounding (a body that nothing holds): a little more on the diagonal is still a good preconditioner.
    const double largest = lower.diagonal().maxCoeff();
    for (double shift = 1e-10; impl_->factor.info() != Eigen::Success && shift < 1; shift *= 100) {
        impl_->factor.setShift(shift * largest);
        impl_->factor.factorize(lower);
    }
    impl_->factor.setShift(0);
}

template <class Real>
bool Cholesky<Real>::is_definite() const {
    return impl_->definite;
}

template <class Real>
double Cholesky<Real>::apply(Team&, const Real* r, Real* z) {
    Eigen::VectorXd& x = impl_->x;
    const Eigen::Index rows = x.size() / 3;
    for (Eigen::Index i = 0; i < rows; ++i)
        for (Eigen::Index c = 0; c < 3; ++c) x[3 * i + c] = double(r[4 * i + c]);
    if (impl_->factor.info() == Eigen::Success) x = impl_->factor.solve(x).eval();
    double dot = 0;
    for (Eigen::Index i = 0; i < rows; ++i) {
        for (Eigen::Index c = 0; c < 3; ++c) {
            z[4 * i + c] = Real(x[3 * i + c]);
            dot += double(r[4 * i + c]) * double(z[4 * i + c]);
        }
        z[4 * i + 3] = Real(0);
    }
    return dot;
}

template <class Real>
auto Cholesky<Real>::traffic() const -> Preconditioner<Real>::Traffic {
    if (impl_->factor.info() != Eigen::Success) return {};
    const double entries = double(impl_->factor.matrixL().nestedExpression().nonZeros()), entry = sizeof(double) + sizeof(int);
    return {2 * entries * entry, 2 * entries * entry + 4.0 * double(impl_->x.size()) * sizeof(double)};
}

template class Cholesky<float>;
template class Cholesky<double>;

}  // namespace supple::solve
