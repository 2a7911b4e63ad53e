#include <algorithm>

#include "supple/base/byte_stream.h"
#include "supple/base/hash.h"
#include "supple/world/edits.h"
#include "supple/world/impl.h"
#include "supple/world/precondition.h"

namespace supple {

namespace {

constexpr std::uint64_t kMagic = 0x31504e53504c5053ULL;  // "SPLPSNP1", little-endian
constexpr std::uint32_t kVersion = 7;

std::uint64_t checksum(std::span<const std::byte> bytes) {
    Hasher hasher;
    hasher.add_bytes(bytes);
    return hasher.value();
}

/// Of where each element's rotation and plastic strain lie: that follows from the laws of a body's regions.
std::uint64_t layout_hash(const Body& body) {
    Hasher hasher;
    hasher.add_bytes(std::as_bytes(std::span(body.layout().slot)));
    return hasher.value();
}

constexpr std::size_t kMostContacts = 1u << 24;

void check_contacts(const std::vector<ContactMemory>& contacts, const Body& body) {
    for (const ContactMemory& c : contacts) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t v = c.vertex[k];
            const bool tag = v < -1 && k == 2 && c.collider == kNoCollider;  // of another body's edge
            if ((v < -1 && !tag) || v >= std::int32_t(body.vertices())) throw Error(ErrorCode::corrupt_snapshot, "snapshot", "a contact does not fit its body");
        }
    }
}

void write(ByteWriter& out, const Drag& drag) {
    out.value(drag.generation);
    if (drag.generation == 0) return;
    out.value(drag.body.index);
    out.value(drag.body.generation);
    for (const double x : {drag.stiffness, drag.damping, drag.max_force}) out.value(x);
    for (const Vec3* v : {&drag.offset, &drag.target, &drag.force}) out.value(std::array{(*v)[0], (*v)[1], (*v)[2]});
    out.array(drag.vertex);
    out.array(drag.weight);
}

/// Vertices of each body in the snapshot.
using BodySizes = std::vector<std::pair<BodyId, std::size_t>>;

std::size_t vertices_of(const BodySizes& bodies, BodyId id) {
    for (const auto& [body, vertices] : bodies)
        if (body == id) return vertices;
    return 0;
}

Drag read_drag(ByteReader& in, const World::Impl& world, const BodySizes& bodies) {
    Drag drag;
    drag.generation = in.value<std::uint32_t>("drag");
    if (drag.generation == 0) return drag;
    drag.body.index = in.value<std::uint32_t>("drag");
    drag.body.generation = in.value<std::uint32_t>("drag");
    for (double* x : {&drag.stiffness, &drag.damping, &drag.max_force}) *x = in.value<double>("drag");
    for (Vec3* v : {&drag.offset, &drag.target, &drag.force}) {
        const auto a = in.value<std::array<double, 3>>("drag");
        *v = Vec3(a[0], a[1], a[2]);
    }
    const bool lives = std::any_of(world.order.begin(), world.order.end(), [&](std::uint32_t slot) {
        return drag.body == BodyId{slot, world.slots[slot].generation};
    });
    if (!lives) throw Error(ErrorCode::corrupt_snapshot, "snapshot", "a drag holds a body that this world does not have");
    const std::size_t n = vertices_of(bodies, drag.body);
    drag.vertex = in.list<std::int32_t>(n, "drag patch");
    drag.weight = in.list<double>(n, "drag patch");
    const bool inside = std::all_of(drag.vertex.begin(), drag.vertex.end(), [&](std::int32_t v) { return v >= 0 && std::size_t(v) < n; });
    if (!inside || drag.vertex.size() != drag.weight.size()) throw Error(ErrorCode::corrupt_snapshot, "snapshot", "a drag's patch does not fit its body");
    drag.masked.resize(drag.vertex.size());
    drag.row.resize(drag.vertex.size());
    drag.own_row.resize(drag.vertex.size());
    return drag;
}

