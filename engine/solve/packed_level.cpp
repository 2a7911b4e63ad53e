#include "supple/solve/packed_level.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace supple::solve {

namespace {

constexpr std::size_t kBlocksPerChunk = 6000;  // some ten microseconds of work
constexpr int kPowerSteps = 30;
constexpr double kPowerMargin = 1.08;          // what so few steps may miss
// Of the interval that the smoother damps; the coarse levels see to the rest. Measured on bars, the bunny, the bunny with inclusions of 100:1 and with nu = 0.49: 0.08 and 0.1 need 7 to 17 %
// fewer iterations than 0.25. Below, the polynomial is no longer less than one where an eigenvalue lies above its bound; 0.1 bears one that is a tenth above.
constexpr double kLowEnd = 0.1;

/// Largest diagonal entry, and the inverse of the block scaled by it: scale^2 D^-1, kept symmetric. A block that is not positive definite is
/// replaced by the identity: any positive choice keeps the preconditioner positive.
void scale_and_invert(const Mat3& D, float& scale, float& inverse_scale, float* inverse) {
    const double largest = D.diagonal().maxCoeff();
    const bool usable = largest > 1e-300 && std::isfinite(largest);
    const double s = usable ? std::sqrt(largest) : 1;
    scale = float(s);
    inverse_scale = float(1 / s);
    const Mat3 N = usable ? Mat3(D / largest) : Mat3::Identity();
    Mat3 adjugate;
    adjugate.col(0) = N.col(1).cross(N.col(2));
    adjugate.col(1) = N.col(2).cross(N.col(0));
    adjugate.col(2) = N.col(0).cross(N.col(1));
    const double det = N.col(0).dot(adjugate.col(0));
    const bool positive = det > 1e-14 && N.diagonal().minCoeff() > 0;
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < 3; ++i) inverse[4 * c + i] = positive ? float(0.5 * (adjugate(i, c) + adjugate(c, i)) / det) : float(i == c);
        inverse[4 * c + 3] = 0;
    }
}

template <class Real>
Mat3 read_diagonal(const Real* value) {
    Mat3 D;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 3; ++i) D(i, c) = double(value[4 * c + i]);
    return D;
}

}  // namespace

PackedLevel::PackedLevel(Isa isa, std::span<const std::int32_t> row_start, std::span<const std::int32_t> column)
    : kernels_(packed_kernels(isa)), row_start_(row_start), column_(column) {
    const std::size_t n = rows();
    value_.assign(blocks() * 12 + 4, 0);
    inverse_.resize(n * 12);
    scale_.resize(n);
    inverse_scale_.resize(n);
    for (AlignedVector<float>* v : {&r, &x, &y, &t}) v->assign(n * 4, 0.0f);
    chunk_ = blocks() < 2 * kBlocksPerChunk ? std::max<std::size_t>(n, 1) : std::max<std::size_t>(8, n * kBlocksPerChunk / blocks());
}

std::size_t PackedLevel::bytes() const {
    return value_.size() * 2 + column_.size() * 4 + (inverse_.size() + 2 * scale_.size() + 4 * r.size() + product_.size()) * 4;
}

double PackedLevel::traffic() const {
    const double product = operator_ != nullptr ? operator_->traffic() : double(blocks()) * 28;
    const double sweep = product + double(rows()) * 100;  // inverse diagonal, three vectors
    return (degree_ == 2 ? 4 : 2) * sweep + double(rows()) * 80;
}

template <class Real>
void PackedLevel::pack(Team& team, const Real* value, std::span<const std::int32_t> diagonal, std::span<const std::int32_t> extra_row,
                       std::span<const Mat3> extra) {
    operator_ = nullptr;
    team.for_range(rows(), chunk_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            scale_and_invert(read_diagonal(value + std::size_t(diagonal[i]) * 12), scale_[i], inverse_scale_[i], inverse_.data() + i * 12);
        }
    });
    for (std::size_t k = 0; k < extra_row.size(); ++k) {
        const auto i = std::size_t(extra_row[k]);
        scale_and_invert(read_diagonal(value + std::size_t(diagonal[i]) * 12) + extra[k], scale_[i], inverse_scale_[i], inverse_.data() + i * 12);
    }
    team.for_range(rows(), chunk_, [&](std::size_t begin, std::size_t end) {
        if constexpr (sizeof(Real) == 4) {
            kernels_.pack_f(row_start_.data(), column_.data(), value, inverse_scale_.data(), value_.data(), begin, end);
        } else {
            kernels_.pack_d(row_start_.data(), column_.data(), value, inverse_scale_.data(), value_.data(), begin, end);
        }
    });
    for (std::size_t k = 0; k < extra_row.size(); ++k) {
        const auto i = std::size_t(extra_row[k]);
        const Mat3 D = read_diagonal(value + std::size_t(diagonal[i]) * 12) + extra[k];
        std::int16_t* to = value_.data() + std::size_t(diagonal[i]) * 12;
        const double factor = 32767.0 * double(inverse_scale_[i]) * double(inverse_scale_[i]);
        for (int c = 0; c < 3; ++c)
            for (int j = 0; j < 3; ++j) to[4 * c + j] = std::int16_t(std::lround(std::clamp(factor * D(j, c), -32767.0, 32767.0)));
    }
}

template void PackedLevel::pack(Team&, const float*, std::span<const std::int32_t>, std::span<const std::int32_t>, std::span<const Mat3>);
template void PackedLevel::pack(Team&, const double*, std::span<const std::int32_t>, std::span<const std::int32_t>, std::span<const Mat3>);

