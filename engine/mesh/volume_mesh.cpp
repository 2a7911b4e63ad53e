// Volume of a trilinear hexahedron. By the divergence theorem it is a sum over the six faces, each a bilinear patch. The patch
// over a, b, c, d halves the volume between the two ways to cut the quadrilateral into triangles (a hyperbolic paraboloid
// halves the tetrahedron a b c d), so with det(p,q,r) = p . (q x r)
//     6 V = sum over faces of  [det(a,b,c) + det(a,c,d) + det(a,b,d) + det(b,c,d)] / 2,
// taken relative to vertex 0 so that a mesh far from the origin loses no digits.
#include "supple/mesh/volume_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "supple/base/disjoint_sets.h"
#include "supple/base/error.h"
#include "supple/mesh/topology.h"

namespace supple {
namespace {

constexpr double kLargestCoordinate_m = 1e100;  // its cube is still a double
constexpr double kZeroVolume = 1e-12;           // relative to the cube of the longest edge

double det3(const Vec3& a, const Vec3& b, const Vec3& c) { return a.dot(b.cross(c)); }

std::string mesh_name(const VolumeMesh& mesh) { return mesh.source.empty() ? "mesh" : mesh.source; }

[[noreturn]] void refuse(const VolumeMesh& mesh, const std::string& message) {
    throw Error(ErrorCode::invalid_argument, mesh_name(mesh), message);
}

template <std::size_t N>
void check_indices(const VolumeMesh& mesh, const std::vector<std::array<std::int32_t, N>>& elements, const char* kind) {
    const std::size_t n = mesh.vertices.size();
    for (std::size_t e = 0; e < elements.size(); ++e)
        for (const std::int32_t v : elements[e])
            if (v < 0 || static_cast<std::size_t>(v) >= n)
                refuse(mesh, std::string(kind) + " " + std::to_string(e) + " uses vertex " + std::to_string(v) + "; legal are 0 to " +
                                 std::to_string(static_cast<std::int64_t>(n) - 1) + " (counted from 0)");
}

void check_input(const VolumeMesh& mesh) {
    if (mesh.element_count() == 0)
        throw Error(ErrorCode::surface_mesh, mesh_name(mesh),
                    "the mesh has no tetrahedron and no hexahedron; a soft body needs volume elements, "
                    "so fill the surface first (supple mesh cook, or a mesher such as Gmsh)");
    if (mesh.vertices.size() > static_cast<std::size_t>(INT32_MAX)) refuse(mesh, "more than 2147483647 vertices");
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        for (int k = 0; k < 3; ++k)
            if (!(std::abs(mesh.vertices[v][k]) <= kLargestCoordinate_m))
                refuse(mesh, "vertex " + std::to_string(v) + " has " + "xyz"[k] + " = " + to_text(mesh.vertices[v][k]) +
                                 "; coordinates must be finite and within +-1e100 m");
    check_indices(mesh, mesh.tets, "tet");
    check_indices(mesh, mesh.hexes, "hex");
    if (!mesh.element_region.empty() && mesh.element_region.size() != mesh.element_count())
        refuse(mesh, "element_region has " + std::to_string(mesh.element_region.size()) + " entries for " +
                         std::to_string(mesh.element_count()) + " elements; give one per element, or none");
    if (!mesh.fill.empty() && mesh.fill.size() != mesh.element_count())
        refuse(mesh, "fill has " + std::to_string(mesh.fill.size()) + " entries for " + std::to_string(mesh.element_count()) +
                         " elements; give one per element, or none");
    for (std::size_t e = 0; e < mesh.element_region.size(); ++e)
        if (const std::int32_t r = mesh.element_region[e]; r < -1 || r >= static_cast<std::int64_t>(mesh.regions.size()))
            refuse(mesh, "element " + std::to_string(e) + " is in region " + std::to_string(r) + "; legal are -1 (none) to " +
                             std::to_string(static_cast<std::int64_t>(mesh.regions.size()) - 1));
    for (const VertexGroup& group : mesh.groups)
        for (const std::int32_t v : group.vertices)
            if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertices.size())
                refuse(mesh, "group \"" + group.name + "\" holds vertex " + std::to_string(v) + "; legal are 0 to " +
                                 std::to_string(static_cast<std::int64_t>(mesh.vertices.size()) - 1) + " (counted from 0)");
}

template <std::size_t N>
std::array<std::int32_t, N> sorted(std::array<std::int32_t, N> v) {
    std::sort(v.begin(), v.end());
    return v;
}

template <std::size_t N>
bool repeats_a_vertex(const std::array<std::int32_t, N>& element) {
    const auto v = sorted(element);
    return std::adjacent_find(v.begin(), v.end()) != v.end();
}

/// 6 V over the cube of the longest edge: the same for every size and place. 0 for a point.
double relative_volume(const VolumeMesh& mesh, const Tet& t) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]], &d = mesh.vertices[t[3]];
    const double longest = std::sqrt(std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (d - a).squaredNorm(), (c - b).squaredNorm(),
                                               (d - b).squaredNorm(), (d - c).squaredNorm()}));
    return longest > 0 ? det3((b - a) / longest, (c - a) / longest, (d - a) / longest) : 0.0;
}

