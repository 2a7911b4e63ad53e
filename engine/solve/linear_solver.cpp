#include "supple/solve/linear_solver.h"

#include <algorithm>
#include <cmath>

#include "supple/base/clock.h"
#include "supple/solve/chunked_sum.h"
#include "supple/solve/joint_preconditioner.h"

namespace supple::solve {

namespace {

// One pass of float32 gains at most about five digits before its recurrence drifts from the truth; float64 needs no second pass.
template <class Real>
constexpr double kPassGain = sizeof(Real) == 4 ? 1e-5 : 1e-14;

constexpr int kMaxPasses = 8;

/// y += J^T K J x for every row; returns the sum of their x . J^T K J x.
template <class Real>
double add_appended(std::span<const AppendedRow> appended, const Real* x, Real* y) {
    double dot = 0;
    for (const AppendedRow& extra : appended) {
        Vec3 mean = Vec3::Zero();
        for (std::size_t i = 0; i < extra.row.size(); ++i) {
            const Real* v = x + std::size_t(extra.row[i]) * 4;
            mean += extra.weight[i].cwiseProduct(Vec3(double(v[0]), double(v[1]), double(v[2])));
        }
        const Vec3 force = extra.stiffness * mean;
        for (std::size_t i = 0; i < extra.row.size(); ++i) {
            for (int c = 0; c < 3; ++c) y[std::size_t(extra.row[i]) * 4 + std::size_t(c)] += Real(extra.weight[i][c] * force[c]);
        }
        dot += mean.dot(force);
    }
    return dot;
}

/// y -= B A^-1 B^T x for every eliminated body; returns the (negative) sum of their x . y.
template <class Real>
double subtract_eliminated(std::span<const EliminatedBody> eliminated, const Real* x, Real* y) {
    double dot = 0;
    for (const EliminatedBody& body : eliminated) {
        Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
        for (std::size_t i = 0; i < body.row.size(); ++i) {
            const Real* v = x + std::size_t(body.row[i]) * 4;
            sum += body.block[i].transpose() * Vec3(double(v[0]), double(v[1]), double(v[2]));
        }
        const Eigen::Matrix<double, 6, 1> answer = body.inverse * sum;
        for (std::size_t i = 0; i < body.row.size(); ++i) {
            const Vec3 force = body.block[i] * answer;
            for (int c = 0; c < 3; ++c) y[std::size_t(body.row[i]) * 4 + std::size_t(c)] -= Real(force[c]);
        }
        dot -= sum.dot(answer);
    }
    return dot;
}

}  // namespace

template <class Real>
double LinearSolver<Real>::add_beside(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended, const Real* x, Real* y) {
    double sum = add_appended(appended, x, y);
    if (!eliminated_.empty()) sum += subtract_eliminated(eliminated_, x, y);
    for (const SystemPart<Real>& part : parts) {
        if (part.coupling != nullptr) sum += part.coupling->multiply_add(team, x + 4 * part.first_row, y + 4 * part.first_row);
    }
    return sum;
}

template <class Real>
double LinearSolver<Real>::precondition(Team& team, std::span<const SystemPart<Real>> parts, const Real* r, Real* z) {
    if (joint_ != nullptr) return joint_->apply(team, r, z);
    double sum = 0;
    for (const SystemPart<Real>& part : parts) {
        const double rz = part.preconditioner->apply(team, r + 4 * part.first_row, z + 4 * part.first_row);
        if (!(rz >= 0)) return rz;
        sum += rz;
    }
    return sum;
}

template <class Real>
LinearSolver<Real>::LinearSolver(std::size_t rows, Isa isa)
    : kernels_(bsr3_kernels<Real>(isa)),
      rows_(rows),
      d_(rows * 4),
      r_(rows * 4),
      p_(rows * 4),
      q_(rows * 4),
      z_(rows * 4),
      partial_(row_chunks(rows)) {}

template <class Real>
void LinearSolver<Real>::resize(std::size_t rows) {
    rows_ = rows;
    for (AlignedVector<Real>* v : {&d_, &r_, &p_, &q_, &z_}) v->resize(rows * 4);
    partial_.resize(row_chunks(rows));
}

template <class Real>
void LinearSolver<Real>::import(Team& team, std::span<const Vec3> from, Real* to) const {
    team.for_range(rows_, kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            to[4 * i] = Real(from[i].x());
            to[4 * i + 1] = Real(from[i].y());
            to[4 * i + 2] = Real(from[i].z());
            to[4 * i + 3] = Real(0);
        }
    });
}

