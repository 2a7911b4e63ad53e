#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "supple/math/polar.h"
#include "supple/world/body_materials.h"
#include "supple/world/edits.h"
#include "supple/world/precondition.h"

namespace supple {

Body::Body() = default;
Body::~Body() = default;

BodyModel model_of(const Body& body) { return {body.def, body.owner, body.motions, body.loads}; }

EditIdentity unedited(const Body& body) {
    EditIdentity is;
    is.vertex_id.resize(body.vertices());
    is.element_id.resize(body.element_count());
    std::iota(is.vertex_id.begin(), is.vertex_id.end(), 0u);
    std::iota(is.element_id.begin(), is.element_id.end(), 0u);
    is.next_vertex_id = std::uint32_t(is.vertex_id.size());
    is.next_element_id = std::uint32_t(is.element_id.size());
    is.from_origin = identity_delta(body.data().mesh);
    return is;
}

namespace {

EditIdentity after(const EditIdentity& before, const TopologyDelta& delta) {
    EditIdentity is = before;
    const auto follow = [](std::vector<std::uint32_t>& ids, const std::vector<std::int32_t>& to_new, std::size_t count, std::uint32_t& next) {
        std::vector<std::uint32_t> now(count);
        std::vector<char> kept(count, 0);
        for (std::size_t i = 0; i < to_new.size(); ++i) {
            if (to_new[i] < 0 || kept[std::size_t(to_new[i])] != 0) continue;  // of merged ones the first
            now[std::size_t(to_new[i])] = ids[i];
            kept[std::size_t(to_new[i])] = 1;
        }
        for (std::size_t i = 0; i < count; ++i)
            if (!kept[i]) now[i] = next++;
        ids = std::move(now);
    };
    follow(is.vertex_id, delta.vertex_to_new, delta.vertex_parents.size(), is.next_vertex_id);
    follow(is.element_id, delta.element_to_new, delta.element_parent.size(), is.next_element_id);
    is.from_origin = compose(before.from_origin, delta);
    return is;
}

/// The way back, vertex by vertex: copies to what they are copies of, points of a cut to the nearer end. What comes back has no parents.
TopologyDelta turned_back(const TopologyDelta& delta) {
    TopologyDelta back;
    back.vertex_parents.resize(delta.vertex_to_new.size());
    for (std::size_t v = 0; v < delta.vertex_to_new.size(); ++v)
        if (delta.vertex_to_new[v] >= 0) back.vertex_parents[v] = {{delta.vertex_to_new[v], -1, -1, -1}, {1, 0, 0, 0}};
    back.element_to_new = delta.element_parent;
    back.element_parent = delta.element_to_new;
    for (const VertexParents& p : delta.vertex_parents) {
        const auto most = std::max_element(p.weight.begin(), p.weight.end()) - p.weight.begin();
        back.vertex_to_new.push_back(p.vertex[std::size_t(most)]);
    }
    return back;
}

TopologyDelta apply(World::Impl& w, BodyId id, MeshEdit edit) {
    Body& from = w.body(id);
    if (edit.delta.is_identity()) return std::move(edit.delta);
    ready_for_edit(w, from);
    auto body = make_edited(from, edit, w.def, w.isa);
    conserve_spin(from, *body, edit.delta);
    auto edits = std::make_unique<BodyEdits>();
    const EditIdentity before = from.edits ? from.edits->identity : unedited(from);
    edits->origin = from.edits && from.edits->origin ? from.edits->origin : std::make_shared<const BodyModel>(model_of(from));
    edits->identity = after(before, edit.delta);
    edits->count = (from.edits ? from.edits->count : 0) + 1;
    BodyEdits::Step step{model_of(from), from.state, from.start, before, edit.delta};
    // Nothing throws for want of sense from here on.
    if (from.edits) edits->undo = std::move(from.edits->undo);
    edits->undo.push_back(std::move(step));
    if (edits->undo.size() > kUndoDepth) edits->undo.pop_front();
    body->edits = std::move(edits);
    const std::vector<Vec3> x_before = from.state.x;
    inherit_preconditioner(from, *body, edit.delta, w.isa);
    replace_body(w, id, std::move(body));
    move_touch(w, id, edit.delta, x_before);
    return std::move(edit.delta);
}

std::vector<Piece> pieces_of(const Body& body) {
    const VolumeMesh& mesh = body.data().mesh;
    const Pieces found = find_pieces(mesh);
    const std::vector<double> density = resolve_materials(body.def, mesh).density_kg_m3;
    std::vector<Piece> out(found.volume_m3.size());
    for (std::size_t e = 0; e < found.of_element.size(); ++e) {
        Piece& piece = out[std::size_t(found.of_element[e])];
        piece.elements.push_back(std::int32_t(e));
        piece.volume_m3 += body.layout().volume[e];
        piece.mass_kg += body.layout().volume[e] * (density.size() == 1 ? density[0] : density[e]);
        for (const std::int32_t v : element_vertices(mesh, e))
            for (std::size_t c = 0; c < 3; ++c) piece.supported = piece.supported || body.is_held(std::size_t(v), c);
    }
    return out;
}

std::size_t largest(const std::vector<Piece>& pieces) {
    return std::size_t(std::max_element(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.volume_m3 < b.volume_m3; }) - pieces.begin());
}

template <class Touch>
double weight_kept(const Touch& vertices, std::size_t count, const TopologyDelta& delta, const auto& weight) {
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i)
        if (delta.vertex_to_new[std::size_t(vertices[i])] >= 0) sum += std::abs(weight[i]);
    return sum;
}

