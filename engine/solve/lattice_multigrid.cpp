#include "supple/solve/lattice_multigrid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "supple/solve/chunked_sum.h"
#include "supple/solve/direct_solver.h"

namespace supple::solve {

namespace {

constexpr std::size_t kDirectNodes = 110;   // a lattice of so few nodes is solved by its inverse
constexpr std::size_t kMostLevels = 12;
constexpr std::size_t kSamples = 9;         // rotations per node: some may belong to inverted elements

/// Sum of unit quaternions, each on the side of the first, made a unit again.
Eigen::Quaterniond mean_rotation(std::span<const std::int32_t> ids, RotationLookup rotation) {
    double sum[4] = {0, 0, 0, 0}, first[4] = {1, 0, 0, 0};
    bool any = false;
    for (const std::int32_t id : ids) {
        if (id < 0) break;
        double q[4];
        rotation(id, q);
        if (!any) std::copy(q, q + 4, first);
        any = true;
        const double side = q[0] * first[0] + q[1] * first[1] + q[2] * first[2] + q[3] * first[3] < 0 ? -1 : 1;
        for (int k = 0; k < 4; ++k) sum[k] += side * q[k];
    }
    const double norm = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2] + sum[3] * sum[3]);
    if (!(norm > 1e-3)) return Eigen::Quaterniond::Identity();
    return {sum[0] / norm, sum[1] / norm, sum[2] / norm, sum[3] / norm};
}

/// out = R v, or R^T v, on x y z of a padded vector.
template <bool transposed>
void rotate(const float* R, const float* v, float* out) {
    for (int i = 0; i < 3; ++i) {
        out[i] = transposed ? R[4 * i] * v[0] + R[4 * i + 1] * v[1] + R[4 * i + 2] * v[2] : R[i] * v[0] + R[4 + i] * v[1] + R[8 + i] * v[2];
    }
    out[3] = 0;
}

std::vector<std::int32_t> diagonals(const BlockRows& A) {
    std::vector<std::int32_t> at(A.rows());
    for (std::size_t i = 0; i < A.rows(); ++i) {
        const auto first = A.column.begin() + A.row_start[i], last = A.column.begin() + A.row_start[i + 1];
        at[i] = std::int32_t(std::lower_bound(first, last, std::int32_t(i)) - A.column.begin());
    }
    return at;
}

}  // namespace

/// Levels from the finest down. Between level l and l + 1 stands transfer[l].
template <class Real>
struct LatticeMultigrid<Real>::Hierarchy {
    std::vector<BlockRows> matrix;                     ///< of level l + 1; values kept for level 1 alone
    std::vector<std::unique_ptr<PackedLevel>> level;   ///< smoothed levels
    std::vector<LatticeInterpolation> transfer;
    std::vector<AlignedVector<float>> correction;      ///< [transfer][node] unscaled, turned
    std::unique_ptr<DirectSolver> direct;              ///< below the last smoothed level, or null
    std::vector<std::int32_t> corrected_though_held;   ///< rows, ascending, that the lattice reaches though some coordinate is held
    std::vector<std::uint8_t> held;
    // Warp of level 1.
    std::vector<std::array<std::int32_t, kSamples>> samples;
    std::vector<Eigen::Quaterniond, Eigen::aligned_allocator<Eigen::Quaterniond>> at_build;
    AlignedVector<float> turn;                         ///< [node][column][x y z 0]
    std::vector<std::int32_t> diagonal1;
    // Appended rows of the current step.
    std::vector<std::int32_t> extra_row, extra_node, row_slot, node_slot;
    std::vector<Mat3> extra, extra_coarse;
    bool level1_altered = false;
    std::vector<double> partial;
    int degree = 2;
    bool smoother_is_due = false;                      ///< level 0 has none yet: with the next update
};

template <class Real>
LatticeMultigrid<Real>::LatticeMultigrid(const Bsr3Pattern& pattern, Isa isa) : pattern_(pattern), isa_(isa) {}

template <class Real>
LatticeMultigrid<Real>::~LatticeMultigrid() = default;

