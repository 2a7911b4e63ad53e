// What an edit of a large body costs, beside its ordinary step: supple_edit_bench [repetitions]. On one thread
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <utility>
#include <vector>

#include "supple/mesh/box_mesh.h"
#include "supple/world/body_template.h"
#include "supple/world/world.h"

namespace {

using namespace supple;

constexpr int kAfter = 40;  ///< steps that an edit may make dearer: until the preconditioner is a new one again

double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
    return v[v.size() / 2];
}

/// Processor time of the calling thread: what neighbours on a busy machine take does not count, nor what is built beside the steps.
class ThreadWatch {
public:
    double lap_ms() {
        const double last = std::exchange(at_, now());
        return at_ - last;
    }

private:
    static double now() {
        timespec t{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        return 1e3 * double(t.tv_sec) + 1e-6 * double(t.tv_nsec);
    }
    double at_ = now();
};

double step_ms(World& world, int* iterations = nullptr) {
    ThreadWatch watch;
    const StepReport report = world.step();
    if (iterations != nullptr) *iterations += report.cg_iterations;
    return watch.lap_ms();
}

struct Bench {
    World world{{.time_step_s = 1.0 / 120, .threads = 1}};
    BodyId body;

    explicit Bench(VolumeMesh mesh)
        : body(world.add_body({.shape = BodyTemplate::build(std::move(mesh)), .material = Corotational{.young_pa = 2e5, .poisson = 0.4}, .density_kg_m3 = 1000})) {
        world.fix(body, InsideBox{{-1, -1, -1}, {1e-6, 1, 1}});
    }
};

/// What steps from here cost a world that was built from the edited mesh, its preconditioner among the rest: what they cost beyond that is the edit's, the body's new motion is not.
std::vector<double> steps_of_new(const World& edited, BodyId body) {
    Bench bench(edited.shape(body).mesh());
    const auto x = edited.positions(body), v = edited.velocities(body);
    bench.world.set_state(bench.body, std::vector<Vec3>(x.begin(), x.end()), std::vector<Vec3>(v.begin(), v.end()));
    const std::vector<std::byte> start = bench.world.save();
    bench.world.step();  // builds
    bench.world.restore(start);
    std::vector<double> ms;
    for (int i = 0; i < kAfter; ++i) ms.push_back(step_ms(bench.world));
    return ms;
}

enum class Kind { cut, erase };

/// One kind of edit, repeated: ordinary steps, the edit, the steps after it, undone.
void run(const char* name, Kind kind, int repetitions) {
    Bench bench(make_tet_box({.max_m = {0.4, 0.15, 0.125}, .cells = {28, 12, 10}}));
    World& world = bench.world;
    const BodyId body = bench.body;
    for (int i = 0; i < 60; ++i) world.step();
    std::vector<double> ordinary, settled, edit, first, later, extra, ratio, undo, beyond;
    int iterations_before = 0, iterations_after = 0;
    std::size_t touched = 0;
    for (int r = 0; r < repetitions; ++r) {
        std::vector<double> calm;
        for (int i = 0; i < 15; ++i) calm.push_back(step_ms(world, &iterations_before));
        TopologyDelta delta;
        ThreadWatch watch;
        if (kind == Kind::cut) {
            const double x = 0.2037, deep = 0.06;  // a slit from above
            delta = world.cut(body, swept_blade(std::vector<Vec3>{{x, 1, -1}, {x, 1, 0.085}}, std::vector<Vec3>{{x, deep, -1}, {x, deep, 0.085}}));
        } else {
            std::vector<std::int32_t> near;
            const VolumeMesh& mesh = world.shape(body).mesh();
            for (std::size_t e = 0; e < mesh.tets.size(); ++e)
                if ((mesh.vertices[std::size_t(mesh.tets[e][0])] - Vec3(0.2, 0.15, 0.06)).norm() < 0.041) near.push_back(std::int32_t(e));
            watch.lap_ms();
            delta = world.remove_elements(body, near);
        }
        const double edit_ms = watch.lap_ms();
        touched = kind == Kind::cut ? delta.cut_elements().size() : delta.removed_elements().size();
        const double usual = median(calm);
        const std::vector<double> of_new = steps_of_new(world, body);
        std::vector<double> rest, own;
        for (int i = 0; i < kAfter; ++i) rest.push_back(step_ms(world));
        for (int i = 0; i < 20; ++i) own.push_back(step_ms(world, &iterations_after));  // of the body as it is now, all built for it
        const double is = median(own);
        double sum = edit_ms;
        for (const double ms : rest) sum += ms - is;
        double more = edit_ms;
        for (int i = 0; i < kAfter; ++i) more += rest[std::size_t(i)] - of_new[std::size_t(i)];
        beyond.push_back(more);
        first.push_back(rest[0]);
        ordinary.push_back(usual);
        settled.push_back(is);
        edit.push_back(edit_ms);
        later.push_back(median({rest.begin() + 1, rest.begin() + 9}));
        extra.push_back(sum);
        ratio.push_back(sum / is);
        watch.lap_ms();
        world.undo_edit(body);
        undo.push_back(watch.lap_ms());
        for (int i = 0; i < 60; ++i) world.step();
    }
    const double usual = median(ordinary), is = median(settled);
    std::printf("%-5s %4zu of 20160 tets: ordinary step %.2f ms (%.1f iterations), later, of the edited body, %.2f ms (%.1f) | edit %.2f ms = %.2f later steps | first step after %.2f | next 8 %.2f | undo %.2f ms\n"
                "      the edit and all that it adds to the %d steps after it: %.2f ms = %.2f steps (median of ratios %.2f); beyond what the same steps cost a world built from the edited mesh: %.2f ms = %.2f steps\n",
                name, touched, usual, double(iterations_before) / (15 * repetitions), is, double(iterations_after) / (20 * repetitions), median(edit), median(edit) / is, median(first) / is,
                median(later) / is, median(undo), kAfter, median(extra), median(extra) / is, median(ratio), median(beyond),
                median(beyond) / is);
}

}  // namespace

int main(int argc, char** argv) {
    const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 9;
    run("cut", Kind::cut, repetitions);
    run("erase", Kind::erase, repetitions);
    return 0;
}
