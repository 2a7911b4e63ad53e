// What a host does with colliders between steps.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "supple/world/contact_stages.h"

namespace supple {

namespace {

[[noreturn]] void bad(const std::string& where, const std::string& message) { throw Error(ErrorCode::invalid_argument, where, message); }

void check_finite(const Vec3& v, const std::string& where) {
    if (!v.allFinite()) bad(where, "is not finite");
}

/// False for what is no quaternion.
bool normalise(std::array<double, 4>& q) {
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 1e-6 && length < 1e6)) return false;
    for (double& x : q) x /= length;
    return true;
}

void normalise(std::array<double, 4>& q, const std::string& where) {
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!normalise(q)) bad(where, "is no quaternion w, x, y, z: its length is " + to_text(length) + "; 1, 0, 0, 0 is no rotation");
}

void check_pose(Pose& pose, const std::string& where) {
    check_finite(pose.position_m, where + ".position_m");
    normalise(pose.rotation_wxyz, where + ".rotation_wxyz");
}

void check_keys(PoseKeys& keys, const std::string& where) {
    const std::size_t n = keys.times_s.size();
    for (const std::size_t m : {keys.positions_m.size(), keys.rotations_wxyz.size()}) {
        if (m != 0 && m != n) bad(where, std::to_string(m) + " entries for " + std::to_string(n) + " times_s; give as many, or none");
    }
    if (n > 0 && keys.positions_m.empty() && keys.rotations_wxyz.empty()) bad(where, "has times_s but neither positions_m nor rotations_wxyz");
    for (std::size_t i = 0; i < n; ++i) {
        if (!std::isfinite(keys.times_s[i]) || (i > 0 && !(keys.times_s[i] > keys.times_s[i - 1]))) bad(where + ".times_s", "must be finite and ascend");
    }
    for (const Vec3& p : keys.positions_m) check_finite(p, where + ".positions_m");
    for (auto& q : keys.rotations_wxyz) normalise(q, where + ".rotations_wxyz");
}

/// Mass, centre and inertia of one that has them; the defaults of its coupling.
void give_mass(Collider& c, const WorldDef& world, const std::string& where) {
    const ColliderDef& def = c.def;
    const bool has_mass = def.motion == ColliderMotion::tool || def.motion == ColliderMotion::dynamic;
    if (!has_mass) {
        if (def.mass_kg != 0) bad(where + ".mass_kg", to_text(def.mass_kg) + " on a fixed or kinematic collider; only tools and dynamic ones have a mass");
        return;
    }
    if (world.solver.integrator == Integrator::quasi_static) {
        throw Error(ErrorCode::unsupported, where + ".motion", "the static integrator knows no inertia: only fixed and kinematic colliders");
    }
    require_in_range(def.mass_kg, 1e-9, 1e9, where + ".mass_kg", "tools and dynamic colliders need one");
    const contact::MassProperties solid = contact::mass_properties(def.shape);
    if (!(solid.volume_m3 > 0)) throw Error(ErrorCode::unsupported, where + ".shape", "a plane has no mass: it is fixed or kinematic");
    const double density = def.mass_kg / solid.volume_m3;
    c.mass = def.mass_kg;
    c.centre = solid.centre_m;
    c.inertia = density * solid.inertia_m5;
    if (def.motion != ColliderMotion::tool) return;
    ToolCoupling& k = c.coupling = def.coupling;
    require_in_range(k.stiffness_n_m, 1e-9, 1e9, where + ".coupling.stiffness_n_m", "500 is usual for haptic devices");
    require_in_range(k.damping_n_s_m, 0, 1e9, where + ".coupling.damping_n_s_m", "0 is critical");
    require_in_range(k.max_force_n, 0, 1e9, where + ".coupling.max_force_n", "0 is no limit");
    require_in_range(k.torsion_nm_rad, 0, 1e9, where + ".coupling.torsion_nm_rad", "0 follows from the stiffness");
    require_in_range(k.max_torque_nm, 0, 1e9, where + ".coupling.max_torque_nm", "0 is no limit");
    if (k.damping_n_s_m == 0) k.damping_n_s_m = 2 * std::sqrt(k.stiffness_n_m * c.mass);
    if (k.torsion_nm_rad == 0) k.torsion_nm_rad = k.stiffness_n_m * c.inertia.trace() / 3 / c.mass;
}

}  // namespace

Collider& World::Impl::collider(ColliderId id) {
    if (id.index < colliders.size() && id.generation != 0 && colliders[id.index].generation == id.generation) return colliders[id.index];
    throw Error(ErrorCode::stale_id, "ColliderId",
                "collider {" + std::to_string(id.index) + ", " + std::to_string(id.generation) + "} is not in this world: it was removed, or never added");
}