/// The vertices that are left of a point's, at most four; false, and the point is a vertex of no account, if that are none.
bool follow_point(const TopologyDelta& delta, std::array<std::int32_t, 4>& vertices, std::array<double, 4>& weights, std::int32_t& corners) {
    double sum = 0;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < std::size_t(corners); ++i) {
        const std::int32_t now = delta.vertex_to_new[std::size_t(vertices[i])];
        if (now < 0) continue;
        sum += weights[i];
        const auto twice = std::size_t(std::find(vertices.begin(), vertices.begin() + std::ptrdiff_t(kept), now) - vertices.begin());
        if (twice < kept) {  // merged
            weights[twice] += weights[i];
            continue;
        }
        vertices[kept] = now;
        weights[kept++] = weights[i];
    }
    for (std::size_t i = kept; i < 4; ++i) {
        vertices[i] = -1;
        weights[i] = 0;
    }
    corners = std::int32_t(std::max<std::size_t>(kept, 1));
    if (kept == 0 || !(std::abs(sum) > 1e-9)) {
        corners = 1;
        vertices = {0, -1, -1, -1};
        weights = {1, 0, 0, 0};
        return false;
    }
    for (double& weight : weights) weight /= sum;
    return true;
}

}  // namespace

void replace_body(World::Impl& w, BodyId id, std::unique_ptr<Body> body) {
    const auto busy = [](Body& b) {
        bool is = false;
        with_system(b, [&](auto& system) { is = system.next && system.next->thread && !system.next->thread->done(); });
        return is;
    };
    std::erase_if(w.retired, [&](const std::unique_ptr<Body>& b) { return !busy(*b); });
    std::unique_ptr<Body>& place = w.slots[id.index].body;
    std::swap(place, body);
    need_crew(w);
    give_contact_surfaces(w);
    if (busy(*body)) w.retired.push_back(std::move(body));  // its thread looks at it; nobody waits
    std::erase_if(w.contact_report, [&](const ContactPoint& c) { return c.body == id || c.other == id; });
}

