#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "supple/mesh/selection.h"
#include "supple/world/precondition.h"

namespace supple {

namespace {

template <class T>
void check_timeline(const Timeline<T>& line, const char* where) {
    const auto fail = [&](const std::string& message) { throw Error(ErrorCode::invalid_argument, where, message); };
    if (line.values.empty()) fail("has no value");
    if (!line.times_s.empty() && line.times_s.size() != line.values.size()) {
        fail("has " + std::to_string(line.times_s.size()) + " times and " + std::to_string(line.values.size()) + " values; give as many of each");
    }
    for (std::size_t i = 0; i < line.times_s.size(); ++i) {
        if (!std::isfinite(line.times_s[i]) || (i > 0 && !(line.times_s[i] > line.times_s[i - 1]))) fail("times_s must be finite and ascending");
    }
    for (const T& value : line.values) {
        if (!value.allFinite()) fail("has a value that is not finite");
    }
}

std::vector<std::int32_t> select_some(const Body& body, const Selection& where, const char* what) {
    std::vector<std::int32_t> vertices = select_vertices(body.data().mesh, where);
    if (vertices.empty()) {
        const MeshReport& r = body.data().report;
        auto text = [](const Vec3& p) { return "(" + to_text(p.x()) + ", " + to_text(p.y()) + ", " + to_text(p.z()) + ")"; };
        throw Error(ErrorCode::invalid_argument, what,
                    "the selection holds no vertex of \"" + body.name + "\"; its rest shape spans " + text(r.min_m) + " to " + text(r.max_m) + " m");
    }
    return vertices;
}

void own(Body& body, const std::vector<std::int32_t>& vertices, Axes axes, std::int32_t owner) {
    const bool axis[3] = {axes.x, axes.y, axes.z};
    for (const std::int32_t v : vertices) {
        if (body.mass[std::size_t(v)] == 0) continue;  // a vertex of no element stays held
        for (std::size_t c = 0; c < 3; ++c) {
            if (axis[c]) body.owner[std::size_t(v) * 3 + c] = owner;
        }
    }
    body.supports_changed = true;
}

PreparedLoad prepare(const Body& body, const Load& load) {
    const TemplateData& data = body.data();
    std::vector<double> weight(data.layout.vertices, 0.0);
    const std::vector<std::int32_t> selected = select_some(body, load.where, "Load.where");
    switch (load.kind) {
        case LoadKind::total_force:
            for (const std::int32_t v : selected) weight[std::size_t(v)] = 1.0 / double(selected.size());
            break;
        case LoadKind::force_per_vertex:
            for (const std::int32_t v : selected) weight[std::size_t(v)] = 1;
            break;
        case LoadKind::traction: {
            std::vector<bool> in(data.layout.vertices, false);
            for (const std::int32_t v : selected) in[std::size_t(v)] = true;
            bool any = false;
            for (const Triangle& t : data.boundary.triangles) {
                const std::size_t a = std::size_t(t[0]), b = std::size_t(t[1]), c = std::size_t(t[2]);
                if (!in[a] || !in[b] || !in[c]) continue;
                const auto& X = data.mesh.vertices;
                const double third = (X[b] - X[a]).cross(X[c] - X[a]).norm() / 6;
                for (const std::size_t v : {a, b, c}) weight[v] += third;
                any = true;
            }
            if (!any) throw Error(ErrorCode::invalid_argument, "Load.where", "no boundary triangle of \"" + body.name + "\" has its three vertices selected");
            break;
        }
        case LoadKind::body_force: {
            const std::vector<std::int32_t> elements = select_elements(data.mesh, load.where);
            if (elements.empty()) throw Error(ErrorCode::invalid_argument, "Load.where", "no element of \"" + body.name + "\" has all its vertices selected");
            double share[8];
            for (const std::int32_t e : elements) {
                const std::size_t corners = fem::corner_volumes(data.mesh, std::size_t(e), share);
                for (std::size_t a = 0; a < corners; ++a) weight[std::size_t(fem::element_vertices(data.mesh, std::size_t(e))[a])] += share[a];
            }
            break;
        }
    }
    PreparedLoad prepared;
    prepared.value = load.value;
    for (std::size_t v = 0; v < weight.size(); ++v) {
        if (weight[v] == 0) continue;
        prepared.vertex.push_back(std::int32_t(v));
        prepared.weight.push_back(weight[v]);
    }
    return prepared;
}

}  // namespace

std::size_t World::fix(BodyId id, const Selection& where, Axes axes) {
    Body& body = impl_->body(id);
    const auto vertices = select_some(body, where, "World::fix");
    own(body, vertices, axes, kHeld);
    return vertices.size();
}

void World::release(BodyId id, const Selection& where) {
    Body& body = impl_->body(id);
    own(body, select_some(body, where, "World::release"), {}, kFree);
}

std::size_t World::prescribe(BodyId id, const Motion& motion) {
    Body& body = impl_->body(id);
    const int kinds = !motion.displacement_m.values.empty() + !motion.velocity_m_s.values.empty() + !motion.affine.values.empty();
    if (kinds != 1) throw Error(ErrorCode::invalid_argument, "Motion", "needs exactly one of displacement_m, velocity_m_s and affine; it has " + std::to_string(kinds));
    if (!motion.displacement_m.values.empty()) check_timeline(motion.displacement_m, "Motion.displacement_m");
    if (!motion.velocity_m_s.values.empty()) check_timeline(motion.velocity_m_s, "Motion.velocity_m_s");
    if (!motion.affine.values.empty()) check_timeline(motion.affine, "Motion.affine");
    const auto vertices = select_some(body, motion.where, "World::prescribe");
    body.motions.push_back(motion);
    own(body, vertices, motion.axes, std::int32_t(body.motions.size() - 1));
    return vertices.size();
}

void World::add_load(BodyId id, const Load& load) {
    Body& body = impl_->body(id);
    check_timeline(load.value, "Load.value");
    body.loads.push_back(prepare(body, load));
}

void World::clear_loads(BodyId id) { impl_->body(id).loads.clear(); }

void refresh_supports(World::Impl& world, BodyId id, Body& body) {
    const solve::Bsr3Pattern& pattern = body.data().pattern;
    const auto touched = [&](std::size_t v) { return body.is_held(v, 0) || body.is_held(v, 1) || body.is_held(v, 2); };
    body.held_rows.clear();
    for (std::size_t row = 0; row < body.vertices(); ++row) {
        bool any = false;
        for (std::int32_t b = pattern.row_start[row]; b < pattern.row_start[row + 1] && !any; ++b) any = touched(std::size_t(pattern.column[std::size_t(b)]));
        if (any) body.held_rows.push_back(std::int32_t(row));
        for (Vec3* history : {&body.state.dv1[row], &body.state.dv2[row]}) *history = free_part(body, row, *history);
    }
    for (Drag& drag : world.drags) {
        if (drag.generation == 0 || drag.body != id) continue;
        for (std::size_t i = 0; i < drag.vertex.size(); ++i) {
            drag.masked[i] = free_part(body, std::size_t(drag.vertex[i]), Vec3::Constant(drag.weight[i]));
        }
    }
    body.supports_changed = false;
    body.preconditioner_fits = false;
}

}  // namespace supple
