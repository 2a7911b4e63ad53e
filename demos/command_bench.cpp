#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "bench/busy.h"
#include "bench/haptic_scorecard.h"
#include "bench/plot.h"
#include "bench/results.h"
#include "command.h"
#include "json_text.h"
#include "output_files.h"
#include "supple/base/error.h"
#include "supple/io/binary_file.h"

namespace supple::demos {
namespace {

double available_gigabytes() {
    std::FILE* file = std::fopen("/proc/meminfo", "r");
    if (file == nullptr) return 1e300;
    char line[128];
    double kilobytes = 1e300;
    while (std::fgets(line, sizeof line, file) != nullptr) {
        if (std::sscanf(line, "MemAvailable: %lf", &kilobytes) == 1) break;
    }
    std::fclose(file);
    return kilobytes * 1.024e-6;
}

/// What the options ask for. @error Error(invalid_argument) where nothing is left of it
std::vector<Workload> chosen(const BenchOptions& o) {
    std::vector<Workload> all;
    for (const std::string& file : o.files)
        for (Workload& w : workloads_of(file, o)) all.push_back(std::move(w));
    if (o.files.empty()) all = o.scaling ? scaling_set(o) : fixed_set(o);
    std::vector<Workload> some;
    std::string names;
    for (Workload& w : all) {
        names += (names.empty() ? "" : ", ") + w.name;
        if (w.name.find(o.only) != std::string::npos) some.push_back(std::move(w));
    }
    if (some.empty()) throw Error(ErrorCode::invalid_argument, "bench --only", "no workload is called \"" + o.only + "\"; there are " + names);
    return some;
}

void write_plots(const BenchOptions& o, const std::vector<Measurement>& all, const std::string& machine) {
    const std::filesystem::path folder(o.plot_folder);
    std::filesystem::create_directories(folder);
    io::write_text_file((folder / "frame_times.svg").string(), frame_time_svg(all, machine));
    const std::string cost = cost_svg(all, machine);
    if (!cost.empty()) io::write_text_file((folder / "cost_against_size.svg").string(), cost);
}

int bench(const BenchOptions& o) {
    require_writable(o.json_file);
    const std::vector<Workload> workloads = o.busy ? std::vector<Workload>{} : chosen(o);
    const Machine machine = measure_machine();
    std::printf("%s\n", machine.line().c_str());
    if (o.busy) {
        const BusyResult busy = measure_busy(o);
        std::fputs(busy.text().c_str(), stdout);
        if (!o.json_file.empty()) io::write_text_file(o.json_file, JsonObject().add("machine", json(machine.line())).add("busy", busy.json()).block() + "\n");
        return kAllWell;
    }
    std::vector<Measurement> all;
    bool good = true;
    for (const Workload& w : workloads) {
        if (w.gigabytes > 0.8 * available_gigabytes()) {
            std::fprintf(stderr, "%s is left out: it may need %.1f GB and %.1f GB are free\n", w.name.c_str(), w.gigabytes, available_gigabytes());
            continue;
        }
        all.push_back(measure(w, o));
        const Measurement& m = all.back();
        std::fputs(text_of(m, machine).c_str(), stdout);
        std::fflush(stdout);
        std::fputs(m.statistics.flag_sentences().c_str(), stderr);
        good = good && m.repeats_agree && m.statistics.flags().empty();
    }
    if (all.size() > 1) std::fputs(summary_table(all).c_str(), stdout);
    if (!o.json_file.empty()) io::write_text_file(o.json_file, json_of(all, machine, o));
    if (!o.plot_folder.empty() && !all.empty()) write_plots(o, all, machine.line());
    return good ? kAllWell : kRunFailed;
}

struct HapticOptions {
    bool quick = false;
    std::string json_file, check_file, write_file;
    double seconds = 5;
};

int bench_haptics(const HapticOptions& o) {
    require_writable(o.json_file);
    require_writable(o.write_file);
    const auto print = [](const std::string& text) {
        std::fputs(text.c_str(), stdout);
        std::fflush(stdout);
    };
    const std::vector<ScoreLine> lines = haptic_scorecard(o.quick, print);
    bool good = true;
    for (const ScoreLine& l : lines) good = good && l.good;
    std::vector<std::string> times;
    if (o.seconds > 0) {
        print("Real time: the servo at 1 kHz beside a simulation that never rests (20,480 tets; not compared)\n");
        const int cores = int(std::max(1u, std::thread::hardware_concurrency()));
        for (int threads = 1;; threads = std::min(2 * threads, cores)) {
            const HapticRealTime r = haptic_real_time(threads, o.seconds);
            print(r.text());
            times.push_back(r.json());
            if (threads >= cores) break;
        }
    }
    if (!o.json_file.empty())
        io::write_text_file(o.json_file, JsonObject().add("scorecard", json_of(lines)).add("real_time", json_array(times)).block() + "\n");
    if (!o.write_file.empty()) io::write_text_file(o.write_file, regression_text(lines));
    if (!o.check_file.empty()) {
        for (const std::string& sentence : differences(lines, o.check_file)) {
            std::fprintf(stderr, "%s\n", sentence.c_str());
            good = false;
        }
    }
    return good ? kAllWell : kRunFailed;
}

void add_haptics(CLI::App& bench, int& status) {
    auto o = std::make_shared<HapticOptions>();
    CLI::App* command = bench.add_subcommand("haptics", "scorecard of the haptic loop in virtual time, and the servo's ticks in real time");
    command->add_flag("--quick", o->quick, "one pair of rates, two devices");
    command->add_option("--json", o->json_file, "write everything as JSON");
    command->add_option("--check", o->check_file, "compare with a regression file; its tolerances decide");
    command->add_option("--write-check", o->write_file, "write such a file");
    command->add_option("--real-time", o->seconds, "seconds of the part in real time, per number of threads; 0: none [5]")->check(CLI::Range(0.0, 3600.0));
    command->callback([o, &status] { status = bench_haptics(*o); });
}

}  // namespace

void add_bench_command(CLI::App& app, int& status) {
    auto o = std::make_shared<BenchOptions>();
    CLI::App* command = app.add_subcommand("bench", "time steps: a fixed set of bodies, or the given scenes, demos and meshes");
    command->add_option("files", o->files, "scenes, demos, or meshes (made 0.2 m large, 100 kPa, the lower tenth held) [the fixed set]");
    command->add_option("--only", o->only, "of these, what has this in its name: tets-12288, hexes, law-, bodies, kilohertz");
    command->add_flag("--quick", o->quick, "nothing above 20,000 elements, a fifth of the steps");
    CLI::Option* scaling = command->add_flag("--scaling", o->scaling, "bars of 1,536 to 2 million tets by 1, 2, 4 .. threads");
    command->add_flag("--busy", o->busy, "the 12,288-tet step while a busy process holds each core")->excludes(scaling);
    command->add_option("--json", o->json_file, "write everything as JSON (tests/bench/compare.py compares two)");
    command->add_option("--plot", o->plot_folder, "write frame_times.svg and cost_against_size.svg into this folder");
    command->add_option("--threads", o->show.threads, "threads [those of the scene, or all cores]")->check(CLI::Range(1, 256));
    add_isa_option(*command, o->show);
    command->add_option("--steps", o->steps, "steps from the start, the first of them untimed [100]")->check(CLI::Range(2, 1000000));
    command->add_option("--repeat", o->repeat, "how often the same steps are timed [3]")->check(CLI::Range(1, 10000));
    command->add_option("--refine", o->show.refine, "cut every element of the given meshes and scene files into eight, so many times [0]")->check(CLI::Range(0, 10));
    command->add_option("--tolerance", o->tolerance, "of the solves, on the true residual; not of scenes and demos [1e-3 and 1e-5]")->check(CLI::Range(1e-12, 0.5));
    command->add_option("--preconditioner", o->preconditioner, "not of scenes and demos [auto]")
        ->transform(CLI::CheckedTransformer(std::map<std::string, PreconditionerKind>{{"auto", PreconditionerKind::automatic},
                                                                                      {"auto_timed", PreconditionerKind::automatic_timed},
                                                                                      {"block_jacobi", PreconditionerKind::block_jacobi},
                                                                                      {"lattice_multigrid", PreconditionerKind::lattice_multigrid},
                                                                                      {"scalar_laplacian", PreconditionerKind::scalar_laplacian}}));
    command->add_option("--operator", o->operator_kind, "what the solves multiply by; not of scenes and demos [auto]")
        ->transform(CLI::CheckedTransformer(std::map<std::string, OperatorKind>{
            {"auto", OperatorKind::automatic}, {"assembled", OperatorKind::assembled}, {"matrix_free", OperatorKind::matrix_free}}));
    add_haptics(*command, status);
    command->callback([o, command, &status] {
        if (command->get_subcommands().empty()) status = bench(*o);
    });
}

}  // namespace supple::demos