template <class Real>
bool LatticeMultigrid<Real>::built() const {
    return h_ != nullptr;
}

namespace {

std::vector<LatticePoint> lattice_points(const LatticeDef& def) {
    Vec3 low = Vec3::Constant(HUGE_VAL), high = -low;
    for (const Vec3& x : def.points) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }
    // No more than 2^20 cells along an axis, whatever the volume says.
    const double size = std::max((high - low).maxCoeff(), 1e-30);
    const double spacing = std::max(def.spacing * std::cbrt(def.volume / double(def.points.size())), size * 1e-6);
    const Vec3 origin = low - Vec3::Constant(0.01 * spacing);
    std::vector<LatticePoint> points(def.points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double at = (def.points[i][Eigen::Index(axis)] - origin[Eigen::Index(axis)]) / spacing;
            points[i].cell[axis] = std::int32_t(at);
            points[i].fraction[axis] = float(at - std::floor(at));
        }
        points[i].active = def.held[i] != 7;
    }
    return points;
}

/// For each node the rotations of the three points that weigh most there, point by point.
std::vector<std::array<std::int32_t, kSamples>> choose_samples(const LatticeInterpolation& P, std::span<const std::array<std::int32_t, 3>> rotation_of_row) {
    std::vector<std::array<std::int32_t, kSamples>> samples(P.node.size());
    for (std::size_t node = 0; node < samples.size(); ++node) {
        std::vector<std::pair<float, std::int32_t>> points;
        for (std::int32_t k = P.to_nodes.row_start[node]; k < P.to_nodes.row_start[node + 1]; ++k) {
            points.emplace_back(-P.to_nodes.weight[std::size_t(k)], P.to_nodes.column[std::size_t(k)]);
        }
        std::sort(points.begin(), points.end());
        samples[node].fill(-1);
        std::size_t count = 0;
        for (std::size_t k = 0; k < points.size() && k < 3; ++k) {
            for (const std::int32_t id : rotation_of_row[std::size_t(points[k].second)]) {
                if (id >= 0) samples[node][count++] = id;
            }
        }
    }
    return samples;
}

}  // namespace

template <class Real>
void LatticeMultigrid<Real>::lay_level0() {
    Hierarchy& h = *h_;
    h.row_slot.assign(pattern_.rows, -1);
    h.extra_row.clear();
    h.extra.clear();
    h.partial.resize(row_chunks(pattern_.rows) + pattern_.rows);  // the finest level's chunks are never more than its rows
    if (h.level.empty()) h.level.emplace_back();
    h.level[0] = std::make_unique<PackedLevel>(isa_, pattern_.row_start, pattern_.column);
}

template <class Real>
void LatticeMultigrid<Real>::build(Team& team, const LatticeDef& def, const Bsr3<Real>& A, RotationLookup rotation) {
    h_ = std::make_unique<Hierarchy>();
    Hierarchy& h = *h_;
    h.degree = def.degree;
    lay_level0();
    h.level[0]->pack(team, A.value.data(), pattern_.diagonal);
    h.level[0]->set_smoother(team, def.degree);
    h.matrix.reserve(kMostLevels);  // levels keep spans of these
    LatticeInterpolation P = make_interpolation(lattice_points(def), pattern_.row_start, pattern_.column);
    if (!P.node.empty()) {  // else all is held
        h.matrix.push_back(galerkin<Real>(team, {pattern_.row_start, pattern_.column, A.value.data(), def.held}, P));
        h.samples = choose_samples(P, def.rotation_of_row);
        for (const auto& ids : h.samples) h.at_build.push_back(mean_rotation(ids, rotation));
        h.transfer.push_back(std::move(P));
        lay_below(team);
    }
    hold(def.held);
    turn(team, rotation);
}

