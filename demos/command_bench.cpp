#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "command.h"
#include "json_text.h"
#include "machine.h"
#include "open_show.h"
#include "output_files.h"
#include "progress.h"
#include "statistics.h"
#include "supple/io/binary_file.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/refine.h"

namespace supple::demos {
namespace {

struct BenchOptions {
    std::vector<std::string> scenes;
    std::string json_file;
    ShowOptions show;
    std::size_t steps = 100;
    std::size_t repeat = 3;
    bool large = false;
    double tolerance = 1e-5;
    PreconditionerKind preconditioner = PreconditionerKind::automatic;
};

struct BenchResult {
    std::string name;
    io::RunSummary world;         ///< after the last step
    StepStatistics statistics;
    bool repeats_agree = true;    ///< every repetition ended in the same bits
    std::optional<Vec3> tip_m;
};

/// The common workload: a bar of 0.4 x 0.1 x 0.1 m, clamped at x = 0, that bends under gravity from rest.
class BarShow : public Show {
public:
    BarShow(std::array<int, 3> cells, const BenchOptions& o) : world_(def(o.show, o.tolerance, o.preconditioner)) {
        const auto shape = BodyTemplate::build(refine(make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3(0.4, 0.1, 0.1), .cells = cells}), o.show.refine));
        BodyDef body;
        body.name = "bar";
        body.shape = shape;
        body.material = Corotational{.young_pa = 2e5, .poisson = 0.4};
        body.density_kg_m3 = 1000;
        body_ = world_.add_body(body);
        world_.fix(body_, InsideBox{Vec3(-1, -1, -1), Vec3(1e-9, 1, 1)});
    }
    World& world() override { return world_; }

    Vec3 tip_m() const {
        const auto& rest = world_.shape(body_).mesh().vertices;
        const auto positions = world_.positions(body_);
        Vec3 sum = Vec3::Zero();
        int count = 0;
        for (std::size_t v = 0; v < rest.size(); ++v) {
            if (rest[v].x() < 0.4 - 1e-9) continue;
            sum += positions[v];
            ++count;
        }
        return sum / count;
    }

private:
    static WorldDef def(const ShowOptions& options, double tolerance, PreconditionerKind preconditioner) {
        WorldDef d;
        d.gravity_m_s2 = Vec3(0, -9.81, 0);
        d.time_step_s = 0.01;
        d.threads = options.threads;
        d.isa = options.isa;
        d.solver.cg_relative_tolerance = tolerance;
        d.solver.preconditioner = preconditioner;
        return d;
    }
    World world_;
    BodyId body_;
};

void do_steps(Show& show, std::size_t steps, StepStatistics* statistics, Progress& progress, std::size_t& done) {
    for (std::size_t i = 0; i < steps; ++i) {
        show.before_step();
        const StepReport report = show.world().step();
        if (statistics != nullptr) statistics->add(show.world(), report);
        progress.show(++done);
    }
}

/// Warm-up, then the same steps again and again from the same state. A world that nobody touches goes back by its snapshot; a scripted
/// one is made anew, since no snapshot holds the script.
template <class Make>
BenchResult measure(const std::string& name, const BenchOptions& o, bool scripted, Make&& make, std::optional<Vec3> (*tip)(Show&)) {
    BenchResult result;
    result.name = name;
    std::unique_ptr<Show> show = make();
    const std::vector<std::byte> start = show->world().save();
    const std::size_t warm_up = std::min<std::size_t>(o.steps, 10);
    Progress progress(name, warm_up + o.repeat * o.steps, false);
    std::size_t done = 0;
    do_steps(*show, warm_up, nullptr, progress, done);
    for (std::size_t r = 0; r < o.repeat; ++r) {
        if (scripted)
            show = make();
        else
            show->world().restore(start);
        do_steps(*show, o.steps, &result.statistics, progress, done);
        const std::uint64_t hash = show->world().hash();
        if (r > 0 && hash != result.world.state_hash) result.repeats_agree = false;
        result.world.state_hash = hash;
    }
    result.world = summary_of(show->world());
    result.tip_m = tip(*show);
    return result;
}

BenchResult measure_bar(std::array<int, 3> cells, const BenchOptions& o) {
    const std::string name = "bar " + std::to_string(cells[0]) + "x" + std::to_string(cells[1]) + "x" + std::to_string(cells[2]);
    const auto tip = [](Show& show) -> std::optional<Vec3> { return static_cast<BarShow&>(show).tip_m(); };
    return measure(name, o, false, [&] { return std::make_unique<BarShow>(cells, o); }, tip);
}

BenchResult measure_scene(const std::string& scene, const BenchOptions& o) {
    const OpenedShow first = open_show(scene, o.show);
    return measure(first.name, o, first.is_demo, [&] { return open_show(scene, o.show).show; }, [](Show&) -> std::optional<Vec3> { return {}; });
}

void print(const BenchResult& r) {
    std::printf("\n%s: %zu elements, %zu vertices, %d thread%s\n%s", r.name.c_str(), r.world.elements, r.world.vertices, r.world.threads, r.world.threads == 1 ? "" : "s",
                r.statistics.table().c_str());
    std::printf("  iterations %.1f (mean), relative residual %.2g (median) %.2g (largest), state %s%s\n", mean(r.statistics.iterations()),
                io::median(r.statistics.residuals()), io::percentile(r.statistics.residuals(), 1), hash_text(r.world.state_hash).c_str(),
                r.repeats_agree ? "" : " - REPETITIONS DIFFER");
    if (r.tip_m) std::printf("  tip (%.5f, %.5f, %.5f) m\n", r.tip_m->x(), r.tip_m->y(), r.tip_m->z());
    std::fflush(stdout);
    std::fputs(r.statistics.flag_sentences().c_str(), stderr);
}

