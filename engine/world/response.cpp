#include "supple/world/response.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "supple/base/error.h"
#include "supple/world/stages.h"

namespace supple {

namespace {

/// J^T K J of a contact, K in units of A.
struct Spring {
    std::array<std::int32_t, Contact::kMost> vertex{};
    std::array<Vec3, Contact::kMost> weight{};
    std::size_t corners = 0;
    Mat3 K = Mat3::Zero();
};

}  // namespace

struct BodyResponse::Parts {
    const Body& body;
    double scale = 0;
    std::vector<Spring> springs;
    explicit Parts(const Body& b) : body(b) {}

    const solve::Bsr3Pattern& pattern() const { return body.data().pattern; }
    Mat3 block(std::size_t index) const {
        Mat3 m = Mat3::Zero();
        const auto read = [&](const auto& value) {
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t r = 0; r < 3; ++r) m(Eigen::Index(r), Eigen::Index(c)) = double(value[index * 12 + 4 * c + r]);
        };
        if (const auto* single = std::get_if<System<float>>(&body.system)) read(single->A.value);
        if (const auto* dbl = std::get_if<System<double>>(&body.system)) read(dbl->A.value);
        return m;
    }
    void multiply(const std::vector<Vec3>& x, std::vector<Vec3>& y) const {
        const solve::Bsr3Pattern& p = pattern();
        const auto run = [&](const auto& value) {
            for (std::size_t row = 0; row < p.rows; ++row) {
                double s0 = 0, s1 = 0, s2 = 0;
                for (auto b = std::size_t(p.row_start[row]); b < std::size_t(p.row_start[row + 1]); ++b) {
                    const auto* v = value.data() + b * 12;
                    const Vec3& q = x[std::size_t(p.vertex[std::size_t(p.column[b])])];
                    s0 += double(v[0]) * q[0] + double(v[4]) * q[1] + double(v[8]) * q[2];
                    s1 += double(v[1]) * q[0] + double(v[5]) * q[1] + double(v[9]) * q[2];
                    s2 += double(v[2]) * q[0] + double(v[6]) * q[1] + double(v[10]) * q[2];
                }
                y[std::size_t(p.vertex[row])] = Vec3(s0, s1, s2);
            }
        };
        if (const auto* single = std::get_if<System<float>>(&body.system)) run(single->A.value);
        if (const auto* dbl = std::get_if<System<double>>(&body.system)) run(dbl->A.value);
        for (const Spring& s : springs) {
            Vec3 z = Vec3::Zero();
            for (std::size_t k = 0; k < s.corners; ++k) z += s.weight[k].cwiseProduct(x[std::size_t(s.vertex[k])]);
            z = s.K * z;
            for (std::size_t k = 0; k < s.corners; ++k) y[std::size_t(s.vertex[k])] += s.weight[k].cwiseProduct(z);
        }
    }
};

BodyResponse::BodyResponse(const World& world, BodyId id, ColliderId without) {
    World::Impl& impl = Inspector(world, id).impl();
    Body& body = impl.body(id);
    parts_ = std::make_unique<Parts>(body);
    parts_->scale = body.work.h * body.work.h;
    if (!(parts_->scale > 0))
        throw Error(ErrorCode::invalid_argument, "BodyResponse", "\"" + body.name + "\" has made no step yet; its matrix is that of the last one: call World::step() first");
    with_system(body, [&](auto& system) {  // a step that solved by the elements has left no matrix
        if (system.by_elements) assemble_matrix(impl.team_for(body.element_count()), body, impl.time_s());
    });
    const auto add = [&](const Contact& c, std::size_t first, std::size_t count) {
        Spring s;
        s.corners = count;
        std::copy_n(c.vertex.begin() + std::ptrdiff_t(first), count, s.vertex.begin());
        std::copy_n(c.masked.begin() + std::ptrdiff_t(first), count, s.weight.begin());
        s.K = parts_->scale * c.K;
        parts_->springs.push_back(s);
    };
    // Another soft body that it touches stands as if it were rigid.
    for (const std::uint32_t slot : impl.order) {
        const Body& owner = *impl.slots[slot].body;
        for (const Contact& c : owner.contacts.list) {
            if (!c.closed || (without && c.collider == without.index)) continue;
            if (&owner == &body) add(c, 0, c.other == &body ? c.vertices() : c.corners);
            else if (c.other == &body) add(c, c.corners, c.others);
        }
    }
}

BodyResponse::~BodyResponse() = default;

std::size_t BodyResponse::vertices() const { return parts_->body.vertices(); }

double BodyResponse::scale() const { return parts_->scale; }

bool BodyResponse::is_free(std::int32_t vertex, int axis) const { return !parts_->body.is_held(std::size_t(vertex), std::size_t(axis)); }

