// mesh cook: a closed surface becomes a mesh of tets or hexes, or a cage around it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "command.h"
#include "command_mesh_parts.h"
#include "output_files.h"
#include "supple/base/clock.h"
#include "supple/base/error.h"
#include "supple/io/mesh_file.h"
#include "supple/io/report.h"
#include "supple/io/skin_file.h"
#include "supple/io/surface_file.h"
#include "supple/mesh/cook.h"
#include "supple/world/world.h"

namespace supple::demos {
namespace {

struct CookOptions {
    std::string in, out, skin;
    bool tets = false, hexes = false, cage = false;
    std::size_t elements = 20000;
    double edge_m = 0, budget_ms = 0, scale = 1;
    double young_pa = 1e4, time_step_s = 1.0 / 60;
    int threads = 0;
    CookKind kind() const { return hexes ? CookKind::hexes : cage ? CookKind::cage : CookKind::tets; }
};

int threads_of(const CookOptions& o) { return o.threads > 0 ? o.threads : hardware_threads(); }

/// Time of a step of a mesh that stands on its lowest tenth and sags, as a body of this stiffness at this time step would [ms]: the least of three medians, as what
/// else this machine does at the moment is not the mesh's fault.
double measure_step_ms(const VolumeMesh& mesh, const CookOptions& o) {
    WorldDef def;
    def.threads = o.threads;
    def.time_step_s = o.time_step_s;
    World world(def);
    BodyDef body;
    body.shape = BodyTemplate::build(mesh);
    body.material = Corotational{.young_pa = o.young_pa, .poisson = 0.4};
    const BodyId id = world.add_body(body);
    const MeshReport& report = world.shape(id).report();
    const double foot = report.min_m.y() + 0.1 * (report.max_m.y() - report.min_m.y());
    world.fix(id, InsideBox{report.min_m, Vec3(report.max_m.x(), foot, report.max_m.z())});
    constexpr int kWarmUp = 5, kSteps = 15, kBatches = 3;
    for (int i = 0; i < kWarmUp; ++i) world.step();
    double least = 1e300;
    for (int batch = 0; batch < kBatches; ++batch) {
        std::vector<double> ms;
        for (int i = 0; i < kSteps; ++i) ms.push_back(world.step().step_ms);
        least = std::min(least, io::median(ms));
    }
    return least;
}

/// The largest mesh whose steps stay within the budget, by trial: the time of a step goes about as the number of elements.
VolumeMesh cook_for_budget(const SolidRegion& region, const mesh::TriangleMesh& surface, double volume_m3, const CookOptions& o, Team& team, CookReport& report) {
    constexpr double kGoal = 0.9, kGood = 0.8;  // of the budget: aimed at, and good enough
    constexpr std::size_t kFewest = 50, kMost = 2000000;
    VolumeMesh best;
    std::size_t elements = 2000, fits = 0, too_many = kMost + 1;
    for (int i = 0; i < 8; ++i) {
        CookReport trial;
        VolumeMesh mesh = cook(region, surface, volume_m3, {.kind = o.kind(), .elements = elements}, team, &trial);
        const double ms = measure_step_ms(mesh, o);
        std::printf("  tried       %zu elements: %.2f ms a step\n", mesh.element_count(), ms);
        if (ms <= o.budget_ms && elements > fits) {
            fits = elements;
            best = std::move(mesh);
            report = trial;
        } else if (ms > o.budget_ms) {
            too_many = std::min(too_many, elements);
        }
        if (ms <= o.budget_ms && ms >= kGood * o.budget_ms) break;
        const double wanted = double(elements) * std::clamp(kGoal * o.budget_ms / ms, 0.1, 10.0);
        std::size_t next = std::size_t(std::clamp(wanted, double(kFewest), double(kMost)));
        if (fits > 0 && too_many <= kMost && (next <= fits || next >= too_many)) next = (fits + too_many) / 2;
        if (next == elements || (fits > 0 && double(too_many) < 1.1 * double(fits))) break;
        elements = next;
    }
    if (best.element_count() == 0)
        throw Error(ErrorCode::invalid_argument, "--budget-ms " + to_text(o.budget_ms),
                    "even the coarsest mesh of this shape takes longer for a step; give a longer budget, or a softer material (--young)");
    return best;
}

void print(const VolumeMesh& mesh, const CookReport& report, double seconds) {
    std::printf("  elements    %zu %s, %zu vertices, lattice edge %.6g m\n", mesh.element_count(), mesh.hexes.empty() ? "tets" : "hexes", mesh.vertices.size(), report.edge_m);
    std::printf("  volume      %.6g m^3, %.2f %% of what the surface encloses (%.6g m^3)\n", report.volume_m3, 100 * report.volume_m3 / report.region_volume_m3,
                report.region_volume_m3);
    if (!mesh.tets.empty()) std::printf("  dihedral    %.2f to %.2f degrees\n", report.quality.min_dihedral_deg, report.quality.max_dihedral_deg);
    if (!mesh.fill.empty()) {
        const auto partly = std::count_if(mesh.fill.begin(), mesh.fill.end(), [](double f) { return f < 1; });
        std::printf("  fill        %td elements are filled in part: less stiff and heavy by their \"fill\"\n", partly);
    }
    for (const std::string& sentence : report.sentences()) std::printf("  note        %s\n", sentence.c_str());
    std::printf("  took        %.2f s\n", seconds);
}

int cook_file(const CookOptions& o) {
    require_writable(o.out);
    if (!o.skin.empty()) require_writable(o.skin);
    if (o.kind() != CookKind::tets && std::filesystem::path(o.out).extension() != ".msh")
        throw Error(ErrorCode::unsupported, o.out, "hexes and cages have elements that are filled in part, which only Gmsh files (.msh) hold");
    mesh::TriangleMesh surface = io::read_surface(o.in);
    for (Vec3& x : surface.vertices) x *= o.scale;
    surface = weld(surface);
    const Stopwatch watch;
    Team team(threads_of(o));
    const SolidRegion region(surface);
    const double volume_m3 = region.volume(team);
    CookReport report;
    std::printf("%s\n", o.in.c_str());
    VolumeMesh mesh = o.budget_ms > 0 ? cook_for_budget(region, surface, volume_m3, o, team, report)
                                      : cook(region, surface, volume_m3, {.kind = o.kind(), .elements = o.elements, .edge_m = o.edge_m}, team, &report);
    print(mesh, report, watch.ms() / 1000);
    io::write_mesh(o.out, mesh);
    if (!o.skin.empty()) write_skin_or_surface(o.skin, mesh, surface);
    return kAllWell;
}

}  // namespace

void add_mesh_cook_command(CLI::App& mesh, int& status) {
    auto o = std::make_shared<CookOptions>();
    CLI::App* command = mesh.add_subcommand("cook", "fill a closed surface (holes and self-intersections are mended) with elements");
    command->add_option("in", o->in, "surface file")->required();
    command->add_option("--out", o->out, "mesh file to write; .msh for hexes and cages")->required();
    CLI::Option_group* kinds = command->add_option_group("kind");
    kinds->add_flag("--tets", o->tets, "tetrahedra snapped to the surface, dihedral angles in 8.9..158.8 degrees [default]");
    kinds->add_flag("--hexes", o->hexes, "cubes, those on the boundary filled in part");
    kinds->add_flag("--cage", o->cage, "tetrahedra around all of the surface, filled in part");
    kinds->require_option(0, 1);
    CLI::Option_group* sizes = command->add_option_group("size");
    sizes->add_option("--elements", o->elements, "about so many [20000]")->check(CLI::Range(1, 100000000));
    sizes->add_option("--edge-length", o->edge_m, "of the lattice [m]")->check(CLI::PositiveNumber);
    sizes->add_option("--budget-ms", o->budget_ms, "as many as step within this time on this machine, by measurement")->check(CLI::PositiveNumber);
    sizes->require_option(0, 1);
    command->add_option("--skin", o->skin, "also write the surface (.obj, .ply, ...), or with its weights for GPU skinning (.skin)");
    command->add_option("--scale", o->scale, "length multiplier of the surface [1]")->check(CLI::PositiveNumber);
    command->add_option("--young", o->young_pa, "--budget-ms: stiffness of the trial [Pa] [1e4]")->check(CLI::PositiveNumber);
    command->add_option("--time-step", o->time_step_s, "--budget-ms: step of the trial [s] [1/60]")->check(CLI::Range(1e-6, 1.0));
    command->add_option("--threads", o->threads, "threads [all cores]")->check(CLI::Range(1, 256));
    command->callback([o, &status] { status = cook_file(*o); });
}

}  // namespace supple::demos
