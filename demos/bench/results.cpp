#include "results.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

#include "json_text.h"

namespace supple::demos {
namespace {

[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return text;
}

std::string times_json(const std::vector<double>& ms) {
    return JsonObject()
        .add("median", json(io::median(ms)))
        .add("p99", json(io::percentile(ms, 0.99)))
        .add("p999", json(io::percentile(ms, 0.999)))
        .add("max", json(io::percentile(ms, 1)))
        .line();
}

std::string mean_and_max(const std::vector<double>& values) {
    return JsonObject().add("mean", json(mean(values))).add("max", json(io::percentile(values, 1))).line();
}

std::string median_and_max(const std::vector<double>& values) {
    return JsonObject().add("median", json(io::median(values))).add("max", json(io::percentile(values, 1))).line();
}

std::string measurement_json(const Measurement& m) {
    const StepStatistics& s = m.statistics;
    JsonObject stages;
    for (std::size_t i = 0; i < kStageCount; ++i) stages.add(name(static_cast<Stage>(i)), times_json(s.stage_ms(i)));
    std::vector<std::string> flags, repeats;
    for (const FlagRecord& f : s.flags()) flags.push_back(json(name(f.flag)));
    for (const double ms : m.repeat_median_ms) repeats.push_back(json(ms));
    JsonObject out;
    out.add("name", json(m.name))
        .add("elements", json(m.world.elements))
        .add("vertices", json(m.world.vertices))
        .add("bodies", json(m.world.bodies))
        .add("threads", json(m.world.threads))
        .add("isa", json(m.world.isa))
        .add("time_step_s", json(m.world.time_step_s))
        .add("steps_timed", json(s.steps()))
        .add("step_ms", times_json(s.step_ms()))
        .add("repeat_median_ms", json_array(repeats))
        .add("cpu_ms", json(m.cpu_ms))
        .add("first_step_ms", json(m.first_step_ms))
        .add("stages_ms", stages.block(3))
        .add("cg_iterations", mean_and_max(s.iterations()))
        .add("cg_relative_residual", median_and_max(s.residuals()))
        .add("setup_ns_per_element_and_core", json(m.setup_ns()))
        .add("solve_mb", json(m.solve_mb()))
        .add("solve_gb_s", json(m.solve_gb_s()))
        .add("resident_mb", json(m.resident_mb))
        .add("flags", json_array(flags))
        .add("state_hash", json(hash_text(m.world.state_hash)))
        .add("repeats_agree", m.repeats_agree ? "true" : "false");
    if (m.tip_m) out.add("tip_m", json(*m.tip_m));
    return out.block(2);
}

}  // namespace

std::string text_of(const Measurement& m, const Machine& machine) {
    const StepStatistics& s = m.statistics;
    std::string text = print("\n%s: %zu elements, %zu vertices, %d thread%s, %s\n", m.name.c_str(), m.world.elements, m.world.vertices, m.threads,
                             m.threads == 1 ? "" : "s", m.world.isa.c_str()) +
                       s.table();
    text += print("  iterations %.1f (mean) %.0f (most), true relative residual %.2g (median) %.2g (largest)\n", mean(s.iterations()),
                  io::percentile(s.iterations(), 1), io::median(s.residuals()), io::percentile(s.residuals(), 1));
    text += print("  set-up %.1f ns per element and core; processor time %.3f ms (median step, all threads); first step %.2f ms\n", m.setup_ns(), m.cpu_ms, m.first_step_ms);
    const double gb_s = m.solve_gb_s(), cache = m.threads > 1 ? machine.cache_all_gb_s : machine.cache_one_gb_s, memory = m.threads > 1 ? machine.read_all_gb_s : machine.read_one_gb_s;
    text += print("  solve: %.1f MB a step, %.1f GB/s, %.0f %% of what this machine reads from cache, %.0f %% from memory\n", m.solve_mb(), gb_s, 100 * gb_s / cache, 100 * gb_s / memory);
    text += print("  memory %.1f MB, state %s%s\n", m.resident_mb, hash_text(m.world.state_hash).c_str(), m.repeats_agree ? "" : " - REPETITIONS DIFFER");
    if (m.tip_m) text += print("  tip (%.5f, %.5f, %.5f) m\n", m.tip_m->x(), m.tip_m->y(), m.tip_m->z());
    return text;
}

std::string summary_table(const std::vector<Measurement>& all) {
    std::size_t width = 8;
    for (const Measurement& m : all) width = std::max(width, m.name.size());
    std::string text = print("\n%-*s %9s %9s %9s %9s %9s %6s %9s %7s %8s %8s\n", static_cast<int>(width), "workload", "median ms", "p99 ms", "p99.9 ms", "CPU ms", "solve ms", "iter.",
                             "residual", "set-up", "solve", "memory");
    for (const Measurement& m : all) {
        const StepStatistics& s = m.statistics;
        text += print("%-*s %9.3f %9.3f %9.3f %9.3f %9.3f %6.1f %9.2g %4.0f ns %3.0f GB/s %5.0f MB%s%s\n", static_cast<int>(width), m.name.c_str(), io::median(s.step_ms()),
                      io::percentile(s.step_ms(), 0.99), io::percentile(s.step_ms(), 0.999), m.cpu_ms, io::median(s.stage_ms(std::size_t(Stage::solve))),
                      mean(s.iterations()), io::percentile(s.residuals(), 1), m.setup_ns(), m.solve_gb_s(), m.resident_mb, s.flags().empty() ? "" : "  flags",
                      m.repeats_agree ? "" : "  DIFFERS");
    }
    return text;
}

std::string json_of(const std::vector<Measurement>& all, const Machine& machine, const BenchOptions& o) {
    const JsonObject machine_json = JsonObject()
                                        .add("processor", json(machine.processor))
                                        .add("cores", json(machine.cores))
                                        .add("read_one_thread_gb_s", json(machine.read_one_gb_s))
                                        .add("read_all_threads_gb_s", json(machine.read_all_gb_s))
                                        .add("cache_read_one_thread_gb_s", json(machine.cache_one_gb_s))
                                        .add("cache_read_all_threads_gb_s", json(machine.cache_all_gb_s));
    std::vector<std::string> results;
    for (const Measurement& m : all) results.push_back(measurement_json(m));
    return JsonObject()
               .add("version", json(SUPPLE_VERSION))
               .add("machine", machine_json.line())
               .add("steps", json(o.steps))
               .add("repeat", json(o.repeat))
               .add("results", json_array(results, ", "))
               .block() +
           "\n";
}

}  // namespace supple::demos