ColliderId World::add_collider(const ColliderDef& def) {
    Impl& w = *impl_;
    std::size_t slot = 0;
    while (slot < w.colliders.size() && w.colliders[slot].generation != 0) ++slot;
    Collider c;
    c.def = def;
    if (c.def.name.empty()) c.def.name = "collider " + std::to_string(slot);
    const std::string where = "ColliderDef";
    contact::check_shape(c.def.shape, where + ".shape");
    check_pose(c.def.pose, where + ".pose");
    require_in_range(def.friction, 0, 10, where + ".friction", "0.3 is usual, 0.01 to 0.1 for wet tissue");
    check_finite(def.velocity_m_s, where + ".velocity_m_s");
    check_finite(def.spin_rad_s, where + ".spin_rad_s");
    check_keys(c.def.keys, where + ".keys");
    if (c.def.keys.size() > 0 && (def.motion == ColliderMotion::fixed || def.motion == ColliderMotion::dynamic)) {
        bad(where + ".keys", "only kinematic colliders and tools follow keyframes");
    }
    give_mass(c, w.def, where);
    c.thinness_m = contact::thinness_m(c.def.shape);
    c.feature_radius_m = contact::feature_radius_m(c.def.shape);
    const contact::Bounds box = contact::bounds(c.def.shape);
    c.reach_m = (box.max_m - c.centre).cwiseMax(c.centre - box.min_m).norm();
    c.start_at(w.def.solver.integrator == Integrator::quasi_static ? 0 : w.time_s());
    if (slot == w.colliders.size()) w.colliders.emplace_back();
    c.generation = w.next_collider_generation++;
    w.colliders[slot] = std::move(c);
    ++w.living_colliders;
    give_contact_surfaces(w);
    w.scratch.eliminated.reserve(w.colliders.size());
    return {std::uint32_t(slot), w.colliders[slot].generation};
}

void World::remove_collider(ColliderId id) {
    Collider& c = impl_->collider(id);
    for (Attachment& attachment : impl_->attachments) {
        if (attachment.generation == 0 || attachment.def.collider != id) continue;
        attachment = Attachment{};
        --impl_->living_attachments;
    }
    c = Collider{};
    --impl_->living_colliders;
}

std::vector<ColliderId> World::colliders() const {
    std::vector<ColliderId> ids;
    for (std::uint32_t slot = 0; slot < impl_->colliders.size(); ++slot) {
        if (impl_->colliders[slot].generation != 0) ids.push_back({slot, impl_->colliders[slot].generation});
    }
    return ids;
}

const ColliderDef& World::collider(ColliderId id) const { return impl_->collider(id).def; }

void World::move_collider(ColliderId id, const Pose& pose) {
    Collider& c = impl_->collider(id);
    Pose to = pose;
    if (!to.position_m.allFinite() || !normalise(to.rotation_wxyz)) check_pose(to = pose, "World::move_collider");  // makes its messages, needed or not
    if (c.def.keys.size() > 0) bad("World::move_collider", "\"" + c.def.name + "\" follows its keyframes; define it without");
    c.target = to;
    if (c.def.motion == ColliderMotion::fixed || c.def.motion == ColliderMotion::dynamic) c.pose = to;
    if (c.def.motion == ColliderMotion::dynamic) c.velocity = c.spin = Vec3::Zero();
}

ColliderState World::collider_state(ColliderId id) const {
    const Collider& c = impl_->collider(id);
    return {c.pose, c.velocity, c.spin, c.force, c.torque, c.coupling_force, c.target};
}

std::span<const ContactPoint> World::contacts() const { return impl_->contact_report; }

Vec3 World::contact_force_n() const {
    Vec3 sum = Vec3::Zero();
    for (const ContactPoint& c : impl_->contact_report) {
        if (c.collider) sum += c.normal_force_n * c.normal + c.friction_force_n;
    }
    return sum;
}

Collider::Moving Collider::moving() const {
    Moving m{};
    std::size_t n = 0;
    for (const Vec3* v : {&pose.position_m, &target.position_m, &velocity, &spin, &force, &torque, &coupling_force}) {
        for (int i = 0; i < 3; ++i) m[n++] = (*v)[i];
    }
    for (const auto* q : {&pose.rotation_wxyz, &target.rotation_wxyz}) {
        for (const double x : *q) m[n++] = x;
    }
    return m;
}

void Collider::set_moving(const Moving& m) {
    std::size_t n = 0;
    for (Vec3* v : {&pose.position_m, &target.position_m, &velocity, &spin, &force, &torque, &coupling_force}) {
        for (int i = 0; i < 3; ++i) (*v)[i] = m[n++];
    }
    for (auto* q : {&pose.rotation_wxyz, &target.rotation_wxyz}) {
        for (double& x : *q) x = m[n++];
    }
}

void Collider::start_at(double time_s) {
    pose = def.pose;
    if (def.keys.size() > 0) pose = def.keys.at(time_s, def.pose);
    target = pose;
    velocity = unknown() ? def.velocity_m_s : Vec3(Vec3::Zero());
    spin = unknown() ? def.spin_rad_s : Vec3(Vec3::Zero());
    force = torque = coupling_force = Vec3::Zero();
}

}  // namespace supple
