#include "cooked.h"

#include <algorithm>
#include <set>

#include "creature_shape.h"
#include "gallbladder_shape.h"
#include "gel_shape.h"
#include "kidney_shape.h"
#include "organs.h"
#include "supple/base/parallel.h"
#include "supple/mesh/isosurface_stuffing.h"
#include "supple/mesh/skin.h"
#include "supple/mesh/surface.h"

namespace supple_assets {
namespace {

using supple::CookKind;
using supple::Vec3;

void round_to_micrometres(std::vector<Vec3>& points) {
    for (Vec3& x : points)
        for (int k = 0; k < 3; ++k) x[k] = std::round(x[k] * 1e6) / 1e6;
}

supple::mesh::TriangleMesh surface_of(double (*shape)(const Vec3&), const Recipe& recipe, supple::Team& team) {
    supple::StuffingDef def;
    def.min_m = recipe.min_m;
    def.max_m = recipe.max_m;
    def.edge_m = recipe.skin_edge_m;
    const supple::VolumeMesh solid = supple::stuff_isosurface(shape, def, nullptr, &team);
    supple::mesh::TriangleMesh surface{solid.vertices, supple::extract_boundary(solid).triangles};
    round_to_micrometres(surface.vertices);
    return supple::weld(surface);
}

Vec3 centre_of(const supple::VolumeMesh& mesh, std::size_t e) {
    Vec3 centre = Vec3::Zero();
    const auto corners = supple::element_vertices(mesh, e);
    for (const std::int32_t v : corners) centre += mesh.vertices[std::size_t(v)];
    return centre / double(corners.size());
}

}  // namespace

const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> all{
        {"liver_vessels", liver, {-0.13, -0.11, -0.09}, {0.13, 0.11, 0.09}, 0.0045, {.kind = CookKind::tets, .elements = 12000},
         {{"portal", portal_vein}, {"hepatic", hepatic_veins}}, "ligament", at_liver_ligament},
        {"kidney", kidney, {-0.06, -0.08, -0.04}, {0.07, 0.08, 0.04}, 0.0024, {.kind = CookKind::tets, .elements = 9000}},
        {"gallbladder", gallbladder, {-0.04, -0.06, -0.03}, {0.04, 0.06, 0.04}, 0.0016, {.kind = CookKind::tets, .elements = 4000}},
        {"creature", creature, {-0.22, -0.02, -0.12}, {0.22, 0.26, 0.12}, 0.0040, {.kind = CookKind::cage, .elements = 5000}},
        {"gel", gel_block, {-0.08, -0.02, -0.07}, {0.08, 0.11, 0.07}, 0.0050, {.kind = CookKind::tets, .elements = 6000}, {{"inclusion", gel_inclusion}}},
    };
    return all;
}

Asset make_asset(const Recipe& recipe, supple::Team& team) {
    Asset asset;
    asset.skin = surface_of(recipe.shape, recipe, team);
    asset.mesh = supple::cook(asset.skin, recipe.cook, team, &asset.report);
    supple::VolumeMesh& mesh = asset.mesh;
    round_to_micrometres(mesh.vertices);
    mesh.regions = {{recipe.name, 1}};
    mesh.element_region.assign(mesh.element_count(), 0);
    for (const Inside& place : recipe.inside) {
        const auto region = std::int32_t(mesh.regions.size());
        mesh.regions.push_back({place.name, region + 1});
        for (std::size_t e = 0; e < mesh.element_count(); ++e)
            if (place.shape(centre_of(mesh, e)) < 0) mesh.element_region[e] = region;
        asset.inside.push_back(surface_of(place.shape, recipe, team));
    }
    if (recipe.in_group) {
        std::set<std::int32_t> chosen;
        for (const supple::Triangle& t : supple::extract_boundary(mesh).triangles)
            for (const std::int32_t v : t)
                if (recipe.in_group(mesh.vertices[std::size_t(v)])) chosen.insert(v);
        mesh.groups = {{recipe.group, {chosen.begin(), chosen.end()}}};
    }
    mesh.source = recipe.name;
    return asset;
}

}  // namespace supple_assets