/// All levels from the matrix of level 1 on.
template <class Real>
void LatticeMultigrid<Real>::lay_below(Team& team) {
    Hierarchy& h = *h_;
    h.turn.resize(h.transfer[0].node.size() * 12);
    h.node_slot.assign(h.transfer[0].node.size(), -1);
    for (std::size_t l = 0;; ++l) {
        const BlockRows& coarse = h.matrix[l];
        const std::size_t nodes = coarse.rows();
        h.correction.emplace_back(nodes * 4, 0.0f);
        if (nodes <= kDirectNodes) {
            h.direct = std::make_unique<DirectSolver>(coarse);
            break;
        }
        const std::vector<std::int32_t> diagonal = diagonals(coarse);
        h.level.push_back(std::make_unique<PackedLevel>(isa_, coarse.row_start, coarse.column));
        h.level.back()->pack(team, coarse.value.data(), diagonal);
        h.level.back()->set_smoother(team, h.degree);
        if (l == 0) h.diagonal1 = diagonal;
        if (l + 1 == kMostLevels) break;
        LatticeInterpolation P = make_interpolation(coarser_points(h.transfer[l].node), coarse.row_start, coarse.column);
        if (P.node.empty() || P.node.size() > nodes * 3 / 4) break;  // a cloud of parts that no lattice makes fewer
        h.matrix.push_back(galerkin<float>(team, {coarse.row_start, coarse.column, coarse.value.data(), {}}, P));
        h.transfer.push_back(std::move(P));
    }
    for (std::size_t l = 1; l < h.matrix.size(); ++l) h.matrix[l].value = {};
}

template <class Real>
void LatticeMultigrid<Real>::follow(LatticeMultigrid& before, const LatticeChange& change) {
    h_ = std::move(before.h_);
    Hierarchy& h = *h_;
    lay_level0();
    h.smoother_is_due = true;
    h.held.assign(pattern_.rows, 0);
    h.corrected_though_held.clear();
    if (h.transfer.empty()) return;
    ScalarRows& P = h.transfer[0].to_points;
    ScalarRows now;
    now.row_start.reserve(pattern_.rows + 1);
    now.column.reserve(P.column.size());
    now.weight.reserve(P.column.size());
    std::vector<std::pair<std::int32_t, double>> sum;
    for (std::size_t i = 0; i < pattern_.rows; ++i) {
        const auto range = [&](std::int32_t row) { return std::pair(P.row_start[std::size_t(row)], P.row_start[std::size_t(row) + 1]); };
        if (change.parent[i][0] >= 0 && change.parent[i][1] < 0) {
            const auto [first, last] = range(change.parent[i][0]);
            now.column.insert(now.column.end(), P.column.begin() + first, P.column.begin() + last);
            now.weight.insert(now.weight.end(), P.weight.begin() + first, P.weight.begin() + last);
        } else {
            sum.clear();
            for (std::size_t k = 0; k < 4 && change.parent[i][k] >= 0; ++k) {
                const auto [first, last] = range(change.parent[i][k]);
                for (std::int32_t w = first; w < last; ++w) sum.emplace_back(P.column[std::size_t(w)], change.weight[i][k] * double(P.weight[std::size_t(w)]));
            }
            std::sort(sum.begin(), sum.end());
            for (std::size_t k = 0; k < sum.size(); ++k) {
                if (k > 0 && sum[k].first == sum[k - 1].first) {
                    now.weight.back() += float(sum[k].second);
                } else {
                    now.column.push_back(sum[k].first);
                    now.weight.push_back(float(sum[k].second));
                }
            }
        }
        now.row_start.push_back(std::int32_t(now.column.size()));
    }
    P = std::move(now);
    h.transfer[0].to_nodes = transpose(P, h.transfer[0].node.size());
    for (auto& ids : h.samples) {
        std::size_t kept = 0;
        for (const std::int32_t id : std::array(ids)) {
            if (id >= 0 && change.new_rotation[std::size_t(id)] >= 0) ids[kept++] = change.new_rotation[std::size_t(id)];
        }
        std::fill(ids.begin() + std::ptrdiff_t(kept), ids.end(), -1);
    }
}