std::array<Vec3, 8> hex_corners(const VolumeMesh& mesh, const Hex& h) {
    std::array<Vec3, 8> x;
    for (int i = 0; i < 8; ++i) x[i] = mesh.vertices[h[i]];
    return x;
}

double relative_volume(const VolumeMesh& mesh, const Hex& h) {
    std::array<Vec3, 8> x = hex_corners(mesh, h);
    double longest = 0;
    for (const auto& e : kHexEdges) longest = std::max(longest, (x[e[1]] - x[e[0]]).norm());
    if (!(longest > 0)) return 0;
    for (int i = 7; i >= 0; --i) x[i] = (x[i] - x[0]) / longest;
    return 6 * hex_volume(x);
}

void rewind(Tet& t) { std::swap(t[2], t[3]); }
void rewind(Hex& h) { std::swap_ranges(h.begin(), h.begin() + 4, h.begin() + 4); }

/// Rewinds the elements of one kind and marks those to remove.
template <class Element>
void inspect(const VolumeMesh& mesh, std::vector<Element>& elements, std::vector<char>& removed, MeshReport& report) {
    removed.assign(elements.size(), 0);
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const double v6 = relative_volume(mesh, elements[e]);
        if (repeats_a_vertex(elements[e]) || !(std::abs(v6) > 6 * kZeroVolume)) {
            removed[e] = 1;
            ++report.degenerate;
        } else if (v6 < 0) {
            rewind(elements[e]);
            ++report.flipped;
        }
    }
    std::vector<std::pair<Element, std::int32_t>> keys;
    keys.reserve(elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e)
        if (!removed[e]) keys.emplace_back(sorted(elements[e]), static_cast<std::int32_t>(e));
    std::sort(keys.begin(), keys.end());
    for (std::size_t i = 1; i < keys.size(); ++i)
        if (keys[i].first == keys[i - 1].first) {
            removed[keys[i].second] = 1;  // the pair's second part makes the earliest one come first
            ++report.duplicate_elements;
        }
}

template <class T>
void drop(std::vector<T>& values, const std::vector<char>& removed) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!removed[i]) values[kept++] = values[i];
    values.resize(kept);
}

/// Bounding box of the used vertices, unused and coincident vertices.
void survey_vertices(const VolumeMesh& mesh, MeshReport& report) {
    const std::size_t n = mesh.vertices.size();
    std::vector<char> used(n, 0);
    for (const Tet& t : mesh.tets)
        for (const std::int32_t v : t) used[v] = 1;
    for (const Hex& h : mesh.hexes)
        for (const std::int32_t v : h) used[v] = 1;
    bool first = true;
    for (std::size_t v = 0; v < n; ++v) {
        if (!used[v]) {
            ++report.unreferenced_vertices;
            continue;
        }
        report.min_m = first ? mesh.vertices[v] : report.min_m.cwiseMin(mesh.vertices[v]).eval();
        report.max_m = first ? mesh.vertices[v] : report.max_m.cwiseMax(mesh.vertices[v]).eval();
        first = false;
    }
    std::vector<std::int32_t> order(n);
    std::iota(order.begin(), order.end(), 0);
    const auto less = [&](std::int32_t a, std::int32_t b) {
        const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b];
        return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
    };
    std::sort(order.begin(), order.end(), less);
    for (std::size_t i = 1; i < n; ++i) report.duplicate_vertices += mesh.vertices[order[i]] == mesh.vertices[order[i - 1]];
}

/// True if the Jacobian of the trilinear map is not positive at some corner.
bool folded(const std::array<Vec3, 8>& x) {
    for (int i = 0; i < 8; ++i) {
        const int layer = i & 4, k = i & 3;
        const Vec3 a = x[layer + (k + 1) % 4] - x[i], b = x[layer + (k + 3) % 4] - x[i], c = x[i ^ 4] - x[i];
        if (!((layer == 0 ? det3(a, b, c) : -det3(a, b, c)) > 0)) return true;
    }
    return false;
}

