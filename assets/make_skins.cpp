// make_skins [DIRECTORY]: writes the skinned assets: NAME.msh, cooked by the engine's own cook from the fine surface NAME_skin.ply of an implicit shape.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "skin_shapes.h"
#include "supple/base/error.h"
#include "supple/base/parallel.h"
#include "supple/io/mesh_file.h"
#include "supple/io/surface_file.h"
#include "supple/mesh/cook.h"
#include "supple/mesh/skin.h"

namespace {

using namespace supple_assets;
using supple::Vec3;
using Shape = double (*)(const Point&);

struct Asset {
    const char* name;
    Shape shape;
    Vec3 min_m, max_m;
    double skin_edge_m;     ///< of the lattice that the fine surface comes from
    std::size_t elements;
    const char* region;
    Shape inner = nullptr;  ///< elements whose centre lies in it are another region
    const char* inner_region = nullptr;
};

const Asset kAssets[] = {
    {"liver_vessels", liver, {-0.13, -0.11, -0.09}, {0.13, 0.11, 0.09}, 0.0050, 9000, "parenchyma", liver_vessels, "vessels"},
    {"kidney", kidney, {-0.05, -0.07, -0.04}, {0.06, 0.07, 0.04}, 0.0024, 4000, "kidney"},
    {"gallbladder", gallbladder, {-0.04, -0.06, -0.04}, {0.04, 0.07, 0.04}, 0.0020, 2500, "gallbladder"},
    {"creature", creature, {-0.20, -0.02, -0.36}, {0.20, 0.52, 0.36}, 0.0110, 5000, "flesh"},
    {"gel_block", gel_block, {-0.11, -0.08, -0.08}, {0.11, 0.08, 0.08}, 0.0060, 5000, "gel", gel_inclusion, "inclusion"},
};

/// The boundary of a fine stuffing, in micrometres: the same bytes every time.
supple::mesh::TriangleMesh fine_surface(const Asset& asset, supple::Team& team) {
    supple::StuffingDef def;
    def.min_m = asset.min_m;
    def.max_m = asset.max_m;
    def.edge_m = asset.skin_edge_m;
    const auto shape = [&](const Vec3& x) { return asset.shape(x); };
    supple::VolumeMesh fine = supple::stuff_isosurface(shape, def, nullptr, &team);
    for (Vec3& x : fine.vertices)
        for (int k = 0; k < 3; ++k) x[k] = std::round(x[k] * 1e6) / 1e6;
    return supple::weld({fine.vertices, supple::extract_boundary(fine).triangles});
}

void make(const Asset& asset, const std::filesystem::path& folder) {
    supple::Team team(supple::hardware_threads());
    const supple::mesh::TriangleMesh surface = fine_surface(asset, team);
    supple::io::write_surface(folder / (std::string(asset.name) + "_skin.ply"), surface);
    supple::CookReport report;
    supple::VolumeMesh mesh = supple::cook(surface, {.elements = asset.elements}, team, &report);
    for (Vec3& x : mesh.vertices)
        for (int k = 0; k < 3; ++k) x[k] = std::round(x[k] * 1e6) / 1e6;
    mesh.regions = {{asset.region, 1}};
    mesh.element_region.assign(mesh.element_count(), 0);
    std::size_t inner = 0;
    if (asset.inner != nullptr) {
        mesh.regions.push_back({asset.inner_region, 2});
        for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
            Vec3 centre = Vec3::Zero();
            for (const std::int32_t v : mesh.tets[e]) centre += 0.25 * mesh.vertices[std::size_t(v)];
            if (asset.inner(centre) >= 0) continue;
            mesh.element_region[e] = 1;
            ++inner;
        }
    }
    supple::io::write_mesh(folder / (std::string(asset.name) + ".msh"), mesh, "gmsh22-binary");
    const auto skin = supple::Skin::build(mesh, surface);
    std::printf("%s: %zu tets (%zu inside), %zu vertices, dihedral angles %.1f to %.1f degrees, %.1f %% of the volume; skin of %zu triangles, at most %.2g m outside\n", asset.name,
                mesh.tets.size(), inner, mesh.vertices.size(), report.quality.min_dihedral_deg, report.quality.max_dihedral_deg,
                100 * report.volume_m3 / report.region_volume_m3, surface.triangles.size(), skin->embedding().report().farthest_m);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 2 || (argc == 2 && argv[1][0] == '-')) {
        std::fprintf(stderr, "usage: make_skins [DIRECTORY]   writes the skinned assets there (default: the current directory)\n");
        return 2;
    }
    try {
        for (const Asset& asset : kAssets) make(asset, argc == 2 ? argv[1] : ".");
    } catch (const supple::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
    return 0;
}
