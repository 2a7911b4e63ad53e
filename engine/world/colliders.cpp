// Colliders over a step: where given motions lead, the equation of those that yield, their poses after it.
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "supple/math/polar.h"
#include "supple/world/contact_stages.h"
#include "supple/world/stages.h"

namespace supple {

std::array<double, 4> rotation_wxyz(const Mat3& R) {
    Eigen::Quaterniond q(R);
    q.normalize();
    if (q.w() < 0) q.coeffs() *= -1;
    return {q.w(), q.x(), q.y(), q.z()};
}

Mat3 rotation_of(const Vec3& vector) {
    const double angle = vector.norm();
    if (!(angle > 1e-300)) return Mat3::Identity();
    return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

Vec3 rotation_vector(const Mat3& R) {
    const Eigen::AngleAxisd turn(R);
    return turn.angle() * turn.axis();
}

Pose PoseKeys::at(double time_s, const Pose& otherwise) const {
    if (times_s.empty()) return otherwise;
    const auto after = std::upper_bound(times_s.begin(), times_s.end(), time_s);
    const auto b = std::min(std::size_t(after - times_s.begin()), times_s.size() - 1), a = after == times_s.begin() || after == times_s.end() ? b : b - 1;
    const double s = a == b ? 0 : (time_s - times_s[a]) / (times_s[b] - times_s[a]);
    Pose pose = otherwise;
    if (!positions_m.empty()) pose.position_m = (1 - s) * positions_m[a] + s * positions_m[b];
    if (!rotations_wxyz.empty()) {
        const auto quaternion = [&](std::size_t i) { return Eigen::Quaterniond(rotations_wxyz[i][0], rotations_wxyz[i][1], rotations_wxyz[i][2], rotations_wxyz[i][3]).normalized(); };
        const Eigen::Quaterniond q = quaternion(a).slerp(s, quaternion(b));
        pose.rotation_wxyz = {q.w(), q.x(), q.y(), q.z()};
    }
    return pose;
}

namespace {

/// A spinning body's spin after h without torque: one Newton step on h omega x (I omega) + I (omega' - omega) = 0, in the body's axes. Stable at any spin.
/// @source Catto 2015, Physics for Game Programmers: Numerical Methods (implicit gyroscopic torque)
Vec3 turn_freely(const Mat3& R, const Mat3& inertia, const Vec3& spin, double h) {
    const Vec3 w = R.transpose() * spin, L = inertia * w;
    const auto skew = [](const Vec3& v) {
        Mat3 C;
        C << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
        return C;
    };
    const Mat3 J = inertia + h * (skew(w) * inertia - skew(L));
    const Vec3 change = J.fullPivLu().solve(h * w.cross(L));
    return R * (w - change);
}

struct Pull {
    Vec3 force, torque;
};

/// Of a tool's coupling at the velocity w, without limits.
Pull pull(const StepContext& ctx, const Collider& c, const Vec6& w) {
    const double h = ctx.world.def.time_step_s;
    const ToolCoupling& k = c.coupling;
    const Mat3 R = rotation_matrix(c.target.rotation_wxyz);
    const Vec3 target = c.target.position_m + R * c.centre;
    const Mat3 R1 = rotation_of(h * w.tail<3>()) * c.R0;
    // Damping per radian and second: that of the translation, by the ratio of the stiffnesses.
    const double spin_damping = k.damping_n_s_m * k.torsion_nm_rad / k.stiffness_n_m;
    return {k.stiffness_n_m * (target - (c.c0 + h * w.head<3>())) - k.damping_n_s_m * w.head<3>(),
            k.torsion_nm_rad * rotation_vector(R * R1.transpose()) - spin_damping * w.tail<3>()};
}

bool over(double limit, const Vec3& value) { return limit > 0 && value.norm() > limit; }

bool cap(const StepContext& ctx, Collider& c, const Vec6& w) {
    if (c.def.motion != ColliderMotion::tool) return false;
    const Pull p = pull(ctx, c, w);
    bool changed = false;
    if (!c.capped_force && over(c.coupling.max_force_n, p.force)) {
        c.force_at_cap = p.force * (c.coupling.max_force_n / p.force.norm());
        c.capped_force = changed = true;
    }
    if (!c.capped_torque && over(c.coupling.max_torque_nm, p.torque)) {
        c.torque_at_cap = p.torque * (c.coupling.max_torque_nm / p.torque.norm());
        c.capped_torque = changed = true;
    }
    return changed;
}

Mat66 mass_matrix(const Collider& c) {
    Mat66 M = Mat66::Zero();
    M.topLeftCorner<3, 3>() = c.mass * Mat3::Identity();
    M.bottomRightCorner<3, 3>() = c.R0 * c.inertia * c.R0.transpose();
    return M;
}

/// w from the equation as it stands; capped as often as it takes.
void solve_alone(StepContext& ctx, Collider& c) {
    for (int i = 0; i < 3; ++i) {
        Mat66 A;
        Vec6 b;
        collider_equation(ctx, c, A, b);
        c.w += A.llt().solve(b);
        if (!cap(ctx, c, c.w)) return;
    }
}

}  // namespace

void collider_equation(const StepContext& ctx, const Collider& c, Mat66& A, Vec6& b) {
    const double h = ctx.world.def.time_step_s;
    A = mass_matrix(c);
    b = A * (c.begin - c.w) + c.impulse;
    if (c.def.motion != ColliderMotion::tool) {
        b.head<3>() += h * c.mass * ctx.world.def.gravity_m_s2;
        return;
    }
    const ToolCoupling& k = c.coupling;
    const Pull p = pull(ctx, c, c.w);
    b.head<3>() += h * (c.capped_force ? c.force_at_cap : p.force);
    b.tail<3>() += h * (c.capped_torque ? c.torque_at_cap : p.torque);
    if (!c.capped_force) A.topLeftCorner<3, 3>() += h * (h * k.stiffness_n_m + k.damping_n_s_m) * Mat3::Identity();
    if (!c.capped_torque) A.bottomRightCorner<3, 3>() += h * (h + k.damping_n_s_m / k.stiffness_n_m) * k.torsion_nm_rad * Mat3::Identity();
}

bool cap_colliders(StepContext& ctx) {
    bool changed = false;
    for (Collider& c : ctx.world.colliders) {
        if (c.generation != 0 && c.unknown()) changed = cap(ctx, c, c.w + c.dw) || changed;
    }
    return changed;
}

void refer_colliders(StepContext& ctx) {
    const double h = ctx.world.def.time_step_s;
    for (Collider& c : ctx.world.colliders) {
        if (c.generation == 0 || !c.unknown()) continue;
        c.reference = c.w + c.dw;
        c.c1 = c.c0 + h * c.reference.head<3>();
        c.R1 = rotation_of(h * c.reference.tail<3>()) * c.R0;
    }
}

void begin_colliders(StepContext& ctx) {
    const double h = ctx.world.def.time_step_s;
    for (Collider& c : ctx.world.colliders) {
        if (c.generation == 0) continue;
        c.force = c.torque = c.coupling_force = Vec3::Zero();
        c.impulse = c.dw = Vec6::Zero();
        c.capped_force = c.capped_torque = false;
        c.R0 = c.R1 = rotation_matrix(c.pose.rotation_wxyz);
        c.c0 = c.c1 = c.pose.position_m + c.R0 * c.centre;
        if (c.def.motion == ColliderMotion::fixed) {
            c.target = c.pose;
            c.velocity = c.spin = Vec3::Zero();
            continue;
        }
        if (c.def.motion != ColliderMotion::dynamic && c.def.keys.size() > 0) c.target = c.def.keys.at(ctx.time_s, c.def.pose);
        if (!c.unknown()) {
            c.R1 = rotation_matrix(c.target.rotation_wxyz);
            c.c1 = c.target.position_m + c.R1 * c.centre;
            c.velocity = (c.c1 - c.c0) / h;
            c.spin = rotation_vector(c.R1 * c.R0.transpose()) / h;
            continue;
        }
        c.begin << c.velocity, turn_freely(c.R0, c.inertia, c.spin, h);
        c.w = c.begin;
        solve_alone(ctx, c);
        c.from = c.w;
    }
}

void end_colliders(StepContext& ctx) {
    const double h = ctx.world.def.time_step_s;
    World::Impl& world = ctx.world;
    for (Collider& c : world.colliders) {
        if (c.generation == 0 || c.def.motion == ColliderMotion::fixed) continue;
        if (!c.unknown()) {
            c.pose = c.target;
            continue;
        }
        // From the forces of all the bodies: what they gave is what it gets.
        solve_alone(ctx, c);
        if (!c.w.allFinite()) {
            c.w = Vec6::Zero();
            ctx.report.flags |= StepFlag::non_finite;
        }
        c.velocity = c.w.head<3>();
        c.spin = c.w.tail<3>();
        if (c.def.motion == ColliderMotion::tool) c.coupling_force = c.capped_force ? c.force_at_cap : pull(ctx, c, c.w).force;
        const Mat3 R = rotation_of(h * c.spin) * c.R0;
        c.pose.rotation_wxyz = rotation_wxyz(R);
        c.pose.position_m = c.c0 + h * c.velocity - R * c.centre;
    }
    world.contact_report.clear();
    for (const std::uint32_t slot : world.order) {
        const std::vector<ContactPoint>& of_body = world.slots[slot].body->contacts.report;
        world.contact_report.insert(world.contact_report.end(), of_body.begin(), of_body.end());
    }
    ctx.report.contacts = int(world.contact_report.size());
    ctx.report.contact_bytes = world.contact_report.capacity() * sizeof(ContactPoint) + world.scratch.contact_bytes();
    for (const std::unique_ptr<Scratch>& aside : world.aside) ctx.report.contact_bytes += aside->contact_bytes();
    for (const std::uint32_t slot : world.order) {
        const Body& body = *world.slots[slot].body;
        ctx.report.contact_bytes += (body.contacts.list.capacity() + body.contacts.before.capacity() + body.contacts.edges.capacity()) * sizeof(Contact) + body.contacts.report.capacity() * sizeof(ContactPoint) +
                                    body.state.contacts.capacity() * sizeof(ContactMemory);
    }
    for (const Collider& c : world.colliders) ctx.report.contact_bytes += c.row.capacity() * sizeof(std::int32_t) + c.block.capacity() * sizeof(solve::Mat36);
}

}  // namespace supple
