// Attachments: points of bodies tied to the world or to colliders.
#include <cmath>

#include "supple/world/contact_stages.h"
#include "supple/math/polar.h"
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

AttachmentId World::attach(const AttachmentDef& def) {
    Impl& w = *impl_;
    const Body& body = w.body(def.body);
    Attachment a;
    a.def = def;
    double sum = 0;
    while (a.corners < 4 && def.vertices[std::size_t(a.corners)] >= 0) {
        const auto k = std::size_t(a.corners++);
        if (std::size_t(def.vertices[k]) >= body.vertices()) bad("vertices", std::to_string(def.vertices[k]) + " is outside [0, " + std::to_string(body.vertices()) + ")");
        for (std::size_t j = 0; j < k; ++j) {
            if (def.vertices[j] == def.vertices[k]) bad("vertices", std::to_string(def.vertices[k]) + " is named twice");
        }
        if (!std::isfinite(def.weights[k])) bad("weights", "is not finite");
        sum += def.weights[k];
    }
    if (a.corners == 0) bad("vertices", "names no vertex");
    if (!(std::abs(sum - 1) < 1e-6)) bad("weights", "sum to " + to_text(sum) + "; they must sum to one");
    require_in_range(def.stiffness_n_m, 0, 1e12, "AttachmentDef.stiffness_n_m", "0 is hard");
    require_in_range(def.max_force_n, 0, 1e12, "AttachmentDef.max_force_n", "0 never breaks");
    if (!def.at_point && !def.anchor_m.allFinite()) bad("anchor_m", "is not finite");
    a.anchor = to_local(collider_of(w, a), def.at_point ? a.mean(body.state.x) : def.anchor_m);
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
    a.anchor = to_local(collider_of(*impl_, a), anchor_m);
}

AttachmentState World::attachment_state(AttachmentId id) const {
    const Attachment& a = impl_->attachment(id);
    return {a.mean(impl_->body(a.def.body).state.x), to_world(collider_of(*impl_, a), a.anchor), a.force, a.broken != 0};
}

void World::detach(AttachmentId id) {
    impl_->attachment(id) = Attachment{};
    --impl_->living_attachments;
}

void find_attachments(StepContext& ctx, BodyId id, Body& body) {
    World::Impl& world = ctx.world;
    const Workspace& w = body.work;
    for (std::size_t slot = 0; slot < world.attachments.size(); ++slot) {
        const Attachment& a = world.attachments[slot];
        if (a.generation == 0 || a.broken != 0 || a.def.body != id) continue;
        Contact c;
        c.attachment = std::int32_t(slot);
        c.corners = std::uint32_t(a.corners);
        Vec3 end = Vec3::Zero();
        double compliance = 0;
        for (std::size_t k = 0; k < c.corners; ++k) {
            const auto v = std::size_t(a.def.vertices[k]);
            c.vertex[k] = a.def.vertices[k];
            c.weight[k] = a.def.weights[k];
            c.masked[k] = free_part(body, v, Vec3::Constant(c.weight[k]));
            end += c.weight[k] * (w.base_x[v] + w.h * (w.v0[v] + w.dv[v]));
            const double inertia = is_static(ctx) ? 0 : body.mass[v] / (w.h * w.h);
            compliance += c.weight[k] * c.weight[k] / (inertia + body.stiffness_trace[v] / 3);
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
        body.contacts.list.push_back(c);
    }
}

}  // namespace supple
