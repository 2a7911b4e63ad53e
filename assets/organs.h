#pragma once
// The organs of this directory, made from their implicit shapes.
#include <cmath>
#include <set>

#include "liver_shape.h"
#include "supple/mesh/isosurface_stuffing.h"
#include "supple/mesh/surface.h"

namespace supple_assets {

inline constexpr double kLiverEdge_m = 0.0135;

/// The upper rear attachment: the bare area with the coronary ligament, and the falciform ligament over the top.
inline bool at_liver_ligament(const Point& x) {
    const bool coronary =
        x[0] > -0.080 && x[0] < 0.056 && x[1] > 0.024 - 0.05 * std::min(x[0], 0.0) && x[2] < -0.014 + 0.35 * (x[0] > 0 ? x[0] : 0.0);
    const bool falciform = std::abs(x[0] - 0.026 - 0.10 * x[1]) < 0.010 && x[1] > 0.036 && x[2] < 0.030;
    return coronary || falciform;
}

/// Region "liver", vertex group "ligament" (surface vertices). Coordinates are rounded to a micrometre.
inline supple::VolumeMesh make_liver(double edge_m = kLiverEdge_m) {
    supple::StuffingDef def;
    def.min_m = {-0.13, -0.11, -0.09};
    def.max_m = {0.13, 0.11, 0.09};
    def.edge_m = edge_m;
    const auto shape = [](const supple::Vec3& x) { return liver(x); };
    supple::VolumeMesh mesh = supple::stuff_isosurface(shape, def);
    for (supple::Vec3& x : mesh.vertices)
        for (int k = 0; k < 3; ++k) x[k] = std::round(x[k] * 1e6) / 1e6;
    mesh.regions = {{"liver", 1}};
    mesh.element_region.assign(mesh.element_count(), 0);
    std::set<std::int32_t> ligament;
    for (const supple::Triangle& t : supple::extract_boundary(mesh).triangles)
        for (const std::int32_t v : t)
            if (at_liver_ligament(mesh.vertices[v])) ligament.insert(v);
    mesh.groups = {{"ligament", {ligament.begin(), ligament.end()}}};
    mesh.source = "liver";
    return mesh;
}

}  // namespace supple_assets