template <class Real>
double LinearSolver<Real>::square(Team& team, const Real* v) {
    return sum_over_rows(team, rows_, partial_, [&](std::size_t begin, std::size_t end) {
        double s = 0;
        for (std::size_t i = begin * 4; i < end * 4; ++i) s += double(v[i]) * double(v[i]);
        return s;
    });
}

template <class Real>
void LinearSolver<Real>::cut(std::span<const SystemPart<Real>> parts) {
    cut_rows(parts, [](const SystemPart<Real>& part) { return part.A->pattern->rows; }, pieces_);
    partial_.resize(std::max(partial_.size(), pieces_.size()));
}

template <class Real>
double LinearSolver<Real>::multiply(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended, const Real* x, Real* y) {
    cut(parts);
    return product(team, parts, appended, x, y);
}

template <class Real>
double LinearSolver<Real>::product(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended, const Real* x, Real* y) {
    for (const SystemPart<Real>& part : parts) {
        if (part.elements != nullptr) part.elements->begin_product(team, x + 4 * part.first_row);
    }
    const double dot = sum_over_pieces(team, pieces_, partial_, [&](const RowPiece& piece) {
        const SystemPart<Real>& part = parts[piece.part];
        const Bsr3Pattern& p = *part.A->pattern;
        const std::size_t first = 4 * part.first_row;
        if (part.elements != nullptr) return part.elements->product_rows(x + first, y + first, piece.begin, piece.end);
        return kernels_.multiply(p.row_start.data(), p.column.data(), part.A->value.data(), x + first, y + first, piece.begin, piece.end);
    });
    return dot + add_beside(team, parts, appended, x, y);
}

/// Leaves in r_ the residual of the best start and adds that start to x. On entry r_ = b.
template <class Real>
void LinearSolver<Real>::warm_start(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended,
                                    std::span<const std::span<const Vec3>> guesses, std::span<Vec3> x) {
    if (guesses.empty()) return;
    // p_ = A g0, q_ = A g1: the residuals of 0, g0 and 2 g0 - g1 are r, r - p and r - 2p + q.
    const bool two = guesses.size() > 1;
    import(team, guesses[0], d_.data());
    if (two) {
        import(team, guesses[1], z_.data());
        for (const SystemPart<Real>& part : parts) {
            const Bsr3Pattern& p = *part.A->pattern;
            const std::size_t first = 4 * part.first_row;
            if (part.elements != nullptr) {
                for (const auto& [from, to] : {std::pair(d_.data() + first, p_.data() + first), std::pair(z_.data() + first, q_.data() + first)}) {
                    part.elements->begin_product(team, from);
                    team.for_range(p.rows, kRowChunk, [&, u = from, v = to](std::size_t begin, std::size_t end) { part.elements->product_rows(u, v, begin, end); });
                }
                continue;
            }
            team.for_range(p.rows, kRowChunk, [&](std::size_t begin, std::size_t end) {
                kernels_.multiply_two(p.row_start.data(), p.column.data(), part.A->value.data(), d_.data() + first, z_.data() + first, p_.data() + first, q_.data() + first, begin, end);
            });
        }
        add_beside(team, parts, appended, z_.data(), q_.data());
        add_beside(team, parts, appended, d_.data(), p_.data());
    } else {
        product(team, parts, appended, d_.data(), p_.data());
    }
    const double zero = square(team, r_.data());
    auto residual_square = [&](Real a, Real b) {
        return sum_over_rows(team, rows_, partial_, [&](std::size_t begin, std::size_t end) {
            double s = 0;
            for (std::size_t i = begin * 4; i < end * 4; ++i) {
                const double v = double(r_[i] - a * p_[i] - (two ? b * q_[i] : Real(0)));
                s += v * v;
            }
            return s;
        });
    };
    const double previous = residual_square(Real(1), Real(0));
    const double extrapolated = two ? residual_square(Real(2), Real(-1)) : previous;
    Real a = 0, b = 0;
    if (previous < zero) a = Real(1);
    if (two && extrapolated < std::min(previous, zero)) {
        a = Real(2);
        b = Real(-1);
    }
    if (a == Real(0)) return;
    team.for_range(rows_, kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            x[i] += double(a) * guesses[0][i];
            if (b != Real(0)) x[i] += double(b) * guesses[1][i];
        }
        for (std::size_t i = begin * 4; i < end * 4; ++i) r_[i] -= a * p_[i] + (b != Real(0) ? b * q_[i] : Real(0));
    });
}

