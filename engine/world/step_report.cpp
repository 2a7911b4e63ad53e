#include "supple/world/step_report.h"

#include <algorithm>

namespace supple {

void StepReport::include(const StepReport& part) {
    flags |= part.flags;
    for (std::size_t i = 0; i < kStageCount; ++i) stage_ms[i] += part.stage_ms[i];
    cg_iterations += part.cg_iterations;
    solve_bytes += part.solve_bytes;
    newton_iterations = std::max(newton_iterations, part.newton_iterations);
    contact_iterations += part.contact_iterations;
    cg_relative_residual = std::max(cg_relative_residual, part.cg_relative_residual);
}

std::string_view name(StepFlag one_bit) {
    switch (one_bit) {
        case StepFlag::iteration_cap: return "iteration_cap";
        case StepFlag::residual_stalled: return "residual_stalled";
        case StepFlag::non_finite: return "non_finite";
        case StepFlag::frozen: return "frozen";
        case StepFlag::newton_cap: return "newton_cap";
        case StepFlag::no_equilibrium: return "no_equilibrium";
        case StepFlag::preconditioner: return "preconditioner";
        case StepFlag::budget: return "budget";
        case StepFlag::late_preconditioner: return "late_preconditioner";
        case StepFlag::contact_cap: return "contact_cap";
        case StepFlag::none: break;
    }
    return "none";
}

std::string_view cure(StepFlag one_bit) {
    switch (one_bit) {
        case StepFlag::iteration_cap:
            return "CG stopped at cg_max_iterations before cg_relative_tolerance: raise the one, loosen the other, or take a smaller time_step_s";
        case StepFlag::residual_stalled:
            return "float32 cannot reach cg_relative_tolerance for this stiffness and time step: set precision to \"double\" or loosen the tolerance";
        case StepFlag::non_finite:
            return "a body's numbers overflowed or it flew apart; it was put back to the start of the step and frozen: look at its loads and prescribed "
                   "motions, set newton_tolerance for a violent start, then reset() or unfreeze() it";
        case StepFlag::frozen: return "a body frozen by an earlier step waits for reset(), restore() or unfreeze()";
        case StepFlag::newton_cap: return "Newton stopped at newton_iterations before newton_tolerance: raise the one or loosen the other";
        case StepFlag::no_equilibrium:
            return "no static equilibrium was found: hold every body against all rigid motions, apply the load over several steps, or raise newton_iterations";
        case StepFlag::preconditioner:
            return "the frozen preconditioner was no longer positive and block-Jacobi took over: look for slivers in the mesh, or set preconditioner to \"block_jacobi\"";
        case StepFlag::budget:
            return "step_budget_us was used up before cg_relative_tolerance: raise the one, loosen the other, or use a coarser mesh";
        case StepFlag::late_preconditioner:
            return "the next preconditioner was not ready in its step and the last one goes on, slower: leave a core to it, or set step_budget_us to 0 for steps that wait";
        case StepFlag::contact_cap:
            return "contacts still opened, closed or slipped after contact_iterations: raise it, take a smaller time_step_s, or move the tool more slowly";
        case StepFlag::none: break;
    }
    return "all is well";
}

std::string_view name(Stage stage) {
    switch (stage) {
        case Stage::guard: return "guard";
        case Stage::loads: return "loads";
        case Stage::contact: return "contact";
        case Stage::elements: return "elements";
        case Stage::assemble: return "assemble";
        case Stage::solve: return "solve";
        case Stage::integrate: return "integrate";
        case Stage::plasticity: return "plasticity";
        case Stage::stress: return "stress";
        case Stage::count_: break;
    }
    return "unknown";
}

}  // namespace supple
