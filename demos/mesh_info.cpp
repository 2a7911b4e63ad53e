#include "mesh_info.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <map>
#include <span>

#include "json_text.h"
#include "mesh_cost.h"
#include "supple/mesh/quality.h"
#include "supple/mesh/surface.h"

namespace supple::demos {
namespace {

/// How many values lie in [edges[i], edges[i + 1]); the last bin holds everything above, too.
struct Histogram {
    std::vector<double> edges;
    std::vector<std::size_t> counts;

    explicit Histogram(std::vector<double> bounds) : edges(std::move(bounds)), counts(edges.size() - 1, 0) {}
    void add(double value) {
        std::size_t bin = 0;
        while (bin + 1 < counts.size() && value >= edges[bin + 1]) ++bin;
        ++counts[bin];
    }
    std::string text() const {
        std::string out;
        for (std::size_t i = 0; i < counts.size(); ++i)
            out += (i ? "  " : "") + to_text(edges[i]) + "-" + to_text(edges[i + 1]) + ": " + std::to_string(counts[i]);
        return out;
    }
    std::string to_json() const {
        std::vector<std::string> bounds, numbers;
        for (const double e : edges) bounds.push_back(json(e));
        for (const std::size_t n : counts) numbers.push_back(json(n));
        return JsonObject().add("edges", json_array(bounds)).add("counts", json_array(numbers)).line();
    }
};

struct Quality {
    MeshQuality tets;
    Histogram dihedral{{0, 5, 10, 20, 30, 40, 50, 60, 71}};
    Histogram radius_ratio{{0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1}};
    Histogram jacobian{{-1, 0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1}};
    double least_jacobian = 1;
};

Quality quality_of(const VolumeMesh& mesh) {
    Quality q;
    q.tets = tet_mesh_quality(mesh);
    for (const Tet& t : mesh.tets) {
        const TetQuality one = tet_quality(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], mesh.vertices[t[3]]);
        q.dihedral.add(one.min_dihedral_deg);
        q.radius_ratio.add(one.radius_ratio);
    }
    for (const Hex& h : mesh.hexes) {
        std::array<Vec3, 8> x;
        for (int i = 0; i < 8; ++i) x[i] = mesh.vertices[h[i]];
        const double jacobian = hex_scaled_jacobian(x);
        q.jacobian.add(jacobian);
        q.least_jacobian = std::min(q.least_jacobian, jacobian);
    }
    return q;
}

[[gnu::format(printf, 2, 3)]] void line(std::string& out, const char* format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    out += text;
    out += '\n';
}

void add_box(std::string& out, const Vec3& low, const Vec3& high) {
    const Vec3 size = high - low;
    line(out, "  box         %.6g %.6g %.6g .. %.6g %.6g %.6g (size %.6g %.6g %.6g)", low.x(), low.y(), low.z(), high.x(), high.y(),
         high.z(), size.x(), size.y(), size.z());
}

std::string json_strings(const std::vector<std::string>& words) {
    std::vector<std::string> out;
    for (const std::string& w : words) out.push_back(json(std::string_view(w)));
    return json_array(out);
}

std::string json_bool(bool value) { return value ? "true" : "false"; }

/// Bodies of ten metres and more are mostly files in other units.
void add_size_sentence(std::vector<std::string>& found, const Vec3& low, const Vec3& high) {
    const double size = (high - low).maxCoeff();
    if (size > 20)
        found.push_back("it is " + to_text(std::round(size * 10) / 10) +
                        " m long as it stands; if the file is in centimetres or millimetres, say so (units: cm, mm)");
}

void add_quality_sentences(std::vector<std::string>& found, const Quality& q, const VolumeMesh& mesh) {
    const std::size_t slivers = q.dihedral.counts[0];
    if (slivers > 0)
        found.push_back(std::to_string(slivers) + (slivers == 1 ? " tetrahedron is a sliver" : " tetrahedra are slivers") +
                        " (a dihedral angle below 5 degrees): it simulates, but solves take more iterations and stress there is poor");
    if (!mesh.hexes.empty() && q.least_jacobian < 0.1)
        found.push_back("the worst hexahedron has a scaled Jacobian of " + to_text(std::round(q.least_jacobian * 1000) / 1000) +
                        ": nearly flat, or folded");
}

void add_boundary_sentences(std::vector<std::string>& found, const mesh::SurfaceReport& boundary) {
    if (boundary.crowded_edges > 0)
        found.push_back(std::to_string(boundary.crowded_edges) +
                        " edges of the boundary are shared by more than two of its triangles: parts touch along an edge only");
    if (boundary.pinched_vertices > 0)
        found.push_back("at " + std::to_string(boundary.pinched_vertices) + " vertices parts of the mesh touch in that point or edge only");
    if (boundary.open_edges + boundary.turned_edges > 0) found.push_back("the boundary is not closed: elements overlap");
}

struct Facts {
    MeshReport report;
    BoundarySurface boundary;
    mesh::SurfaceReport skin;
    Quality quality;
    MeshCost cost;
    std::vector<std::string> found;
    std::map<std::int32_t, std::size_t> region_elements;
};

std::string volume_text(const VolumeMesh& mesh, const std::string& file, const Facts& f) {
    std::string out = file + "\n";
    line(out, "  vertices    %zu\n  tets        %zu\n  hexes       %zu", mesh.vertices.size(), mesh.tets.size(), mesh.hexes.size());
    line(out, "  boundary    %zu triangles, %s", f.boundary.triangles.size(),
         f.skin.is_closed()                             ? "closed"
         : f.skin.open_edges + f.skin.turned_edges == 0 ? "closed, not a manifold"
                                                        : "not closed");
    line(out, "  components  %zu", f.report.components);
    add_box(out, f.report.min_m, f.report.max_m);
    line(out, "  volume      %.9g", f.report.volume_m3);
    if (!mesh.tets.empty()) {
        line(out, "  dihedral    %.2f to %.2f degrees; least of each tet, degrees: %s", f.quality.tets.min_dihedral_deg,
             f.quality.tets.max_dihedral_deg, f.quality.dihedral.text().c_str());
        line(out, "  radii       inscribed to circumscribed x 3: least %.4f, mean %.4f: %s", f.quality.tets.min_radius_ratio,
             f.quality.tets.mean_radius_ratio, f.quality.radius_ratio.text().c_str());
    }
    if (!mesh.hexes.empty())
        line(out, "  hex shape   least scaled Jacobian %.4f: %s", f.quality.least_jacobian, f.quality.jacobian.text().c_str());
    for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
        const auto count = f.region_elements.find(std::int32_t(i));
        line(out, "  region      %s (tag %d): %zu elements", mesh.regions[i].name.c_str(), mesh.regions[i].tag,
             count == f.region_elements.end() ? std::size_t(0) : count->second);
    }
    for (const VertexGroup& group : mesh.groups) line(out, "  group       %s: %zu vertices", group.name.c_str(), group.vertices.size());
    line(out, "  expect      about %.3g MB and %.3g ms a step on one thread (corotational, 60 Hz; to a factor of two, more where it bends far)",
         f.cost.memory_mb, f.cost.step_ms);
    for (const std::string& sentence : f.found) line(out, "  found       %s", sentence.c_str());
    if (f.found.empty()) line(out, "  found       nothing to repair");
    return out;
}