/// A d = r from d = 0 until the recurrence has |r| <= target, and sqrt(r.z) <= energy_target where that is not zero; d_ and r_ hold the result.
template <class Real>
void LinearSolver<Real>::conjugate_gradients(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended,
                                             double target, double energy_target, const LinearSolveDef& def, LinearSolveResult& result) {
    double rr = energy_target > 0 ? square(team, r_.data()) : HUGE_VAL;
    team.for_range(rows_, kRowChunk, [&](std::size_t begin, std::size_t end) {
        std::fill(d_.begin() + std::ptrdiff_t(begin * 4), d_.begin() + std::ptrdiff_t(end * 4), Real(0));
    });
    double rz = 0;
    for (int iteration = 0; result.iterations < def.max_iterations; ++iteration) {
        if (def.deadline_ns != 0 && now_ns() > def.deadline_ns) {
            result.out_of_time = true;
            return;
        }
        const double rz_new = precondition(team, parts, r_.data(), z_.data());
        if (!(rz_new > 0)) {  // zero residual, not a number, or a preconditioner that has lost its way
            result.breakdown = rz_new < 0;
            return;
        }
        if (energy_target > 0 && std::sqrt(rz_new) <= energy_target && std::sqrt(rr) <= target) return;
        const Real beta = iteration == 0 ? Real(0) : Real(rz_new / rz);
        rz = rz_new;
        team.for_range(rows_, kRowChunk, [&](std::size_t begin, std::size_t end) {
            if (iteration == 0) {
                std::copy(z_.begin() + std::ptrdiff_t(begin * 4), z_.begin() + std::ptrdiff_t(end * 4), p_.begin() + std::ptrdiff_t(begin * 4));
            } else {
                kernels_.turn(beta, z_.data(), p_.data(), begin, end);
            }
        });
        const double curvature = product(team, parts, appended, p_.data(), q_.data());
        result.indefinite = def.only_definite && curvature < 0;
        if (!(curvature > 0)) return;  // p = 0 in this precision, or not a number
        const Real alpha = Real(rz / curvature);
        rr = sum_over_rows(team, rows_, partial_, [&](std::size_t begin, std::size_t end) {
            return kernels_.advance(alpha, p_.data(), q_.data(), d_.data(), r_.data(), begin, end);
        });
        ++result.iterations;
        if (energy_target == 0 && !(std::sqrt(rr) > target)) return;
    }
}

