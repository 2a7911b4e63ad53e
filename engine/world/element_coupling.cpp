#include "supple/solve/chunked_sum.h"
#include "supple/world/body.h"

namespace supple {

using solve::kRowChunk;

template <class Real>
ElementCoupling<Real>::ElementCoupling(Body& body)
    : body_(body),
      field_(body.vertices() * 4),
      product_(body.vertices() * 4),
      diagonal_(body.vertices()),
      diagonal_by_row_(body.vertices()),
      partial_(solve::row_chunks(body.vertices())) {}

template <class Real>
double ElementCoupling<Real>::multiply_add(Team& team, const Real* x, Real* y) {
    const std::vector<std::int32_t>& vertex = body_.data().pattern.vertex;
    std::fill(product_.begin(), product_.end(), Real(0));
    for (std::size_t i = 0; i < vertex.size(); ++i) std::copy_n(x + 4 * i, 4, field_.begin() + 4 * std::ptrdiff_t(vertex[i]));
    body_.elements->couple(team, scale_, field_.data(), product_.data());
    return solve::sum_over_rows(team, body_.vertices(), partial_, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const auto v = std::size_t(vertex[i]);
            for (std::size_t c = 0; c < 3; ++c) {
                if (body_.is_held(v, c)) continue;
                y[4 * i + c] += product_[4 * v + c];
                sum += double(x[4 * i + c]) * double(product_[4 * v + c]);
            }
        }
        return sum;
    });
}

template <class Real>
std::span<const Mat3> ElementCoupling<Real>::update_diagonal(Team& team, double scale) {
    scale_ = scale;
    std::fill(diagonal_.begin(), diagonal_.end(), Mat3::Zero());
    body_.elements->add_coupling_diagonal(team, diagonal_);
    for (std::size_t i = 0; i < diagonal_.size(); ++i) {
        const auto v = std::size_t(body_.data().pattern.vertex[i]);
        Mat3& D = diagonal_by_row_[i];
        D = scale * diagonal_[v];
        for (std::size_t c = 0; c < 3; ++c) {
            if (!body_.is_held(v, c)) continue;
            D.row(Eigen::Index(c)).setZero();
            D.col(Eigen::Index(c)).setZero();
        }
    }
    return diagonal_by_row_;
}

template class ElementCoupling<float>;
template class ElementCoupling<double>;

}  // namespace supple