void write(ByteWriter& out, const Attachment& a) {
    out.value(a.generation);
    if (a.generation == 0) return;
    for (const std::uint32_t x : {a.def.body.index, a.def.body.generation, a.def.collider.index, a.def.collider.generation, a.def.other.index, a.def.other.generation}) out.value(x);
    out.value(a.def.vertices);
    out.value(a.def.weights);
    out.value(a.corners);
    out.value(a.def.other_vertices);
    out.value(a.def.other_weights);
    out.value(a.others);
    out.value(a.broken);
    for (const double x : {a.def.stiffness_n_m, a.def.max_force_n}) out.value(x);
    for (const Vec3* v : {&a.anchor, &a.force}) out.value(std::array{(*v)[0], (*v)[1], (*v)[2]});
}

Attachment read_attachment(ByteReader& in, const World::Impl& world, const BodySizes& bodies) {
    Attachment a;
    a.generation = in.value<std::uint32_t>("attachment");
    if (a.generation == 0) return a;
    for (std::uint32_t* x : {&a.def.body.index, &a.def.body.generation, &a.def.collider.index, &a.def.collider.generation, &a.def.other.index, &a.def.other.generation})
        *x = in.value<std::uint32_t>("attachment");
    a.def.vertices = in.value<std::array<std::int32_t, 4>>("attachment");
    a.def.weights = in.value<std::array<double, 4>>("attachment");
    a.corners = in.value<std::int32_t>("attachment");
    a.def.other_vertices = in.value<std::array<std::int32_t, 4>>("attachment");
    a.def.other_weights = in.value<std::array<double, 4>>("attachment");
    a.others = in.value<std::int32_t>("attachment");
    a.broken = in.value<std::int32_t>("attachment");
    for (double* x : {&a.def.stiffness_n_m, &a.def.max_force_n}) *x = in.value<double>("attachment");
    for (Vec3* v : {&a.anchor, &a.force}) {
        const auto xyz = in.value<std::array<double, 3>>("attachment");
        *v = Vec3(xyz[0], xyz[1], xyz[2]);
    }
    const auto wrong = [] { throw Error(ErrorCode::corrupt_snapshot, "snapshot", "an attachment does not fit the bodies and colliders of this world"); };
    const auto fits = [&](BodyId id, const std::array<std::int32_t, 4>& vertices, std::int32_t corners) {
        const bool lives = std::any_of(world.order.begin(), world.order.end(), [&](std::uint32_t slot) { return id == BodyId{slot, world.slots[slot].generation}; });
        if (!lives || corners < 1 || corners > 4) return false;
        const std::size_t n = vertices_of(bodies, id);
        return std::all_of(vertices.begin(), vertices.begin() + corners, [&](std::int32_t v) { return v >= 0 && std::size_t(v) < n; });
    };
    if (!fits(a.def.body, a.def.vertices, a.corners) || (a.def.other && !fits(a.def.other, a.def.other_vertices, a.others))) wrong();
    if (a.def.collider && (a.def.collider.index >= world.colliders.size() || world.colliders[a.def.collider.index].generation != a.def.collider.generation)) wrong();
    return a;
}

}  // namespace

