#include "supple/haptics/model_builder.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "supple/base/clock.h"
#include "supple/contact/closest.h"
#include "supple/math/polar.h"

namespace supple::haptics {

namespace {

constexpr std::size_t kMostPressed = 18;   // of the model's places: the rest is for what comes near
constexpr double kApart = 0.3;             // of an edge: nearer points are one
constexpr double kFacing = -0.2;           // cosine between the shape's normal and the surface's: what faces away is not met

std::pair<std::uint32_t, std::uint32_t> key_of(BodyId body) { return {body.index, body.generation}; }

}  // namespace

ModelBuilder::ModelBuilder(const ModelBuilderDef& def) : def_(def) {
    require_in_range(double(def.patch_vertices), 8, 400, "ModelBuilderDef.patch_vertices");
    require_in_range(def.reach_m, 0, 1e6, "ModelBuilderDef.reach_m");
    require_in_range(def.correct_every, 0, 1000, "ModelBuilderDef.correct_every");
    require_in_range(def.correction_tolerance, 1e-12, 0.5, "ModelBuilderDef.correction_tolerance");
}

void ModelBuilder::find_held(const World& world, std::span<const HeldPoint> held) {
    for (const HeldPoint& h : held) {
        const AttachmentState state = world.attachment_state(h.attachment);
        if (state.broken) continue;
        Candidate c;
        c.body = h.body;
        c.contact.position_m = state.point_m;
        c.contact.force_n = -state.force_n;
        c.contact.velocity_m_s = world.velocities(h.body)[std::size_t(h.vertex)];
        c.contact.holds = true;
        c.rows = {{h.vertex, 1.0}};
        c.press_n = state.force_n.norm();
        found_.push_back(c);
    }
}

/// The contacts of the step, with their forces.
void ModelBuilder::find_pressed(const World& world, ColliderId tool) {
    for (const ContactPoint& c : world.contacts()) {
        if (!(c.collider == tool)) continue;
        const Triangle& t = world.shape(c.body).boundary().triangles[std::size_t(c.triangle)];
        const auto v = world.velocities(c.body);
        Candidate candidate;
        candidate.body = c.body;
        candidate.contact.position_m = c.position_m;
        candidate.contact.normal = -c.normal;
        candidate.contact.force_n = -(c.normal_force_n * c.normal + c.friction_force_n);
        candidate.contact.friction = world.collider(tool).friction;
        for (std::size_t k = 0; k < 3; ++k) {
            if (c.barycentric[k] == 0) continue;
            candidate.rows.push_back({t[k], c.barycentric[k]});
            candidate.contact.velocity_m_s += c.barycentric[k] * v[std::size_t(t[k])];
        }
        candidate.press_n = c.normal_force_n;
        found_.push_back(candidate);
    }
}

/// Points of the surfaces that the tool may meet before the next step, nearest first, as far as there are places.
void ModelBuilder::find_near(const World& world, ColliderId tool) {
    const Shape& shape = world.collider(tool).shape;
    if (std::holds_alternative<PlaneShape>(shape)) return;
    const Pose pose = world.collider_state(tool).pose;
    const Mat3 R = rotation_matrix(pose.rotation_wxyz);
    const contact::Bounds box = contact::bounds(shape);
    const double size = std::max(box.min_m.norm(), box.max_m.norm());
    std::vector<Candidate> near;
    for (const BodyId body : world.bodies()) {
        if (world.is_frozen(body)) continue;
        const auto x = world.positions(body), v = world.velocities(body);
        for (const Triangle& t : world.shape(body).boundary().triangles) {
            const auto corner = [&](std::size_t k) -> const Vec3& { return x[std::size_t(t[k])]; };
            const Vec3 outward = (corner(1) - corner(0)).cross(corner(2) - corner(0));
            const double edge = std::sqrt(outward.norm());
            const double reach = def_.reach_m > 0 ? def_.reach_m : 0.5 * edge + 0.5 * world.def().time_step_s;
            const Vec3 middle = (corner(0) + corner(1) + corner(2)) / 3;
            const double radius = std::max({(corner(0) - middle).norm(), (corner(1) - middle).norm(), (corner(2) - middle).norm()});
            if ((middle - pose.position_m).norm() > size + reach + radius) continue;
            const auto local = [&](std::size_t k) { return Vec3(R.transpose() * (corner(k) - pose.position_m)); };
            const contact::TrianglePoint point = contact::deepest_on_triangle(shape, local(0), local(1), local(2));
            const Vec3 normal = R * point.at.normal;
            if (point.at.d > reach || normal.dot(outward) > kFacing * outward.norm()) continue;
            Candidate c;
            c.body = body;
            c.edge_m = edge;
            c.contact.normal = -normal;
            c.contact.gap_m = std::max(0.0, point.at.d);
            c.contact.friction = world.collider(tool).friction;
            for (std::size_t k = 0; k < 3; ++k) {
                const double w = point.barycentric[Eigen::Index(k)];
                if (w == 0) continue;
                c.rows.push_back({t[k], w});
                c.contact.position_m += w * corner(k);
                c.contact.velocity_m_s += w * v[std::size_t(t[k])];
            }
            near.push_back(c);
        }
    }
    std::stable_sort(near.begin(), near.end(), [](const Candidate& a, const Candidate& b) { return a.contact.gap_m < b.contact.gap_m; });
    for (const Candidate& c : near) {
        const bool known = std::any_of(found_.begin(), found_.end(), [&](const Candidate& f) {
            return f.body == c.body && (f.contact.position_m - c.contact.position_m).norm() < kApart * c.edge_m;
        });
        if (known) continue;
        if (found_.size() < kMostLocalContacts) {
            found_.push_back(c);
        } else {
            ++report_.left_out;
        }
    }
}

/// Where there are more than `most`, contacts of one body that lie together become one, with the sum of their forces: around those that lie farthest apart. The first
/// `from` stay as they are.
void ModelBuilder::merge(std::size_t from, std::size_t most) {
    if (found_.size() <= most) return;
    std::vector<Candidate> kept(found_.begin(), found_.begin() + std::ptrdiff_t(from));
    found_.erase(found_.begin(), found_.begin() + std::ptrdiff_t(from));
    most -= from;
    const std::size_t n = found_.size();
    std::vector<std::size_t> seed{std::size_t(std::max_element(found_.begin(), found_.end(), [](const auto& a, const auto& b) { return a.press_n < b.press_n; }) - found_.begin())};
    std::vector<double> distance(n, HUGE_VAL);
    std::vector<std::size_t> owner(n, 0);
    const auto apart = [&](std::size_t a, std::size_t b) {  // other bodies, and other sides of a thin part, are far
        if (!(found_[a].body == found_[b].body)) return 1e6;
        return (found_[a].contact.position_m - found_[b].contact.position_m).norm() * (2 - found_[a].contact.normal.dot(found_[b].contact.normal));
    };
    for (;;) {
        for (std::size_t i = 0; i < n; ++i) {
            const double d = apart(i, seed.back());
            if (d < distance[i]) {
                distance[i] = d;
                owner[i] = seed.size() - 1;
            }
        }
        if (seed.size() == most) break;
        seed.push_back(std::size_t(std::max_element(distance.begin(), distance.end()) - distance.begin()));
    }
    std::vector<Candidate>& merged = kept;
    for (std::size_t g = 0; g < seed.size(); ++g) {
        Candidate sum;
        sum.body = found_[seed[g]].body;
        sum.contact.friction = found_[seed[g]].contact.friction;
        sum.contact.normal = Vec3::Zero();
        double total = 0;
        for (std::size_t i = 0; i < n; ++i) total += owner[i] == g ? found_[i].press_n : 0;
        for (std::size_t i = 0; i < n; ++i) {
            if (owner[i] != g) continue;
            const Candidate& c = found_[i];
            const double part = total > 0 ? c.press_n / total : i == seed[g] ? 1 : 0;
            report_.merged += i != seed[g];
            sum.contact.normal += part * c.contact.normal;
            sum.contact.position_m += part * c.contact.position_m;
            sum.contact.velocity_m_s += part * c.contact.velocity_m_s;
            sum.contact.force_n += c.contact.force_n;
            sum.press_n += c.press_n;
            for (const Row& r : c.rows) {
                const auto same = std::find_if(sum.rows.begin(), sum.rows.end(), [&](const Row& s) { return s.vertex == r.vertex; });
                if (same != sum.rows.end()) {
                    same->weight += part * r.weight;
                } else {
                    sum.rows.push_back({r.vertex, part * r.weight});
                }
            }
        }
        sum.contact.normal.normalize();
        merged.push_back(sum);
    }
    found_.swap(merged);
}

/// W of the contacts of one body.
void ModelBuilder::fill_body(const World& world, ColliderId tool, BodyId body, LocalModel& model) {
    std::vector<std::size_t> places;
    std::vector<std::int32_t> seeds;
    for (std::size_t i = 0; i < found_.size(); ++i) {
        if (!(found_[i].body == body)) continue;
        places.push_back(i);
        for (const Row& r : found_[i].rows)
            if (r.weight != 0) seeds.push_back(r.vertex);
    }
    const Stopwatch patch_watch;
    const BodyResponse response(world, body, tool);
    const std::vector<std::int32_t> patch = response.patch(seeds, def_.patch_vertices);
    report_.patch_vertices += patch.size();
    response.submatrix(patch, A_);
    const auto place_of = [&](std::int32_t v) { return Eigen::Index(std::lower_bound(patch.begin(), patch.end(), v) - patch.begin()); };
    const auto in_patch = [&](std::int32_t v) { return std::binary_search(patch.begin(), patch.end(), v); };
    B_.setZero(A_.rows(), 3 * Eigen::Index(places.size()));
    for (std::size_t k = 0; k < places.size(); ++k) {
        for (const Row& r : found_[places[k]].rows) {
            if (!in_patch(r.vertex)) continue;  // more touched vertices than the patch may hold
            for (Eigen::Index c = 0; c < 3; ++c)
                if (response.is_free(r.vertex, int(c))) B_(3 * place_of(r.vertex) + c, 3 * Eigen::Index(k) + c) = r.weight;
        }
    }
    const Eigen::LLT<Eigen::Ref<MatX>> factor(A_);
    MatX W;
    if (factor.info() == Eigen::Success) {
        factor.matrixL().solveInPlace(B_);
        W = response.scale() * B_.transpose() * B_;
    } else {
        report_.indefinite = true;
        response.submatrix(patch, A_);
        W = MatX::Zero(B_.cols(), B_.cols());
        const Eigen::VectorXd soft = response.scale() * A_.diagonal().cwiseAbs().cwiseMax(1e-30).cwiseInverse();
        for (Eigen::Index c = 0; c < B_.cols(); ++c) W(c, c) = B_.col(c).cwiseAbs2().dot(soft);
    }
    for (std::size_t i = 0; i < places.size(); ++i)
        for (std::size_t j = 0; j < places.size(); ++j)
            for (Eigen::Index r = 0; r < 3; ++r)
                for (Eigen::Index c = 0; c < 3; ++c)
                    model.W(3 * places[i] + std::size_t(r), 3 * places[j] + std::size_t(c)) = W(3 * Eigen::Index(i) + r, 3 * Eigen::Index(j) + c);
    report_.patch_us += patch_watch.ms() * 1000;
    if (def_.correct_every == 0) return;
    const Stopwatch correction_watch;
    const auto [at, fresh] = memory_.try_emplace(key_of(body));
    Memory& memory = at->second;
    if (fresh || memory.steps_left-- <= 0) {
        correct(response, memory, places, model);
        memory.steps_left = def_.correct_every - 1;
    }
    double trace = 0;
    for (const std::size_t i : places) {
        for (const std::size_t j : places)
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c) model.W(3 * i + r, 3 * j + c) += memory.far_field(Eigen::Index(r), Eigen::Index(c));
        for (std::size_t r = 0; r < 3; ++r) trace += model.W(3 * i + r, 3 * i + r) / double(places.size());
    }
    report_.far_field = trace > 0 ? std::max(report_.far_field, memory.far_field.trace() / trace) : 0;
    report_.correction_us += correction_watch.ms() * 1000;
}

