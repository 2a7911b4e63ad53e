#include "measure.h"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <fstream>

#include "progress.h"
#include "supple/world/body.h"

namespace supple::demos {
namespace {

/// Memory of this process that is in use now [MB].
double resident_mb() {
    malloc_trim(0);  // what earlier workloads have freed is not this one's
    std::ifstream in("/proc/self/statm");
    double size = 0, resident = 0;
    in >> size >> resident;
    return resident * double(sysconf(_SC_PAGESIZE)) * 1e-6;
}

int threads_at_work(const World& world, int threads) {
    const std::vector<BodyId> bodies = world.bodies();
    return bodies.size() == 1 && world.shape(bodies[0]).mesh().element_count() < kMinElementsForThreads ? 1 : threads;
}

double cpu_ms() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * double(t.tv_sec) + 1e-6 * double(t.tv_nsec);
}

StepReport one_step(Show& show) {
    show.before_step();
    return show.world().step();
}

}  // namespace

double Measurement::setup_ns() const {
    std::vector<double> ms;
    for (std::size_t i = 0; i < statistics.steps(); ++i) {
        double sum = 0;
        for (const Stage stage : {Stage::elements, Stage::assemble, Stage::stress}) sum += statistics.stage_ms(std::size_t(stage))[i];
        ms.push_back(sum);
    }
    return 1e6 * io::median(ms) * threads / double(world.elements);
}

double Measurement::solve_mb() const { return 1e-6 * io::median(statistics.solve_bytes()); }

double Measurement::solve_gb_s() const {
    std::vector<double> gb_s;
    const std::vector<double>& ms = statistics.stage_ms(std::size_t(Stage::solve));
    for (std::size_t i = 0; i < statistics.steps(); ++i) {
        if (ms[i] > 0) gb_s.push_back(1e-6 * statistics.solve_bytes()[i] / ms[i]);
    }
    return io::median(gb_s);
}

Measurement measure(const Workload& workload, const BenchOptions& o) {
    Measurement m;
    m.name = workload.name;
    m.series = workload.series;
    const std::size_t steps = std::max<std::size_t>(2, workload.steps > 0 ? workload.steps : o.quick ? o.steps / 5 : o.steps);
    const std::size_t warm_up = std::min<std::size_t>(steps, 10);
    Progress progress(workload.name, warm_up + o.repeat * steps, false);
    std::size_t done = 0;
    const double memory_before = resident_mb();
    std::unique_ptr<Show> show = workload.make();
    const std::vector<std::byte> start = show->world().save();
    for (std::size_t i = 0; i < warm_up; ++i) {
        one_step(*show);
        progress.show(++done);
    }
    m.resident_mb = resident_mb() - memory_before;
    std::vector<double> first, cpu;
    for (std::size_t r = 0; r < o.repeat; ++r) {
        if (workload.scripted)
            show = workload.make();
        else
            show->world().restore(start);
        std::vector<double> step_ms;
        for (std::size_t i = 0; i < steps; ++i) {
            const double cpu_before = cpu_ms();
            const StepReport report = one_step(*show);
            const double cpu_step = cpu_ms() - cpu_before;
            progress.show(++done);
            if (i == 0) {
                first.push_back(report.step_ms);
                m.statistics.add_untimed(show->world(), report);
                continue;
            }
            m.statistics.add(show->world(), report);
            step_ms.push_back(report.step_ms);
            cpu.push_back(cpu_step);
        }
        m.repeat_median_ms.push_back(io::median(step_ms));
        const std::uint64_t hash = show->world().hash();
        if (r > 0 && hash != m.world.state_hash) m.repeats_agree = false;
        m.world.state_hash = hash;
    }
    m.first_step_ms = io::median(first);
    m.cpu_ms = io::median(cpu);
    m.world = summary_of(show->world());
    m.threads = threads_at_work(show->world(), m.world.threads);
    if (workload.tip) m.tip_m = workload.tip(*show);
    return m;
}

}  // namespace supple::demos