template <class Real>
void LatticeMultigrid<Real>::save(ByteWriter& out) const {
    const Hierarchy& h = *h_;
    out.value(std::int32_t(h.degree));
    out.value(h.smoother_is_due ? 0.0f : h.level[0]->largest_eigenvalue());
    out.value(std::uint64_t(h.transfer.size()));
    if (h.transfer.empty()) return;
    out.array(h.transfer[0].node);
    const ScalarRows& P = h.transfer[0].to_points;
    out.array(P.row_start);
    out.array(P.column);
    out.array(P.weight);
    out.array(h.matrix[0].row_start);
    out.array(h.matrix[0].column);
    out.array(h.matrix[0].value);
    out.array(h.samples);
    std::vector<double> q;
    for (const Eigen::Quaterniond& r : h.at_build) q.insert(q.end(), {r.w(), r.x(), r.y(), r.z()});
    out.array(q);
}

template <class Real>
void LatticeMultigrid<Real>::load(Team& team, ByteReader& in, std::size_t rotations) {
    constexpr std::size_t kMost = std::size_t(1) << 30;
    constexpr const char* what = "preconditioner";
    auto made = std::make_unique<Hierarchy>();
    Hierarchy& h = *made;
    const auto wrong = [] { throw Error(ErrorCode::corrupt_snapshot, "snapshot", "a preconditioner does not fit its body"); };
    const auto rows_good = [](const std::vector<std::int32_t>& start, const std::vector<std::int32_t>& column, std::size_t rows, std::size_t columns) {
        return start.size() == rows + 1 && start[0] == 0 && std::is_sorted(start.begin(), start.end()) && std::size_t(start.back()) == column.size() &&
               std::all_of(column.begin(), column.end(), [&](std::int32_t c) { return c >= 0 && std::size_t(c) < columns; });
    };
    h.degree = in.value<std::int32_t>(what);
    const float eigenvalue = in.value<float>(what);
    const auto levels = in.value<std::uint64_t>(what);
    if ((h.degree != 1 && h.degree != 2) || !(eigenvalue >= 0 && eigenvalue < 1e6f)) wrong();
    if (levels > 0) {
        LatticeInterpolation P;
        P.node = in.list<std::array<std::int32_t, 3>>(kMost, what);
        P.to_points.row_start = in.list<std::int32_t>(kMost, what);
        P.to_points.column = in.list<std::int32_t>(kMost, what);
        P.to_points.weight = in.list<float>(kMost, what);
        BlockRows A;
        A.row_start = in.list<std::int32_t>(kMost, what);
        A.column = in.list<std::int32_t>(kMost, what);
        A.value = in.list<float>(kMost, what);
        h.samples = in.list<std::array<std::int32_t, kSamples>>(kMost, what);
        const auto q = in.list<double>(kMost, what);
        const std::size_t nodes = P.node.size();
        const bool samples_good = std::all_of(h.samples.begin(), h.samples.end(), [&](const auto& ids) {
            return std::all_of(ids.begin(), ids.end(), [&](std::int32_t id) { return id >= -1 && id < std::int64_t(rotations); });
        });
        if (nodes == 0 || !rows_good(P.to_points.row_start, P.to_points.column, pattern_.rows, nodes) || P.to_points.weight.size() != P.to_points.column.size() ||
            !rows_good(A.row_start, A.column, nodes, nodes) || A.value.size() != 12 * A.column.size() || h.samples.size() != nodes || q.size() != 4 * nodes || !samples_good) {
            wrong();
        }
        P.to_nodes = transpose(P.to_points, nodes);
        for (std::size_t i = 0; i < nodes; ++i) h.at_build.emplace_back(q[4 * i], q[4 * i + 1], q[4 * i + 2], q[4 * i + 3]);
        h.matrix.reserve(kMostLevels);
        h.matrix.push_back(std::move(A));
        h.transfer.push_back(std::move(P));
    }
    h_ = std::move(made);
    lay_level0();
    h.smoother_is_due = eigenvalue == 0;
    if (!h.smoother_is_due) h.level[0]->set_smoother(eigenvalue, h.degree);
    h.held.assign(pattern_.rows, 0);
    if (levels > 0) lay_below(team);
}

