#include "supple/world/edit_events.h"

#include <algorithm>
#include <cmath>

#include "supple/mesh/embedding.h"
#include "supple/mesh/topology.h"

namespace supple {

namespace {

[[noreturn]] void refuse(const std::string& where, const std::string& message) { throw Error(ErrorCode::invalid_argument, where, message); }

void check_times(double begin_s, double end_s, const std::string& where) {
    require_in_range(begin_s, 0, 1e9, where + ".begin_s");
    if (!(end_s >= begin_s && end_s <= 1e9)) refuse(where + ".end_s", to_text(end_s) + " is before begin_s " + to_text(begin_s) + ", or beyond 1e9");
}

/// The step before which a moment comes.
std::int64_t step_of(double time_s, double h) { return std::llround(time_s / h); }

std::vector<Vec3> pose(const CutEvent& cut, double s) {
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < cut.from_m.size(); ++i) out.push_back((1 - s) * cut.from_m[i] + s * cut.to_m[i]);
    return out;
}

}  // namespace

double mean_edge_m(const VolumeMesh& mesh) {
    double sum = 0;
    std::size_t count = 0;
    const auto add = [&](std::int32_t a, std::int32_t b) {
        sum += (mesh.vertices[std::size_t(a)] - mesh.vertices[std::size_t(b)]).norm();
        ++count;
    };
    for (const Tet& t : mesh.tets)
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = a + 1; b < 4; ++b) add(t[a], t[b]);
    for (const Hex& h : mesh.hexes)
        for (const auto& e : kHexEdges) add(h[std::size_t(e[0])], h[std::size_t(e[1])]);
    return count > 0 ? sum / double(count) : 0;
}

std::vector<std::int32_t> elements_near(const World& world, BodyId body, const Vec3& a, const Vec3& b, double radius_m) {
    const VolumeMesh& mesh = world.shape(body).mesh();
    const auto x = world.positions(body);
    const double length2 = (b - a).squaredNorm();
    std::vector<std::int32_t> out;
    for (std::size_t e = 0; e < mesh.element_count(); ++e) {
        const auto ids = element_vertices(mesh, e);
        Vec3 c = Vec3::Zero();
        for (const std::int32_t v : ids) c += x[std::size_t(v)] / double(ids.size());
        const double s = length2 > 0 ? std::clamp((c - a).dot(b - a) / length2, 0.0, 1.0) : 0;
        if ((c - a - s * (b - a)).norm() < radius_m) out.push_back(std::int32_t(e));
    }
    return out;
}

EditScript::EditScript(std::vector<CutEvent> cuts, std::vector<EraseEvent> erasures, std::vector<HealEvent> heals, std::vector<AddEvent> additions)
    : cuts_(std::move(cuts)), erasures_(std::move(erasures)), heals_(std::move(heals)), additions_(std::move(additions)) {
    for (const AddEvent& add : additions_) require_in_range(add.time_s, 0, 1e9, "AddEvent.time_s");
    for (const HealEvent& heal : heals_) {
        require_in_range(heal.time_s, 0, 1e9, "HealEvent.time_s");
        if (!(heal.def.gap_m > 0 && std::isfinite(heal.def.gap_m))) refuse("HealEvent.gap_m", to_text(heal.def.gap_m) + " must be above 0");
        require_in_range(heal.def.radius_m, 0, 1e9, "HealEvent.radius_m", "0: everywhere");
        if (!heal.def.centre_m.allFinite()) refuse("HealEvent.centre_m", "is not finite");
    }
    for (const CutEvent& cut : cuts_) {
        check_times(cut.begin_s, cut.end_s, "CutEvent");
        if (cut.from_m.size() < 2 || cut.from_m.size() != cut.to_m.size()) refuse("CutEvent.from_m", "needs two points or more, and as many in to_m");
        for (const auto* points : {&cut.from_m, &cut.to_m})
            if (!std::all_of(points->begin(), points->end(), [](const Vec3& p) { return p.allFinite(); })) refuse("CutEvent.from_m", "or to_m is not finite");
        require_in_range(cut.stride_m, 0, 1e9, "CutEvent.stride_m", "0 takes one and a half mean edges");
    }
    for (const EraseEvent& erase : erasures_) {
        check_times(erase.begin_s, erase.end_s, "EraseEvent");
        if (!erase.from_m.allFinite() || !erase.to_m.allFinite()) refuse("EraseEvent.from_m", "or to_m is not finite");
        if (!(erase.radius_m > 0 && std::isfinite(erase.radius_m))) refuse("EraseEvent.radius_m", to_text(erase.radius_m) + " must be above 0");
    }
}

std::size_t EditScript::before_step(World& world) const {
    const double h = world.def().time_step_s;
    const auto step = std::int64_t(world.step_count());
    std::size_t edits = 0;
    for (const CutEvent& cut : cuts_) {
        if (step < step_of(cut.begin_s, h) || step > step_of(cut.end_s, h)) continue;
        double way = 0;
        for (std::size_t i = 0; i < cut.from_m.size(); ++i) way = std::max(way, (cut.to_m[i] - cut.from_m[i]).norm());
        // Cuts change the mean edge a little and so where strides end; each begins a whole one behind, so nothing is left out.
        const double stride = cut.stride_m > 0 ? cut.stride_m : 1.5 * mean_edge_m(world.shape(cut.body).mesh());
        const int strides = cut.end_s > cut.begin_s ? std::max(1, int(std::ceil(way / stride))) : 1;
        for (int k = 0; k < strides; ++k) {
            if (step_of(cut.begin_s + (cut.end_s - cut.begin_s) * (k + 1) / strides, h) != step) continue;
            mesh::TriangleMesh blade;
            for (int j = std::max(0, k - 1); j <= k; ++j) {  // from a stride behind: elements at the seam are crossed wholly
                const auto strip = swept_blade(pose(cut, double(j) / strides), pose(cut, double(j + 1) / strides));
                const auto first = std::int32_t(blade.vertices.size());
                blade.vertices.insert(blade.vertices.end(), strip.vertices.begin(), strip.vertices.end());
                for (const Triangle& t : strip.triangles) blade.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
            }
            if (blade.triangles.empty()) continue;
            edits += !world.cut(cut.body, blade, cut.def).is_identity();
        }
    }
    for (const EraseEvent& erase : erasures_) {
        const std::int64_t first = step_of(erase.begin_s, h), last = step_of(erase.end_s, h);
        if (step < first || step > last) continue;
        const auto at = [&](std::int64_t i) {
            const double s = last > first ? std::clamp(double(i - first) / double(last - first), 0.0, 1.0) : 1.0;
            return Vec3((1 - s) * erase.from_m + s * erase.to_m);
        };
        const auto gone = elements_near(world, erase.body, at(step - 1), at(step), erase.radius_m);
        if (gone.empty() || gone.size() == world.shape(erase.body).mesh().element_count()) continue;
        edits += !world.remove_elements(erase.body, gone).is_identity();
    }
    for (const HealEvent& heal : heals_)
        if (step == step_of(heal.time_s, h)) edits += !world.heal(heal.body, heal.def).is_identity();
    for (const AddEvent& add : additions_)
        if (step == step_of(add.time_s, h)) edits += !world.add_elements(add.body, add.elements).is_identity();
    return edits;
}

}  // namespace supple
