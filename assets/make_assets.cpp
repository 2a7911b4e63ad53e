// make_assets DIRECTORY [NAME...]: writes the assets that are cooked (all, or those named) as Gmsh 2.2 meshes with PLY skins, or "liver", the mesh that is
// committed beside this program.
#include <cstdio>
#include <filesystem>
#include <string>

#include "cooked.h"
#include "organs.h"
#include "supple/base/error.h"
#include "supple/base/parallel.h"
#include "supple/io/mesh_file.h"
#include "supple/io/surface_file.h"
#include "supple/mesh/quality.h"

namespace {

namespace fs = std::filesystem;

void print(const fs::path& file, const supple::VolumeMesh& mesh) {
    const supple::MeshQuality quality = supple::tet_mesh_quality(mesh);
    std::printf("%s: %zu %s, %zu vertices", file.string().c_str(), mesh.element_count(), mesh.hexes.empty() ? "tets" : "hexes", mesh.vertices.size());
    if (!mesh.tets.empty()) std::printf(", dihedral angles %.1f to %.1f degrees", quality.min_dihedral_deg, quality.max_dihedral_deg);
    for (const auto& group : mesh.groups) std::printf(", %zu vertices in \"%s\"", group.vertices.size(), group.name.c_str());
    std::printf("\n");
}

void write(const fs::path& folder, const supple_assets::Recipe& recipe, supple::Team& team) {
    const supple_assets::Asset asset = supple_assets::make_asset(recipe, team);
    const fs::path file = folder / (recipe.name + ".msh");
    supple::io::write_mesh(file, asset.mesh, "gmsh22-binary");
    supple::io::write_surface(folder / (recipe.name + ".ply"), asset.skin, "ply");
    for (std::size_t i = 0; i < asset.inside.size(); ++i)
        supple::io::write_surface(folder / (recipe.name + "." + recipe.inside[i].name + ".ply"), asset.inside[i], "ply");
    print(file, asset.mesh);
    std::printf("  skin of %zu triangles; %.2f %% of the volume\n", asset.skin.triangles.size(), 100 * asset.report.volume_m3 / asset.report.region_volume_m3);
    for (const std::string& sentence : asset.report.sentences()) std::printf("  note: %s\n", sentence.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') {
        std::fprintf(stderr, "usage: make_assets DIRECTORY [NAME...]   writes the cooked assets there; NAME: liver");
        for (const auto& recipe : supple_assets::recipes()) std::fprintf(stderr, ", %s", recipe.name.c_str());
        std::fprintf(stderr, "\n");
        return 2;
    }
    try {
        const fs::path folder = argv[1];
        fs::create_directories(folder);
        supple::Team team(supple::hardware_threads());
        for (int i = 2; i < argc; ++i) {
            bool known = std::string(argv[i]) == "liver";
            for (const auto& recipe : supple_assets::recipes()) known = known || recipe.name == argv[i];
            if (!known) {
                std::fprintf(stderr, "make_assets: %s is no asset; call it without arguments for the names\n", argv[i]);
                return 2;
            }
            if (std::string(argv[i]) != "liver") continue;
            const supple::VolumeMesh mesh = supple_assets::make_liver();
            supple::io::write_mesh(folder / "liver.msh", mesh);
            print(folder / "liver.msh", mesh);
        }
        for (const auto& recipe : supple_assets::recipes()) {
            bool wanted = argc == 2;
            for (int i = 2; i < argc; ++i) wanted = wanted || recipe.name == argv[i];
            if (wanted) write(folder, recipe, team);
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make_assets: %s\n", error.what());
        return 2;
    }
    return 0;
}
