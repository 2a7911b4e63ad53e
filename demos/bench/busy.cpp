#include "busy.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "json_text.h"
#include "progress.h"
#include "supple/base/clock.h"
#include "supple/base/error.h"
#include "supple/base/parallel.h"
#include "supple/io/report.h"

namespace supple::demos {
namespace {

/// Processes that do nothing but keep a core, as long as this lives.
class BusyProcesses {
public:
    explicit BusyProcesses(int count) {
        const pid_t parent = getpid();
        for (int i = 0; i < count; ++i) {
            const pid_t child = fork();
            if (child < 0) throw Error(ErrorCode::external_tool, "bench --busy", "no process can be started: let this user have more of them");
            if (child == 0) {
                prctl(PR_SET_PDEATHSIG, SIGKILL);  // never outlives the benchmark, however that ends
                if (getppid() != parent) _exit(0);
                volatile unsigned turns = 0;
                for (;;) turns = turns + 1;
            }
            children_.push_back(child);
        }
    }
    ~BusyProcesses() {
        for (const pid_t child : children_) {
            kill(child, SIGKILL);
            waitpid(child, nullptr, 0);
        }
    }
    BusyProcesses(const BusyProcesses&) = delete;
    BusyProcesses& operator=(const BusyProcesses&) = delete;

private:
    std::vector<pid_t> children_;
};

/// So many dependent additions.
double spin_ms(std::uint64_t turns) {
    const Stopwatch watch;
    volatile std::uint64_t sum = 0;
    for (std::uint64_t i = 0; i < turns; ++i) sum = sum + i;
    return watch.ms();
}

/// Turns that take so long on a core of one's own.
std::uint64_t turns_for(double ms) {
    constexpr std::uint64_t kTurns = 200000;
    double best = 1e300;
    for (int i = 0; i < 50; ++i) best = std::min(best, spin_ms(kTurns));
    return static_cast<std::uint64_t>(double(kTurns) * ms / best);
}

double tail_ms(const std::vector<double>& ms) { return io::percentile(ms, 0.99) - io::median(ms); }

}  // namespace

double BusyResult::step_tail_ms() const { return tail_ms(step_ms); }
double BusyResult::spin_tail_ms() const { return tail_ms(spin_ms); }

std::string BusyResult::text() const {
    char text[1024];
    std::snprintf(text, sizeof text,
                  "\n12,288 tets to 1e-3 beside %d busy processes, in turns with a loop on one thread; both take %.2f ms when nothing else runs\n"
                  "  [ms]   %9s %9s %9s %9s %12s\n"
                  "  step   %9.3f %9.3f %9.3f %9.3f %12.3f\n"
                  "  loop   %9.3f %9.3f %9.3f %9.3f %12.3f\n"
                  "  p99 - median of the step is %.2f times that of the loop\n",
                  processes, idle_ms, "median", "p99", "p99.9", "max", "p99 - median", io::median(step_ms), io::percentile(step_ms, 0.99),
                  io::percentile(step_ms, 0.999), io::percentile(step_ms, 1), step_tail_ms(), io::median(spin_ms), io::percentile(spin_ms, 0.99),
                  io::percentile(spin_ms, 0.999), io::percentile(spin_ms, 1), spin_tail_ms(), step_tail_ms() / spin_tail_ms());
    return text;
}

std::string BusyResult::json() const {
    const auto times = [](const std::vector<double>& ms) {
        return JsonObject()
            .add("median", demos::json(io::median(ms)))
            .add("p99", demos::json(io::percentile(ms, 0.99)))
            .add("p999", demos::json(io::percentile(ms, 0.999)))
            .line();
    };
    return JsonObject()
        .add("processes", demos::json(processes))
        .add("idle_ms", demos::json(idle_ms))
        .add("step_ms", times(step_ms))
        .add("loop_ms", times(spin_ms))
        .add("tail_ratio", demos::json(step_tail_ms() / spin_tail_ms()))
        .block(1);
}

BusyResult measure_busy(const BenchOptions& o) {
    BusyResult result;
    result.processes = hardware_threads();
    const std::unique_ptr<Show> show = bar("busy", {.cells = {32, 8, 8}, .tolerance = o.tolerance.value_or(1e-3)}, o).make();
    World& world = show->world();
    result.idle_ms = 1e300;
    for (int i = 0; i < 200; ++i) result.idle_ms = std::min(result.idle_ms, world.step().step_ms);
    const std::uint64_t turns = turns_for(result.idle_ms);
    const std::size_t rounds = o.quick ? o.steps : 20 * o.steps;
    const BusyProcesses others(result.processes);
    Progress progress("busy", rounds, false);
    for (std::size_t i = 0; i < rounds; ++i) {
        result.step_ms.push_back(world.step().step_ms);
        result.spin_ms.push_back(spin_ms(turns));
        progress.show(i + 1);
    }
    return result;
}

}  // namespace supple::demos
