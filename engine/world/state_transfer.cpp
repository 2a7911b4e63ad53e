// What moves of a body, carried to the mesh of an edit. New vertices take the weighted means of their parents, so positions and velocities inside a cut element are the linear
// functions that they were: rest and present shape of every part, and its linear momentum (the integral of a linear velocity is that of its corners' mean) are unchanged. The angular
// momentum of lumped masses is not an integral: cutting a tet of mass m changes it. With exact integrals
//     L_exact = m/20 (sum x_a x v_a + (sum x_a) x (sum v_a)),  L_lumped = m/4 sum x_a x v_a,
// a part takes its exact integral and its share of what the tet's lumping added; each piece of the body is then turned by as much as its new lumping lacks, around the mass
// centre of the vertices of its cut parts, which changes no linear momentum.
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <tuple>

#include "supple/base/error.h"
#include "supple/world/body_materials.h"
#include "supple/world/edits.h"
#include "supple/world/precondition.h"

namespace supple {

namespace {

void mix(const std::vector<Vec3>& from, const TopologyDelta& delta, std::vector<Vec3>& to) {
    if (from.empty()) return to.clear();
    to.resize(delta.vertex_parents.size());
    for (std::size_t v = 0; v < to.size(); ++v) {
        const VertexParents& p = delta.vertex_parents[v];
        if (p.vertex[1] < 0) {  // itself: to the bit
            to[v] = from[std::size_t(p.vertex[0])];
            continue;
        }
        bool alike = true;  // merged where they were one: to the bit, too
        for (std::size_t k = 1; k < 4 && p.vertex[k] >= 0; ++k) alike = alike && from[std::size_t(p.vertex[k])] == from[std::size_t(p.vertex[0])];
        if (alike) {
            to[v] = from[std::size_t(p.vertex[0])];
            continue;
        }
        to[v] = Vec3::Zero();
        for (std::size_t k = 0; k < 4 && p.vertex[k] >= 0; ++k) to[v] += p.weight[k] * from[std::size_t(p.vertex[k])];
    }
}

/// [block][fields][lane] of every element from its parent. Free lanes of `to` stay.
void inherit(const AlignedVector<double>& from, const fem::ElementLayout& was, const TopologyDelta& delta, const fem::ElementLayout& is, std::size_t fields, AlignedVector<double>& to) {
    if (from.empty() || to.empty()) return;
    const auto place = [&](std::size_t slot, std::size_t k) { return (slot / fem::kBlock * fields + k) * fem::kBlock + slot % fem::kBlock; };
    for (std::size_t e = 0; e < delta.element_parent.size(); ++e)
        for (std::size_t k = 0; k < fields; ++k) to[place(is.slot[e], k)] = from[place(was.slot[std::size_t(delta.element_parent[e])], k)];
}

void transfer(const BodyState& from, const fem::ElementLayout& was, const TopologyDelta& delta, const fem::ElementLayout& is, BodyState& to) {
    mix(from.x, delta, to.x);
    mix(from.v, delta, to.v);
    mix(from.x_previous, delta, to.x_previous);
    mix(from.dv1, delta, to.dv1);
    mix(from.dv2, delta, to.dv2);
    mix(from.v_previous, delta, to.v_previous);
    mix(from.a, delta, to.a);
    to.moving = from.moving;
    to.frozen = from.frozen;
    for (std::size_t v = 0; v < delta.vertex_to_new.size(); ++v)  // a force, not a field: copies have none
        if (delta.vertex_to_new[v] >= 0) to.reaction[std::size_t(delta.vertex_to_new[v])] += from.reaction[v];
    inherit(from.quaternion, was, delta, is, 4, to.quaternion);
    inherit(from.plastic, was, delta, is, 6, to.plastic);
    to.contacts.clear();
    for (ContactMemory c : from.contacts) {
        bool lives = c.vertex[2] >= -1;  // the edges of an edited body are others
        for (std::int32_t& v : c.vertex) {
            if (v < 0) continue;
            v = delta.vertex_to_new[std::size_t(v)];
            lives = lives && v >= 0;
        }
        if (!lives) continue;
        for (std::size_t k = 1; k < 3; ++k) {
            for (std::size_t j = k; j > 0 && c.vertex[j] >= 0 && c.vertex[j] < c.vertex[j - 1]; --j) {
                std::swap(c.vertex[j], c.vertex[j - 1]);
                std::swap(c.weight[j], c.weight[j - 1]);
            }
        }
        to.contacts.push_back(c);
    }
    std::sort(to.contacts.begin(), to.contacts.end(),
              [](const ContactMemory& a, const ContactMemory& b) { return std::tie(a.collider, a.other, a.vertex) < std::tie(b.collider, b.other, b.vertex); });
}

template <class T>
std::vector<T> of_parents(const std::vector<T>& from, const TopologyDelta& delta) {
    std::vector<T> to;
    if (from.empty()) return to;
    to.reserve(delta.element_parent.size());
    for (const std::int32_t e : delta.element_parent) to.push_back(from[std::size_t(e)]);
    return to;
}

BodyDef follow(const BodyDef& def, std::shared_ptr<const BodyTemplate> shape, const MeshEdit& edit) {
    const VolumeMesh& before = def.shape->mesh();
    BodyDef to = def;
    to.shape = std::move(shape);
    to.young_pa_per_element = of_parents(def.young_pa_per_element, edit.delta);
    to.poisson_per_element = of_parents(def.poisson_per_element, edit.delta);
    to.material_per_element = of_parents(def.material_per_element, edit.delta);
    to.stiffness_factor_per_element = of_parents(def.stiffness_factor_per_element, edit.delta);
    to.density_kg_m3_per_element = of_parents(def.density_kg_m3_per_element, edit.delta);
    to.regions.clear();
    for (const MaterialRegion& region : def.regions) {
        std::vector<char> in(before.element_count(), 0);
        for (const std::int32_t e : select_elements(before, region.where, region.rule)) in[std::size_t(e)] = 1;
        ElementList list;
        for (std::size_t e = 0; e < edit.delta.element_parent.size(); ++e)
            if (in[std::size_t(edit.delta.element_parent[e])] != 0) list.elements.push_back(std::int32_t(e));
        if (list.elements.empty()) continue;  // nothing of it is left
        to.regions.push_back(region);
        to.regions.back().where = std::move(list);
    }
    if (def.skin) to.skin = def.skin->follow(before, edit);
    return to;
}

}  // namespace

std::unique_ptr<Body> make_edited(const Body& from, const MeshEdit& edit, const WorldDef& world, Isa isa) {
    const TopologyDelta& delta = edit.delta;
    auto shape = from.shape->edited(edit);
    if (shape->mesh().element_count() != delta.element_parent.size())  // no edit of ours makes such, a snapshot's bytes may
        throw Error(ErrorCode::invalid_argument, from.name, "the edited mesh has elements that are flat or repeat a vertex");
    auto body = make_body(follow(from.def, shape, edit), world, 0, isa);
    body->name = from.name;
    body->motions = from.motions;
    for (std::size_t v = 0; v < delta.vertex_parents.size(); ++v) {
        const VertexParents& p = delta.vertex_parents[v];
        for (std::size_t c = 0; c < 3; ++c) {
            std::int32_t& owner = body->owner[v * 3 + c];
            owner = from.owner[std::size_t(p.vertex[0]) * 3 + c];
            for (std::size_t k = 1; k < 4 && p.vertex[k] >= 0; ++k) {
                const std::int32_t other = from.owner[std::size_t(p.vertex[k]) * 3 + c];
                if (other == owner) continue;
                if (!delta.is_merged(v)) owner = kFree;  // a point between
                else if (owner == kFree) owner = other;  // who is held holds
            }
        }
    }
    body->loads = from.loads.followed(from.data(), body->data(), delta, body->name);
    transfer(from.state, from.layout(), delta, body->layout(), body->state);
    transfer(from.start, from.layout(), delta, body->layout(), body->start);
    begin_after_edit(*body, from.state.solver);
    body->supports_changed = true;
    return body;
}

namespace {

/// Turns free vertices around their mass centre by as much as gives them an angular momentum: no linear momentum changes.
bool turn_by(Body& body, std::vector<std::int32_t>& ids, const Vec3& spin) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    std::erase_if(ids, [&](std::int32_t v) { return body.is_held(std::size_t(v), 0) || body.is_held(std::size_t(v), 1) || body.is_held(std::size_t(v), 2); });
    double mass = 0;
    Vec3 centre = Vec3::Zero();
    for (const std::int32_t v : ids) {
        mass += body.mass[std::size_t(v)];
        centre += body.mass[std::size_t(v)] * body.state.x[std::size_t(v)];
    }
    if (!(mass > 0)) return false;
    centre /= mass;
    Mat3 inertia = Mat3::Zero();
    for (const std::int32_t v : ids) {
        const Vec3 r = body.state.x[std::size_t(v)] - centre;
        inertia += body.mass[std::size_t(v)] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(inertia);
    if (!(axes.eigenvalues()[0] > 1e-9 * axes.eigenvalues()[2])) return false;  // on a line: no velocity turns it
    Vec3 omega = Vec3::Zero();
    for (int k = 0; k < 3; ++k) omega += axes.eigenvectors().col(k) * (axes.eigenvectors().col(k).dot(spin) / axes.eigenvalues()[k]);
    for (const std::int32_t v : ids) body.state.v[std::size_t(v)] += omega.cross(body.state.x[std::size_t(v)] - centre);
    return true;
}

/// Vertices that went into one another lose the spin of their motion around their mean: the merged ones of the piece are turned by it, or the whole piece where they lie on a line.
void conserve_merged_spin(const Body& from, Body& to, const TopologyDelta& delta) {
    std::vector<std::int32_t> merged;
    for (std::size_t v = 0; v < to.vertices(); ++v)
        if (delta.is_merged(v)) merged.push_back(std::int32_t(v));
    if (merged.empty()) return;
    const VolumeMesh& mesh = to.data().mesh;
    const Pieces pieces = find_pieces(mesh);
    std::vector<std::vector<std::int32_t>> of_piece(pieces.volume_m3.size()), all(pieces.volume_m3.size());
    std::vector<Vec3> lack(pieces.volume_m3.size(), Vec3::Zero());
    std::vector<std::int32_t> piece(to.vertices(), 0);
    for (std::size_t e = 0; e < mesh.element_count(); ++e)
        for (const std::int32_t v : element_vertices(mesh, e)) {
            piece[std::size_t(v)] = pieces.of_element[e];
            all[std::size_t(pieces.of_element[e])].push_back(v);
        }
    for (const std::int32_t v : merged) {
        const auto i = std::size_t(v);
        Vec3& missing = lack[std::size_t(piece[i])];
        of_piece[std::size_t(piece[i])].push_back(v);
        missing -= to.mass[i] * to.state.x[i].cross(to.state.v[i]);
        for (std::size_t k = 0; k < 4 && delta.vertex_parents[i].vertex[k] >= 0; ++k) {
            const auto was = std::size_t(delta.vertex_parents[i].vertex[k]);
            missing += from.mass[was] * from.state.x[was].cross(from.state.v[was]);
        }
    }
    for (std::size_t p = 0; p < lack.size(); ++p)
        if (!of_piece[p].empty() && !turn_by(to, of_piece[p], lack[p])) turn_by(to, all[p], lack[p]);
}

}  // namespace

void conserve_spin(const Body& from, Body& to, const TopologyDelta& delta) {
    conserve_merged_spin(from, to, delta);
    const std::vector<std::int32_t> cut = delta.cut_elements();
    if (cut.empty()) return;
    const VolumeMesh& before = from.data().mesh;
    const VolumeMesh& after = to.data().mesh;
    const std::vector<double> density = resolve_materials(from.def, before).density_kg_m3;
    std::vector<char> is_cut(before.element_count(), 0);
    for (const std::int32_t e : cut) is_cut[std::size_t(e)] = 1;
    struct Spin {
        Vec3 lumped = Vec3::Zero(), exact = Vec3::Zero();
    };
    const auto spin_of = [](const Tet& t, const std::vector<Vec3>& x, const std::vector<Vec3>& v, double mass) {
        Vec3 sum = Vec3::Zero(), X = Vec3::Zero(), V = Vec3::Zero();
        for (const std::int32_t i : t) {
            sum += x[std::size_t(i)].cross(v[std::size_t(i)]);
            X += x[std::size_t(i)];
            V += v[std::size_t(i)];
        }
        return Spin{mass / 4 * sum, mass / 20 * (sum + X.cross(V))};
    };
    const Pieces pieces = find_pieces(after);
    std::vector<Vec3> lack(pieces.volume_m3.size(), Vec3::Zero());
    std::vector<std::vector<std::int32_t>> vertices(pieces.volume_m3.size());
    for (std::size_t e = 0; e < after.tets.size(); ++e) {
        const auto parent = std::size_t(delta.element_parent[e]);
        if (!is_cut[parent]) continue;
        const double mass = from.layout().volume[parent] * (density.size() == 1 ? density[0] : density[parent]);
        const Spin whole = spin_of(before.tets[parent], from.state.x, from.state.v, mass);
        const Spin part = spin_of(after.tets[e], to.state.x, to.state.v, delta.element_share[e] * mass);
        const auto piece = std::size_t(pieces.of_element[e]);
        lack[piece] += part.exact + delta.element_share[e] * (whole.lumped - whole.exact) - part.lumped;
        vertices[piece].insert(vertices[piece].end(), after.tets[e].begin(), after.tets[e].end());
    }
    for (std::size_t p = 0; p < lack.size(); ++p) turn_by(to, vertices[p], lack[p]);
}

}  // namespace supple