std::vector<std::byte> World::save() const {
    const Impl& w = *impl_;
    ByteWriter out;
    out.value(kMagic);
    out.value(kVersion);
    out.value(std::uint32_t(w.def.solver.precision));
    out.value(w.def.time_step_s);
    out.value(std::array{w.def.gravity_m_s2[0], w.def.gravity_m_s2[1], w.def.gravity_m_s2[2]});
    out.value(w.step);
    out.value(w.accumulator_s);
    out.value(w.next_drag_generation);
    out.value(std::uint64_t(w.order.size()));
    for (const std::uint32_t slot : w.order) {
        out.value(slot);
        out.value(w.slots[slot].generation);
        write_edits(out, *w.slots[slot].body);
        out.value(layout_hash(*w.slots[slot].body));
        BodyState::for_each_field(w.slots[slot].body->state, [&](const char*, const auto& field) { out.array(field); });
        write_inherited(out, *w.slots[slot].body);
    }
    out.value(std::uint64_t(w.drags.size()));
    for (const Drag& drag : w.drags) write(out, drag);
    out.value(w.next_collider_generation);
    out.value(std::uint64_t(w.colliders.size()));
    for (const Collider& collider : w.colliders) {
        out.value(collider.generation);
        if (collider.generation != 0) out.value(collider.moving());
    }
    out.value(w.next_attachment_generation);
    out.value(std::uint64_t(w.attachments.size()));
    for (const Attachment& attachment : w.attachments) write(out, attachment);
    std::vector<std::byte> bytes = out.take();
    ByteWriter seal;
    seal.value(checksum(bytes));
    const std::vector<std::byte> end = seal.take();
    bytes.insert(bytes.end(), end.begin(), end.end());
    return bytes;
}