void survey_elements(const VolumeMesh& mesh, MeshReport& report) {
    for (const Tet& t : mesh.tets)
        report.volume_m3 += tet_volume(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], mesh.vertices[t[3]]);
    for (const Hex& h : mesh.hexes) {
        const std::array<Vec3, 8> x = hex_corners(mesh, h);
        report.volume_m3 += hex_volume(x);
        report.folded_hexes += folded(x);
    }
    DisjointSets parts(mesh.element_count());
    for_each_face(mesh, [&](std::span<const HalfFace> sides) {
        report.overloaded_faces += sides.size() > 2;
        for (const HalfFace s : sides.subspan(1)) parts.join(std::size_t(half_face(mesh, sides[0]).element), std::size_t(half_face(mesh, s).element));
    });
    for (std::size_t e = 0; e < mesh.element_count(); ++e) report.components += parts.root(e) == e;
}

}  // namespace

std::span<const std::int32_t> element_vertices(const VolumeMesh& mesh, std::size_t element) {
    if (element < mesh.tets.size()) return mesh.tets[element];
    return mesh.hexes[element - mesh.tets.size()];
}

double tet_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return det3(b - a, c - a, d - a) / 6; }

double hex_volume(const std::array<Vec3, 8>& x) {
    double twelve_v = 0;
    for (const auto& f : kHexFaces) {
        const Vec3 a = x[f[0]] - x[0], b = x[f[1]] - x[0], c = x[f[2]] - x[0], d = x[f[3]] - x[0];
        twelve_v += det3(a, b, c) + det3(a, c, d) + det3(a, b, d) + det3(b, c, d);
    }
    return twelve_v / 12;
}

MeshReport check_and_repair(VolumeMesh& mesh) {
    check_input(mesh);
    const std::size_t elements_given = mesh.element_count();
    MeshReport report;
    std::vector<char> removed, hexes_removed;
    inspect(mesh, mesh.tets, removed, report);
    inspect(mesh, mesh.hexes, hexes_removed, report);
    drop(mesh.tets, removed);
    drop(mesh.hexes, hexes_removed);
    removed.insert(removed.end(), hexes_removed.begin(), hexes_removed.end());
    if (!mesh.element_region.empty()) drop(mesh.element_region, removed);
    if (!mesh.fill.empty()) drop(mesh.fill, removed);
    if (mesh.element_count() == 0)
        throw Error(ErrorCode::surface_mesh, mesh_name(mesh),
                    "all " + std::to_string(elements_given) +
                        " volume elements are flat (zero volume) or repeat a vertex: nothing is left to simulate; "
                        "check that the file holds a solid, with three different coordinates per vertex");
    survey_vertices(mesh, report);
    survey_elements(mesh, report);
    return report;
}

bool keeps_new_elements(const VolumeMesh& mesh, std::span<const std::int32_t> old_element) {
    const auto keeps = [&](const auto& element) { return !repeats_a_vertex(element) && relative_volume(mesh, element) > 6 * kZeroVolume; };
    for (std::size_t e = 0; e < old_element.size(); ++e) {
        if (old_element[e] >= 0) continue;
        if (!(e < mesh.tets.size() ? keeps(mesh.tets[e]) : keeps(mesh.hexes[e - mesh.tets.size()]))) return false;
    }
    return true;
}

std::vector<std::string> MeshReport::sentences() const {
    std::vector<std::string> out;
    const auto say = [&](std::size_t n, const char* one, const char* many) {
        if (n > 0) out.push_back(std::to_string(n) + " " + (n == 1 ? one : many));
    };
    say(flipped, "element had negative volume and was rewound.", "elements had negative volume and were rewound.");
    say(degenerate, "element was flat or repeated a vertex and was removed.", "elements were flat or repeated a vertex and were removed.");
    say(duplicate_elements, "element had the vertices of an earlier one and was removed.",
        "elements had the vertices of earlier ones and were removed.");
    say(unreferenced_vertices, "vertex belongs to no element; it stays in place and never moves.",
        "vertices belong to no element; they stay in place and never move.");
    say(duplicate_vertices, "vertex lies exactly on an earlier one; the two were not joined, so the mesh may be open there.",
        "vertices lie exactly on earlier ones; they were not joined, so the mesh may be open there.");
    say(folded_hexes, "hex has a folded corner (Jacobian not positive); remesh there.",
        "hexes have a folded corner (Jacobian not positive); remesh there.");
    say(overloaded_faces, "face is shared by more than two elements, which overlap there.",
        "faces are shared by more than two elements, which overlap there.");
    if (components > 1)
        out.push_back("The mesh falls into " + std::to_string(components) +
                      " parts that share no face; each moves on its own unless it is fixed or attached.");
    return out;
}

}  // namespace supple
