// make_assets [DIRECTORY]: writes the organs of this directory as Gmsh 2.2 files.
#include <cstdio>
#include <filesystem>

#include "organs.h"
#include "supple/base/error.h"
#include "supple/io/mesh_file.h"
#include "supple/mesh/quality.h"

int main(int argc, char** argv) {
    if (argc > 2 || (argc == 2 && argv[1][0] == '-')) {
        std::fprintf(stderr, "usage: make_assets [DIRECTORY]   writes liver.msh there (default: the current directory)\n");
        return 2;
    }
    const std::filesystem::path file = std::filesystem::path(argc == 2 ? argv[1] : ".") / "liver.msh";
    try {
        const supple::VolumeMesh mesh = supple_assets::make_liver();
        supple::io::write_mesh(file, mesh);
        const supple::MeshQuality quality = supple::tet_mesh_quality(mesh);
        std::printf("%s: %zu tets, %zu vertices (%zu in \"ligament\"), dihedral angles %.1f to %.1f degrees\n", file.string().c_str(),
                    mesh.tets.size(), mesh.vertices.size(), mesh.groups[0].vertices.size(), quality.min_dihedral_deg,
                    quality.max_dihedral_deg);
    } catch (const supple::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
    return 0;
}