template <class Real>
void LatticeMultigrid<Real>::hold(std::span<const std::uint8_t> held) {
    Hierarchy& h = *h_;
    h.held.assign(held.begin(), held.end());
    h.corrected_though_held.clear();
    if (h.transfer.empty()) return;
    const std::vector<std::int32_t>& start = h.transfer[0].to_points.row_start;
    for (std::size_t i = 0; i < held.size(); ++i) {
        if (held[i] != 0 && start[i] != start[i + 1]) h.corrected_though_held.push_back(std::int32_t(i));
    }
}

template <class Real>
void LatticeMultigrid<Real>::turn(Team& team, RotationLookup rotation) {
    Hierarchy& h = *h_;
    team.for_range(h.samples.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t node = begin; node < end; ++node) {
            const Eigen::Quaterniond q = mean_rotation(h.samples[node], rotation) * h.at_build[node].conjugate();
            const Mat3 R = q.toRotationMatrix();
            float* out = h.turn.data() + node * 12;
            for (int c = 0; c < 3; ++c)
                for (int i = 0; i < 4; ++i) out[4 * c + i] = i < 3 ? float(R(i, c)) : 0.0f;
        }
    });
}

namespace {

/// Adds `block` to the entry of `row` in a list of blocks by row; slot [row] says where in the list, -1: nowhere yet.
void add_to(std::vector<std::int32_t>& slot, std::vector<std::int32_t>& rows, std::vector<Mat3>& blocks, std::int32_t row, const Mat3& block) {
    std::int32_t& at = slot[std::size_t(row)];
    if (at < 0) {
        at = std::int32_t(rows.size());
        rows.push_back(row);
        blocks.push_back(block);
    } else {
        blocks[std::size_t(at)] += block;
    }
}

void clear(std::vector<std::int32_t>& slot, std::vector<std::int32_t>& rows, std::vector<Mat3>& blocks) {
    for (const std::int32_t row : rows) slot[std::size_t(row)] = -1;
    rows.clear();
    blocks.clear();
}

}  // namespace

template <class Real>
void LatticeMultigrid<Real>::update(Team& team, const Bsr3<Real>& A, std::span<const AppendedRow> appended) {
    gather_appended(appended);
    h_->level[0]->pack(team, A.value.data(), pattern_.diagonal, h_->extra_row, h_->extra);
    finish_update(team);
}

template <class Real>
void LatticeMultigrid<Real>::update(Team& team, Operator<Real>& A, std::span<const AppendedRow> appended) {
    if constexpr (sizeof(Real) == 4) {
        gather_appended(appended);
        h_->level[0]->take(team, A, h_->extra_row, h_->extra);
        finish_update(team);
    } else {
        SUPPLE_ASSERT(takes_operator());
    }
}

template <class Real>
void LatticeMultigrid<Real>::gather_appended(std::span<const AppendedRow> appended) {
    Hierarchy& h = *h_;
    clear(h.row_slot, h.extra_row, h.extra);
    clear(h.node_slot, h.extra_node, h.extra_coarse);
    for (const AppendedRow& row : appended) {
        for (std::size_t i = 0; i < row.row.size(); ++i) {
            add_to(h.row_slot, h.extra_row, h.extra, row.row[i], row.weight[i].asDiagonal() * row.stiffness * row.weight[i].asDiagonal());
        }
    }
}

template <class Real>
void LatticeMultigrid<Real>::finish_update(Team& team) {
    Hierarchy& h = *h_;
    if (h.smoother_is_due) {
        h.level[0]->set_smoother(team, h.degree, h.held);
        h.smoother_is_due = false;
    }
    if (h.level.size() < 2) return;
    // Level 1 sees appended stiffness lumped on its nodes, in the frame of the build: what moves all of them alike meets it in full.
    const ScalarRows& P = h.transfer[0].to_points;
    for (std::size_t k = 0; k < h.extra_row.size(); ++k) {
        for (std::int32_t w = P.row_start[std::size_t(h.extra_row[k])]; w < P.row_start[std::size_t(h.extra_row[k]) + 1]; ++w) {
            const std::int32_t node = P.column[std::size_t(w)];
            const float* R = h.turn.data() + std::size_t(node) * 12;
            Mat3 D;
            for (int c = 0; c < 3; ++c)
                for (int i = 0; i < 3; ++i) D(i, c) = double(R[4 * c + i]);
            add_to(h.node_slot, h.extra_node, h.extra_coarse, node, double(P.weight[std::size_t(w)]) * D.transpose() * h.extra[k] * D);
        }
    }
    if (h.extra_node.empty() && !h.level1_altered) return;
    h.level[1]->pack(team, h.matrix[0].value.data(), h.diagonal1, h.extra_node, h.extra_coarse);
    h.level1_altered = !h.extra_node.empty();
}

