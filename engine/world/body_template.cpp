#include "supple/world/body_template.h"

#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/mesh/locality.h"
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

}  // namespace

std::vector<solve::GatherMap> make_gather_maps(const VolumeMesh& mesh, const solve::Bsr3Pattern& pattern, const fem::ElementLayout& layout) {
    std::vector<solve::GatherMap> maps;
    for (const fem::ElementGroup& group : layout.groups) {
        maps.push_back(group.kind == fem::ElementKind::tet ? gather_map(pattern, mesh.tets, group.element, 0)
                                                           : gather_map(pattern, mesh.hexes, group.element, mesh.tets.size()));
    }
    return maps;
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
    data->report = check_and_repair(mesh);
    if (mesh.tets.size() >= kMaxTets || mesh.hexes.size() >= kMaxHexes) {
        throw Error(ErrorCode::unsupported, where,
                    std::to_string(mesh.tets.size()) + " tetrahedra and " + std::to_string(mesh.hexes.size()) +
                        " hexahedra are more than 2^28 - 1 and 2^26 - 1 in one body; split the mesh");
    }
    data->mesh = std::move(mesh);
    const VolumeMesh& m = data->mesh;
    data->boundary = extract_boundary(m);
    for (const Triangle& t : data->boundary.triangles) data->boundary_vertices.insert(data->boundary_vertices.end(), t.begin(), t.end());
    std::sort(data->boundary_vertices.begin(), data->boundary_vertices.end());
    data->boundary_vertices.erase(std::unique(data->boundary_vertices.begin(), data->boundary_vertices.end()), data->boundary_vertices.end());
    data->pattern = solve::make_pattern(m.vertices.size(), m.tets, m.hexes, locality_order(m.vertices));
    data->layout = fem::make_layout(m, {}, data->pattern.row);
    data->gather = make_gather_maps(m, data->pattern, data->layout);
    return std::shared_ptr<const BodyTemplate>(new BodyTemplate(std::move(data)));
}

BodyTemplate::BodyTemplate(std::unique_ptr<const TemplateData> data) : data_(std::move(data)) {}
BodyTemplate::~BodyTemplate() = default;

const VolumeMesh& BodyTemplate::mesh() const { return data_->mesh; }
const MeshReport& BodyTemplate::report() const { return data_->report; }
const BoundarySurface& BodyTemplate::boundary() const { return data_->boundary; }

}  // namespace supple
