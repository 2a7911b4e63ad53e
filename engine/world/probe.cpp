#include "supple/world/probe.h"

#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/fem/element_geometry.h"
#include "supple/mesh/selection.h"
#include "supple/world/impl.h"

namespace supple {

namespace {

void check_threshold(double value, const char* field) {
    if (!(value > 0)) throw Error(ErrorCode::invalid_argument, field, to_text(value) + " must be above 0; leave it out to have no threshold");
}

void make_fractions(std::vector<double>& weights) {
    double sum = 0;
    for (const double w : weights) sum += w;
    for (double& w : weights) w = sum > 0 ? w / sum : 1.0 / double(weights.size());
}

}  // namespace

Probe::Probe(const World& world, BodyId body, const ProbeDef& def) : def_(def), body_(body) {
    if (def_.name.empty()) def_.name = "probe";
    check_threshold(def.threshold_pa, "ProbeDef.threshold_pa");
    check_threshold(def.threshold_m, "ProbeDef.threshold_m");
    select_some(world.shape(body).data(), world.name(body), def.where, "ProbeDef.where");  // none is refused
    edits_ = world.edit_count(body);
    if (const auto* list = std::get_if<VertexList>(&def.where)) {
        const std::vector<std::uint32_t> ids = world.vertex_ids(body);
        for (const std::int32_t v : list->vertices) listed_.push_back(ids[std::size_t(v)]);
        std::sort(listed_.begin(), listed_.end());
    }
    select(world);
    sample_.time_s = world.time_s();
}

void Probe::select(const World& world) {
    const VolumeMesh& mesh = world.shape(body_).mesh();
    if (!listed_.empty()) {
        const std::vector<std::uint32_t> ids = world.vertex_ids(body_);
        VertexList list;
        for (std::size_t v = 0; v < ids.size(); ++v)
            if (std::binary_search(listed_.begin(), listed_.end(), ids[v])) list.vertices.push_back(std::int32_t(v));
        def_.where = std::move(list);
    }
    vertices_ = select_vertices(mesh, def_.where);
    vertex_weight_.clear();
    stress_weight_.clear();
    std::vector<double> share(mesh.vertices.size(), 0.0);
    for (std::size_t e = 0; e < mesh.element_count(); ++e) {
        const fem::ElementGeometry g = fem::element_geometry(mesh, e);
        for (std::size_t a = 0; a < g.corners; ++a) share[std::size_t(g.vertex[a])] += g.volume / double(g.corners);
    }
    for (const std::int32_t v : vertices_) vertex_weight_.push_back(share[std::size_t(v)]);
    make_fractions(vertex_weight_);
    stressed_ = select_elements(mesh, def_.where);
    on_elements_ = !stressed_.empty();
    if (on_elements_) {
        for (const std::int32_t e : stressed_) stress_weight_.push_back(fem::element_geometry(mesh, std::size_t(e)).volume);
        make_fractions(stress_weight_);
    } else {
        stressed_ = vertices_;
        stress_weight_ = vertex_weight_;
    }
    start_ = world.start_positions(body_);
}

const ProbeSample& Probe::read(const World& world) {
    if (const std::uint64_t edits = world.edit_count(body_); edits != edits_) {
        edits_ = edits;
        select(world);
    }
    const double before_s = sample_.time_s, over_s = sample_.over_threshold_s, displaced_s = sample_.displaced_s;
    sample_ = {};
    sample_.time_s = world.time_s();
    world.stress(body_, {.strain = def_.strain, .at = on_elements_ ? StressAt::element : StressAt::vertex}, field_);
    for (std::size_t i = 0; i < stressed_.size(); ++i) {
        const double s = field_.von_mises_pa[std::size_t(stressed_[i])];
        sample_.mean_von_mises_pa += stress_weight_[i] * s;
        if (sample_.peak_at >= 0 && !(s > sample_.peak_von_mises_pa)) continue;
        sample_.peak_von_mises_pa = s;
        sample_.peak_at = stressed_[i];
    }
    const auto x = world.positions(body_);
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
        const std::size_t v = std::size_t(vertices_[i]);
        const double d = (x[v] - start_[v]).norm();
        sample_.mean_displacement_m += vertex_weight_[i] * d;
        sample_.peak_displacement_m = std::max(sample_.peak_displacement_m, d);
    }
    if (sample_.time_s < before_s) return sample_;  // the world went back
    const double elapsed_s = sample_.time_s - before_s;
    sample_.over_threshold_s = over_s + (sample_.peak_von_mises_pa > def_.threshold_pa ? elapsed_s : 0);
    sample_.displaced_s = displaced_s + (sample_.peak_displacement_m > def_.threshold_m ? elapsed_s : 0);
    return sample_;
}

}  // namespace supple
