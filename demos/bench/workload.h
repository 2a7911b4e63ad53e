#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "demo.h"

namespace supple::demos {

/// What the command line says about a benchmark.
struct BenchOptions {
    std::vector<std::string> files;     ///< scenes, demos, meshes; none: the fixed set
    std::string only;                   ///< workloads whose name contains this
    std::string json_file, plot_folder;
    ShowOptions show;
    std::size_t steps = 100;            ///< from the start of a workload; the first is not timed
    std::size_t repeat = 3;
    bool quick = false;                 ///< nothing beyond 20,000 elements, a fifth of the steps
    bool scaling = false;               ///< cost against size and threads in place of the fixed set
    bool busy = false;                  ///< steps beside busy processes in place of the fixed set
    std::optional<double> tolerance{};  ///< of the bars' and meshes' solves, in place of 1e-3 and 1e-5
    PreconditionerKind preconditioner = PreconditionerKind::automatic;
    OperatorKind operator_kind = OperatorKind::automatic;
};

/// Something to time. Its name says all that a comparison needs: "tets-12288-1e-3".
struct Workload {
    std::string name;
    bool scripted = false;  ///< something is done to it between steps, and no snapshot holds the script
    std::function<std::unique_ptr<Show>()> make;
    std::function<Vec3(Show&)> tip{};                   ///< a point that tells whether the steps were right; may be empty
    std::string series{};                               ///< which curve of cost against size it belongs to; empty: none
    std::size_t steps = 0;                              ///< 0: as many as the options say
    double gigabytes = 0;                               ///< a bound on the memory it needs; left out where there is less
};

/// The common workload: a bar of 0.4 x 0.1 x 0.1 m clamped at x = 0 bends under gravity from rest.
struct BarDef {
    std::array<int, 3> cells{};
    bool hexes = false;
    Material material = Corotational{.young_pa = 2e5, .poisson = 0.4};
    double tolerance = 1e-5;
    double time_step_s = 0.01;
    int threads = 0;
};
Workload bar(const std::string& name, const BarDef& bar, const BenchOptions& options);

std::vector<Workload> fixed_set(const BenchOptions& options);
std::vector<Workload> scaling_set(const BenchOptions& options);
/// A scene or a demo: one; a mesh: one per tolerance.
/// @error Error(invalid_argument) for what is none of them, or whatever reading it throws
std::vector<Workload> workloads_of(const std::string& file, const BenchOptions& options);

}  // namespace supple::demos
