#include "supple/world/body_template.h"

#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/mesh/edit_trace.h"
#include "supple/solve/pattern_edit.h"
#include "supple/world/template_data.h"

namespace supple {

namespace {

constexpr std::size_t kMaxTets = std::size_t(1) << 28;   // gather maps hold element * 16 in 32 bits
constexpr std::size_t kMaxHexes = std::size_t(1) << 26;  // and element * 64

template <class Element>
solve::GatherMap gather_map(const solve::Bsr3Pattern& pattern, const std::vector<Element>& all, const std::vector<std::int32_t>& chosen, std::size_t first) {
    std::vector<Element> elements;
    for (const std::int32_t e : chosen) elements.push_back(all[std::size_t(e) - first]);
    return solve::make_gather_map(pattern, elements);
}

std::vector<std::int32_t> vertices_of(const BoundarySurface& boundary, std::size_t vertices) {
    std::vector<char> on(vertices, 0);
    for (const Triangle& t : boundary.triangles)
        for (const std::int32_t v : t) on[std::size_t(v)] = 1;
    std::vector<std::int32_t> out;
    for (std::size_t v = 0; v < vertices; ++v)
        if (on[v] != 0) out.push_back(std::int32_t(v));
    return out;
}

/// Gather map of the elements [first, first + elements.size()) of the mesh after an edit.
template <std::size_t N>
solve::GatherMap follow_gather(const TemplateData& was, const TemplateData& is, const EditTrace& trace, const solve::RowChange& rows, fem::ElementKind kind,
                               const std::vector<std::array<std::int32_t, N>>& elements) {
    const std::size_t first = kind == fem::ElementKind::tet ? 0 : is.mesh.tets.size(), first_before = kind == fem::ElementKind::tet ? 0 : was.mesh.tets.size();
    const std::size_t before = kind == fem::ElementKind::tet ? was.mesh.tets.size() : was.mesh.hexes.size();
    std::vector<std::int32_t> new_element(before);
    for (std::size_t e = 0; e < before; ++e) new_element[e] = trace.new_element[first_before + e] - std::int32_t(first);
    const solve::GatherMap* map = nullptr;
    solve::GatherMap none;
    for (std::size_t g = 0; g < was.layout.groups.size(); ++g)
        if (was.layout.groups[g].kind == kind) map = &was.gather[g];
    if (map == nullptr) {  // the first elements of this kind
        none.start.assign(was.pattern.blocks() + 1, 0);
        map = &none;
    }
    const fem::ElementMap& around = is.layout.around;
    return solve::change_gather_map<N>(*map, was.pattern, is.pattern, rows, new_element, elements, [&](std::size_t row, std::vector<std::int32_t>& out) {
        for (std::int64_t k = around.start[row]; k < around.start[row + 1]; ++k) {
            const std::int32_t e = around.element[std::size_t(k)] - std::int32_t(first);
            if (e >= 0 && std::size_t(e) < elements.size()) out.push_back(e);
        }
    });
}

}  // namespace

std::shared_ptr<const BodyTemplate> BodyTemplate::edited(const MeshEdit& edit) const {
    const TemplateData& was = *data_;
    const EditTrace trace = trace_edit(was.mesh, edit.mesh, edit.delta);
    const bool good = trace.ordered && edit.mesh.tets.size() < kMaxTets && edit.mesh.hexes.size() < kMaxHexes && keeps_new_elements(edit.mesh, trace.old_element);
    if (!good) return build(edit.mesh);
    auto data = std::make_unique<TemplateData>();
    TemplateData& is = *data;
    is.mesh = edit.mesh;
    is.boundary = follow_boundary(was.mesh, was.boundary, is.mesh, trace);
    is.boundary_vertices = vertices_of(is.boundary, is.mesh.vertices.size());
    is.min_m = is.max_m = is.mesh.vertices[std::size_t(is.boundary_vertices[0])];
    for (const std::int32_t v : is.boundary_vertices) {
        is.min_m = is.min_m.cwiseMin(is.mesh.vertices[std::size_t(v)]);
        is.max_m = is.max_m.cwiseMax(is.mesh.vertices[std::size_t(v)]);
    }
    is.layout = fem::follow_layout(is.mesh, was.layout, was.mesh.tets.size(), trace.old_element);
    const solve::RowChange rows{trace.old_vertex, trace.new_vertex};
    const fem::ElementMap& around = is.layout.around;
    is.pattern = solve::change_pattern(was.pattern, rows, [&](std::size_t row, std::vector<std::int32_t>& out) {
        for (std::int64_t k = around.start[row]; k < around.start[row + 1]; ++k) {
            const auto corners = fem::element_vertices(is.mesh, std::size_t(around.element[std::size_t(k)]));
            out.insert(out.end(), corners.begin(), corners.end());
        }
    });
    for (const fem::ElementGroup& group : is.layout.groups)
        is.gather.push_back(group.kind == fem::ElementKind::tet ? follow_gather<4>(was, is, trace, rows, group.kind, is.mesh.tets)
                                                                : follow_gather<8>(was, is, trace, rows, group.kind, is.mesh.hexes));
    return std::shared_ptr<const BodyTemplate>(new BodyTemplate(std::move(data)));
}

std::vector<solve::GatherMap> make_gather_maps(const VolumeMesh& mesh, const solve::Bsr3Pattern& pattern, const fem::ElementLayout& layout) {
    std::vector<solve::GatherMap> maps;
    for (const fem::ElementGroup& group : layout.groups) {
        maps.push_back(group.kind == fem::ElementKind::tet ? gather_map(pattern, mesh.tets, group.element, 0)
                                                           : gather_map(pattern, mesh.hexes, group.element, mesh.tets.size()));
    }
    return maps;
}

const MeshReport& TemplateData::mesh_report() const {
    if (checked) return *checked;
    std::call_once(report_made_, [&] {
        VolumeMesh copy = mesh;
        late_report_ = check_and_repair(copy);
    });
    return late_report_;
}

const fem::RecoveryWeights& TemplateData::recovery(Recovery kind) const {
    const std::size_t k = std::size_t(kind);
    std::call_once(recovery_made_[k], [&] { recovery_[k] = fem::make_recovery(mesh, boundary_vertices, kind); });
    return recovery_[k];
}

std::shared_ptr<const BodyTemplate> BodyTemplate::build(VolumeMesh mesh, double scale) {
    const std::string where = mesh.source.empty() ? "BodyTemplate::build" : mesh.source;
    if (!(std::isfinite(scale) && scale > 0)) {
        throw Error(ErrorCode::invalid_argument, where, "scale " + to_text(scale) + " must be above 0; a mesh in centimetres has scale 0.01");
    }
    auto data = std::make_unique<TemplateData>();
    for (Vec3& x : mesh.vertices) x *= scale;
    data->checked = check_and_repair(mesh);
    data->min_m = data->checked->min_m;
    data->max_m = data->checked->max_m;
    if (mesh.tets.size() >= kMaxTets || mesh.hexes.size() >= kMaxHexes) {
        throw Error(ErrorCode::unsupported, where,
                    std::to_string(mesh.tets.size()) + " tetrahedra and " + std::to_string(mesh.hexes.size()) +
                        " hexahedra are more than 2^28 - 1 and 2^26 - 1 in one body; split the mesh");
    }
    data->mesh = std::move(mesh);
    const VolumeMesh& m = data->mesh;
    data->boundary = extract_boundary(m);
    data->boundary_vertices = vertices_of(data->boundary, m.vertices.size());
    data->layout = fem::make_layout(m);
    data->pattern = solve::make_pattern(m.vertices.size(), m.tets, m.hexes);
    data->gather = make_gather_maps(m, data->pattern, data->layout);
    return std::shared_ptr<const BodyTemplate>(new BodyTemplate(std::move(data)));
}

BodyTemplate::BodyTemplate(std::unique_ptr<const TemplateData> data) : data_(std::move(data)) {}
BodyTemplate::~BodyTemplate() = default;

const VolumeMesh& BodyTemplate::mesh() const { return data_->mesh; }
const MeshReport& BodyTemplate::report() const { return data_->mesh_report(); }
const BoundarySurface& BodyTemplate::boundary() const { return data_->boundary; }

}  // namespace supple
