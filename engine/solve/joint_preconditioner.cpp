#include "supple/solve/joint_preconditioner.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "supple/solve/chunked_sum.h"

namespace supple::solve {

namespace {

constexpr double kMostWork = 3e7;     // multiplications of the factor of the links; beyond, they are diagonals
constexpr double kRidge = 1e-6;       // of the diagonal: the coarse matrix is as exact as the sums of Real that it is made of
constexpr double kIncompressible = 1e3;  // of its mean diagonal: what the coarse level adds against a change of volume whose stiffness it does not see

/// L with L L^T = K, K positive semidefinite: directions without stiffness have zero columns.
Mat3 root_of(const Mat3& K) {
    Mat3 L = Mat3::Zero();
    const double least = 1e-14 * K.trace();
    for (int j = 0; j < 3; ++j) {
        const double pivot = K(j, j) - L.row(j).squaredNorm();
        if (!(pivot > least)) continue;
        L(j, j) = std::sqrt(pivot);
        for (int i = j + 1; i < 3; ++i) L(i, j) = (K(i, j) - L.row(i).dot(L.row(j))) / L(j, j);
    }
    return L;
}

template <class Real>
Vec3 read(const Real* v) {
    return {double(v[0]), double(v[1]), double(v[2])};
}

}  // namespace

template <class Real>
void JointPreconditioner<Real>::invert(std::size_t row) {
    Mat3 inverse;
    bool ok = false;
    (diagonal_[row] + extra_[row]).eval().computeInverseWithCheck(inverse, ok, 1e-300);
    if (!ok || !inverse.allFinite()) inverse = Mat3::Identity();  // a row of a body about to be contained: any finite choice
    inverse_d_[row] = 0.5 * (inverse + inverse.transpose());
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 4; ++i) inverse_[row * 12 + std::size_t(4 * c + i)] = i < 3 ? Real(inverse_d_[row](i, c)) : Real(0);
}

template <class Real>
void JointPreconditioner<Real>::take_diagonals(Team& team) {
    diagonal_.resize(rows_);
    inverse_d_.resize(rows_);
    inverse_.resize(rows_ * 12);
    part_of_.resize(rows_);
    extra_.assign(rows_, Mat3::Zero());
    changed_.clear();
    team.for_range(parts_.size(), 1, [&](std::size_t p, std::size_t) {
        const JointPart<Real>& part = parts_[p];
        const Bsr3Pattern& pattern = *part.A->pattern;
        for (std::size_t i = 0; i < pattern.rows; ++i) {
            const std::size_t row = part.first_row + i;
            const Real* value = part.A->value.data() + std::size_t(pattern.diagonal[i]) * 12;
            for (int c = 0; c < 3; ++c) diagonal_[row].col(c) = read(value + 4 * c);
            if (!part.coupling_diagonal.empty()) diagonal_[row] += part.coupling_diagonal[i];
            part_of_[row] = std::int32_t(p);
            invert(row);
        }
    });
}

/// The affine motions of each part and Z^T A Z, a sum over blocks of q_i q_j^T (x) A_ij.
template <class Real>
void JointPreconditioner<Real>::take_motions(Team& team) {
    motion_.resize(rows_);
    free_.resize(rows_);
    galerkin_.resize(parts_.size());
    team.for_range(parts_.size(), 1, [&](std::size_t p, std::size_t) {
        const JointPart<Real>& part = parts_[p];
        const Bsr3Pattern& pattern = *part.A->pattern;
        const std::size_t n = pattern.rows;
        Vec3 middle = Vec3::Zero();
        for (const Vec3& x : part.points) middle += x / double(n);
        double size = 0;
        for (const Vec3& x : part.points) size = std::max(size, (x - middle).cwiseAbs().maxCoeff());
        const double scale = size > 0 && std::isfinite(size) ? 1 / size : 0;
        Motion* const motion = motion_.data() + part.first_row;
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3 q = scale * (part.points[std::size_t(pattern.vertex[i])] - middle);
            motion[i] = {1, q.x(), q.y(), q.z()};
            const std::int32_t* const owner = part.owner.data() + 3 * std::size_t(pattern.vertex[i]);
            free_[part.first_row + i] = std::uint8_t((owner[0] == -1 ? 1 : 0) | (owner[1] == -1 ? 2 : 0) | (owner[2] == -1 ? 4 : 0));
        }
        Coarse& E = galerkin_[p];
        E.setZero();
        for (std::size_t i = 0; i < n; ++i) {
            Real Y[4][12] = {};
            for (std::int32_t k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k) {
                const auto j = std::size_t(pattern.column[std::size_t(k)]);
                const Real* const value = part.A->value.data() + std::size_t(k) * 12;
                Real held[12];
                const Real* block = value;
                if (i == j) {  // the identity of held coordinates is no stiffness
                    const std::int32_t* const owner = part.owner.data() + 3 * std::size_t(pattern.vertex[i]);
                    for (std::size_t e = 0; e < 12; ++e) held[e] = owner[e / 4] != -1 ? Real(0) : value[e];
                    for (std::size_t e = 0; e < 12; ++e)
                        if (e % 4 < 3 && owner[e % 4] != -1) held[e] = 0;
                    block = held;
                }
                for (std::size_t b = 0; b < 4; ++b) {
                    const Real q = Real(motion[j][b]);
                    for (std::size_t e = 0; e < 12; ++e) Y[b][e] += q * block[e];
                }
            }
            for (Eigen::Index a = 0; a < 4; ++a)
                for (Eigen::Index b = 0; b < 4; ++b)
                    for (Eigen::Index c = 0; c < 3; ++c)
                        for (Eigen::Index d = 0; d < 3; ++d) E(3 * a + d, 3 * b + c) += motion[i][std::size_t(a)] * double(Y[b][4 * c + d]);
        }
        E = (0.5 * (E + E.transpose())).eval();
        if (!part.coupling_diagonal.empty()) {
            Eigen::Matrix<double, kMotions, 1> volume = Eigen::Matrix<double, kMotions, 1>::Zero();
            volume[3] = volume[7] = volume[11] = 1;
            E += kIncompressible / kMotions * E.trace() * volume * volume.transpose();
        }
    });
}

