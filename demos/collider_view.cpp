#include "collider_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace supple::demos {
namespace {

constexpr std::array<float, 3> kSteel{0.62f, 0.66f, 0.71f}, kTable{0.55f, 0.52f, 0.48f};

Mat3 matrix(const std::array<double, 4>& q) { return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix(); }

/// Turned back by what a spin does in `time_s`.
Mat3 before(const Mat3& R, const Vec3& spin, double time_s) {
    const double angle = spin.norm() * time_s;
    return angle > 1e-12 ? Mat3(Eigen::AngleAxisd(-angle, spin.normalized()) * R) : R;
}

}  // namespace

void ColliderView::add(const World& world, double alpha, const Vec3& up, double size_m, const Vec3& centre, FrameView& view) {
    const std::vector<ColliderId> ids = world.colliders();
    std::erase_if(drawn_, [&](const Drawn& d) { return std::find(ids.begin(), ids.end(), d.id) == ids.end(); });
    for (const ColliderId id : ids) {
        const ColliderDef& def = world.collider(id);
        const ColliderState state = world.collider_state(id);
        const double back_s = (1 - alpha) * world.def().time_step_s;
        const Mat3 R = before(matrix(state.pose.rotation_wxyz), state.spin_rad_s, back_s);
        const Vec3 position = state.pose.position_m - back_s * state.velocity_m_s;
        if (const auto* plane = std::get_if<PlaneShape>(&def.shape); plane != nullptr && (R * plane->normal).normalized().dot(up) > 1 - 1e-9) {
            view.ground_height_m = up.dot(position) + plane->offset_m;
            continue;
        }
        auto at = std::find_if(drawn_.begin(), drawn_.end(), [&](const Drawn& d) { return d.id == id; });
        if (at == drawn_.end()) {
            drawn_.push_back({id, contact::surface_of(def.shape, 0.75 * size_m, R.transpose() * (centre - position)), {}});
            at = drawn_.end() - 1;
        }
        at->positions.resize(at->local.vertices.size());
        for (std::size_t i = 0; i < at->positions.size(); ++i) at->positions[i] = position + R * at->local.vertices[i];
    }
    for (const Drawn& d : drawn_) {  // spans only now: the list no longer grows
        if (d.positions.empty()) continue;
        SurfaceView surface;
        surface.positions = d.positions;
        surface.triangles = d.local.triangles;
        surface.look = Look::metal;
        surface.color = world.collider(d.id).motion == ColliderMotion::fixed ? kTable : kSteel;
        view.surfaces.push_back(surface);
    }
}

void add_contact_arrows(const World& world, double per_n, FrameView& view) {
    for (const ContactPoint& c : world.contacts()) {
        const Vec3 force = c.normal_force_n * c.normal + c.friction_force_n;
        view.arrows.push_back({c.position_m, c.position_m + per_n * force});
    }
}

}  // namespace supple::demos
