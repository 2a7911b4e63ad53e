#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "command.h"
#include "open_show.h"
#include "output_files.h"
#include "progress.h"
#include "statistics.h"
#include "stress_options.h"
#include "supple/base/error.h"
#include "supple/io/binary_file.h"
#include "supple/io/probe_table.h"
#include "supple/io/result_export.h"
#include "supple/io/text_files.h"

namespace supple::demos {
namespace {

struct RunOptions {
    std::string scene;
    std::size_t steps = 0;  ///< 0 = not given: 300, or the duration of a demo
    bool steps_given = false;
    ShowOptions show;
    std::string report, positions, velocities, save, restore, probes;
    std::string export_to;
    std::size_t export_every = 0;  ///< 0: about 30 frames a second of simulated time
    StressOptions stress;
    bool quiet = false;
};

/// Writes the results of every so many steps, the start included, and of the last one.
class Exporter {
public:
    Exporter(const RunOptions& o, const World& world) {
        if (o.export_to.empty()) return;
        out_ = io::ResultExport::open(o.export_to, world, o.export_every > 0);
        const auto automatic = std::size_t(std::max(1LL, std::llround(1 / (30 * world.def().time_step_s))));
        every_ = o.export_every > 0 ? o.export_every : automatic;
        out_->add_frame(world);
    }
    void after_step(const World& world, std::size_t steps_done, std::size_t steps) {
        if (out_ && (steps_done % every_ == 0 || steps_done == steps)) out_->add_frame(world);
    }
    void finish() {
        if (out_) out_->finish();
    }

private:
    std::unique_ptr<io::ResultExport> out_;
    std::size_t every_ = 1;
};

void check(const RunOptions& o) {
    o.stress.check();
    for (const std::string& file : {o.report, o.positions, o.velocities, o.save, o.probes}) require_writable(file);
}

/// All bodies one after the other, in the order of the scene.
template <class T>
std::vector<T> of_all_bodies(const World& world, std::span<const T> (World::*result)(BodyId) const) {
    std::vector<T> all;
    for (const BodyId body : world.bodies()) {
        const std::span<const T> part = (world.*result)(body);
        all.insert(all.end(), part.begin(), part.end());
    }
    return all;
}

void write_results(const RunOptions& o, const World& world, const StepStatistics& statistics) {
    if (!o.report.empty()) statistics.write_report(o.report, world);
    if (!o.positions.empty()) io::write_vectors(o.positions, of_all_bodies(world, &World::positions));
    if (!o.velocities.empty()) io::write_vectors(o.velocities, of_all_bodies(world, &World::velocities));
    if (!o.stress.file.empty()) {
        std::vector<Voigt> all;
        for (const BodyId body : world.bodies()) {
            const StressField field = world.stress(body, o.stress.def());
            all.insert(all.end(), field.cauchy_pa.begin(), field.cauchy_pa.end());
        }
        io::write_stress(o.stress.file, all);
    }
    if (!o.save.empty()) io::write_binary_file(o.save, world.save());
}

/// The show's own probes, or one over each body.
std::vector<Probe> probes_of(Show& show) {
    std::vector<Probe> probes = show.make_probes();
    if (!probes.empty()) return probes;
    const World& world = show.world();
    for (const BodyId body : world.bodies()) probes.emplace_back(world, body, ProbeDef{.name = "all", .where = Everything{}});
    return probes;
}

void print_findings(const World& world) {
    for (const BodyId body : world.bodies())
        for (const std::string& sentence : world.shape(body).report().sentences())
            std::fprintf(stderr, "supple: %s: %s\n", world.name(body).c_str(), sentence.c_str());
}

void print_summary(const std::string& name, const World& world, const StepStatistics& s) {
    const io::RunSummary w = summary_of(world);
    const Vec3& r = w.reaction_n;
    std::printf("%s: %zu vertices, %zu elements, %zu steps of %g s on %d thread%s\n", name.c_str(), w.vertices, w.elements, s.steps(),
                w.time_step_s, w.threads, w.threads == 1 ? "" : "s");
    std::printf("  step        median %.3f ms, p99 %.3f ms\n", io::median(s.step_ms()), io::percentile(s.step_ms(), 0.99));
    std::printf("  solver      %.1f iterations a step, relative residual %.2g (median), %.2g (largest)\n", mean(s.iterations()),
                io::median(s.residuals()), io::percentile(s.residuals(), 1));
    std::printf("  energy      kinetic %.6g J, elastic %.6g J, gravity %.6g J\n", w.energy.kinetic_j, w.energy.elastic_j, w.energy.gravity_j);
    std::printf("  reaction    %.6g %.6g %.6g N\n", r.x(), r.y(), r.z());
    std::printf("  state hash  %s\n", hash_text(w.state_hash).c_str());
}

int run(const RunOptions& o) {
    check(o);
    OpenedShow opened = open_show(o.scene, o.show);
    World& world = opened.show->world();
    if (opened.is_demo && !o.restore.empty())
        throw Error(ErrorCode::unsupported, "--restore",
                    "the demo \"" + opened.name + "\" is driven by a script that no snapshot holds; snapshots continue scene files");
    if (!o.quiet) print_findings(world);
    if (!o.restore.empty()) world.restore(io::read_binary_file(o.restore));

    std::size_t steps = o.steps;
    if (!o.steps_given)
        steps = opened.is_demo ? static_cast<std::size_t>(std::llround(opened.show->duration_s() / world.def().time_step_s)) : 300;
    StepStatistics statistics;
    std::vector<Probe> probes = o.probes.empty() ? std::vector<Probe>{} : probes_of(*opened.show);
    io::ProbeTable table;
    Exporter exporter(o, world);
    {
        Progress progress(opened.name, steps, o.quiet);
        for (std::size_t i = 0; i < steps; ++i) {
            opened.show->before_step();
            statistics.add(world, world.step());
            for (Probe& probe : probes) {
                probe.read(world);
                table.add(world, probe);
            }
            exporter.after_step(world, i + 1, steps);
            progress.show(i + 1);
        }
    }
    exporter.finish();
    write_results(o, world, statistics);
    if (!o.probes.empty()) table.write(o.probes);
    if (!o.quiet) print_summary(opened.name, world, statistics);
    std::fputs(statistics.flag_sentences().c_str(), stderr);
    return statistics.flags().empty() ? kAllWell : kRunFailed;
}

}  // namespace

void add_run_command(CLI::App& app, int& status) {
    auto o = std::make_shared<RunOptions>();
    CLI::App* command = app.add_subcommand("run", "step a scene file or a demo without drawing");
    command->add_option("scene", o->scene, "scene file, or name of a demo")->required();
    CLI::Option* steps = command->add_option("--steps", o->steps, "steps to do [300; a demo: its duration]")->check(CLI::Range(0, 1000000000));
    command->add_option("--threads", o->show.threads, "threads [those of the scene, or all cores]")->check(CLI::Range(1, 256));
    add_isa_option(*command, o->show);
    command->add_option("--report", o->report, "write a JSON report");
    command->add_option("--positions", o->positions, "write the final positions, x y z a line [m]");
    command->add_option("--velocities", o->velocities, "write the final velocities [m/s]");
    o->stress.add(*command);
    command->add_option("--probes", o->probes, "write the readings of the scene's probes (or of one over each body) after each step, as CSV");
    command->add_option("--export", o->export_to,
                        "write results for other programs: a folder or FILE.pvd (VTU series for ParaView), FILE.vtu (last state), FILE.glb or .gltf (animation), "
                        "FILE.obj .ply .stl .off (deformed surface)");
    command->add_option("--export-every", o->export_every, "steps between exported frames [about 30 frames a simulated second]; surfaces: a file per frame")
        ->check(CLI::Range(1, 1000000000));
    command->add_option("--save", o->save, "write a snapshot after the last step");
    command->add_option("--restore", o->restore, "begin from a snapshot of the same scene");
    command->add_flag("--quiet", o->quiet, "no progress bar and no summary");
    command->callback([o, steps, &status] {
        o->steps_given = steps->count() > 0;
        status = run(*o);
    });
}

}  // namespace supple::demos
