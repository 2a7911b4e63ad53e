#include "workload.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "open_show.h"
#include "supple/base/error.h"
#include "supple/base/parallel.h"
#include "supple/io/mesh_file.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/refine.h"

namespace supple::demos {
namespace {

constexpr std::size_t kQuickElements = 20000;

/// A world to which nothing is done between steps.
class Still : public Show {
public:
    explicit Still(const WorldDef& def) : world_(def) {}
    World& world() override { return world_; }

private:
    World world_;
};

WorldDef world_def(const BenchOptions& o, double tolerance, double time_step_s = 0.01, int threads = 0) {
    WorldDef def;
    def.gravity_m_s2 = Vec3(0, -9.81, 0);
    def.time_step_s = time_step_s;
    def.threads = threads > 0 ? threads : o.show.threads;
    def.isa = o.show.isa;
    def.solver.cg_relative_tolerance = tolerance;
    def.solver.preconditioner = o.preconditioner;
    def.solver.operator_kind = o.operator_kind;
    return def;
}

std::string tolerance_text(double tolerance) {
    char text[32];
    std::snprintf(text, sizeof text, "%.0e", tolerance);
    std::string out(text);
    const std::size_t zero = out.find("e-0");  // 1e-03: 1e-3
    return zero == std::string::npos ? out : out.erase(zero + 2, 1);
}

std::vector<double> tolerances(const BenchOptions& o) {
    return o.tolerance ? std::vector<double>{*o.tolerance} : std::vector<double>{1e-3, 1e-5};
}

std::size_t elements_of(const BarDef& bar) {
    return std::size_t(bar.cells[0]) * std::size_t(bar.cells[1]) * std::size_t(bar.cells[2]) * (bar.hexes ? 1 : 6);
}

std::shared_ptr<const BodyTemplate> box(const BarDef& bar, const Vec3& size_m) {
    const BoxDef def{.min_m = Vec3::Zero(), .max_m = size_m, .cells = bar.cells};
    return BodyTemplate::build(bar.hexes ? make_hex_box(def) : make_tet_box(def));
}

/// Centroid of the vertices that are farthest along x at rest.
Vec3 far_end(Show& show) {
    const World& world = show.world();
    const BodyId body = world.bodies().front();
    const auto& rest = world.shape(body).mesh().vertices;
    double far = -HUGE_VAL;
    for (const Vec3& x : rest) far = std::max(far, x.x());
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (std::size_t v = 0; v < rest.size(); ++v) {
        if (rest[v].x() < far - 1e-9) continue;
        sum += world.positions(body)[v];
        ++count;
    }
    return sum / count;
}

struct NamedLaw {
    const char* name;
    Material material;
};

/// The eight hyperelastic laws, all with the shear and bulk modulus of the bar at small strain.
std::vector<NamedLaw> laws() {
    constexpr double E = 2e5, nu = 0.4, mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), bulk = lambda + 2 * mu / 3;
    return {{"arruda_boyce", ArrudaBoyce{mu / 1.0851367078791743, bulk}},
            {"costa", Costa{mu, lambda}},
            {"mooney_rivlin", MooneyRivlin{0.3 * mu, 0.2 * mu, bulk}},
            {"neo_hookean", NeoHookean{mu, lambda}},
            {"ogden", Ogden{{{2 * mu, 3}}, bulk}},
            {"stable_neo_hookean", StableNeoHookean{mu, lambda}},
            {"st_venant_kirchhoff", StVenantKirchhoff{mu, lambda}},
            {"veronda_westman", VerondaWestman{mu / 2, 2, bulk}}};
}

/// Cubes of 384 tets, each clamped at one face, side by side: one world.
Workload many_bodies(const BenchOptions& o) {
    constexpr int kBodies = 64;
    Workload w;
    w.name = "bodies-64x384-1e-3";
    w.make = [o] {
        auto show = std::make_unique<Still>(world_def(o, o.tolerance.value_or(1e-3)));
        BodyDef def;
        def.shape = box({.cells = {4, 4, 4}}, Vec3::Constant(0.1));
        def.material = Corotational{.young_pa = 2e4, .poisson = 0.4};
        for (int i = 0; i < kBodies; ++i) {
            def.translation_m = Vec3(0.2 * (i % 8), 0, 0.2 * (i / 8));
            show->world().fix(show->world().add_body(def), InsideBox{Vec3(-1, -1, -1), Vec3(1e-9, 1, 1)});
        }
        return show;
    };
    w.tip = far_end;
    return w;
}

/// A mesh scaled to 0.2 m, its lower tenth held.
Workload mesh_body(const std::string& file, double tolerance, const BenchOptions& o) {
    Workload w;
    w.name = std::filesystem::path(file).stem().string() + (o.show.refine > 0 ? "-refined-" + std::to_string(o.show.refine) : "") + "-" + tolerance_text(tolerance);
    w.make = [file, tolerance, o] {
        VolumeMesh mesh = refine(io::read_mesh(file), o.show.refine);
        Vec3 low = Vec3::Constant(HUGE_VAL), high = -low;
        for (const Vec3& x : mesh.vertices) {
            low = low.cwiseMin(x);
            high = high.cwiseMax(x);
        }
        const double scale = 0.2 / (high - low).maxCoeff();
        BodyDef def;
        def.shape = BodyTemplate::build(std::move(mesh), scale);
        def.material = Corotational{.young_pa = 1e5, .poisson = 0.45};
        auto show = std::make_unique<Still>(world_def(o, tolerance));
        low *= scale;
        high *= scale;
        high.y() = low.y() + 0.1 * (high.y() - low.y());
        show->world().fix(show->world().add_body(def), InsideBox{low - Vec3::Ones(), Vec3(high.x() + 1, high.y(), high.z() + 1)});
        return show;
    };
    return w;
}

bool is_scene_or_demo(const std::string& file) {
    if (std::filesystem::path(file).extension() == ".json" || !std::filesystem::exists(file)) return true;  // open_show() says what is wrong
    for (const Demo& demo : all_demos())
        if (demo.name == file) return true;
    return false;
}

}  // namespace