void World::restore(std::span<const std::byte> snapshot) {
    Impl& w = *impl_;
    const auto differs = [](const std::string& message) { throw Error(ErrorCode::corrupt_snapshot, "snapshot", message); };
    if (snapshot.size() < sizeof(std::uint64_t)) differs("truncated in its header");
    const std::span<const std::byte> contents = snapshot.first(snapshot.size() - sizeof(std::uint64_t));
    ByteReader in(contents);
    if (in.value<std::uint64_t>("header") != kMagic) differs("this is not a Supple snapshot");
    if (const auto version = in.value<std::uint32_t>("header"); version != kVersion) {
        differs("written by format version " + std::to_string(version) + ", this build reads " + std::to_string(kVersion));
    }
    if (in.value<std::uint32_t>("header") != std::uint32_t(w.def.solver.precision)) differs("it was saved with the other solver precision");
    if (const double h = in.value<double>("header"); h != w.def.time_step_s) {
        differs("time_step_s " + to_text(h) + " differs from this world's " + to_text(w.def.time_step_s));
    }
    const auto gravity = in.value<std::array<double, 3>>("header");
    const auto step = in.value<std::uint64_t>("header");
    const auto accumulator = in.value<double>("header");
    const auto next_drag = in.value<std::uint32_t>("header");
    if (const auto count = in.value<std::uint64_t>("header"); count != w.order.size()) {
        differs("it holds " + std::to_string(count) + " bodies, this world has " + std::to_string(w.order.size()));
    }
    ByteReader seal(snapshot.last(sizeof(std::uint64_t)));
    const bool sealed = seal.value<std::uint64_t>("checksum") == checksum(contents);
    // Everything is read into copies first: a bad snapshot leaves the world as it was.
    std::vector<BodyState> states;
    std::vector<Inherited> inherited;
    std::vector<std::unique_ptr<Body>> edited;  ///< bodies of other edits than those here; null: as here
    for (const std::uint32_t slot : w.order) {
        const auto index = in.value<std::uint32_t>("body id");
        const auto generation = in.value<std::uint32_t>("body id");
        if (index != slot || generation != w.slots[slot].generation) differs("the ids of its bodies differ: build the world by the same calls in the same order");
        edited.push_back(read_edits(in, sealed, *w.slots[slot].body, w.def, w.isa));
        const Body& body = edited.back() ? *edited.back() : *w.slots[slot].body;
        const auto layout = in.value<std::uint64_t>("layout");
        states.push_back(body.start);
        BodyState::for_each_field(states.back(), [&](const char* what, auto& field) {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(field)>, std::vector<ContactMemory>>) {
                field = in.list<ContactMemory>(kMostContacts, what);
            } else {
                in.array(field, what);
            }
        });
        check_contacts(states.back().contacts, body);
        if (!sealed && states.back().solver[kMemoryInherited] != 0) differs("its bytes were changed after it was saved");
        inherited.emplace_back();
        read_inherited(in, states.back(), body, w.isa, inherited.back());
        if (layout != layout_hash(body)) {
            differs("the elements of \"" + body.name + "\" are grouped into other laws: set the materials it had when it was saved first");
        }
    }
    BodySizes bodies;
    for (std::size_t i = 0; i < w.order.size(); ++i) {
        const Body& body = edited[i] ? *edited[i] : *w.slots[w.order[i]].body;
        bodies.push_back({BodyId{w.order[i], w.slots[w.order[i]].generation}, body.vertices()});
    }
    const auto drag_count = in.value<std::uint64_t>("drags");
    std::vector<Drag> drags;
    for (std::uint64_t i = 0; i < drag_count; ++i) drags.push_back(read_drag(in, w, bodies));
    const auto next_collider = in.value<std::uint32_t>("colliders");
    if (const auto count = in.value<std::uint64_t>("colliders"); count != w.colliders.size()) {
        differs("it holds " + std::to_string(count) + " places for colliders, this world has " + std::to_string(w.colliders.size()));
    }
    std::vector<Collider::Moving> colliders(w.colliders.size());
    for (std::size_t i = 0; i < colliders.size(); ++i) {
        if (in.value<std::uint32_t>("collider id") != w.colliders[i].generation) differs("the ids of its colliders differ: build the world by the same calls in the same order");
        if (w.colliders[i].generation != 0) colliders[i] = in.value<Collider::Moving>("collider");
    }
    const auto next_attachment = in.value<std::uint32_t>("attachments");
    std::vector<Attachment> attachments;
    const auto attachment_count = in.value<std::uint64_t>("attachments");
    for (std::uint64_t i = 0; i < attachment_count; ++i) attachments.push_back(read_attachment(in, w, bodies));
    if (!in.at_end()) differs("it is longer than its contents");
    if (!sealed) differs("its bytes were changed after it was saved");

    w.def.gravity_m_s2 = Vec3(gravity[0], gravity[1], gravity[2]);
    w.step = step;
    w.accumulator_s = accumulator;
    w.next_drag_generation = std::max(w.next_drag_generation, next_drag);  // no handle given out since the save may come to life again
    for (std::size_t i = 0; i < states.size(); ++i) {
        if (edited[i]) replace_body(w, {w.order[i], w.slots[w.order[i]].generation}, std::move(edited[i]));
        Body& body = *w.slots[w.order[i]].body;
        restart_preconditioner(body, states[i]);
        std::swap(body.state, states[i]);
        take_inherited(body, std::move(inherited[i]));
        body.supports_changed = true;
        body.stress.valid = false;
    }
    w.drags = std::move(drags);
    w.scratch.appended.reserve(w.drags.size());
    w.next_collider_generation = std::max(w.next_collider_generation, next_collider);
    for (std::size_t i = 0; i < colliders.size(); ++i) {
        if (w.colliders[i].generation != 0) w.colliders[i].set_moving(colliders[i]);
    }
    w.contact_report.clear();
    w.next_attachment_generation = std::max(w.next_attachment_generation, next_attachment);
    w.attachments = std::move(attachments);
    w.living_attachments = std::size_t(std::count_if(w.attachments.begin(), w.attachments.end(), [](const Attachment& a) { return a.generation != 0; }));
}

void World::reset() {
    Impl& w = *impl_;
    w.step = 0;
    w.accumulator_s = 0;
    w.drags.clear();
    for (Collider& collider : w.colliders) collider.start_at(0);
    w.attachments.clear();
    w.living_attachments = 0;
    w.contact_report.clear();
    for (const std::uint32_t slot : w.order) {
        Body& body = *w.slots[slot].body;
        drop_preconditioner(body);
        body.state = body.start;
        body.supports_changed = true;
        supports_have_changed(body);
        body.stress.valid = false;
    }
}

}  // namespace supple