std::string volume_json(const VolumeMesh& mesh, const std::string& file, const Facts& f) {
    std::vector<std::string> regions, groups;
    for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
        const auto count = f.region_elements.find(std::int32_t(i));
        regions.push_back(JsonObject()
                              .add("name", json(std::string_view(mesh.regions[i].name)))
                              .add("tag", json(mesh.regions[i].tag))
                              .add("elements", json(count == f.region_elements.end() ? std::size_t(0) : count->second))
                              .line());
    }
    for (const VertexGroup& group : mesh.groups)
        groups.push_back(JsonObject().add("name", json(std::string_view(group.name))).add("vertices", json(group.vertices.size())).line());
    const MeshReport& r = f.report;
    JsonObject quality;
    if (!mesh.tets.empty())
        quality.add("min_dihedral_deg", json(f.quality.tets.min_dihedral_deg))
            .add("max_dihedral_deg", json(f.quality.tets.max_dihedral_deg))
            .add("min_radius_ratio", json(f.quality.tets.min_radius_ratio))
            .add("mean_radius_ratio", json(f.quality.tets.mean_radius_ratio))
            .add("min_dihedral_histogram", f.quality.dihedral.to_json())
            .add("radius_ratio_histogram", f.quality.radius_ratio.to_json());
    if (!mesh.hexes.empty())
        quality.add("min_scaled_jacobian", json(f.quality.least_jacobian)).add("scaled_jacobian_histogram", f.quality.jacobian.to_json());
    return JsonObject()
               .add("file", json(std::string_view(file)))
               .add("kind", json(std::string_view("volume")))
               .add("vertices", json(mesh.vertices.size()))
               .add("tets", json(mesh.tets.size()))
               .add("hexes", json(mesh.hexes.size()))
               .add("components", json(r.components))
               .add("box_m", JsonObject().add("min", json(r.min_m)).add("max", json(r.max_m)).line())
               .add("volume_m3", json(r.volume_m3))
               .add("boundary", JsonObject()
                                    .add("triangles", json(f.boundary.triangles.size()))
                                    .add("closed", json_bool(f.skin.open_edges + f.skin.turned_edges == 0))
                                    .add("non_manifold_edges", json(f.skin.crowded_edges))
                                    .add("non_manifold_vertices", json(f.skin.pinched_vertices))
                                    .line())
               .add("quality", quality.line())
               .add("regions", json_array(regions))
               .add("groups", json_array(groups))
               .add("repaired", JsonObject()
                                    .add("inverted", json(r.flipped))
                                    .add("degenerate", json(r.degenerate))
                                    .add("duplicate_elements", json(r.duplicate_elements))
                                    .line())
               .add("reported", JsonObject()
                                    .add("unreferenced_vertices", json(r.unreferenced_vertices))
                                    .add("duplicate_vertices", json(r.duplicate_vertices))
                                    .add("folded_hexes", json(r.folded_hexes))
                                    .add("overloaded_faces", json(r.overloaded_faces))
                                    .line())
               .add("expected", JsonObject().add("memory_mb", json(f.cost.memory_mb)).add("step_ms", json(f.cost.step_ms)).line())
               .add("found", json_strings(f.found))
               .block() +
           "\n";
}

