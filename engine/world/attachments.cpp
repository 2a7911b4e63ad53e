// Attachments: points of bodies tied to the world or to colliders.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "supple/world/contact_stages.h"
#include "supple/math/polar.h"
#include "supple/mesh/triangle_tree.h"
#include "supple/world/stages.h"

namespace supple {

namespace {

constexpr double kHard = 1000;  // times what the vertices weigh against a force over one step

[[noreturn]] void bad(const std::string& field, const std::string& message) { throw Error(ErrorCode::invalid_argument, "AttachmentDef." + field, message); }

/// The frame of a collider between steps.
Vec3 to_local(const Collider* c, const Vec3& p) {
    return c == nullptr ? p : Vec3(rotation_matrix(c->pose.rotation_wxyz).transpose() * (p - c->pose.position_m));
}
Vec3 to_world(const Collider* c, const Vec3& p) {
    return c == nullptr ? p : Vec3(c->pose.position_m + rotation_matrix(c->pose.rotation_wxyz) * p);
}

Collider* collider_of(World::Impl& world, const Attachment& a) { return a.def.collider ? &world.collider(a.def.collider) : nullptr; }

}  // namespace

Attachment& World::Impl::attachment(AttachmentId id) {
    if (id.index < attachments.size() && id.generation != 0 && attachments[id.index].generation == id.generation) return attachments[id.index];
    throw Error(ErrorCode::stale_id, "AttachmentId",
                "attachment {" + std::to_string(id.index) + ", " + std::to_string(id.generation) + "} was detached, or went with its body or collider");
}

namespace {

/// How many vertices a point of a body has, after a look at them.
std::int32_t check_point(const Body& body, const std::array<std::int32_t, 4>& vertices, const std::array<double, 4>& weights, const std::string& prefix) {
    std::int32_t corners = 0;
    double sum = 0;
    while (corners < 4 && vertices[std::size_t(corners)] >= 0) {
        const auto k = std::size_t(corners++);
        if (std::size_t(vertices[k]) >= body.vertices()) bad(prefix + "vertices", std::to_string(vertices[k]) + " is outside [0, " + std::to_string(body.vertices()) + ")");
        for (std::size_t j = 0; j < k; ++j) {
            if (vertices[j] == vertices[k]) bad(prefix + "vertices", std::to_string(vertices[k]) + " is named twice");
        }
        if (!std::isfinite(weights[k])) bad(prefix + "weights", "is not finite");
        sum += weights[k];
    }
    if (corners == 0) bad(prefix + "vertices", "names no vertex");
    if (!(std::abs(sum - 1) < 1e-6)) bad(prefix + "weights", "sum to " + to_text(sum) + "; they must sum to one");
    return corners;
}

/// The tetrahedra that fill an element, its own corners: of a hexahedron the five of which one is in the middle.
std::vector<Tet> tets_of(const std::vector<std::int32_t>& corner) {
    if (corner.size() == 4) return {{corner[0], corner[1], corner[2], corner[3]}};
    std::vector<Tet> tets;
    for (const auto& t : {std::array{0, 1, 3, 4}, {1, 2, 3, 6}, {1, 4, 5, 6}, {3, 4, 6, 7}, {1, 3, 4, 6}}) {
        tets.push_back({corner[std::size_t(t[0])], corner[std::size_t(t[1])], corner[std::size_t(t[2])], corner[std::size_t(t[3])]});
    }
    return tets;
}

/// The point of a body that is at p now: weights in the tetrahedron that holds it, or that it is beside the least.
void locate(const Body& body, const Vec3& p, std::array<std::int32_t, 4>& vertices, std::array<double, 4>& weights) {
    const VolumeMesh& mesh = body.data().mesh;
    double best = -HUGE_VAL;
    for (std::size_t e = 0; e < body.element_count(); ++e) {
        const auto corners = element_vertices(mesh, e);
        for (const Tet& t : tets_of({corners.begin(), corners.end()})) {
            const auto x = [&](std::size_t k) -> const Vec3& { return body.state.x[std::size_t(t[k])]; };
            Mat3 D;
            D << x(1) - x(0), x(2) - x(0), x(3) - x(0);
            const Vec3 w = D.fullPivLu().solve(p - x(0));
            const std::array<double, 4> all{1 - w.sum(), w[0], w[1], w[2]};
            const double least = *std::min_element(all.begin(), all.end());
            if (!std::isfinite(least) || least <= best) continue;
            best = least;
            vertices = {t[0], t[1], t[2], t[3]};
            weights = all;
        }
    }
}

/// The place of an attachment on another body.
void tie_to_body(World::Impl& w, Attachment& a, const Body& body) {
    const Body& other = w.body(a.def.other);
    if (a.def.collider) bad("other", "is given beside a collider; an attachment has one end elsewhere");
    if (!a.def.at_point) bad("at_point", "is false: anchor_m is a place in the world, not on another body; name other_vertices");
    if (a.def.other_vertices[0] < 0) {
        if (&other == &body) bad("other", "is the body itself: name other_vertices");
        locate(other, a.mean(body.state.x), a.def.other_vertices, a.def.other_weights);
    }
    a.others = check_point(other, a.def.other_vertices, a.def.other_weights, "other_");
}

}  // namespace

AttachmentId World::attach(const AttachmentDef& def) {
    Impl& w = *impl_;
    const Body& body = w.body(def.body);
    Attachment a;
    a.def = def;
    a.corners = check_point(body, def.vertices, def.weights, "");
    require_in_range(def.stiffness_n_m, 0, 1e12, "AttachmentDef.stiffness_n_m", "0 is hard");
    require_in_range(def.max_force_n, 0, 1e12, "AttachmentDef.max_force_n", "0 never breaks");
    if (!def.at_point && !def.anchor_m.allFinite()) bad("anchor_m", "is not finite");
    if (def.other) {
        tie_to_body(w, a, body);
    } else {
        a.anchor = to_local(collider_of(w, a), def.at_point ? a.mean(body.state.x) : def.anchor_m);
    }
    std::size_t slot = 0;
    while (slot < w.attachments.size() && w.attachments[slot].generation != 0) ++slot;
    if (slot == w.attachments.size()) w.attachments.emplace_back();
    a.generation = w.next_attachment_generation++;
    w.attachments[slot] = a;
    ++w.living_attachments;
    return {std::uint32_t(slot), a.generation};
}

void World::move_attachment(AttachmentId id, const Vec3& anchor_m) {
    Attachment& a = impl_->attachment(id);
    if (!anchor_m.allFinite()) throw Error(ErrorCode::invalid_argument, "World::move_attachment", "the anchor is not finite");
    if (a.def.other) throw Error(ErrorCode::invalid_argument, "World::move_attachment", "this one is tied to another body: detach it, and attach it elsewhere");
    a.anchor = to_local(collider_of(*impl_, a), anchor_m);
}

AttachmentState World::attachment_state(AttachmentId id) const {
    const Attachment& a = impl_->attachment(id);
    const Vec3 anchor = a.def.other ? a.other_mean(impl_->body(a.def.other).state.x) : to_world(collider_of(*impl_, a), a.anchor);
    return {a.mean(impl_->body(a.def.body).state.x), anchor, a.force, a.broken != 0};
}

void World::detach(AttachmentId id) {
    impl_->attachment(id) = Attachment{};
    --impl_->living_attachments;
}

std::vector<AttachmentId> World::tie(BodyId id, BodyId other_id, double gap_m, const AttachmentDef& def) {
    const Body &body = impl_->body(id), &other = impl_->body(other_id);
    if (&body == &other) throw Error(ErrorCode::invalid_argument, "World::tie", "one body twice; surfaces of two bodies are tied");
    require_in_range(gap_m, 1e-12, 1e6, "World::tie, gap_m", "about half an edge of the meshes is usual");
    const std::vector<Triangle>& triangles = other.data().boundary.triangles;
    const TriangleTree surface(mesh::TriangleMesh{other.state.x, triangles});
    std::vector<AttachmentId> made;
    for (const std::int32_t v : body.data().boundary_vertices) {
        const NearestPoint at = surface.nearest(body.state.x[std::size_t(v)], gap_m);
        if (at.triangle < 0) continue;
        AttachmentDef one = def;
        one.body = id;
        one.vertices = {v, -1, -1, -1};
        one.weights = {1, 0, 0, 0};
        one.other = other_id;
        one.other_vertices = {-1, -1, -1, -1};
        std::size_t n = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            if (at.barycentric[k] == 0) continue;
            one.other_vertices[n] = triangles[std::size_t(at.triangle)][k];
            one.other_weights[n++] = at.barycentric[k];
        }
        made.push_back(attach(one));
    }
    if (!made.empty()) set_contact(id, other_id, false);
    return made;
}