/// From the residual t of `level` to the correction of its points: restricts, solves below.
template <class Real>
void LatticeMultigrid<Real>::down(Team& team, std::size_t level) {
    Hierarchy& h = *h_;
    const LatticeInterpolation& P = h.transfer[level];
    const PackedKernels& kernels = packed_kernels(isa_);
    const float* fine = h.level[level]->t.data();
    const std::size_t nodes = P.node.size();
    const bool last = level + 1 == h.level.size();
    PackedLevel* coarse = last ? nullptr : h.level[level + 1].get();
    float* b = last ? h.direct->b.data() : coarse->r.data();
    team.for_range(nodes, last ? nodes : coarse->chunk(), [&](std::size_t begin, std::size_t end) {
        kernels.gather(P.to_nodes.row_start.data(), P.to_nodes.column.data(), P.to_nodes.weight.data(), fine, b, begin, end);
        for (std::size_t i = begin; i < end; ++i) {
            float v[4];
            if (level == 0) {
                rotate<true>(h.turn.data() + i * 12, b + 4 * i, v);
            } else {
                std::copy(b + 4 * i, b + 4 * i + 4, v);
            }
            const float s = last ? 1.0f : coarse->inverse_scale()[i];
            for (std::size_t c = 0; c < 4; ++c) b[4 * i + c] = s * v[c];
        }
        if (!last) coarse->smooth_first(begin, end);
    });
    float* out = h.correction[level].data();
    const auto finish = [&](const float* x, const float* scale, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const float s = scale ? scale[i] : 1.0f;
            const float v[4] = {s * x[4 * i], s * x[4 * i + 1], s * x[4 * i + 2], 0};
            if (level == 0) {
                rotate<false>(h.turn.data() + i * 12, v, out + 4 * i);
            } else {
                std::copy(v, v + 4, out + 4 * i);
            }
        }
    };
    if (last) {
        DirectSolver& d = *h.direct;
        const std::size_t half = nodes > 64 ? (nodes + 1) / 2 : nodes;
        team.for_range(nodes, half, [&](std::size_t begin, std::size_t end) {
            bsr3_kernels<float>(isa_).multiply(d.row_start.data(), d.column.data(), d.value.data(), d.b.data(), d.x.data(), begin, end);
            finish(d.x.data(), nullptr, begin, end);
        });
        return;
    }
    cycle(team, level + 1);
    team.for_range(nodes, coarse->chunk(), [&](std::size_t begin, std::size_t end) {
        const bool two = coarse->degree() == 2;
        if (two) {
            coarse->restart_second(begin, end);
        } else {
            coarse->restart_first(begin, end);
        }
        finish(two ? coarse->y.data() : coarse->x.data(), coarse->inverse_scale(), begin, end);
    });
}

