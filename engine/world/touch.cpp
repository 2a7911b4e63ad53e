#include <algorithm>
#include <cmath>

#include "supple/mesh/surface.h"
#include "supple/world/stages.h"

namespace supple {

namespace {

/// The rest position of a point of a triangle.
Vec3 rest_point(std::span<const Vec3> X, const Triangle& triangle, const std::array<double, 3>& barycentric) {
    Vec3 x = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) x += barycentric[k] * X[std::size_t(triangle[k])];
    return x;
}

Vec3 rest_point(const Body& body, const PickHit& hit) {
    if (hit.skin_triangle >= 0) {
        const mesh::TriangleMesh& skin = body.def.skin->surface();
        return rest_point(skin.vertices, skin.triangles[std::size_t(hit.skin_triangle)], hit.barycentric);
    }
    return rest_point(body.data().mesh.vertices, body.data().boundary.triangles[std::size_t(hit.triangle)], hit.barycentric);
}

std::optional<RayHit> hit_surface(const Body& body, const Ray& ray) {
    if (!body.def.skin) return intersect(ray, body.data().boundary.triangles, body.state.x);
    const Skin& skin = *body.def.skin;
    std::vector<Vec3> x(skin.embedding().size());
    skin.embedding().deform(body.state.x, x);
    return intersect(ray, skin.surface().triangles, x);
}

/// A point of a skin belongs to the element of its nearest corner.
std::int32_t element_of(const Body& body, const RayHit& hit) {
    if (!body.def.skin) return body.data().boundary.element[std::size_t(hit.triangle)];
    const auto corner = std::size_t(std::max_element(hit.barycentric.begin(), hit.barycentric.end()) - hit.barycentric.begin());
    const Triangle& triangle = body.def.skin->surface().triangles[std::size_t(hit.triangle)];
    return body.def.skin->embedding().elements()[std::size_t(triangle[corner])];
}

}  // namespace

std::optional<PickHit> World::pick(const Ray& ray) const {
    std::optional<PickHit> first;
    for (const BodyId id : bodies()) {
        const Body& body = impl_->body(id);
        const auto hit = hit_surface(body, ray);
        if (!hit || (first && first->distance <= hit->distance)) continue;
        first = PickHit{};
        first->body = id;
        (body.def.skin ? first->skin_triangle : first->triangle) = hit->triangle;
        first->element = element_of(body, *hit);
        first->barycentric = hit->barycentric;
        first->position_m = ray.origin + hit->distance * ray.direction;
        first->distance = hit->distance;
    }
    if (first) {
        const Body& body = impl_->body(first->body);
        shape_weights(body.data().mesh, first->element, rest_point(body, *first), first->element_weights);
    }
    return first;
}

Drag& World::Impl::drag(DragId id) {
    if (id.index < drags.size() && id.generation != 0 && drags[id.index].generation == id.generation) return drags[id.index];
    throw Error(ErrorCode::stale_id, "DragId",
                "drag {" + std::to_string(id.index) + ", " + std::to_string(id.generation) + "} has ended, or never began in this world");
}

namespace {

/// The surface vertices around the point weighted by (1 - (r/R)^2)^2 at rest, or the picked triangle; of a skin, the element that moves it.
void choose_patch(const Body& body, const PickHit& hit, double radius_m, Drag& drag) {
    const TemplateData& data = body.data();
    const auto& X = data.mesh.vertices;
    const Vec3 centre = rest_point(body, hit);
    double sum = 0;
    for (const std::int32_t v : data.boundary_vertices) {
        const double q = (X[std::size_t(v)] - centre).squaredNorm() / (radius_m * radius_m);
        if (!(q < 1)) continue;
        drag.vertex.push_back(v);
        drag.weight.push_back((1 - q) * (1 - q));
        sum += drag.weight.back();
    }
    if (drag.vertex.size() < 3) {  // a radius below the edge length
        if (hit.skin_triangle < 0) {
            const Triangle& triangle = data.boundary.triangles[std::size_t(hit.triangle)];
            drag.vertex.assign(triangle.begin(), triangle.end());
            drag.weight.assign(hit.barycentric.begin(), hit.barycentric.end());
            return;
        }
        const auto corners = element_vertices(data.mesh, hit.element);
        drag.vertex.assign(corners.begin(), corners.end());
        drag.weight.clear();
        sum = 0;
        for (std::size_t a = 0; a < corners.size(); ++a) {  // a point beyond the element has negative weights: pull at the others
            drag.weight.push_back(std::max(hit.element_weights[a], 0.0));
            sum += drag.weight.back();
        }
    }
    for (double& w : drag.weight) w /= sum;
}

}  // namespace

DragId World::begin_drag(const PickHit& hit, const DragDef& def) {
    Impl& w = *impl_;
    const Body& body = w.body(hit.body);
    const bool skin = body.def.skin && hit.skin_triangle >= 0;
    const auto triangles = skin ? body.def.skin->surface().triangles.size() : body.data().boundary.triangles.size();
    const std::int32_t triangle = skin ? hit.skin_triangle : hit.triangle;
    if (triangle < 0 || std::size_t(triangle) >= triangles || (hit.skin_triangle >= 0 && !skin)) {
        throw Error(ErrorCode::invalid_argument, skin ? "PickHit.skin_triangle" : "PickHit.triangle", std::to_string(triangle) + " is outside [0, " + std::to_string(triangles) + ")");
    }
    if (skin && (hit.element < 0 || std::size_t(hit.element) >= body.element_count()))
        throw Error(ErrorCode::invalid_argument, "PickHit.element", std::to_string(hit.element) + " is outside [0, " + std::to_string(body.element_count()) + ")");
    const Vec3 barycentric(hit.barycentric[0], hit.barycentric[1], hit.barycentric[2]);
    if (!hit.position_m.allFinite() || !barycentric.allFinite() || !(std::abs(barycentric.sum() - 1) < 1e-6) ||
        !std::all_of(hit.element_weights.begin(), hit.element_weights.end(), [](double weight) { return std::isfinite(weight); })) {
        throw Error(ErrorCode::invalid_argument, "PickHit", "position_m must be finite and barycentric must sum to one; pass on what World::pick() gave");
    }
    require_in_range(def.radius_m, 0, 1e6, "DragDef.radius_m", "0 takes the picked triangle alone");
    require_in_range(def.stiffness_n_m, 0, 1e15, "DragDef.stiffness_n_m", "0 takes the local effective mass");
    require_in_range(def.max_force_n, 0, 1e15, "DragDef.max_force_n", "0 means no cap");

    Drag drag;
    drag.body = hit.body;
    choose_patch(body, hit, def.radius_m, drag);
    drag.masked.resize(drag.vertex.size());
    drag.row.resize(drag.vertex.size());
    drag.own_row.resize(drag.vertex.size());
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
    w.scratch.appended.reserve(w.drags.size());
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