void find_attachments(StepContext& ctx, Member& member, std::span<Member> members) {
    World::Impl& world = ctx.world;
    const Body& body = *member.body;
    const auto end_of = [](const Body& of, std::int32_t vertex) -> Vec3 {
        const auto v = std::size_t(vertex);
        return of.work.base_x[v] + of.work.h * (of.work.v0[v] + of.work.dv[v]);
    };
    for (std::size_t slot = 0; slot < world.attachments.size(); ++slot) {
        const Attachment& a = world.attachments[slot];
        if (a.generation == 0 || a.broken != 0 || a.def.body != member.id) continue;
        Contact c;
        c.attachment = std::int32_t(slot);
        c.corners = std::uint32_t(a.corners);
        Vec3 end = Vec3::Zero();
        double compliance = 0;
        for (std::size_t k = 0; k < c.corners; ++k) {
            c.vertex[k] = a.def.vertices[k];
            c.weight[k] = a.def.weights[k];
            c.masked[k] = free_part(body, std::size_t(c.vertex[k]), Vec3::Constant(c.weight[k]));
            end += c.weight[k] * end_of(body, c.vertex[k]);
            compliance += c.weight[k] * c.weight[k] / weight_against(ctx, body, c.vertex[k]);
        }
        if (a.def.other) {
            const auto other = std::find_if(members.begin(), members.end(), [&](const Member& m) { return m.id == a.def.other; });
            if (other == members.end()) continue;  // it is frozen
            c.other = other->body;
            c.other_slot = std::int32_t(a.def.other.index);
            c.collider = kNoCollider;
            c.others = std::uint32_t(a.others);
            for (std::size_t i = 0; i < std::size_t(a.others); ++i) {
                const std::size_t k = c.corners + i;
                c.vertex[k] = a.def.other_vertices[i];
                c.weight[k] = -a.def.other_weights[i];
                c.masked[k] = free_part(*c.other, std::size_t(c.vertex[k]), Vec3::Constant(c.weight[k] * c.other->work.h / body.work.h));
                end += c.weight[k] * end_of(*c.other, c.vertex[k]);
                compliance += c.weight[k] * c.weight[k] / weight_against(ctx, *c.other, c.vertex[k]);
            }
            c.stiffness = a.def.stiffness_n_m > 0 ? a.def.stiffness_n_m : kHard / compliance;
            c.z_ref = end;
            member.body->contacts.list.push_back(c);
            continue;
        }
        c.stiffness = a.def.stiffness_n_m > 0 ? a.def.stiffness_n_m : kHard / compliance;
        c.collider = a.def.collider ? a.def.collider.index : kNoCollider;
        c.lever = a.anchor;
        Vec3 anchor = a.anchor;
        if (c.collider != kNoCollider) {
            const Collider& collider = world.colliders[c.collider];
            anchor = collider.to_world1(a.anchor);
            c.lever = anchor - collider.c1;
        }
        c.z_ref = end - anchor;
        member.body->contacts.list.push_back(c);
    }
}

}  // namespace supple