/// Sorts the appended rows into links and diagonals, and D with them. False if there are no links.
template <class Real>
bool JointPreconditioner<Real>::link_rows(bool pairs) {
    for (const std::int32_t row : changed_) {
        extra_[std::size_t(row)].setZero();
        invert(std::size_t(row));
    }
    changed_.clear();
    links_.clear();
    at_row_.clear();
    for (std::size_t e = 0; e < appended_.size(); ++e) {
        const AppendedRow& extra = appended_[e];
        const bool simple = std::all_of(extra.row.begin(), extra.row.end(), [&](std::int32_t row) { return parts_[std::size_t(part_of_[std::size_t(row)])].own == nullptr; });
        if (pairs && simple && extra.row.size() > 1) {
            for (std::size_t i = 0; i < extra.row.size(); ++i) at_row_.push_back({extra.row[i], std::int32_t(links_.size()), std::int32_t(i)});
            links_.push_back({std::int32_t(e), root_of(extra.stiffness)});
            continue;
        }
        for (std::size_t i = 0; i < extra.row.size(); ++i) {
            const auto row = std::size_t(extra.row[i]);
            if (parts_[std::size_t(part_of_[row])].own != nullptr) continue;
            extra_[row] += extra.weight[i].asDiagonal() * extra.stiffness * extra.weight[i].asDiagonal();
            changed_.push_back(extra.row[i]);
        }
    }
    for (const std::int32_t row : changed_) invert(std::size_t(row));
    return !links_.empty();
}

