#include <cstdio>
#include <memory>

#include "command.h"
#include "command_mesh_parts.h"
#include "mesh_info.h"
#include "output_files.h"
#include "supple/base/error.h"
#include "supple/io/mesh_file.h"
#include "supple/io/mesh_formats.h"
#include "supple/io/mesh_units.h"
#include "supple/io/surface_file.h"
#include "supple/mesh/surface.h"

namespace supple::demos {
namespace {

struct MeshOptions {
    std::string in, out, format;
    double scale = 1;
    std::string unit = "m", up = "y";
    bool as_json = false, keep_faults = false, drop_fill = false;

    io::MeshUnits units() const { return {scale, unit, up}; }
};

/// What a file holds: a volume mesh where it can be one, otherwise a surface.
struct Content {
    VolumeMesh volume;
    mesh::TriangleMesh surface;
    bool is_volume = true;
};

Content read(const MeshOptions& o) {
    Content content;
    try {
        content.volume = io::read_mesh(o.in);
        o.units().apply(content.volume.vertices);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::surface_mesh) throw;
        content.is_volume = false;
        content.surface = io::read_surface(o.in);
        o.units().apply(content.surface.vertices);
    }
    return content;
}

int info(const MeshOptions& o) {
    Content content = read(o);
    const std::string text =
        content.is_volume ? describe(std::move(content.volume), o.in, o.as_json) : describe(content.surface, o.in, o.as_json);
    std::fputs(text.c_str(), stdout);
    return kAllWell;
}

/// The boundary of a volume mesh as a surface of its own.
mesh::TriangleMesh boundary_of(const VolumeMesh& mesh) {
    mesh::TriangleMesh surface{{}, extract_boundary(mesh).triangles};
    std::vector<std::int32_t> number(mesh.vertices.size(), -1);
    for (const Triangle& t : surface.triangles)
        for (const std::int32_t v : t) number[std::size_t(v)] = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] < 0) continue;
        number[v] = std::int32_t(surface.vertices.size());
        surface.vertices.push_back(mesh.vertices[v]);
    }
    for (Triangle& t : surface.triangles)
        for (std::int32_t& v : t) v = number[std::size_t(v)];
    return surface;
}

/// Whether the output is a surface format.
bool writes_surface(const MeshOptions& o) {
    try {
        io::choose_surface_format(o.out, o.format);
        return true;
    } catch (const Error&) {
        return false;
    }
}

int convert(const MeshOptions& o) {
    const bool to_surface = writes_surface(o);
    if (!to_surface) io::choose_volume_format(o.out, o.format);  // an unknown one is refused before any work
    require_writable(o.out);
    Content content = read(o);
    if (!content.is_volume) {
        if (!to_surface)
            throw Error(ErrorCode::surface_mesh, o.in,
                        "this is a surface, and " + o.out + " holds a volume mesh; fill it first (`supple mesh cook`), or write .obj, .stl, .ply or .off");
        io::write_surface(o.out, content.surface, o.format);
        return kAllWell;
    }
    VolumeMesh& mesh = content.volume;
    if (!o.keep_faults)
        for (const std::string& sentence : check_and_repair(mesh).sentences())
            std::fprintf(stderr, "supple: %s: %s\n", o.in.c_str(), sentence.c_str());
    if (to_surface) {
        io::write_surface(o.out, boundary_of(mesh), o.format);
        return kAllWell;
    }
    const io::OutputFormat& format = io::choose_volume_format(o.out, o.format);
    if (!format.loses.empty() && !(mesh.regions.empty() && mesh.groups.empty()))
        std::fprintf(stderr, "supple: %s: %s files cannot hold %s\n", o.out.c_str(), std::string(format.title).c_str(), std::string(format.loses).c_str());
    if (o.drop_fill) mesh.fill.clear();
    if (!mesh.fill.empty() && format.key.substr(0, 4) != "gmsh")
        throw Error(ErrorCode::unsupported, o.out, "this mesh has elements that are filled in part, which only Gmsh files (.msh) hold; --drop-fill writes them as full ones");
    io::write_mesh(o.out, mesh, o.format);
    return kAllWell;
}

int list_formats() {
    std::printf("read:\n");
    for (const io::InputFormat& f : io::input_formats())
        if (f.read || f.read_surface)
            std::printf("  %-20s %s%s\n", std::string(f.endings).c_str(), std::string(f.title).c_str(), f.is_surface ? " (surfaces)" : "");
    std::printf("written (convert --format NAME; without it the first of the ending):\n");
    for (const io::OutputFormat& f : io::output_formats())
        std::printf("  %-20s %-11s %s%s\n", std::string(f.key).c_str(), std::string(f.endings).c_str(), std::string(f.title).c_str(),
                    f.write ? "" : " (surfaces)");
    return kAllWell;
}

void add_units(CLI::App& command, MeshOptions& o) {
    command.add_option("--scale", o.scale, "length multiplier [1]")->check(CLI::PositiveNumber);
    command.add_option("--units", o.unit, "of the file's lengths: m, dm, cm, mm, um, km, in, ft [m]");
    command.add_option("--up", o.up, "the file's axis that points up and becomes y: x, y, z, -x, -y, -z [y]");
}

}  // namespace

void add_mesh_command(CLI::App& app, int& status) {
    CLI::App* mesh = app.add_subcommand("mesh", "look at and convert volume and surface meshes");
    mesh->require_subcommand(1);
    add_mesh_cook_command(*mesh, status);
    add_mesh_skin_command(*mesh, status);
    add_mesh_refine_command(*mesh, status);
    auto o = std::make_shared<MeshOptions>();
    CLI::App* info_command = mesh->add_subcommand("info", "count, measure and check a mesh or a surface");
    info_command->add_option("file", o->in, "mesh file")->required();
    info_command->add_flag("--json", o->as_json, "as JSON");
    add_units(*info_command, *o);
    info_command->callback([o, &status] { status = info(*o); });
    CLI::App* convert_command = mesh->add_subcommand("convert", "repair a mesh and write it in another format; a surface format gets a volume's boundary");
    convert_command->add_option("in", o->in, "mesh file")->required();
    convert_command->add_option("out", o->out, "file to write")->required();
    convert_command->add_option("--format", o->format, "one that `supple mesh formats` names [by the ending of the file]");
    convert_command->add_flag("--keep-faults", o->keep_faults, "do not repair inverted, flat and repeated elements");
    convert_command->add_flag("--drop-fill", o->drop_fill, "write elements that are filled in part as full ones");
    add_units(*convert_command, *o);
    convert_command->callback([o, &status] { status = convert(*o); });
    CLI::App* formats_command = mesh->add_subcommand("formats", "list what is read and written");
    formats_command->callback([&status] { status = list_formats(); });
}

}  // namespace supple::demos
