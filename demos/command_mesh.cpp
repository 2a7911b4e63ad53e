#include <cstdio>
#include <map>
#include <memory>

#include "command.h"
#include "command_mesh_parts.h"
#include "output_files.h"
#include "supple/base/error.h"
#include "supple/io/mesh_file.h"
#include "supple/mesh/surface.h"

namespace supple::demos {
namespace {

struct MeshOptions {
    std::string in, out;
    double scale = 1;
};

void print_regions(const VolumeMesh& mesh) {
    std::map<std::int32_t, std::size_t> elements;
    for (const std::int32_t region : mesh.element_region) ++elements[region];
    for (std::size_t i = 0; i < mesh.regions.size(); ++i)
        std::printf("  region      %s (tag %d): %zu elements\n", mesh.regions[i].name.c_str(), mesh.regions[i].tag,
                    elements[static_cast<std::int32_t>(i)]);
    for (const VertexGroup& group : mesh.groups) std::printf("  group       %s: %zu vertices\n", group.name.c_str(), group.vertices.size());
}

int info(const MeshOptions& o) {
    VolumeMesh mesh = io::read_mesh(o.in);
    const MeshReport report = check_and_repair(mesh);
    const BoundarySurface boundary = extract_boundary(mesh);
    const Vec3 size = report.max_m - report.min_m;
    std::printf("%s\n", o.in.c_str());
    std::printf("  vertices    %zu\n  tets        %zu\n  hexes       %zu\n", mesh.vertices.size(), mesh.tets.size(), mesh.hexes.size());
    std::printf("  boundary    %zu triangles\n  components  %zu\n", boundary.triangles.size(), report.components);
    std::printf("  box         %.6g %.6g %.6g .. %.6g %.6g %.6g (size %.6g %.6g %.6g)\n", report.min_m.x(), report.min_m.y(), report.min_m.z(),
                report.max_m.x(), report.max_m.y(), report.max_m.z(), size.x(), size.y(), size.z());
    std::printf("  volume      %.9g\n", report.volume_m3);
    print_regions(mesh);
    for (const std::string& sentence : report.sentences()) std::printf("  found       %s\n", sentence.c_str());
    if (report.sentences().empty()) std::printf("  found       nothing to repair\n");
    return kAllWell;
}

int convert(const MeshOptions& o) {
    const std::string ending = std::filesystem::path(o.out).extension().string();
    if (ending != ".msh")
        throw Error(ErrorCode::unsupported, o.out, "the ending \"" + ending + "\" is unknown; this version writes Gmsh 2.2 (.msh)");
    require_writable(o.out);
    VolumeMesh mesh = io::read_mesh(o.in);
    for (const std::string& sentence : check_and_repair(mesh).sentences()) std::fprintf(stderr, "supple: %s: %s\n", o.in.c_str(), sentence.c_str());
    for (Vec3& x : mesh.vertices) x *= o.scale;
    io::write_mesh(o.out, mesh);
    return kAllWell;
}

}  // namespace

void add_mesh_command(CLI::App& app, int& status) {
    CLI::App* mesh = app.add_subcommand("mesh", "look at and convert volume meshes");
    mesh->require_subcommand(1);
    add_mesh_cook_command(*mesh, status);
    add_mesh_skin_command(*mesh, status);
    add_mesh_refine_command(*mesh, status);
    auto o = std::make_shared<MeshOptions>();
    CLI::App* info_command = mesh->add_subcommand("info", "count, measure and check a mesh");
    info_command->add_option("file", o->in, "mesh file")->required();
    info_command->callback([o, &status] { status = info(*o); });
    CLI::App* convert_command = mesh->add_subcommand("convert", "repair a mesh and write it as Gmsh 2.2");
    convert_command->add_option("in", o->in, "mesh file")->required();
    convert_command->add_option("out", o->out, "file to write, *.msh")->required();
    convert_command->add_option("--scale", o->scale, "length multiplier [1]")->check(CLI::PositiveNumber);
    convert_command->callback([o, &status] { status = convert(*o); });
}

}  // namespace supple::demos
