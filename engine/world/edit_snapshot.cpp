// The edits of a body in a snapshot: its mesh as it is, and what each vertex and element is of the mesh that it was added with. From these and the body as a host builds it, the edited
// body follows by make_edited(), in one go instead of edit by edit; what is given in numbers (rest positions, shares of nodal loads) is stored, since sums in another
// order would differ in their last bits.
#include <algorithm>
#include <cmath>

#include "supple/world/edits.h"

namespace supple {

namespace {

[[noreturn]] void wrong(const std::string& message) { throw Error(ErrorCode::corrupt_snapshot, "snapshot", message); }

constexpr std::size_t kMost = std::size_t(1) << 28;

bool all_in(const std::vector<std::int32_t>& values, std::int64_t low, std::size_t end) {
    return std::all_of(values.begin(), values.end(), [&](std::int32_t v) { return v >= low && v < std::int64_t(end); });
}

template <class Element>
bool corners_in(const std::vector<Element>& elements, std::size_t vertices) {
    return std::all_of(elements.begin(), elements.end(), [&](const Element& e) { return std::all_of(e.begin(), e.end(), [&](std::int32_t v) { return v >= 0 && std::size_t(v) < vertices; }); });
}

/// As the host built it, with the supports of now where they are on vertices that still are.
std::unique_ptr<Body> origin_of(const Body& body, const WorldDef& world, Isa isa) {
    const BodyModel& model = *body.edits->origin;
    auto made = make_body(model.def, world, 0, isa);
    made->name = body.name;
    made->owner = model.owner;
    const std::vector<std::int32_t>& to_new = body.edits->identity.from_origin.vertex_to_new;
    for (std::size_t v = 0; v < to_new.size(); ++v)
        for (std::size_t c = 0; c < 3 && to_new[v] >= 0; ++c) made->owner[3 * v + c] = body.owner[3 * std::size_t(to_new[v]) + c];
    made->motions = body.motions;
    made->loads = model.loads;
    made->start = made->state;
    made->supports_changed = true;
    return made;
}

}  // namespace

void write_edits(ByteWriter& out, const Body& body) {
    const bool is_edited = body.edits != nullptr && !body.edits->identity.from_origin.is_identity();
    out.value(std::uint64_t(is_edited ? body.edits->count : 0));
    if (!is_edited) return;
    const EditIdentity& is = body.edits->identity;
    out.value(is.next_vertex_id);
    out.value(is.next_element_id);
    out.array(is.vertex_id);
    out.array(is.element_id);
    const VolumeMesh& mesh = body.data().mesh;
    out.array(mesh.vertices);
    out.array(mesh.tets);
    out.array(mesh.hexes);
    out.array(is.from_origin.vertex_to_new);
    out.array(is.from_origin.vertex_parents);
    out.array(is.from_origin.element_to_new);
    out.array(is.from_origin.element_parent);
    out.array(is.from_origin.element_share);
    out.array(body.start.x);
    out.value(std::uint64_t(body.loads.dead().size()));
    for (const DeadLoad& load : body.loads.dead()) {
        out.array(load.vertex);
        out.array(load.weight);
    }
}

std::unique_ptr<Body> read_edits(ByteReader& in, bool sealed, const Body& body, const WorldDef& world, Isa isa) {
    const bool has_origin = body.edits != nullptr && body.edits->origin != nullptr;
    const bool is_edited = has_origin && !body.edits->identity.from_origin.is_identity();
    const auto count = in.value<std::uint64_t>("edits");
    if (count == 0) {
        if (!is_edited) return nullptr;
        auto made = origin_of(body, world, isa);
        made->edits = std::make_unique<BodyEdits>();
        made->edits->origin = body.edits->origin;
        made->edits->identity = unedited(*made);
        made->edits->count = body.edits->count + 1;
        return made;
    }
    EditIdentity is;
    is.next_vertex_id = in.value<std::uint32_t>("edits");
    is.next_element_id = in.value<std::uint32_t>("edits");
    is.vertex_id = in.list<std::uint32_t>(kMost, "edits");
    is.element_id = in.list<std::uint32_t>(kMost, "edits");
    MeshEdit edit;
    edit.mesh.vertices = in.list<Vec3>(kMost, "edits");
    edit.mesh.tets = in.list<Tet>(kMost, "edits");
    edit.mesh.hexes = in.list<Hex>(kMost, "edits");
    TopologyDelta& d = edit.delta;
    d.vertex_to_new = in.list<std::int32_t>(kMost, "edits");
    d.vertex_parents = in.list<VertexParents>(kMost, "edits");
    d.element_to_new = in.list<std::int32_t>(kMost, "edits");
    d.element_parent = in.list<std::int32_t>(kMost, "edits");
    d.element_share = in.list<double>(kMost, "edits");
    std::vector<Vec3> start = in.list<Vec3>(kMost, "edits");
    std::vector<DeadLoad> nodal(in.value<std::uint64_t>("edits") % (kMost + 1));
    for (DeadLoad& load : nodal) {
        load.vertex = in.list<std::int32_t>(kMost, "edits");
        load.weight = in.list<double>(kMost, "edits");
    }

    const VolumeMesh& host = has_origin ? body.edits->origin->def.shape->mesh() : body.data().mesh;
    const std::size_t vertices = edit.mesh.vertices.size(), elements = edit.mesh.element_count();
    const bool parents_good = std::all_of(d.vertex_parents.begin(), d.vertex_parents.end(), [&](const VertexParents& p) {
        return p.vertex[0] >= 0 && all_in({p.vertex.begin(), p.vertex.end()}, -1, host.vertices.size());
    });
    const auto finite = [](const Vec3& x) { return x.allFinite(); };
    if (d.vertex_to_new.size() != host.vertices.size() || d.element_to_new.size() != host.element_count())
        wrong("\"" + body.name + "\" was another mesh before its edits: restore into a world built by the same calls");
    if (elements == 0 || is.vertex_id.size() != vertices || is.element_id.size() != elements || d.vertex_parents.size() != vertices || d.element_parent.size() != elements ||
        d.element_share.size() != elements || start.size() != vertices || !parents_good || !all_in(d.vertex_to_new, -1, vertices) || !all_in(d.element_to_new, -1, elements) ||
        !all_in(d.element_parent, 0, host.element_count()) || !corners_in(edit.mesh.tets, vertices) || !corners_in(edit.mesh.hexes, vertices) ||
        !std::all_of(edit.mesh.vertices.begin(), edit.mesh.vertices.end(), finite) || !std::all_of(start.begin(), start.end(), finite)) {
        wrong("the edits of \"" + body.name + "\" do not fit its mesh");
    }
    for (std::size_t e = 0; e < elements; ++e)
        if ((e < edit.mesh.tets.size()) != (std::size_t(d.element_parent[e]) < host.tets.size())) wrong("the edits of \"" + body.name + "\" do not fit its mesh");
    const bool same = is_edited && body.edits->identity.vertex_id == is.vertex_id && body.edits->identity.element_id == is.element_id &&
                      body.data().mesh.vertices == edit.mesh.vertices && body.data().mesh.tets == edit.mesh.tets && body.data().mesh.hexes == edit.mesh.hexes;
    if (same) return nullptr;
    if (!sealed) wrong("its bytes were changed after it was saved");

    const std::unique_ptr<Body> origin = has_origin ? origin_of(body, world, isa) : nullptr;
    const Body& from = origin ? *origin : body;
    edit.mesh.source = host.source;
    edit.mesh.regions = host.regions;
    for (const std::int32_t e : d.element_parent) {
        if (!host.element_region.empty()) edit.mesh.element_region.push_back(host.element_region[std::size_t(e)]);
        if (!host.fill.empty()) edit.mesh.fill.push_back(host.fill[std::size_t(e)]);
    }
    for (const VertexGroup& group : host.groups) {
        std::vector<char> chosen(host.vertices.size(), 0);
        for (const std::int32_t v : group.vertices) chosen[std::size_t(v)] = 1;
        VertexGroup kept{group.name, {}};
        for (std::size_t v = 0; v < vertices; ++v) {
            const VertexParents& p = d.vertex_parents[v];
            bool all = true;
            for (std::size_t k = 0; k < 4 && p.vertex[k] >= 0; ++k) all = all && chosen[std::size_t(p.vertex[k])] != 0;
            if (all) kept.vertices.push_back(std::int32_t(v));
        }
        edit.mesh.groups.push_back(std::move(kept));
    }
    auto made = make_edited(from, edit, world, isa);
    made->start.x = std::move(start);
    for (std::size_t i = 0; i < std::min(nodal.size(), made->loads.dead().size()); ++i) {
        if (nodal[i].vertex != made->loads.dead()[i].vertex || nodal[i].weight.size() != nodal[i].vertex.size()) continue;  // not the loads of then
        made->loads.dead()[i].weight = nodal[i].weight;
    }
    made->edits = std::make_unique<BodyEdits>();
    made->edits->origin = has_origin ? body.edits->origin : std::make_shared<const BodyModel>(model_of(body));
    made->edits->identity = std::move(is);
    made->edits->identity.from_origin = d;
    made->edits->count = std::max(count, has_origin ? body.edits->count + 1 : count);
    return made;
}

}  // namespace supple
