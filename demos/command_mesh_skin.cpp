// mesh skin: embeds a fine surface in a mesh and writes its weights. mesh refine: eight elements of each one.
#include <cstdio>
#include <memory>

#include "command.h"
#include "command_mesh_parts.h"
#include "output_files.h"
#include "supple/io/mesh_file.h"
#include "supple/io/skin_file.h"
#include "supple/io/surface_file.h"
#include "supple/mesh/refine.h"
#include "supple/mesh/skin.h"

namespace supple::demos {

void write_skin_or_surface(const std::filesystem::path& file, const VolumeMesh& mesh, const mesh::TriangleMesh& surface) {
    const auto skin = Skin::build(mesh, surface);
    const Embedding::Report& report = skin->embedding().report();
    std::printf("  skin        %zu vertices, %zu triangles; %zu vertices outside of the mesh, the farthest by %.3g m (least weight %.3g)\n",
                skin->surface().vertices.size(), skin->surface().triangles.size(), report.outside, report.farthest_m, report.least_weight);
    if (file.extension() == ".skin")
        io::write_skin(file, *skin);
    else
        io::write_surface(file, skin->surface());
}

void add_mesh_skin_command(CLI::App& mesh, int& status) {
    struct Options {
        std::string mesh, surface, out;
        double scale = 1;
    };
    auto o = std::make_shared<Options>();
    CLI::App* command = mesh.add_subcommand("skin", "embed a fine surface in a mesh and write its weights for GPU skinning");
    command->add_option("mesh", o->mesh, "volume mesh file")->required();
    command->add_option("surface", o->surface, "surface file, in the coordinates of the mesh")->required();
    command->add_option("--out", o->out, "file to write, *.skin")->required();
    command->add_option("--scale", o->scale, "length multiplier of both [1]")->check(CLI::PositiveNumber);
    command->callback([o, &status] {
        require_writable(o->out);
        VolumeMesh volume = io::read_mesh(o->mesh);
        for (Vec3& x : volume.vertices) x *= o->scale;
        for (const std::string& sentence : check_and_repair(volume).sentences()) std::fprintf(stderr, "supple: %s: %s\n", o->mesh.c_str(), sentence.c_str());
        mesh::TriangleMesh surface = io::read_surface(o->surface);
        for (Vec3& x : surface.vertices) x *= o->scale;
        std::printf("%s\n", o->surface.c_str());
        write_skin_or_surface(o->out, volume, surface);
        status = kAllWell;
    });
}

void add_mesh_refine_command(CLI::App& mesh, int& status) {
    struct Options {
        std::string in, out;
        int times = 1;
    };
    auto o = std::make_shared<Options>();
    CLI::App* command = mesh.add_subcommand("refine", "cut every element into eight; regions and groups are kept");
    command->add_option("in", o->in, "mesh file")->required();
    command->add_option("out", o->out, "file to write")->required();
    command->add_option("--times", o->times, "how often [1]")->check(CLI::Range(1, 10));
    command->callback([o, &status] {
        require_writable(o->out);
        VolumeMesh volume = io::read_mesh(o->in);
        for (const std::string& sentence : check_and_repair(volume).sentences()) std::fprintf(stderr, "supple: %s: %s\n", o->in.c_str(), sentence.c_str());
        const VolumeMesh fine = refine(volume, o->times);
        io::write_mesh(o->out, fine);
        std::printf("%s: %zu elements, %zu vertices\n", o->out.c_str(), fine.element_count(), fine.vertices.size());
        status = kAllWell;
    });
}

}  // namespace supple::demos
