#include "supple/world/body_template.h"

#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/mesh/edit_trace.h"
#include "supple/mesh/locality.h"
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

/// Where an element lies among those of its group.
std::int32_t place_in(const fem::ElementLayout& layout, const fem::ElementGroup& group, std::int32_t element) {
    return std::int32_t(layout.slot[std::size_t(element)] - group.first_block * fem::kBlock);
}

/// Gather map of a group after an edit.
template <std::size_t N>
solve::GatherMap follow_gather(const TemplateData& was, const TemplateData& is, const EditTrace& trace, const solve::RowChange& rows, const fem::ElementGroup& group,
                               const std::vector<std::array<std::int32_t, N>>& all, std::size_t first) {
    std::vector<std::array<std::int32_t, N>> elements;
    elements.reserve(group.element.size());
    for (const std::int32_t e : group.element) elements.push_back(all[std::size_t(e) - first]);
    const solve::GatherMap* map = nullptr;
    solve::GatherMap none;
    std::vector<std::int32_t> new_element;  // [place in the group before]
    for (std::size_t g = 0; g < was.layout.groups.size(); ++g) {
        if (was.layout.groups[g].kind != group.kind) continue;
        map = &was.gather[g];
        for (const std::int32_t e : was.layout.groups[g].element) {
            const std::int32_t now = trace.new_element[std::size_t(e)];
            new_element.push_back(now < 0 ? -1 : place_in(is.layout, group, now));
        }
    }
    if (map == nullptr) {  // the first elements of this kind
        none.start.assign(was.pattern.blocks() + 1, 0);
        map = &none;
    }
    const fem::ElementMap& around = is.layout.around;
    return solve::change_gather_map<N>(*map, was.pattern, is.pattern, rows, new_element, elements, [&](std::int32_t vertex, std::vector<std::int32_t>& out) {
        for (std::int64_t k = around.start[std::size_t(vertex)]; k < around.start[std::size_t(vertex) + 1]; ++k) {
            const auto e = std::size_t(around.element[std::size_t(k)]);
            if (e >= first && e < first + all.size()) out.push_back(place_in(is.layout, group, std::int32_t(e)));
        }
        std::sort(out.begin(), out.end());
    });
}

/// Rows before and after an edit.
struct FollowedRows {
    std::vector<std::int32_t> order, old_row, new_row;  ///< as in solve::RowChange
    std::vector<std::int32_t> row;                      ///< [vertex now]
    bool ordered = true;                                ///< those that go on have kept their order; else nothing can be taken over
};

FollowedRows follow_rows(const TemplateData& was, const VolumeMesh& mesh, const EditTrace& trace) {
    FollowedRows rows;
    rows.order = locality_order(mesh.vertices);
    rows.old_row.resize(rows.order.size());
    rows.row.resize(rows.order.size());
    for (std::size_t i = 0; i < rows.row.size(); ++i) {
        rows.row[std::size_t(rows.order[i])] = std::int32_t(i);
        const std::int32_t old = trace.old_vertex[std::size_t(rows.order[i])];
        rows.old_row[i] = old < 0 ? -1 : was.pattern.row[std::size_t(old)];
    }
    rows.new_row.resize(was.pattern.rows);
    std::int32_t last = -1;
    for (std::size_t i = 0; i < rows.new_row.size(); ++i) {
        const std::int32_t now = trace.new_vertex[std::size_t(was.pattern.vertex[i])];
        rows.new_row[i] = now < 0 ? -1 : rows.row[std::size_t(now)];
        if (now < 0) continue;
        rows.ordered = rows.ordered && rows.new_row[i] > last;
        last = rows.new_row[i];
    }
    return rows;
}

}  // namespace

std::shared_ptr<const BodyTemplate> BodyTemplate::edited(const MeshEdit& edit) const {
    const TemplateData& was = *data_;
    const EditTrace trace = trace_edit(was.mesh, edit.mesh, edit.delta);
    const bool good = trace.ordered && edit.mesh.tets.size() < kMaxTets && edit.mesh.hexes.size() < kMaxHexes && keeps_new_elements(edit.mesh, trace.old_element);
    if (!good) return build(edit.mesh);
    const FollowedRows rows = follow_rows(was, edit.mesh, trace);
    if (!rows.ordered) return build(edit.mesh);  // what is left is so much smaller that the curve through it is another one
    auto data = std::make_unique<TemplateData>();
    TemplateData& is = *data;
    is.mesh = edit.mesh;
    is.boundary = follow_boundary(was.boundary, is.mesh, trace);
    is.boundary_vertices = vertices_of(is.boundary, is.mesh.vertices.size());
    is.min_m = is.max_m = is.mesh.vertices[std::size_t(is.boundary_vertices[0])];
    for (const std::int32_t v : is.boundary_vertices) {
        is.min_m = is.min_m.cwiseMin(is.mesh.vertices[std::size_t(v)]);
        is.max_m = is.max_m.cwiseMax(is.mesh.vertices[std::size_t(v)]);
    }
    is.layout = fem::follow_layout(is.mesh, rows.row, was.layout, trace.old_element);
    const fem::ElementMap& around = is.layout.around;
    const solve::RowChange change{rows.order, rows.old_row, rows.new_row};
    is.pattern = solve::change_pattern(was.pattern, change, [&](std::int32_t vertex, std::vector<std::int32_t>& out) {
        for (std::int64_t k = around.start[std::size_t(vertex)]; k < around.start[std::size_t(vertex) + 1]; ++k) {
            const auto corners = element_vertices(is.mesh, std::size_t(around.element[std::size_t(k)]));
            out.insert(out.end(), corners.begin(), corners.end());
        }
    });
    for (const fem::ElementGroup& group : is.layout.groups)
        is.gather.push_back(group.kind == fem::ElementKind::tet ? follow_gather<4>(was, is, trace, change, group, is.mesh.tets, 0)
                                                                : follow_gather<8>(was, is, trace, change, group, is.mesh.hexes, is.mesh.tets.size()));
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
    data->pattern = solve::make_pattern(m.vertices.size(), m.tets, m.hexes, locality_order(m.vertices));
    data->layout = fem::make_layout(m, {}, data->pattern.row);
    data->gather = make_gather_maps(m, data->pattern, data->layout);
    return std::shared_ptr<const BodyTemplate>(new BodyTemplate(std::move(data)));
}

BodyTemplate::BodyTemplate(std::unique_ptr<const TemplateData> data) : data_(std::move(data)) {}
BodyTemplate::~BodyTemplate() = default;

const VolumeMesh& BodyTemplate::mesh() const { return data_->mesh; }
const MeshReport& BodyTemplate::report() const { return data_->mesh_report(); }
const BoundarySurface& BodyTemplate::boundary() const { return data_->boundary; }

}  // namespace supple
