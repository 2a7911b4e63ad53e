// Frame times of the demos that cut, carve and tear, beside the same demos with their bodies left whole: supple_edit_frames [--threads N] [demo...].
// Both go step by step in turns, so that what else the machine does meets both; nothing is drawn. A frame is what leads to the next state: the demo's script (edits, tools, the haptic loop's ticks) and the step.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "demo.h"
#include "supple/base/error.h"

namespace {

using namespace supple;
using demos::Show;

double now_ms() { return 1e-6 * double(std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count()); }

double quantile(std::vector<double> v, double q) {
    if (v.empty()) return 0;
    const auto at = std::min(v.size() - 1, std::size_t(q * double(v.size())));
    std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(at), v.end());
    return v[at];
}

std::unique_ptr<Show> open(const std::string& name, const demos::ShowOptions& options) {
    for (const demos::Demo& demo : demos::all_demos())
        if (demo.name == name) return demo.make(options);
    throw Error(ErrorCode::invalid_argument, name, "is not one of cut, carve, tear");
}

std::uint64_t edits_of(const World& world) {
    std::uint64_t sum = 0;
    for (const BodyId id : world.bodies()) sum += world.edit_count(id);
    return sum;
}

/// One of the two, step by step.
struct Run {
    std::unique_ptr<Show> show;
    std::vector<double> script_ms, frame_ms;
    std::vector<int> iterations;
    std::vector<char> edited;

    void step() {
        const std::uint64_t edits = edits_of(show->world());
        const double begin = now_ms();
        show->before_step();
        const double middle = now_ms();
        iterations.push_back(show->world().step().cg_iterations);
        frame_ms.push_back(now_ms() - begin);
        script_ms.push_back(middle - begin);
        edited.push_back(edits_of(show->world()) != edits);
    }
};

void compare(const std::string& name, int threads) {
    demos::ShowOptions options;
    options.threads = threads;
    Run cut{open(name, options), {}, {}, {}, {}};
    options.edits = false;
    Run whole{open(name, options), {}, {}, {}, {}};
    const auto steps = std::size_t(cut.show->duration_s() / cut.show->world().def().time_step_s);
    for (std::size_t i = 0; i < steps; ++i) {
        (i % 2 == 0 ? cut : whole).step();
        (i % 2 == 0 ? whole : cut).step();
    }
    if (edits_of(whole.show->world()) > edits_of(cut.show->world()) || std::count(whole.edited.begin(), whole.edited.end(), 1) > 0)
        throw Error(ErrorCode::invalid_argument, name, "was edited though it was to stay whole");
    const auto first = std::size_t(std::find(cut.edited.begin(), cut.edited.end(), 1) - cut.edited.begin());
    const auto last = steps - std::size_t(std::find(cut.edited.rbegin(), cut.edited.rend(), 1) - cut.edited.rbegin());
    if (first >= last) throw Error(ErrorCode::invalid_argument, name, "is never edited");
    const auto within = [&](const auto& v) { return std::vector<double>(v.begin() + std::ptrdiff_t(first), v.begin() + std::ptrdiff_t(last)); };
    std::vector<double> edits;
    for (std::size_t i = first; i < last; ++i)
        if (cut.edited[i]) edits.push_back(cut.frame_ms[i]);
    std::printf("%s: steps %zu to %zu, %zu of them with an edit; %d threads\n", name.c_str(), first, last, edits.size(), threads);
    for (const auto& [what, run] : {std::pair{"edited", &cut}, {"left whole", &whole}}) {
        const std::vector<double> frame = within(run->frame_ms);
        double sum = 0;
        for (const double n : within(run->iterations)) sum += n;
        std::printf("  %-10s  frame %7.2f ms median, %7.2f p99, %7.2f longest; %5.1f iterations a step; script %6.2f ms median, %6.2f p99\n", what, quantile(frame, 0.5), quantile(frame, 0.99), quantile(frame, 1),
                    sum / double(last - first), quantile(within(run->script_ms), 0.5), quantile(within(run->script_ms), 0.99));
    }
    const std::vector<double> a = within(cut.frame_ms), b = within(whole.frame_ms);
    std::printf("  ratio       %.2f median, %.2f p99; frames with an edit %.2f ms median\n", quantile(a, 0.5) / quantile(b, 0.5), quantile(a, 0.99) / quantile(b, 0.99), quantile(edits, 0.5));
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        int threads = 1;
        std::vector<std::string> names;
        for (int i = 1; i < argc; ++i) {
            if (std::strcmp(argv[i], "--threads") == 0 && i + 1 < argc) threads = std::max(1, std::atoi(argv[++i]));
            else names.emplace_back(argv[i]);
        }
        if (names.empty()) names = {"cut", "carve", "tear"};
        for (const std::string& name : names) compare(name, threads);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
    return 0;
}