std::vector<std::int32_t> BodyResponse::patch(std::span<const std::int32_t> seeds, std::size_t most) const {
    const solve::Bsr3Pattern& p = parts_->pattern();
    std::vector<std::int32_t> found;
    std::vector<char> seen(vertices(), 0);
    const auto take = [&](std::int32_t v) {
        if (found.size() >= most || seen[std::size_t(v)] != 0) return;
        seen[std::size_t(v)] = 1;
        found.push_back(v);
    };
    for (const std::int32_t v : seeds) take(v);
    for (std::size_t next = 0; next < found.size() && found.size() < most; ++next) {
        const auto row = std::size_t(p.row[std::size_t(found[next])]);
        for (auto b = p.row_start[row]; b < p.row_start[row + 1]; ++b) take(p.vertex[std::size_t(p.column[std::size_t(b)])]);
    }
    std::sort(found.begin(), found.end());
    return found;
}

void BodyResponse::submatrix(std::span<const std::int32_t> chosen, MatX& A) const {
    const solve::Bsr3Pattern& p = parts_->pattern();
    const auto n = Eigen::Index(3 * chosen.size());
    A.setZero(n, n);
    std::vector<std::int32_t> place(vertices(), -1);
    for (std::size_t i = 0; i < chosen.size(); ++i) place[std::size_t(chosen[i])] = std::int32_t(i);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const auto row = std::size_t(p.row[std::size_t(chosen[i])]);
        for (auto b = std::size_t(p.row_start[row]); b < std::size_t(p.row_start[row + 1]); ++b) {
            const std::int32_t j = place[std::size_t(p.vertex[std::size_t(p.column[b])])];
            if (j >= 0) A.block<3, 3>(3 * Eigen::Index(i), 3 * j) = parts_->block(b);
        }
    }
    for (const Spring& s : parts_->springs) {
        for (std::size_t a = 0; a < s.corners; ++a) {
            for (std::size_t b = 0; b < s.corners; ++b) {
                const std::int32_t i = place[std::size_t(s.vertex[a])], j = place[std::size_t(s.vertex[b])];
                if (i >= 0 && j >= 0) A.block<3, 3>(3 * i, 3 * j) += s.weight[a].asDiagonal() * s.K * s.weight[b].asDiagonal();
            }
        }
    }
}

BodyResponse::Solved BodyResponse::solve(std::span<const Vec3> force_n, std::span<Vec3> displacement_m, double tolerance, int max_iterations) const {
    const Parts& parts = *parts_;
    const std::size_t n = vertices();
    if (force_n.size() != n || displacement_m.size() != n)
        throw Error(ErrorCode::invalid_argument, "BodyResponse::solve", std::to_string(force_n.size()) + " forces and " + std::to_string(displacement_m.size()) +
                                                                            " displacements for " + std::to_string(n) + " vertices; give one of each per vertex");
    // Block-Jacobi with the springs' own diagonals.
    std::vector<Mat3> inverse(n);
    for (std::size_t i = 0; i < n; ++i) inverse[i] = parts.block(std::size_t(parts.pattern().diagonal[std::size_t(parts.pattern().row[i])]));
    for (const Spring& s : parts.springs)
        for (std::size_t k = 0; k < s.corners; ++k) inverse[std::size_t(s.vertex[k])] += s.weight[k].asDiagonal() * s.K * s.weight[k].asDiagonal();
    for (std::size_t i = 0; i < n; ++i) inverse[i] = inverse[i].isZero(0) ? Mat3(Mat3::Zero()) : Mat3(inverse[i].inverse());
    const auto free_part = [&](std::size_t i, Vec3 v) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (parts.body.is_held(i, axis)) v[Eigen::Index(axis)] = 0;
        return v;
    };
    const auto dot = [&](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
        double sum = 0;
        for (std::size_t i = 0; i < n; ++i) sum += a[i].dot(b[i]);
        return sum;
    };
    std::vector<Vec3> x(n), r(n), z(n), p(n), q(n);
    double size = 0;
    for (std::size_t i = 0; i < n; ++i) {
        x[i] = free_part(i, displacement_m[i].allFinite() ? displacement_m[i] : Vec3(Vec3::Zero())) / parts.scale;
        r[i] = free_part(i, force_n[i]);
        size += r[i].squaredNorm();
    }
    parts.multiply(x, q);
    for (std::size_t i = 0; i < n; ++i) r[i] -= q[i];
    const double target = tolerance * std::sqrt(size);
    Solved solved;
    double rz = 0, norm = std::sqrt(dot(r, r));
    while (norm > target && solved.iterations < max_iterations) {
        for (std::size_t i = 0; i < n; ++i) z[i] = inverse[i] * r[i];
        const double before = rz;
        rz = dot(r, z);
        const double beta = solved.iterations == 0 ? 0 : rz / before;
        for (std::size_t i = 0; i < n; ++i) p[i] = solved.iterations == 0 ? z[i] : Vec3(z[i] + beta * p[i]);
        parts.multiply(p, q);
        const double curvature = dot(p, q);
        if (!(curvature > 0)) break;
        const double alpha = rz / curvature;
        for (std::size_t i = 0; i < n; ++i) {
            x[i] += alpha * p[i];
            r[i] -= alpha * q[i];
        }
        norm = std::sqrt(dot(r, r));
        ++solved.iterations;
    }
    for (std::size_t i = 0; i < n; ++i) displacement_m[i] = parts.scale * x[i];
    solved.relative_residual = size > 0 ? norm / std::sqrt(size) : 0;
    return solved;
}

}  // namespace supple
