#pragma once
#include <Eigen/Cholesky>
#include <vector>

#include "supple/base/aligned.h"
#include "supple/solve/galerkin.h"

namespace supple::solve {

/// Inverse of a small matrix, dense, in the blocks that the product wants.
struct DirectSolver {
    std::vector<std::int32_t> row_start, column;
    AlignedVector<float> value;
    AlignedVector<float> b, x;

    explicit DirectSolver(const BlockRows& A) {
        const std::size_t n = A.rows();
        Eigen::MatrixXd M = Eigen::MatrixXd::Zero(Eigen::Index(3 * n), Eigen::Index(3 * n));
        for (std::size_t i = 0; i < n; ++i) {
            for (std::int32_t k = A.row_start[i]; k < A.row_start[i + 1]; ++k) {
                for (std::size_t c = 0; c < 3; ++c)
                    for (std::size_t r = 0; r < 3; ++r)
                        M(Eigen::Index(3 * i + r), Eigen::Index(3 * std::size_t(A.column[std::size_t(k)]) + c)) = double(A.value[std::size_t(k) * 12 + 4 * c + r]);
            }
        }
        // Rounding may have left the smallest eigenvalues at zero or below: lift the diagonal until the factor exists.
        Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(M.rows(), M.cols());
        for (double lift = 1e-6; lift < 10; lift *= 10) {
            Eigen::MatrixXd lifted = M;
            for (Eigen::Index i = 0; i < M.rows(); ++i) lifted(i, i) = M(i, i) > 0 ? M(i, i) * (1 + lift) : 1;
            const Eigen::LLT<Eigen::MatrixXd> factor(lifted);
            if (factor.info() != Eigen::Success) continue;
            inverse = factor.solve(Eigen::MatrixXd::Identity(M.rows(), M.cols()));
            if (inverse.allFinite()) break;
            inverse.setZero();
        }
        value.assign(n * n * 12, 0);
        row_start.resize(n + 1);
        column.resize(n * n);
        for (std::size_t i = 0; i <= n; ++i) row_start[i] = std::int32_t(i * n);
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < n; ++j) {
                column[i * n + j] = std::int32_t(j);
                for (std::size_t c = 0; c < 3; ++c)
                    for (std::size_t r = 0; r < 3; ++r) {
                        const auto a = Eigen::Index(3 * i + r), b_ = Eigen::Index(3 * j + c);
                        value[(i * n + j) * 12 + 4 * c + r] = float(0.5 * (inverse(a, b_) + inverse(b_, a)));
                    }
            }
        }
        b.assign(n * 4, 0.0f);
        x.assign(n * 4, 0.0f);
    }
};

}  // namespace supple::solve