void move_touch(World::Impl& w, BodyId id, const TopologyDelta& delta, const std::vector<Vec3>& x_before) {
    const Body& body = w.body(id);
    for (Drag& drag : w.drags) {
        if (drag.generation == 0 || drag.body != id) continue;
        const Vec3 anchor = drag.mean(x_before) + drag.offset;
        double sum = 0;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < drag.vertex.size(); ++i) {
            const std::int32_t now = delta.vertex_to_new[std::size_t(drag.vertex[i])];
            if (now < 0) continue;
            sum += drag.weight[i];
            if (const auto twice = std::find(drag.vertex.begin(), drag.vertex.begin() + std::ptrdiff_t(kept), now); twice != drag.vertex.begin() + std::ptrdiff_t(kept)) {
                drag.weight[std::size_t(twice - drag.vertex.begin())] += drag.weight[i];  // merged
                continue;
            }
            drag.vertex[kept] = now;
            drag.weight[kept++] = drag.weight[i];
        }
        drag.vertex.resize(kept);
        drag.weight.resize(kept);
        drag.masked.assign(kept, Vec3::Zero());
        if (!(sum > 0)) {
            drag.generation = 0;
            continue;
        }
        for (double& weight : drag.weight) weight /= sum;
        drag.offset = anchor - drag.mean(body.state.x);
    }
    for (Attachment& a : w.attachments) {
        if (a.generation == 0) continue;
        const auto break_it = [&] {  // the handle stays good and says that it broke
            a.broken = 1;
            a.force = Vec3::Zero();
        };
        if (a.def.other == id && !follow_point(delta, a.def.other_vertices, a.def.other_weights, a.others)) break_it();
        if (a.def.body != id) continue;
        const Vec3 point = a.mean(x_before);
        const auto had = std::size_t(a.corners);
        if (!follow_point(delta, a.def.vertices, a.def.weights, a.corners)) {
            break_it();
            continue;
        }
        const auto kept = std::size_t(a.corners);
        Vec3 shift = a.mean(body.state.x) - point;  // what is left is tied as far from its place as the whole was
        if (a.def.collider) shift = rotation_matrix(w.collider(a.def.collider).pose.rotation_wxyz).transpose() * shift;
        if (!a.def.other && kept < had && shift.squaredNorm() > 0) a.anchor += shift;
    }
}

TopologyDelta World::remove_elements(BodyId id, std::span<const std::int32_t> elements) {
    return apply(*impl_, id, supple::remove_elements(impl_->body(id).data().mesh, elements));
}

TopologyDelta World::tear(BodyId id, std::span<const ElementFace> faces) { return apply(*impl_, id, separate_faces(impl_->body(id).data().mesh, faces)); }

TopologyDelta World::cut(BodyId id, const mesh::TriangleMesh& blade, const CutDef& def, CutReport* report) {
    const Body& body = impl_->body(id);
    return apply(*impl_, id, supple::cut(body.data().mesh, body.state.x, blade, def, report));
}

TopologyDelta World::heal(BodyId id, const HealDef& def, HealReport* report) {
    const Body& body = impl_->body(id);
    std::vector<double> weight = body.mass;
    for (std::size_t v = 0; v < weight.size(); ++v)
        if (body.is_held(v, 0) || body.is_held(v, 1) || body.is_held(v, 2)) weight[v] = std::numeric_limits<double>::infinity();  // a support does not give way
    return apply(*impl_, id, supple::heal(body.data().mesh, body.state.x, weight, def, report));
}

TopologyDelta World::add_elements(BodyId id, const AddedElements& added) { return apply(*impl_, id, supple::add_elements(impl_->body(id).data().mesh, added)); }

bool World::undo_edit(BodyId id) {
    Impl& w = *impl_;
    Body& from = w.body(id);
    if (!from.edits || from.edits->undo.empty()) return false;
    const BodyEdits::Step& step = from.edits->undo.back();
    ready_for_edit(w, from);
    auto body = make_body(step.model.def, w.def, 0, w.isa);
    body->name = from.name;
    body->owner = step.model.owner;
    body->motions = step.model.motions;
    body->loads = step.model.loads;
    body->state = step.state;
    body->start = step.start;
    begin_after_edit(*body, step.state.solver);
    body->supports_changed = true;
    auto edits = std::make_unique<BodyEdits>();
    edits->origin = from.edits->origin;
    edits->identity = step.identity;
    edits->count = from.edits->count + 1;
    const TopologyDelta back = turned_back(step.delta);
    edits->undo = std::move(from.edits->undo);
    edits->undo.pop_back();
    body->edits = std::move(edits);
    const std::vector<Vec3> x_before = from.state.x;
    inherit_preconditioner(from, *body, back, w.isa);
    replace_body(w, id, std::move(body));
    move_touch(w, id, back, x_before);
    return true;
}

