#include "supple/mesh/selection.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>

#include "supple/base/error.h"

namespace supple {
namespace {

using Mask = std::vector<char>;  // one per vertex

[[noreturn]] void refuse(const char* where, const std::string& message) { throw Error(ErrorCode::invalid_argument, where, message); }

using Points = std::span<const Vec3>;

void check_radius(double radius_m, const char* where) {
    if (!(radius_m >= 0)) refuse(where, "radius is " + to_text(radius_m) + " m; give one >= 0");
}

void mark(Points, const Everything&, Mask& mask) { std::fill(mask.begin(), mask.end(), char{1}); }

void mark(Points points, const InsideBox& box, Mask& mask) {
    for (int k = 0; k < 3; ++k)
        if (!(box.min_m[k] <= box.max_m[k]))
            refuse("InsideBox.max_m", std::string("box runs in ") + "xyz"[k] + " from " + to_text(box.min_m[k]) + " to " +
                                          to_text(box.max_m[k]) + " m; give min <= max");
    for (std::size_t v = 0; v < mask.size(); ++v)
        mask[v] = (points[v].array() >= box.min_m.array()).all() && (points[v].array() <= box.max_m.array()).all();
}

void mark(Points points, const InsideSphere& sphere, Mask& mask) {
    if (!sphere.centre_m.allFinite()) refuse("InsideSphere.centre_m", "the centre is not finite; give three finite coordinates [m]");
    check_radius(sphere.radius_m, "InsideSphere.radius_m");
    for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = (points[v] - sphere.centre_m).norm() <= sphere.radius_m;
}

void mark(Points points, const InsideCapsule& capsule, Mask& mask) {
    if (!capsule.a_m.allFinite() || !capsule.b_m.allFinite()) refuse("InsideCapsule.a_m", "an end is not finite; give three finite coordinates [m] each");
    check_radius(capsule.radius_m, "InsideCapsule.radius_m");
    const Vec3 along = capsule.b_m - capsule.a_m;
    const double length2 = along.squaredNorm();
    for (std::size_t v = 0; v < mask.size(); ++v) {
        const Vec3 from_a = points[v] - capsule.a_m;
        const double t = length2 > 0 ? std::clamp(from_a.dot(along) / length2, 0.0, 1.0) : 0.0;
        mask[v] = (from_a - t * along).norm() <= capsule.radius_m;
    }
}

void mark(const VolumeMesh&, const VertexList& list, Mask& mask) {
    for (const std::int32_t v : list.vertices) {
        if (v < 0 || static_cast<std::size_t>(v) >= mask.size())
            refuse("VertexList.vertices", "vertex " + std::to_string(v) + " does not exist; legal are 0 to " +
                                              std::to_string(static_cast<std::int64_t>(mask.size()) - 1) + " (counted from 0)");
        mask[v] = 1;
    }
}

std::vector<std::int32_t> elements_of_region(const VolumeMesh& mesh, const std::string& name) {
    std::vector<std::int32_t> elements;
    for (std::size_t e = 0; e < mesh.element_region.size(); ++e)
        if (const std::int32_t r = mesh.element_region[e]; r >= 0 && mesh.regions[r].name == name)
            elements.push_back(static_cast<std::int32_t>(e));
    return elements;
}

bool has_region(const VolumeMesh& mesh, const std::string& name) {
    return std::any_of(mesh.regions.begin(), mesh.regions.end(), [&](const Region& r) { return r.name == name; });
}

[[noreturn]] void unknown_group(const VolumeMesh& mesh, const std::string& name) {
    std::vector<std::string> known;
    for (const VertexGroup& g : mesh.groups) known.push_back(g.name);
    for (const Region& r : mesh.regions) known.push_back(r.name);
    std::sort(known.begin(), known.end());
    known.erase(std::unique(known.begin(), known.end()), known.end());
    std::string list;
    for (const std::string& k : known) list += (list.empty() ? "\"" : ", \"") + k + "\"";
    refuse("InGroup.name", "there is no group \"" + name + "\" in " + (mesh.source.empty() ? "the mesh" : mesh.source) + "; " +
                               (known.empty() ? "it has no groups, select by box, sphere or vertices" : "it has " + list));
}

void mark(const VolumeMesh& mesh, const InGroup& group, Mask& mask) {
    bool found = has_region(mesh, group.name);
    for (const VertexGroup& g : mesh.groups)
        if (g.name == group.name) {
            found = true;
            mark(mesh, VertexList{g.vertices}, mask);
        }
    if (!found) unknown_group(mesh, group.name);
    const auto tets = static_cast<std::int32_t>(mesh.tets.size());
    for (const std::int32_t e : elements_of_region(mesh, group.name)) {
        if (e < tets)
            for (const std::int32_t v : mesh.tets[e]) mask[v] = 1;
        else
            for (const std::int32_t v : mesh.hexes[e - tets]) mask[v] = 1;
    }
}

void mark(const VolumeMesh& mesh, const ElementList& list, Mask& mask) {
    const auto tets = static_cast<std::int32_t>(mesh.tets.size());
    for (const std::int32_t e : list.elements) {
        if (e < 0 || static_cast<std::size_t>(e) >= mesh.element_count())
            refuse("ElementList.elements", "holds element " + std::to_string(e) + "; the mesh has " + std::to_string(mesh.element_count()) + ", counted from 0");
        if (e < tets)
            for (const std::int32_t v : mesh.tets[e]) mask[v] = 1;
        else
            for (const std::int32_t v : mesh.hexes[e - tets]) mask[v] = 1;
    }
}

template <class Shape>
constexpr bool kHasInside = !std::is_same_v<Shape, VertexList> && !std::is_same_v<Shape, InGroup> && !std::is_same_v<Shape, ElementList>;

Mask make_mask(const VolumeMesh& mesh, const Selection& selection) {
    Mask mask(mesh.vertices.size(), 0);
    std::visit(
        [&](const auto& s) {
            if constexpr (kHasInside<std::decay_t<decltype(s)>>)
                mark(mesh.vertices, s, mask);
            else
                mark(mesh, s, mask);
        },
        selection);
    return mask;
}

template <class Element>
void append_centres(const VolumeMesh& mesh, const std::vector<Element>& elements, std::vector<Vec3>& centres) {
    for (const Element& element : elements) {
        Vec3 sum = Vec3::Zero();
        for (const std::int32_t v : element) sum += mesh.vertices[std::size_t(v)];
        centres.push_back(sum / double(element.size()));
    }
}

std::vector<std::int32_t> select_by_centre(const VolumeMesh& mesh, const Selection& selection) {
    std::vector<Vec3> centres;
    append_centres(mesh, mesh.tets, centres);
    append_centres(mesh, mesh.hexes, centres);
    Mask mask(centres.size(), 0);
    std::visit(
        [&](const auto& s) {
            if constexpr (kHasInside<std::decay_t<decltype(s)>>)
                mark(centres, s, mask);
            else
                refuse("ElementRule::centre", "a vertex list or a group has no inside; select by box, sphere or capsule, or by all vertices");
        },
        selection);
    std::vector<std::int32_t> out;
    for (std::size_t e = 0; e < mask.size(); ++e)
        if (mask[e]) out.push_back(static_cast<std::int32_t>(e));
    return out;
}

}  // namespace

std::vector<std::int32_t> select_vertices(const VolumeMesh& mesh, const Selection& selection) {
    const Mask mask = make_mask(mesh, selection);
    std::vector<std::int32_t> out;
    for (std::size_t v = 0; v < mask.size(); ++v)
        if (mask[v]) out.push_back(static_cast<std::int32_t>(v));
    return out;
}

std::vector<std::int32_t> select_elements(const VolumeMesh& mesh, const Selection& selection, ElementRule rule) {
    if (const auto* group = std::get_if<InGroup>(&selection); group && has_region(mesh, group->name))
        return elements_of_region(mesh, group->name);
    if (const auto* list = std::get_if<ElementList>(&selection)) {
        make_mask(mesh, selection);  // refuses what is out of range
        std::vector<std::int32_t> out = list->elements;
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        return out;
    }
    if (rule == ElementRule::centre) return select_by_centre(mesh, selection);
    const Mask mask = make_mask(mesh, selection);
    const auto chosen = [&](std::int32_t v) { return mask[v] != 0; };
    std::vector<std::int32_t> out;
    std::int32_t e = 0;
    for (const Tet& t : mesh.tets) {
        if (std::all_of(t.begin(), t.end(), chosen)) out.push_back(e);
        ++e;
    }
    for (const Hex& h : mesh.hexes) {
        if (std::all_of(h.begin(), h.end(), chosen)) out.push_back(e);
        ++e;
    }
    return out;
}

}  // namespace supple
