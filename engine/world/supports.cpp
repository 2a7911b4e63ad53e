#include "supple/mesh/selection.h"
#include "supple/world/precondition.h"

namespace supple {

namespace {

void own(Body& body, const std::vector<std::int32_t>& vertices, Axes axes, std::int32_t owner) {
    const bool axis[3] = {axes.x, axes.y, axes.z};
    for (const std::int32_t v : vertices) {
        if (body.mass[std::size_t(v)] == 0) continue;  // a vertex of no element stays held
        for (std::size_t c = 0; c < 3; ++c) {
            if (axis[c]) body.owner[std::size_t(v) * 3 + c] = owner;
        }
    }
    body.supports_changed = true;
    supports_have_changed(body);
}

}  // namespace

std::size_t World::fix(BodyId id, const Selection& where, Axes axes) {
    Body& body = impl_->body(id);
    const auto vertices = select_some(body.data(), body.name, where, "World::fix");
    own(body, vertices, axes, kHeld);
    return vertices.size();
}

void World::release(BodyId id, const Selection& where) {
    Body& body = impl_->body(id);
    own(body, select_some(body.data(), body.name, where, "World::release"), {}, kFree);
}

std::size_t World::prescribe(BodyId id, const Motion& motion) {
    Body& body = impl_->body(id);
    const int kinds = !motion.displacement_m.values.empty() + !motion.velocity_m_s.values.empty() + !motion.affine.values.empty();
    if (kinds != 1) throw Error(ErrorCode::invalid_argument, "Motion", "needs exactly one of displacement_m, velocity_m_s and affine; it has " + std::to_string(kinds));
    if (!motion.displacement_m.values.empty()) check_timeline(motion.displacement_m, "Motion.displacement_m");
    if (!motion.velocity_m_s.values.empty()) check_timeline(motion.velocity_m_s, "Motion.velocity_m_s");
    if (!motion.affine.values.empty()) check_timeline(motion.affine, "Motion.affine");
    const auto vertices = select_some(body.data(), body.name, motion.where, "World::prescribe");
    body.motions.push_back(motion);
    own(body, vertices, motion.axes, std::int32_t(body.motions.size() - 1));
    return vertices.size();
}

void World::add_load(BodyId id, const Load& load) {
    Body& body = impl_->body(id);
    body.loads.add(body.data(), body.name, load);
}

void World::clear_loads(BodyId id) { impl_->body(id).loads.clear(); }

void refresh_supports(World::Impl& world, BodyId id, Body& body) {
    const solve::Bsr3Pattern& pattern = body.data().pattern;
    const auto touched = [&](std::size_t v) { return body.is_held(v, 0) || body.is_held(v, 1) || body.is_held(v, 2); };
    body.held_rows.clear();
    for (std::size_t row = 0; row < body.vertices(); ++row) {
        bool any = false;
        for (std::int32_t b = pattern.row_start[row]; b < pattern.row_start[row + 1] && !any; ++b) any = touched(std::size_t(pattern.vertex[std::size_t(pattern.column[std::size_t(b)])]));
        if (any) body.held_rows.push_back(std::int32_t(row));
    }
    for (std::size_t v = 0; v < body.vertices(); ++v) {
        for (Vec3* history : {&body.state.dv1[v], &body.state.dv2[v]}) *history = free_part(body, v, *history);
    }
    for (Drag& drag : world.drags) {
        if (drag.generation == 0 || drag.body != id) continue;
        for (std::size_t i = 0; i < drag.vertex.size(); ++i) {
            drag.masked[i] = free_part(body, std::size_t(drag.vertex[i]), Vec3::Constant(drag.weight[i]));
        }
    }
    body.supports_changed = false;
}

}  // namespace supple