std::string times_json(const std::vector<double>& ms) {
    return JsonObject()
        .add("median", json(io::median(ms)))
        .add("p99", json(io::percentile(ms, 0.99)))
        .add("p999", json(io::percentile(ms, 0.999)))
        .add("max", json(io::percentile(ms, 1)))
        .line();
}

std::string result_json(const BenchResult& r) {
    JsonObject stages;
    for (std::size_t i = 0; i < kStageCount; ++i) stages.add(name(static_cast<Stage>(i)), times_json(r.statistics.stage_ms(i)));
    std::vector<std::string> flags;
    for (const FlagRecord& f : r.statistics.flags()) flags.push_back(json(name(f.flag)));
    JsonObject out;
    out.add("name", json(r.name))
        .add("elements", json(r.world.elements))
        .add("vertices", json(r.world.vertices))
        .add("threads", json(r.world.threads))
        .add("steps_timed", json(r.statistics.steps()))
        .add("step_ms", times_json(r.statistics.step_ms()))
        .add("stages_ms", stages.block(3))
        .add("cg_iterations", JsonObject()
                                  .add("mean", json(mean(r.statistics.iterations())))
                                  .add("max", json(io::percentile(r.statistics.iterations(), 1)))
                                  .line())
        .add("cg_relative_residual", JsonObject()
                                         .add("median", json(io::median(r.statistics.residuals())))
                                         .add("max", json(io::percentile(r.statistics.residuals(), 1)))
                                         .line())
        .add("flags", json_array(flags))
        .add("state_hash", json(hash_text(r.world.state_hash)))
        .add("repeats_agree", r.repeats_agree ? "true" : "false");
    if (r.tip_m) out.add("tip_m", json(*r.tip_m));
    return out.block(2);
}

int bench(const BenchOptions& o) {
    require_writable(o.json_file);
    const Machine machine = measure_machine();
    std::printf("%s\n", machine.line().c_str());
    std::vector<std::string> results;
    bool good = true;
    const auto take = [&](const BenchResult& r) {
        print(r);
        results.push_back(result_json(r));
        good = good && r.repeats_agree && r.statistics.flags().empty();
    };
    for (const std::string& scene : o.scenes) take(measure_scene(scene, o));
    if (o.scenes.empty()) {
        for (const auto& cells : {std::array{16, 4, 4}, std::array{32, 8, 8}, std::array{64, 16, 16}}) take(measure_bar(cells, o));
        if (o.large) take(measure_bar({96, 24, 24}, o));
    }
    const JsonObject machine_json = JsonObject()
                                        .add("processor", json(machine.processor))
                                        .add("cores", json(machine.cores))
                                        .add("read_one_thread_gb_s", json(machine.read_one_gb_s))
                                        .add("read_all_threads_gb_s", json(machine.read_all_gb_s));
    if (!o.json_file.empty())
        io::write_text_file(o.json_file, JsonObject()
                                        .add("machine", machine_json.line())
                                        .add("steps", json(o.steps))
                                        .add("repeat", json(o.repeat))
                                        .add("results", json_array(results, ", "))
                                        .block() +
                                    "\n");
    return good ? kAllWell : kRunFailed;
}

}  // namespace

void add_bench_command(CLI::App& app, int& status) {
    auto o = std::make_shared<BenchOptions>();
    CLI::App* command = app.add_subcommand("bench", "time steps: the standard bars, or the given scenes and demos");
    command->add_option("scenes", o->scenes, "scene files or demos [bars of 1,536, 12,288 and 98,304 tets]");
    command->add_option("--json", o->json_file, "write everything as JSON");
    command->add_option("--threads", o->show.threads, "threads [those of the scene, or all cores]")->check(CLI::Range(1, 256));
    add_isa_option(*command, o->show);
    command->add_option("--steps", o->steps, "steps from the start of the scene [100]")->check(CLI::Range(1, 1000000));
    command->add_option("--repeat", o->repeat, "how often the same steps are timed [3]")->check(CLI::Range(1, 10000));
    command->add_option("--refine", o->show.refine, "cut every element of scene files and bars into eight, so many times [0]")->check(CLI::Range(0, 10));
    command->add_flag("--large", o->large, "also the bar of 331,776 tets");
    command->add_option("--tolerance", o->tolerance, "of the bars' solves, on the true residual [1e-5]")->check(CLI::Range(1e-12, 0.5));
    command->add_option("--preconditioner", o->preconditioner, "of the bars' solves [auto]")
        ->transform(CLI::CheckedTransformer(std::map<std::string, PreconditionerKind>{{"auto", PreconditionerKind::automatic},
                                                                                      {"block_jacobi", PreconditionerKind::block_jacobi},
                                                                                      {"lattice_multigrid", PreconditionerKind::lattice_multigrid},
                                                                                      {"scalar_laplacian", PreconditionerKind::scalar_laplacian}}));
    command->callback([o, &status] { status = bench(*o); });
}

}  // namespace supple::demos