/// From r and x = smooth_first(r) of a level to where only its last smoothing step is left: that is fused with what follows.
template <class Real>
void LatticeMultigrid<Real>::cycle(Team& team, std::size_t l) {
    Hierarchy& h = *h_;
    PackedLevel& level = *h.level[l];
    const std::size_t n = level.rows(), chunk = level.chunk();
    const bool two = level.degree() == 2;
    if (two) {
        level.begin_product(team, level.x.data());
        team.for_range(n, chunk, [&](std::size_t begin, std::size_t end) { level.smooth_second(begin, end); });
    } else {
        level.y.swap(level.x);
    }
    if (l < h.transfer.size()) {
        level.begin_product(team, level.y.data());
        team.for_range(n, chunk, [&](std::size_t begin, std::size_t end) { level.residual(level.y.data(), begin, end); });
        down(team, l);
        const ScalarRows& P = h.transfer[l].to_points;
        team.for_range(n, chunk, [&](std::size_t begin, std::size_t end) {
            packed_kernels(isa_).prolong(P.row_start.data(), P.column.data(), P.weight.data(), h.correction[l].data(), level.scale(), level.y.data(),
                                         begin, end);
            if (l != 0 || h.corrected_though_held.empty()) return;
            auto at = std::lower_bound(h.corrected_though_held.begin(), h.corrected_though_held.end(), std::int32_t(begin));
            for (; at != h.corrected_though_held.end() && *at < std::int32_t(end); ++at) {
                for (std::size_t c = 0; c < 3; ++c) {
                    if (h.held[std::size_t(*at)] >> c & 1) level.y[4 * std::size_t(*at) + c] = 0;
                }
            }
        });
    }
    level.begin_product(team, level.y.data());
    if (!two) return;
    team.for_range(n, chunk, [&](std::size_t begin, std::size_t end) { level.restart_first(begin, end); });
    level.begin_product(team, level.x.data());
}

template <class Real>
double LatticeMultigrid<Real>::apply(Team& team, const Real* r, Real* z) {
    Hierarchy& h = *h_;
    PackedLevel& fine = *h.level[0];
    const std::size_t n = fine.rows(), chunk = fine.chunk();
    team.for_range(n, chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const float s = fine.inverse_scale()[i];
            for (std::size_t c = 0; c < 4; ++c) fine.r[4 * i + c] = s * float(r[4 * i + c]);
        }
        fine.smooth_first(begin, end);
    });
    cycle(team, 0);
    const bool two = fine.degree() == 2;
    team.for_range(n, chunk, [&](std::size_t begin, std::size_t end) {
        const double dot = two ? fine.restart_second(begin, end) : fine.restart_first(begin, end);
        h.partial[begin / chunk] = dot;
        const float* x = two ? fine.y.data() : fine.x.data();
        for (std::size_t i = begin; i < end; ++i) {
            const float s = fine.inverse_scale()[i];
            for (std::size_t c = 0; c < 4; ++c) z[4 * i + c] = Real(s * x[4 * i + c]);
        }
    });
    double sum = 0;
    for (std::size_t k = 0; k < fine.chunks(); ++k) sum += h.partial[k];
    return sum;
}

template <class Real>
std::vector<std::size_t> LatticeMultigrid<Real>::level_rows() const {
    std::vector<std::size_t> rows;
    if (!h_) return rows;
    for (const auto& level : h_->level) rows.push_back(level->rows());
    if (h_->direct) rows.push_back(h_->direct->b.size() / 4);
    return rows;
}

template <class Real>
std::size_t LatticeMultigrid<Real>::bytes() const {
    std::size_t sum = 0;
    if (!h_) return sum;
    for (const auto& level : h_->level) sum += level->bytes();
    for (const auto& P : h_->transfer) sum += 2 * P.to_points.column.size() * 8;
    if (!h_->matrix.empty()) sum += h_->matrix[0].value.size() * 4;
    if (h_->direct) sum += h_->direct->value.size() * 4;
    return sum;
}

template <class Real>
auto LatticeMultigrid<Real>::traffic() const -> Preconditioner<Real>::Traffic {
    typename Preconditioner<Real>::Traffic sum;
    if (!h_) return sum;
    sum.update = h_->level[0]->pack_traffic(sizeof(Real));
    sum.apply = double(pattern_.rows) * 8 * sizeof(Real);
    for (const auto& level : h_->level) sum.apply += level->traffic();
    for (const auto& P : h_->transfer) sum.apply += 2 * (double(P.to_points.column.size()) * 8 + double(P.node.size() + P.to_points.row_start.size()) * 36);
    if (h_->direct) sum.apply += double(h_->direct->column.size()) * 52;
    return sum;
}

template class LatticeMultigrid<float>;
template class LatticeMultigrid<double>;

}  // namespace supple::solve