/// S. False if it is too much work, or not positive.
template <class Real>
bool JointPreconditioner<Real>::factor_links() {
    const std::size_t n = links_.size();
    std::sort(at_row_.begin(), at_row_.end(), [](const Place& a, const Place& b) { return a.row != b.row ? a.row < b.row : a.link != b.link ? a.link < b.link : a.slot < b.slot; });
    const auto for_rows = [&](auto&& visit) {
        for (std::size_t begin = 0; begin < at_row_.size();) {
            std::size_t end = begin;
            while (end < at_row_.size() && at_row_[end].row == at_row_[begin].row) ++end;
            visit(std::span<const Place>(at_row_).subspan(begin, end - begin));
            begin = end;
        }
    };
    start_.assign(n + 1, 0);
    for_rows([&](std::span<const Place> here) {
        for (const Place& a : here) start_[std::size_t(a.link) + 1] += std::int32_t(here.size());
    });
    for (std::size_t i = 0; i < n; ++i) start_[i + 1] += start_[i];
    neighbour_.resize(std::size_t(start_[n]));
    queue_.assign(start_.begin(), start_.end() - 1);
    for_rows([&](std::span<const Place> here) {
        for (const Place& a : here)
            for (const Place& b : here) neighbour_[std::size_t(queue_[std::size_t(a.link)]++)] = b.link;
    });
    narrow_order(start_, neighbour_, place_, queue_);
    first_.resize(3 * n);
    double work = 0;
    for (std::size_t i = 0; i < n; ++i) {
        std::int32_t first = place_[i];
        for (std::int32_t k = start_[i]; k < start_[i + 1]; ++k) first = std::min(first, place_[std::size_t(neighbour_[std::size_t(k)])]);
        for (std::size_t c = 0; c < 3; ++c) first_[3 * std::size_t(place_[i]) + c] = 3 * first;
        const double width = 3 * (1 + place_[i] - first);
        work += 1.5 * width * width;
    }
    if (work > kMostWork) return false;
    S_.shape(first_);
    for (std::size_t i = 0; i < 3 * n; ++i) S_.at(i, i) = 1;
    for_rows([&](std::span<const Place> here) {
        const Mat3& inverse = inverse_d_[std::size_t(here[0].row)];
        const auto reach = [&](const Place& a) -> Mat3 {
            const Link& link = links_[std::size_t(a.link)];
            return appended_[std::size_t(link.extra)].weight[std::size_t(a.slot)].asDiagonal() * link.L;
        };
        for (const Place& a : here) {
            const Mat3 left = reach(a).transpose() * inverse;
            const auto at = std::size_t(place_[std::size_t(a.link)]);
            for (const Place& b : here) {
                const auto with = std::size_t(place_[std::size_t(b.link)]);
                if (with > at) continue;
                const Mat3 block = left * reach(b);
                for (std::size_t i = 0; i < 3; ++i)
                    for (std::size_t j = 0; j < 3; ++j) {
                        if (3 * with + j <= 3 * at + i) S_.at(3 * at + i, 3 * with + j) += block(Eigen::Index(i), Eigen::Index(j));
                    }
            }
        }
    });
    t_.resize(3 * n);
    u_.resize(3 * n);
    return S_.factor();
}

template <class Real>
void JointPreconditioner<Real>::add_coarse(std::size_t p, std::size_t q, const Coarse& block) {
    const std::size_t at = kMotions * std::size_t(coarse_place_[p]), with = kMotions * std::size_t(coarse_place_[q]);
    if (with > at) return;  // the transposed one is added
    for (std::size_t i = 0; i < kMotions; ++i)
        for (std::size_t j = 0; j < kMotions; ++j) {
            if (with + j <= at + i) E_.at(at + i, with + j) += block(Eigen::Index(i), Eigen::Index(j));
        }
}