void PackedLevel::take(Team& team, Operator<float>& A, std::span<const std::int32_t> extra_row, std::span<const Mat3> extra) {
    operator_ = &A;
    product_.resize(rows() * 4);
    const std::span<const float> diagonal = A.diagonal();
    const auto invert = [&](std::size_t i, const Mat3& D) {
        float scale = 1, inverse_scale = 1, *inverse = inverse_.data() + i * 12;
        scale_and_invert(D, scale, inverse_scale, inverse);
        for (std::size_t k = 0; k < 12; ++k) inverse[k] *= inverse_scale * inverse_scale;
        scale_[i] = inverse_scale_[i] = 1;
    };
    team.for_range(rows(), chunk_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) invert(i, read_diagonal(diagonal.data() + 12 * i));
    });
    extra_order_.resize(extra_row.size());
    std::iota(extra_order_.begin(), extra_order_.end(), std::size_t(0));
    std::sort(extra_order_.begin(), extra_order_.end(), [&](std::size_t a, std::size_t b) { return extra_row[a] < extra_row[b]; });
    extra_row_.clear();
    extra_.clear();
    for (const std::size_t k : extra_order_) {
        const auto i = std::size_t(extra_row[k]);
        extra_row_.push_back(extra_row[k]);
        extra_.push_back(extra[k]);
        invert(i, read_diagonal(diagonal.data() + 12 * i) + extra[k]);
    }
}

void PackedLevel::set_smoother(Team& team, int degree, std::span<const std::uint8_t> held) {
    // Power steps on D^-1 A = 1 - (what one Jacobi step from x leaves of x), from a start without pattern.
    std::uint32_t seed = 1;
    for (std::size_t i = 0; i < rows(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            seed = seed * 1664525u + 1013904223u;
            x[4 * i + c] = operator_ != nullptr && !held.empty() && (held[i] >> c & 1) ? 0.0f : float(seed >> 8) * 0x1p-23f - 1;
        }
    }
    std::fill(r.begin(), r.end(), 0.0f);
    double growth = 1;
    for (int step = 0; step < kPowerSteps; ++step) {
        begin_product(team, x.data());
        team.for_range(rows(), chunk_, [&](std::size_t begin, std::size_t end) {
            relax(-1.0f, -1.0f, x.data(), nullptr, y.data(), begin, end);  // y = D^-1 A x
        });
        double before = 0, after = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            before += double(x[i]) * double(x[i]);
            after += double(y[i]) * double(y[i]);
        }
        growth = before > 0 ? std::sqrt(after / before) : 1;
        const float shrink = after > 0 ? float(1 / std::sqrt(after)) : 0.0f;
        for (std::size_t i = 0; i < x.size(); ++i) x[i] = shrink * y[i];
    }
    set_smoother(float(std::max(1.0, kPowerMargin * growth)), degree);
}

void PackedLevel::set_smoother(float largest_eigenvalue, int degree) {
    lambda_ = largest_eigenvalue;
    degree_ = degree;
    // Chebyshev's recurrence: d0 = D^-1 r / theta; d1 = rho1 rho0 d0 + (2 rho1 / delta) D^-1 (r - A x1), theta and delta the interval's middle and half width.
    const double high = double(lambda_), low = kLowEnd * high, theta = 0.5 * (high + low), delta = 0.5 * (high - low);
    const double rho0 = delta / theta, rho1 = 1 / (2 * theta / delta - rho0);
    first_ = float(1 / theta);
    momentum_ = float(rho1 * rho0);
    second_ = float(2 * rho1 / delta);
}

void PackedLevel::smooth_first(std::size_t begin, std::size_t end) { kernels_.first(view(), first_, r.data(), x.data(), begin, end); }

/// The operator's products, with the extra blocks.
void PackedLevel::product(const float* of, std::size_t begin, std::size_t end) {
    operator_->product_rows(of, product_.data(), begin, end);
    auto at = std::lower_bound(extra_row_.begin(), extra_row_.end(), std::int32_t(begin));
    for (; at != extra_row_.end() && *at < std::int32_t(end); ++at) {
        const std::size_t i = 4 * std::size_t(*at);
        const Vec3 more = extra_[std::size_t(at - extra_row_.begin())] * Vec3(double(of[i]), double(of[i + 1]), double(of[i + 2]));
        for (std::size_t c = 0; c < 3; ++c) product_[i + c] += float(more[Eigen::Index(c)]);
    }
}

/// out = from + a (from - previous) + b D^-1 (r - A from); returns r . out.
double PackedLevel::relax(float a, float b, const float* from, const float* previous, float* out, std::size_t begin, std::size_t end) {
    if (operator_ == nullptr) return kernels_.relax(view(), a, b, r.data(), from, previous, out, begin, end);
    product(from, begin, end);
    return kernels_.relax_product(inverse_.data(), product_.data(), a, b, r.data(), from, previous, out, begin, end);
}

void PackedLevel::smooth_second(std::size_t begin, std::size_t end) { relax(momentum_, second_, x.data(), nullptr, y.data(), begin, end); }

double PackedLevel::restart_first(std::size_t begin, std::size_t end) { return relax(0, first_, y.data(), nullptr, x.data(), begin, end); }

double PackedLevel::restart_second(std::size_t begin, std::size_t end) { return relax(momentum_, second_, x.data(), y.data(), y.data(), begin, end); }

void PackedLevel::residual(const float* of, std::size_t begin, std::size_t end) {
    if (operator_ == nullptr) return kernels_.residual(view(), r.data(), of, t.data(), begin, end);
    product(of, begin, end);
    for (std::size_t i = 4 * begin; i < 4 * end; ++i) t[i] = r[i] - product_[i];
}

}  // namespace supple::solve
