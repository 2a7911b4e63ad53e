// Matrix-vector products and preconditioners against what their bytes cost at the bandwidth measured in the same run.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "elastic_problem.h"
#include "kernels.h"

namespace supple::bench {
namespace {

using Problem = test::ElasticProblem<float>;

std::shared_ptr<Problem> bar_problem(std::array<int, 3> cells) {
    Problem::Def def;
    def.young_pa = 2e5;
    return std::make_shared<Problem>(test::bar(cells), def, [](const Vec3& x) { return std::uint8_t(x.x() < 1e-9 ? 7 : 0); });
}

/// What is read again in every iteration lies in the cache as long as it is smaller than that.
double read_gb_s(double bytes) { return bytes < 20e6 ? machine().cache_one_gb_s : machine().read_one_gb_s; }

/// Bytes per second, and the seconds that the bytes alone would take.
void report_bytes(benchmark::State& state, double bytes) {
    state.counters["bytes"] = benchmark::Counter(bytes, benchmark::Counter::kIsIterationInvariantRate);
    state.counters["bound_s"] = 1e-9 * bytes / read_gb_s(bytes);
}

void matvec(benchmark::State& state, const std::shared_ptr<Problem>& p, Isa isa) {
    solve::LinearSolver<float> solver(p->rows(), isa);
    AlignedVector<float> x(p->rows() * 4, 1.0f), y(p->rows() * 4);
    const solve::SystemPart<float> part{&p->A};
    for (auto _ : state) benchmark::DoNotOptimize(solver.multiply(p->team, {&part, 1}, {}, x.data(), y.data()));
    report_bytes(state, double(p->pattern.blocks() * 52 + p->rows() * 36));
    state.counters["per_block"] =
        benchmark::Counter(double(p->pattern.blocks()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void apply(benchmark::State& state, const std::shared_ptr<Problem>& p, bool multigrid) {
    std::unique_ptr<solve::Preconditioner<float>> preconditioner;
    if (multigrid)
        preconditioner = p->multigrid();
    else
        preconditioner = std::make_unique<solve::BlockJacobi<float>>(p->rows(), best_isa());
    preconditioner->update(p->team, p->A, {});
    AlignedVector<float> r(p->rows() * 4, 0.0f), z(p->rows() * 4);
    for (std::size_t i = 0; i < p->rows(); ++i)
        for (std::size_t c = 0; c < 3; ++c) r[4 * i + c] = float(p->b[i][Eigen::Index(c)]);
    for (auto _ : state) benchmark::DoNotOptimize(preconditioner->apply(p->team, r.data(), z.data()));
    if (!multigrid) report_bytes(state, double(p->rows() * 80));
}

void update(benchmark::State& state, const std::shared_ptr<Problem>& p) {
    const auto multigrid = p->multigrid();
    for (auto _ : state) {
        multigrid->turn(p->team, p->rotation());
        multigrid->update(p->team, p->A, {});
    }
}

void build(benchmark::State& state, const std::shared_ptr<Problem>& p) {
    for (auto _ : state) benchmark::DoNotOptimize(p->multigrid());
}

}  // namespace

void register_solve_kernels() {
    for (const std::array<int, 3>& cells : {std::array{32, 8, 8}, {64, 16, 16}, {96, 24, 24}}) {
        const std::string tets = "_" + std::to_string(6 * cells[0] * cells[1] * cells[2]);
        // Made when the first of its benchmarks runs: a filter then costs nothing else.
        const auto cache = std::make_shared<std::shared_ptr<Problem>>();
        const auto problem = [cells, cache] {
            if (!*cache) *cache = bar_problem(cells);
            return *cache;
        };
        for (const Isa isa : kAllIsas) {
            if (is_supported(isa))
                benchmark::RegisterBenchmark(("matvec/tets" + tets + "/" + std::string(name(isa))).c_str(), [=](benchmark::State& s) { matvec(s, problem(), isa); });
        }
        benchmark::RegisterBenchmark(("block_jacobi/tets" + tets).c_str(), [=](benchmark::State& s) { apply(s, problem(), false); });
        benchmark::RegisterBenchmark(("multigrid_cycle/tets" + tets).c_str(), [=](benchmark::State& s) { apply(s, problem(), true); });
        benchmark::RegisterBenchmark(("multigrid_update/tets" + tets).c_str(), [=](benchmark::State& s) { update(s, problem()); });
        benchmark::RegisterBenchmark(("multigrid_build/tets" + tets).c_str(), [=](benchmark::State& s) { build(s, problem()); });
    }
}

}  // namespace supple::bench