Workload bar(const std::string& name, const BarDef& bar, const BenchOptions& o) {
    Workload w;
    w.name = name;
    w.make = [bar, o] {
        auto show = std::make_unique<Still>(world_def(o, bar.tolerance, bar.time_step_s, bar.threads));
        BodyDef def;
        def.name = "bar";
        def.shape = box(bar, Vec3(0.4, 0.1, 0.1));
        def.material = bar.material;
        show->world().fix(show->world().add_body(def), InsideBox{Vec3(-1, -1, -1), Vec3(1e-9, 1, 1)});
        return show;
    };
    w.tip = far_end;
    w.gigabytes = 2e-6 * double(elements_of(bar)) * (bar.hexes ? 6 : 1);
    return w;
}

std::vector<Workload> fixed_set(const BenchOptions& o) {
    std::vector<Workload> set;
    const auto add = [&](const std::string& kind, BarDef def) {
        if (o.quick && elements_of(def) > kQuickElements) return;
        for (const double tolerance : tolerances(o)) {
            def.tolerance = tolerance;
            set.push_back(bar(kind + "-" + std::to_string(elements_of(def)) + "-" + tolerance_text(tolerance), def, o));
            set.back().series = kind + " to " + tolerance_text(tolerance);
        }
    };
    for (const std::array<int, 3>& cells : {std::array{16, 4, 4}, {32, 8, 8}, {64, 16, 16}, {96, 24, 24}}) add("tets", {.cells = cells});
    for (const std::array<int, 3>& cells : {std::array{32, 8, 8}, {64, 16, 16}}) add("hexes", {.cells = cells, .hexes = true});
    for (const NamedLaw& law : laws())
        set.push_back(bar(std::string("law-") + law.name + "-12288-1e-3", {.cells = {32, 8, 8}, .material = law.material, .tolerance = o.tolerance.value_or(1e-3)}, o));
    set.push_back(many_bodies(o));
    set.push_back(bar("kilohertz-5184-1e-3", {.cells = {24, 6, 6}, .tolerance = o.tolerance.value_or(1e-3), .time_step_s = 1e-3, .threads = 1}, o));
    if (!o.quick) set.back().steps = 10 * o.steps;  // a thousand: p99.9 is then more than the worst of them all
    return set;
}

std::vector<Workload> scaling_set(const BenchOptions& o) {
    std::vector<Workload> set;
    const int most = o.show.threads > 0 ? o.show.threads : hardware_threads();
    const double tolerance = o.tolerance.value_or(1e-3);
    for (const std::array<int, 3>& cells :
         {std::array{16, 4, 4}, {24, 6, 6}, {32, 8, 8}, {48, 12, 12}, {64, 16, 16}, {96, 24, 24}, {128, 32, 32}, {176, 44, 44}}) {
        BarDef def{.cells = cells, .tolerance = tolerance};
        const std::size_t elements = elements_of(def);
        if (o.quick && elements > kQuickElements) continue;
        for (int threads = 1; threads <= most; threads = threads < most && 2 * threads > most ? most : 2 * threads) {
            def.threads = threads;
            set.push_back(bar("tets-" + std::to_string(elements) + "-threads-" + std::to_string(threads) + "-" + tolerance_text(tolerance), def, o));
            set.back().series = std::to_string(threads) + (threads == 1 ? " thread" : " threads");
            if (elements > 400000) set.back().steps = std::min<std::size_t>(o.steps, 20);
        }
    }
    return set;
}

std::vector<Workload> workloads_of(const std::string& file, const BenchOptions& o) {
    std::vector<Workload> made;
    if (is_scene_or_demo(file)) {
        const OpenedShow first = open_show(file, o.show);
        Workload w;
        w.name = first.name;
        w.scripted = first.is_demo;
        w.make = [file, o] { return open_show(file, o.show).show; };
        made.push_back(std::move(w));
    } else {
        for (const double tolerance : tolerances(o)) made.push_back(mesh_body(file, tolerance, o));
    }
    return made;
}

}  // namespace supple::demos