template <class Real>
bool JointPreconditioner<Real>::factor_coarse(std::span<const EliminatedBody> eliminated) {
    const std::size_t n = parts_.size();
    // Which parts meet.
    meets_.clear();
    const auto meet = [&](std::int32_t a, std::int32_t b) {
        meets_.push_back({a, b});
        meets_.push_back({b, a});
    };
    for (const AppendedRow& extra : appended_) {
        for (const std::int32_t row : extra.row) {
            if (part_of_[std::size_t(row)] != part_of_[std::size_t(extra.row[0])]) meet(part_of_[std::size_t(extra.row[0])], part_of_[std::size_t(row)]);
        }
    }
    for (const EliminatedBody& body : eliminated) {  // all that touch it
        queue_.clear();
        for (const std::int32_t row : body.row) queue_.push_back(part_of_[std::size_t(row)]);
        std::sort(queue_.begin(), queue_.end());
        queue_.erase(std::unique(queue_.begin(), queue_.end()), queue_.end());
        for (std::size_t a = 0; a < queue_.size(); ++a)
            for (std::size_t b = 0; b < a; ++b) meet(queue_[a], queue_[b]);
    }
    std::sort(meets_.begin(), meets_.end());
    meets_.erase(std::unique(meets_.begin(), meets_.end()), meets_.end());
    start_.assign(n + 1, 0);
    neighbour_.clear();
    for (const auto& [a, b] : meets_) {
        ++start_[std::size_t(a) + 1];
        neighbour_.push_back(b);
    }
    for (std::size_t i = 0; i < n; ++i) start_[i + 1] += start_[i];
    narrow_order(start_, neighbour_, coarse_place_, queue_);
    first_.resize(kMotions * n);
    for (std::size_t i = 0; i < n; ++i) {
        std::int32_t first = coarse_place_[i];
        for (std::int32_t k = start_[i]; k < start_[i + 1]; ++k) first = std::min(first, coarse_place_[std::size_t(neighbour_[std::size_t(k)])]);
        for (std::size_t c = 0; c < kMotions; ++c) first_[kMotions * std::size_t(coarse_place_[i]) + c] = std::int32_t(kMotions) * first;
    }
    E_.shape(first_);
    for (std::size_t p = 0; p < n; ++p) add_coarse(p, p, galerkin_[p]);
    // The rows: J Z of one part is a 3 x 12 matrix.
    using Reach = Eigen::Matrix<double, kMotions, 3, Eigen::DontAlign>;
    for (const AppendedRow& extra : appended_) {
        std::array<std::pair<std::int32_t, Reach>, 2> side;
        std::size_t sides = 0;
        for (std::size_t i = 0; i < extra.row.size(); ++i) {
            const std::int32_t p = part_of_[std::size_t(extra.row[i])];
            std::size_t s = 0;
            while (s < sides && side[s].first != p) ++s;
            if (s == sides) {
                if (sides == side.size()) continue;  // no row has a third
                side[sides++] = {p, Reach::Zero()};
            }
            const Motion& q = motion_[std::size_t(extra.row[i])];
            for (Eigen::Index a = 0; a < 4; ++a) side[s].second.template middleRows<3>(3 * a) += q[std::size_t(a)] * Mat3(extra.weight[i].asDiagonal());
        }
        for (std::size_t s = 0; s < sides; ++s) {
            const Reach stiff = side[s].second * extra.stiffness;
            for (std::size_t o = 0; o < sides; ++o) add_coarse(std::size_t(side[s].first), std::size_t(side[o].first), Coarse(stiff * side[o].second.transpose()));
        }
    }
    for (const EliminatedBody& body : eliminated) {
        reach_.resize(n);
        for (auto& reach : reach_) reach.setZero();
        for (std::size_t i = 0; i < body.row.size(); ++i) {
            const Motion& q = motion_[std::size_t(body.row[i])];
            auto& reach = reach_[std::size_t(part_of_[std::size_t(body.row[i])])];
            for (Eigen::Index a = 0; a < 4; ++a) reach.template middleRows<3>(3 * a) += q[std::size_t(a)] * body.block[i];
        }
        for (std::size_t p = 0; p < n; ++p) {
            if (reach_[p].isZero(0)) continue;
            for (std::size_t q = 0; q < n; ++q) {
                if (!reach_[q].isZero(0)) add_coarse(p, q, Coarse(-reach_[p] * body.inverse * reach_[q].transpose()));
            }
        }
    }
    for (std::size_t i = 0; i < kMotions * n; ++i) {
        double& e = E_.at(i, i);
        e = e > 0 ? (1 + kRidge) * e : 1;  // a motion that is held altogether
    }
    c_.resize(kMotions * n);
    y_.resize(kMotions * n);
    return E_.factor();
}

template <class Real>
void JointPreconditioner<Real>::update(Team& team, std::span<const JointPart<Real>> parts, std::span<const AppendedRow> appended, std::span<const EliminatedBody> eliminated,
                                       bool same_matrices) {
    parts_ = parts;
    appended_ = appended;
    if (!same_matrices) {
        rows_ = 0;
        for (const JointPart<Real>& part : parts) rows_ += part.A->pattern->rows;
        cut_rows(parts, [](const JointPart<Real>& part) { return part.A->pattern->rows; }, pieces_);
        partial_.resize(pieces_.size());
        moved_.resize(kMotions * pieces_.size());
        take_diagonals(team);
        take_motions(team);
    }
    if (link_rows(true) && !factor_links()) link_rows(false);
    coarse_ = factor_coarse(eliminated);
}

/// Sum of motion^T r over rows.
template <class Real>
void JointPreconditioner<Real>::gather(const Real* r, std::size_t begin, std::size_t end, double* sum) const {
    double at[4][4] = {};
    for (std::size_t row = begin; row < end; ++row) {
        const Motion& q = motion_[row];
        const double v[4] = {double(r[4 * row]), double(r[4 * row + 1]), double(r[4 * row + 2]), double(r[4 * row + 3])};
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t c = 0; c < 4; ++c) at[a][c] += q[a] * v[c];
    }
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t c = 0; c < 3; ++c) sum[3 * a + c] = at[a][c];
}

/// z += motion y over rows, where coordinates are free.
template <class Real>
void JointPreconditioner<Real>::spread(const double* y, std::size_t begin, std::size_t end, Real* z) const {
    double by[4][4] = {};
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t c = 0; c < 3; ++c) by[a][c] = y[3 * a + c];
    for (std::size_t row = begin; row < end; ++row) {
        const Motion& q = motion_[row];
        double s[4];
        for (std::size_t c = 0; c < 4; ++c) s[c] = q[0] * by[0][c] + q[1] * by[1][c] + q[2] * by[2][c] + q[3] * by[3][c];
        for (std::size_t c = 0; c < 4; ++c) s[c] = free_[row] >> c & 1 ? s[c] : 0;
        for (std::size_t c = 0; c < 4; ++c) z[4 * row + c] += Real(s[c]);
    }
}

