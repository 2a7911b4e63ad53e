// Micro-benchmarks of the kernels: supple_kernel_bench --benchmark_filter=matvec --benchmark_repetitions=5
#include <benchmark/benchmark.h>

#include "kernels.h"

namespace supple::bench {

const demos::Machine& machine() {
    static const demos::Machine measured = demos::measure_machine();
    return measured;
}

}  // namespace supple::bench

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::AddCustomContext("machine", supple::bench::machine().line());
    supple::bench::register_element_kernels();
    supple::bench::register_solve_kernels();
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
