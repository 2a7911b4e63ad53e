#include <algorithm>
#include <cmath>

#include "supple/mesh/surface.h"
#include "supple/world/stages.h"

namespace supple {

std::optional<PickHit> World::pick(const Ray& ray) const {
    std::optional<PickHit> first;
    for (const BodyId id : bodies()) {
        const Body& body = impl_->body(id);
        const BoundarySurface& surface = body.data().boundary;
        const auto hit = intersect(ray, surface.triangles, body.state.x);
        if (!hit || (first && first->distance <= hit->distance)) continue;
        first = PickHit{id, hit->triangle, surface.element[std::size_t(hit->triangle)], hit->barycentric,
                        ray.origin + hit->distance * ray.direction, hit->distance};
    }
    return first;
}

Drag& World::Impl::drag(DragId id) {
    if (id.index < drags.size() && id.generation != 0 && drags[id.index].generation == id.generation) return drags[id.index];
    throw Error(ErrorCode::stale_id, "DragId",
                "drag {" + std::to_string(id.index) + ", " + std::to_string(id.generation) + "} has ended, or never began in this world");
}

namespace {

/// The picked triangle, or the surface vertices around the point weighted by (1 - (r/R)^2)^2 at rest.
void choose_patch(const Body& body, const PickHit& hit, double radius_m, Drag& drag) {
    const TemplateData& data = body.data();
    const Triangle& triangle = data.boundary.triangles[std::size_t(hit.triangle)];
    const auto& X = data.mesh.vertices;
    Vec3 centre = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) centre += hit.barycentric[k] * X[std::size_t(triangle[k])];
    double sum = 0;
    for (const std::int32_t v : data.boundary_vertices) {
        const double q = (X[std::size_t(v)] - centre).squaredNorm() / (radius_m * radius_m);
        if (!(q < 1)) continue;
        drag.vertex.push_back(v);
        drag.weight.push_back((1 - q) * (1 - q));
        sum += drag.weight.back();
    }
    if (drag.vertex.size() < 3) {  // a radius below the edge length: the triangle
        drag.vertex.assign(triangle.begin(), triangle.end());
        drag.weight.assign(hit.barycentric.begin(), hit.barycentric.end());
        return;
    }
    for (double& w : drag.weight) w /= sum;
}

}  // namespace

DragId World::begin_drag(const PickHit& hit, const DragDef& def) {
    Impl& w = *impl_;
    const Body& body = w.body(hit.body);
    const auto triangles = body.data().boundary.triangles.size();
    if (hit.triangle < 0 || std::size_t(hit.triangle) >= triangles) {
        throw Error(ErrorCode::invalid_argument, "PickHit.triangle", std::to_string(hit.triangle) + " is outside [0, " + std::to_string(triangles) + ")");
    }
    const Vec3 barycentric(hit.barycentric[0], hit.barycentric[1], hit.barycentric[2]);
    if (!hit.position_m.allFinite() || !barycentric.allFinite() || !(std::abs(barycentric.sum() - 1) < 1e-6)) {
        throw Error(ErrorCode::invalid_argument, "PickHit", "position_m must be finite and barycentric must sum to one; pass on what World::pick() gave");
    }
    require_in_range(def.radius_m, 0, 1e6, "DragDef.radius_m", "0 takes the picked triangle alone");
    require_in_range(def.stiffness_n_m, 0, 1e15, "DragDef.stiffness_n_m", "0 takes the local effective mass");
    require_in_range(def.max_force_n, 0, 1e15, "DragDef.max_force_n", "0 means no cap");

    Drag drag;
    drag.body = hit.body;
    choose_patch(body, hit, def.radius_m, drag);
    drag.masked.resize(drag.vertex.size());
    // What the patch weighs against a force over one step: 1 / sum w^2 / a, with a = m/h^2 + K of each vertex; and its inertia alone.
    const double h = w.def.time_step_s;
    double compliance = 0, inverse_mass = 0;
    for (std::size_t i = 0; i < drag.vertex.size(); ++i) {
        const std::size_t v = std::size_t(drag.vertex[i]);
        const double w2 = drag.weight[i] * drag.weight[i];
        compliance += w2 / (body.mass[v] / (h * h) + body.stiffness_trace[v] / 3);
        inverse_mass += w2 / body.mass[v];
    }
    drag.stiffness = def.stiffness_n_m > 0 ? def.stiffness_n_m : 1 / compliance;
    drag.damping = 2 * std::sqrt(drag.stiffness / inverse_mass);
    drag.max_force = def.max_force_n;
    drag.offset = hit.position_m - drag.mean(body.state.x);
    drag.target = hit.position_m;
    drag.generation = w.next_drag_generation++;

    std::size_t slot = 0;
    while (slot < w.drags.size() && w.drags[slot].generation != 0) ++slot;
    if (slot == w.drags.size()) w.drags.emplace_back();
    w.drags[slot] = std::move(drag);
    w.appended.reserve(w.drags.size());
    w.body(hit.body).supports_changed = true;
    return {std::uint32_t(slot), w.drags[slot].generation};
}

void World::move_drag(DragId id, const Vec3& target_m) {
    if (!target_m.allFinite()) throw Error(ErrorCode::invalid_argument, "World::move_drag", "the target is not finite");
    impl_->drag(id).target = target_m;
}

DragState World::drag_state(DragId id) const {
    const Drag& drag = impl_->drag(id);
    return {drag.mean(impl_->body(drag.body).state.x) + drag.offset, drag.target, drag.force};
}

void World::end_drag(DragId id) { impl_->drag(id).generation = 0; }

}  // namespace supple