template <class Real>
double JointPreconditioner<Real>::apply(Team& team, const Real* r, Real* z) {
    double rz = 0;
    for (const JointPart<Real>& part : parts_) {
        if (part.own == nullptr) continue;
        const double own = part.own->apply(team, r + 4 * part.first_row, z + 4 * part.first_row);
        if (!(own >= 0)) return own;
        rz += own;
    }
    rz += sum_over_pieces(team, pieces_, partial_, [&](const RowPiece& piece) {
        const JointPart<Real>& part = parts_[piece.part];
        const std::size_t begin = part.first_row + piece.begin, end = part.first_row + piece.end;
        if (coarse_) gather(r, begin, end, moved_.data() + kMotions * std::size_t(&piece - pieces_.data()));
        return part.own != nullptr ? 0.0 : kernels_.block_diagonal(inverse_.data(), r, z, begin, end);
    });
    for (std::size_t l = 0; l < links_.size(); ++l) {
        const AppendedRow& extra = appended_[std::size_t(links_[l].extra)];
        Vec3 s = Vec3::Zero();
        for (std::size_t i = 0; i < extra.row.size(); ++i) s += extra.weight[i].cwiseProduct(read(z + std::size_t(extra.row[i]) * 4));
        Eigen::Map<Vec3>(t_.data() + 3 * place_[l]) = links_[l].L.transpose() * s;
    }
    if (!links_.empty()) {
        u_ = t_;
        S_.solve(u_.data());
        for (std::size_t i = 0; i < u_.size(); ++i) rz -= t_[i] * u_[i];
        for (std::size_t l = 0; l < links_.size(); ++l) {
            const AppendedRow& extra = appended_[std::size_t(links_[l].extra)];
            const Vec3 f = links_[l].L * Eigen::Map<const Vec3>(u_.data() + 3 * place_[l]);
            for (std::size_t i = 0; i < extra.row.size(); ++i) {
                const auto row = std::size_t(extra.row[i]);
                const Vec3 back = inverse_d_[row] * extra.weight[i].cwiseProduct(f);
                for (int c = 0; c < 3; ++c) z[4 * row + std::size_t(c)] -= Real(back[c]);
            }
        }
    }
    if (!coarse_) return rz;
    std::fill(c_.begin(), c_.end(), 0.0);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
        double* const out = c_.data() + kMotions * std::size_t(coarse_place_[pieces_[i].part]);
        for (std::size_t k = 0; k < kMotions; ++k) out[k] += moved_[kMotions * i + k];
    }
    y_ = c_;
    E_.solve(y_.data());
    for (std::size_t i = 0; i < c_.size(); ++i) rz += c_[i] * y_[i];
    team.for_chunks(pieces_.size(), [&](std::size_t i) {
        const RowPiece& piece = pieces_[i];
        const std::size_t first = parts_[piece.part].first_row;
        spread(y_.data() + kMotions * std::size_t(coarse_place_[piece.part]), first + piece.begin, first + piece.end, z);
    });
    return rz;
}

template <class Real>
std::size_t JointPreconditioner<Real>::bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return of(part_of_) + of(diagonal_) + of(inverse_d_) + of(inverse_) + of(extra_) + of(changed_) + of(links_) + of(at_row_) + of(start_) + of(neighbour_) + of(place_) +
           of(queue_) + of(first_) + of(t_) + of(u_) + of(motion_) + of(free_) + of(pieces_) + of(moved_) + of(galerkin_) + of(meets_) + of(coarse_place_) + of(reach_) + of(c_) + of(y_) + S_.bytes() + E_.bytes();
}

template <class Real>
auto JointPreconditioner<Real>::traffic() const -> Preconditioner<Real>::Traffic {
    const double rows = double(rows_);
    typename Preconditioner<Real>::Traffic sum{rows * (sizeof(Mat3) * 2 + 12 * sizeof(Real)), rows * 20 * sizeof(Real) + 2 * double(S_.bytes() + E_.bytes())};
    if (coarse_) sum.apply += 2 * rows * (sizeof(Motion) + 4 * sizeof(Real));
    for (const JointPart<Real>& part : parts_) {
        if (part.own == nullptr) continue;
        sum.update += part.own->traffic().update;
        sum.apply += part.own->traffic().apply;
    }
    return sum;
}

template class JointPreconditioner<float>;
template class JointPreconditioner<double>;

}  // namespace supple::solve