template <class Real>
std::array<double, 2> LinearSolver<Real>::traffic(std::span<const SystemPart<Real>> parts, bool warm) const {
    constexpr double vector = 4 * sizeof(Real);
    const double rows = double(rows_);
    double matrix = 0;
    typename Preconditioner<Real>::Traffic preconditioner;
    if (joint_ != nullptr) preconditioner = joint_->traffic();
    for (const SystemPart<Real>& part : parts) {
        const Bsr3Pattern& p = *part.A->pattern;
        matrix += part.elements != nullptr ? part.elements->traffic() : double(p.column.size()) * (12 * sizeof(Real) + sizeof(std::int32_t)) + double(p.rows) * 2 * vector;
        if (joint_ != nullptr) continue;
        const auto own = part.preconditioner->traffic();
        preconditioner.update += own.update;
        preconditioner.apply += own.apply;
    }
    const double start = preconditioner.update + rows * (2 * sizeof(Vec3) + 2 * vector) + (warm ? matrix + rows * (2 * sizeof(Vec3) + 8 * vector) : 0);
    return {start, matrix + preconditioner.apply + rows * 9 * vector};  // turn: z p p; advance: p q d d r r
}

template <class Real>
LinearSolveResult LinearSolver<Real>::solve(Team& team, std::span<const SystemPart<Real>> parts, std::span<const AppendedRow> appended,
                                            std::span<const Vec3> b, std::span<const std::span<const Vec3>> guesses, const LinearSolveDef& def,
                                            FunctionRef<void(const Vec3* x, Vec3* r)> true_residual, std::span<Vec3> x,
                                            std::span<Vec3> residual) {
    LinearSolveResult result;
    const bool definite = std::all_of(parts.begin(), parts.end(), [](const SystemPart<Real>& part) { return part.preconditioner->is_definite(); });
    result.indefinite = def.only_definite && !definite;
    if (result.indefinite) return result;
    cut(parts);
    import(team, b, r_.data());
    if (joint_ != nullptr) {
        const double size = def.energy_tolerance > 0 ? std::sqrt(std::max(0.0, precondition(team, parts, r_.data(), z_.data()))) : 0;
        result.energy_target = std::max(def.energy_target, def.energy_tolerance * size);
    }
    warm_start(team, parts, appended, guesses, x);
    const std::array<double, 2> traffic_of = traffic(parts, !guesses.empty());
    result.bytes = traffic_of[0];
    double recurrence = std::sqrt(square(team, r_.data()));
    result.start_residual = recurrence;
    double last_true = HUGE_VAL;
    for (int pass = 0;; ++pass) {
        if ((recurrence > def.target || (pass == 0 && result.energy_target > 0)) && result.iterations < def.max_iterations) {
            // A little below the target: the pass is worth nothing if rounding leaves it a hair above.
            const double goal = std::max(0.9 * def.target, kPassGain<Real> * recurrence);
            const int before = result.iterations;
            conjugate_gradients(team, parts, appended, goal, pass == 0 ? result.energy_target : 0, def, result);
            result.bytes += (result.iterations - before) * traffic_of[1];
            // A preconditioner made of the matrix itself fails with it.
            result.indefinite = result.indefinite || (def.only_definite && result.breakdown);
            if (result.indefinite) return result;
            team.for_range(rows_, kRowChunk, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) x[i] += Vec3(double(d_[4 * i]), double(d_[4 * i + 1]), double(d_[4 * i + 2]));
            });
        }
        true_residual(x.data(), residual.data());
        result.residual = std::sqrt(sum_over_rows(team, rows_, partial_, [&](std::size_t begin, std::size_t end) {
            double s = 0;
            for (std::size_t i = begin; i < end; ++i) s += residual[i].squaredNorm();
            return s;
        }));
        result.converged = result.residual <= def.target;
        if (result.converged) result.breakdown = result.out_of_time = false;
        if (result.converged || result.breakdown || result.out_of_time) return result;
        if (result.iterations >= def.max_iterations || !std::isfinite(result.residual)) return result;
        if (pass + 1 >= kMaxPasses || result.residual > 0.5 * last_true) {
            result.stalled = true;
            return result;
        }
        last_true = result.residual;
        import(team, residual, r_.data());
        recurrence = result.residual;
    }
}

template class LinearSolver<float>;
template class LinearSolver<double>;

}  // namespace supple::solve