/// memory.far_field from a solve of the full system: what a unit force, shared by the places as they press, moves them by beyond what the patch says.
void ModelBuilder::correct(const BodyResponse& response, Memory& memory, std::span<const std::size_t> places, const LocalModel& model) {
    double total = 0;
    for (const std::size_t i : places) total += found_[i].press_n;
    const auto share = [&](std::size_t i) { return total > 0 ? found_[i].press_n / total : 1.0 / double(places.size()); };
    Mat3 patch = Mat3::Zero(), full = Mat3::Zero();
    for (const std::size_t i : places)
        for (const std::size_t j : places)
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c) patch(Eigen::Index(r), Eigen::Index(c)) += share(i) * share(j) * model.W(3 * i + r, 3 * j + c);
    std::vector<Vec3> force(response.vertices());
    for (Eigen::Index c = 0; c < 3; ++c) {
        std::fill(force.begin(), force.end(), Vec3::Zero());
        for (const std::size_t i : places)
            for (const Row& r : found_[i].rows) force[std::size_t(r.vertex)][c] += share(i) * r.weight;
        std::vector<Vec3>& u = memory.displacement[std::size_t(c)];
        u.resize(response.vertices(), Vec3::Zero());
        report_.correction_iterations += response.solve(force, u, def_.correction_tolerance).iterations;
        for (const std::size_t i : places)
            for (const Row& r : found_[i].rows) full.col(c) += share(i) * r.weight * u[std::size_t(r.vertex)];
    }
    // A clamped rim only stiffens; what the solves' tolerance makes negative is nothing.
    const Mat3 difference = (full - patch + (full - patch).transpose()) / 2;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(difference);
    memory.far_field = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
}

const ModelReport& ModelBuilder::build(const World& world, ColliderId tool, LocalModel& model, std::span<const HeldPoint> held) {
    const Stopwatch watch;
    report_ = {};
    found_.clear();
    find_held(world, held);
    const std::size_t holds = found_.size();
    find_pressed(world, tool);
    merge(holds, kMostPressed);
    find_near(world, tool);
    model.step_s = world.def().time_step_s;
    model.tool_m = world.collider_state(tool).pose.position_m;
    model.contacts = report_.contacts = found_.size();
    for (std::size_t i = 0; i < found_.size(); ++i) model.contact[i] = found_[i].contact;
    std::fill_n(model.compliance.begin(), 9 * found_.size() * found_.size(), 0.0);
    report_.find_us = watch.ms() * 1000;
    std::set<std::pair<std::uint32_t, std::uint32_t>> touched;
    for (const Candidate& c : found_)
        if (touched.insert(key_of(c.body)).second) fill_body(world, tool, c.body, model);
    std::erase_if(memory_, [&](const auto& m) { return !touched.contains(m.first); });
    report_.total_us = watch.ms() * 1000;
    return report_;
}

}  // namespace supple::haptics
