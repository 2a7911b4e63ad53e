#include <array>
#include <cstdio>

#include "supple/base/error.h"
#include "supple/base/parallel.h"
#include "supple/math/isa.h"
#include "view/gui.h"
#include "view/panels.h"

namespace supple::demos::view {
namespace {

constexpr std::array<std::string_view, 6> kKinds = {"automatic", "block Jacobi", "lattice multigrid", "scalar Laplacian", "direct", "automatic, timed"};
constexpr std::array<std::string_view, 3> kOperators = {"automatic", "assembled", "matrix-free"};
constexpr std::array<std::string_view, 4> kIntegrators = {"implicit Euler", "bdf2", "newmark", "static"};

bool whole_number(const char* label, const char* id, int& value, int low, int high, const char* help) {
    const bool changed = ImGui::SliderInt(label, &value, low, high, "%d", ImGuiSliderFlags_Logarithmic);
    controls().mark(id);
    tooltip(help);
    return changed;
}

bool edit(SolverDef& solver) {
    bool changed = slider("Tolerance", "tolerance", solver.cg_relative_tolerance, 1e-9, 1e-1, "%.9g", "of the linear solve: 1e-3 for games, 1e-5 for measurements", true);
    changed |= whole_number("Iterations", "iterations", solver.cg_max_iterations, 1, 10000, "most per linear solve");
    changed |= whole_number("Newton", "newton", solver.newton_iterations, 0, 100, "most linear solves a step; 0: 1, of the static integrator 100");
    changed |= slider("Newton tol.", "newton tolerance", solver.newton_tolerance, 0, 0.1, solver.newton_tolerance > 0 ? "%.9g" : "all", "Newton stops where the residual has fallen to this part; 0: it does every iteration", true);
    int kind = int(solver.preconditioner);
    if (choice("Precond.", "preconditioner", kind, kKinds, "how the solves are sped up; none changes the answer beyond the tolerance")) {
        solver.preconditioner = PreconditionerKind(kind);
        changed = true;
    }
    int multiplied = int(solver.operator_kind);
    if (choice("Operator", "operator", multiplied, kOperators, "what the solves multiply by: hexes of one shape are faster without a matrix")) {
        solver.operator_kind = OperatorKind(multiplied);
        changed = true;
    }
    changed |= slider("Mass damp.", "mass damping", solver.rayleigh_mass_1_s, 0, 50, "%.3g 1/s", "Rayleigh: like a thick fluid around the bodies", true);
    changed |= slider("Inner damp.", "stiffness damping", solver.rayleigh_stiffness_s, 0, 0.1, "%.6g s", "Rayleigh: calms fast vibrations", true);
    return changed;
}

}  // namespace

void solver_panel(Desk& desk) {
    if (!header("Solver", false)) return;
    Session& session = desk.session;
    SolverDef solver = session.world().def().solver;
    try {
        if (edit(solver)) session.set_solver(solver);
    } catch (const Error& error) {
        desk.say(error.what(), true);
    }
    char line[200];
    const WorldDef& def = session.world().def();
    std::snprintf(line, sizeof line, "%s, %s precision, %s tangent. The last step: %d iterations, residual %.1e.", kIntegrators[std::size_t(def.solver.integrator)].data(),
                  def.solver.precision == Precision::double_ ? "double" : "single", def.solver.tangent == Tangent::exact ? "exact" : "warped",
                  session.last().cg_iterations, session.last().cg_relative_residual);
    quiet_sentence(line);
    const int threads = def.threads > 0 ? def.threads : hardware_threads();
    const std::string_view isa = name(def.isa.value_or(best_isa()));
    std::snprintf(line, sizeof line, "%d thread%s, kernels for %.*s.", threads, threads == 1 ? "" : "s", int(isa.size()), isa.data());
    quiet_sentence(line);
}

}  // namespace supple::demos::view
