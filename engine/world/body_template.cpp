#include "supple/world/body_template.h"

#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/fem/rest.h"
#include "supple/world/template_data.h"

namespace supple {

namespace {

constexpr std::size_t kMaxElements = std::size_t(1) << 28;  // gather maps hold element * 16 in 32 bits

}  // namespace

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
    if (!mesh.hexes.empty()) {
        throw Error(ErrorCode::unsupported, where,
                    std::to_string(mesh.hexes.size()) + " hexahedra: bodies are made of tetrahedra; split the hexes into tetrahedra");
    }
    if (mesh.tets.size() >= kMaxElements) {
        throw Error(ErrorCode::unsupported, where, std::to_string(mesh.tets.size()) + " elements are more than 2^28 - 1 in one body; split the mesh");
    }
    data->mesh = std::move(mesh);
    const VolumeMesh& m = data->mesh;
    data->boundary = extract_boundary(m);
    for (const Triangle& t : data->boundary.triangles) data->boundary_vertices.insert(data->boundary_vertices.end(), t.begin(), t.end());
    std::sort(data->boundary_vertices.begin(), data->boundary_vertices.end());
    data->boundary_vertices.erase(std::unique(data->boundary_vertices.begin(), data->boundary_vertices.end()), data->boundary_vertices.end());
    data->rest = fem::make_rest(m.vertices, m.tets);
    data->corners = fem::make_corner_map(m.vertices.size(), m.tets);
    data->pattern = solve::make_pattern(m.vertices.size(), m.tets);
    data->gather = solve::make_gather_map(data->pattern, m.tets);
    return std::shared_ptr<const BodyTemplate>(new BodyTemplate(std::move(data)));
}

BodyTemplate::BodyTemplate(std::unique_ptr<const TemplateData> data) : data_(std::move(data)) {}
BodyTemplate::~BodyTemplate() = default;

const VolumeMesh& BodyTemplate::mesh() const { return data_->mesh; }
const MeshReport& BodyTemplate::report() const { return data_->report; }
const BoundarySurface& BodyTemplate::boundary() const { return data_->boundary; }

}  // namespace supple