std::string surface_text(const mesh::TriangleMesh& surface, const std::string& file, const mesh::SurfaceReport& r,
                         const std::vector<std::string>& found) {
    std::string out = file + "\n";
    line(out, "  a surface: `supple mesh cook` fills it with elements");
    line(out, "  vertices    %zu\n  triangles   %zu\n  components  %zu", surface.vertices.size(), surface.triangles.size(), r.components);
    add_box(out, r.min_m, r.max_m);
    line(out, "  area        %.9g", r.area_m2);
    if (r.is_closed()) line(out, "  volume      %.9g", r.volume_m3);
    line(out, "  boundary    %s", r.is_closed() ? "closed" : "not closed");
    for (const std::string& sentence : found) line(out, "  found       %s", sentence.c_str());
    if (found.empty()) line(out, "  found       nothing to repair");
    return out;
}

}  // namespace

std::string describe(VolumeMesh mesh, const std::string& file, bool as_json) {
    Facts f;
    f.report = check_and_repair(mesh);
    f.boundary = extract_boundary(mesh);
    f.skin = mesh::check_surface({mesh.vertices, f.boundary.triangles});
    f.quality = quality_of(mesh);
    f.cost = estimate_cost(mesh);
    for (const std::int32_t region : mesh.element_region) ++f.region_elements[region];
    f.found = f.report.sentences();
    add_boundary_sentences(f.found, f.skin);
    add_quality_sentences(f.found, f.quality, mesh);
    add_size_sentence(f.found, f.report.min_m, f.report.max_m);
    return as_json ? volume_json(mesh, file, f) : volume_text(mesh, file, f);
}

std::string describe(const mesh::TriangleMesh& surface, const std::string& file, bool as_json) {
    const mesh::SurfaceReport r = mesh::check_surface(surface);
    std::vector<std::string> found = r.sentences();
    add_size_sentence(found, r.min_m, r.max_m);
    if (!as_json) return surface_text(surface, file, r, found);
    return JsonObject()
               .add("file", json(std::string_view(file)))
               .add("kind", json(std::string_view("surface")))
               .add("vertices", json(surface.vertices.size()))
               .add("triangles", json(surface.triangles.size()))
               .add("components", json(r.components))
               .add("box_m", JsonObject().add("min", json(r.min_m)).add("max", json(r.max_m)).line())
               .add("area_m2", json(r.area_m2))
               .add("volume_m3", r.is_closed() ? json(r.volume_m3) : "null")
               .add("boundary", JsonObject()
                                    .add("closed", json_bool(r.is_closed()))
                                    .add("open_edges", json(r.open_edges))
                                    .add("non_manifold_edges", json(r.crowded_edges))
                                    .add("non_manifold_vertices", json(r.pinched_vertices))
                                    .add("turned_edges", json(r.turned_edges))
                                    .line())
               .add("reported", JsonObject()
                                    .add("degenerate_triangles", json(r.degenerate_triangles))
                                    .add("duplicate_triangles", json(r.duplicate_triangles))
                                    .add("unreferenced_vertices", json(r.unreferenced_vertices))
                                    .add("duplicate_vertices", json(r.duplicate_vertices))
                                    .line())
               .add("found", json_strings(found))
               .block() +
           "\n";
}

}  // namespace supple::demos
