#include <Eigen/LU>

#include "supple/solve/chunked_sum.h"
#include "supple/solve/preconditioner.h"

namespace supple::solve {

template <class Real>
BlockJacobi<Real>::BlockJacobi(std::size_t rows, Isa isa)
    : kernels_(bsr3_kernels<Real>(isa)), rows_(rows), inverse_(rows * 12), appended_(rows, Mat3::Zero()), partial_(row_chunks(rows)) {}

namespace {

template <class Real>
Mat3 read_block(const Real* value) {
    Mat3 D;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 3; ++i) D(i, c) = double(value[4 * c + i]);
    return D;
}

template <class Real>
void write_inverse(const Mat3& D, Real* out) {
    Mat3 inverse;
    bool ok = false;
    D.computeInverseWithCheck(inverse, ok, 1e-300);
    if (!ok || !inverse.allFinite()) inverse = Mat3::Identity();  // a row of a body about to be contained: any finite choice
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 4; ++i) out[4 * c + i] = i < 3 ? Real(0.5 * (inverse(i, c) + inverse(c, i))) : Real(0);
}

}  // namespace

template <class Real>
template <class Block>
void BlockJacobi<Real>::invert(Team& team, std::span<const AppendedRow> appended, Block&& block) {
    const auto invert_row = [&](std::size_t row) {
        Mat3 D = read_block(block(row)) + appended_[row];
        if (!this->coupling_diagonal.empty()) D += this->coupling_diagonal[row];
        write_inverse(D, inverse_.data() + row * 12);
    };
    for (const AppendedRow& extra : appended) {
        for (std::size_t i = 0; i < extra.row.size(); ++i) {
            appended_[std::size_t(extra.row[i])] += extra.weight[i].asDiagonal() * extra.stiffness * extra.weight[i].asDiagonal();
        }
    }
    team.for_range(rows_, kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) invert_row(row);
    });
    for (const AppendedRow& extra : appended) {
        for (const std::int32_t row : extra.row) appended_[std::size_t(row)] = Mat3::Zero();
    }
}

template <class Real>
void BlockJacobi<Real>::update(Team& team, const Bsr3<Real>& A, std::span<const AppendedRow> appended) {
    invert(team, appended, [&](std::size_t row) { return A.value.data() + std::size_t(A.pattern->diagonal[row]) * 12; });
}

template <class Real>
void BlockJacobi<Real>::update(Team& team, Operator<Real>& A, std::span<const AppendedRow> appended) {
    invert(team, appended, [D = A.diagonal()](std::size_t row) { return D.data() + 12 * row; });
}

template <class Real>
double BlockJacobi<Real>::apply(Team& team, const Real* r, Real* z) {
    return sum_over_rows(team, rows_, partial_, [&](std::size_t begin, std::size_t end) {
        return kernels_.block_diagonal(inverse_.data(), r, z, begin, end);
    });
}

template class BlockJacobi<float>;
template class BlockJacobi<double>;

}  // namespace supple::solve