std::uint64_t World::edit_count(BodyId id) const {
    const Body& body = impl_->body(id);
    return body.edits ? body.edits->count : 0;
}

std::vector<char> World::inner_boundary(BodyId id) const {
    const Body& body = impl_->body(id);
    if (!body.edits) return {};
    const std::vector<std::int32_t> parent = boundary_parents(body.edits->origin->def.shape->mesh(), {body.data().mesh, body.edits->identity.from_origin});
    std::vector<char> out(parent.size());
    std::transform(parent.begin(), parent.end(), out.begin(), [](std::int32_t t) { return char(t < 0); });
    return out;
}

std::vector<std::uint32_t> World::vertex_ids(BodyId id) const {
    const Body& body = impl_->body(id);
    return body.edits ? body.edits->identity.vertex_id : unedited(body).vertex_id;
}

std::vector<std::uint32_t> World::element_ids(BodyId id) const {
    const Body& body = impl_->body(id);
    return body.edits ? body.edits->identity.element_id : unedited(body).element_id;
}

std::vector<Piece> World::pieces(BodyId id) const { return pieces_of(impl_->body(id)); }

TopologyDelta World::remove_pieces(BodyId id, double below_m3) {
    require_in_range(below_m3, 0, 1e30, "World::remove_pieces", "a rest volume [m^3]");
    const std::vector<Piece> all = pieces(id);
    std::vector<std::int32_t> gone;
    for (std::size_t p = 0; p < all.size(); ++p)
        if (p != largest(all) && all[p].volume_m3 < below_m3) gone.insert(gone.end(), all[p].elements.begin(), all[p].elements.end());
    return remove_elements(id, gone);
}

std::vector<BodyId> World::split_off_pieces(BodyId id) {
    Impl& w = *impl_;
    const std::vector<Piece> all = pieces(id);
    const bool any_supported = std::any_of(all.begin(), all.end(), [](const Piece& p) { return p.supported; });
    std::vector<std::int32_t> leaving;
    std::vector<BodyId> out;
    for (std::size_t p = 0; p < all.size(); ++p) {
        if (all.size() == 1 || (any_supported ? all[p].supported : p == largest(all))) continue;
        const Body& from = w.body(id);
        std::vector<std::int32_t> others;
        for (std::size_t q = 0; q < all.size(); ++q)
            if (q != p) others.insert(others.end(), all[q].elements.begin(), all[q].elements.end());
        const MeshEdit edit = supple::remove_elements(from.data().mesh, others);
        auto body = make_edited(from, edit, w.def, w.isa);
        body->name = from.name + ", piece " + std::to_string(p);
        leaving.insert(leaving.end(), all[p].elements.begin(), all[p].elements.end());
        std::uint32_t slot = 0;
        while (slot < w.slots.size() && w.slots[slot].body) ++slot;
        if (slot == w.slots.size()) w.slots.emplace_back();
        const std::vector<Vec3> x_before = from.state.x;
        w.slots[slot].body = std::move(body);
        w.order.push_back(slot);
        need_crew(w);
        out.push_back({slot, w.slots[slot].generation});
        for (Drag& drag : w.drags)
            if (drag.generation != 0 && drag.body == id && weight_kept(drag.vertex, drag.vertex.size(), edit.delta, drag.weight) > 0.5) drag.body = out.back();
        for (Attachment& a : w.attachments) {
            if (a.generation == 0) continue;
            if (a.def.body == id && weight_kept(a.def.vertices, std::size_t(a.corners), edit.delta, a.def.weights) > 0.5) a.def.body = out.back();
            if (a.def.other == id && weight_kept(a.def.other_vertices, std::size_t(a.others), edit.delta, a.def.other_weights) > 0.5) a.def.other = out.back();
        }
        move_touch(w, out.back(), edit.delta, x_before);
    }
    if (!leaving.empty()) remove_elements(id, leaving);
    give_contact_surfaces(w);
    return out;
}

}  // namespace supple
