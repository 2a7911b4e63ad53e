#include <algorithm>

#include "supple/base/byte_stream.h"
#include "supple/base/hash.h"
#include "supple/world/impl.h"
#include "supple/world/precondition.h"

namespace supple {

namespace {

constexpr std::uint64_t kMagic = 0x31504e53504c5053ULL;  // "SPLPSNP1", little-endian
constexpr std::uint32_t kVersion = 4;

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

Drag read_drag(ByteReader& in, const World::Impl& world) {
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
    const Body& body = world.body(drag.body);
    drag.vertex = in.list<std::int32_t>(body.vertices(), "drag patch");
    drag.weight = in.list<double>(body.vertices(), "drag patch");
    const bool inside = std::all_of(drag.vertex.begin(), drag.vertex.end(), [&](std::int32_t v) { return v >= 0 && std::size_t(v) < body.vertices(); });
    if (!inside || drag.vertex.size() != drag.weight.size()) throw Error(ErrorCode::corrupt_snapshot, "snapshot", "a drag's patch does not fit its body");
    drag.masked.resize(drag.vertex.size());
    return drag;
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
        out.value(layout_hash(*w.slots[slot].body));
        BodyState::for_each_field(w.slots[slot].body->state, [&](const char*, const auto& field) { out.array(field); });
    }
    out.value(std::uint64_t(w.drags.size()));
    for (const Drag& drag : w.drags) write(out, drag);
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
    // Everything is read into copies first: a bad snapshot leaves the world as it was.
    std::vector<BodyState> states;
    for (const std::uint32_t slot : w.order) {
        const auto index = in.value<std::uint32_t>("body id");
        const auto generation = in.value<std::uint32_t>("body id");
        if (index != slot || generation != w.slots[slot].generation) differs("the ids of its bodies differ: build the world by the same calls in the same order");
        const auto layout = in.value<std::uint64_t>("layout");
        states.push_back(w.slots[slot].body->start);
        BodyState::for_each_field(states.back(), [&](const char* what, auto& field) { in.array(field, what); });
        if (layout != layout_hash(*w.slots[slot].body)) {
            differs("the elements of \"" + w.slots[slot].body->name + "\" are grouped into other laws: set the materials it had when it was saved first");
        }
    }
    const auto drag_count = in.value<std::uint64_t>("drags");
    std::vector<Drag> drags;
    for (std::uint64_t i = 0; i < drag_count; ++i) drags.push_back(read_drag(in, w));
    if (!in.at_end()) differs("it is longer than its contents");
    ByteReader seal(snapshot.last(sizeof(std::uint64_t)));
    if (seal.value<std::uint64_t>("checksum") != checksum(contents)) differs("its bytes were changed after it was saved");

    w.def.gravity_m_s2 = Vec3(gravity[0], gravity[1], gravity[2]);
    w.step = step;
    w.accumulator_s = accumulator;
    w.next_drag_generation = std::max(w.next_drag_generation, next_drag);  // no handle given out since the save may come to life again
    for (std::size_t i = 0; i < states.size(); ++i) {
        Body& body = *w.slots[w.order[i]].body;
        restart_preconditioner(body, states[i]);
        std::swap(body.state, states[i]);
        body.supports_changed = true;
        body.supports_edited = false;  // the snapshot says what its preconditioner was built from
        body.stress.valid = false;
    }
    w.drags = std::move(drags);
    w.appended.reserve(w.drags.size());
}

void World::reset() {
    Impl& w = *impl_;
    w.step = 0;
    w.accumulator_s = 0;
    w.drags.clear();
    for (const std::uint32_t slot : w.order) {
        Body& body = *w.slots[slot].body;
        drop_preconditioner(body);
        body.state = body.start;
        body.supports_changed = body.supports_edited = true;
        body.stress.valid = false;
    }
}

}  // namespace supple
