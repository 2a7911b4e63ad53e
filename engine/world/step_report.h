#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "supple/math/types.h"

namespace supple {

/// Why a step is less than it should be. Every bit names the setting that cures it (see cure()).
enum class StepFlag : std::uint32_t {
    none = 0,
    iteration_cap = 1u << 0,     ///< CG stopped at SolverDef.cg_max_iterations before its tolerance
    residual_stalled = 1u << 1,  ///< float32 could not reach the tolerance: use Precision::double_
    non_finite = 1u << 2,        ///< a body became non-finite, or a million times larger than at rest, in this step; it was rolled back and frozen
    frozen = 1u << 3,            ///< a body frozen by an earlier step is waiting for World::reset(), restore() or unfreeze()
    newton_cap = 1u << 4,        ///< newton_iterations done before newton_tolerance (only with newton_tolerance > 0)
    no_equilibrium = 1u << 5,    ///< static: no equilibrium found, even with the load in small steps
    preconditioner = 1u << 6,    ///< the preconditioner lost its definiteness; block-Jacobi took over, the answer is as good but slower
    budget = 1u << 7,            ///< step_budget_us was used up before the tolerance: the step holds the best iterate
    late_preconditioner = 1u << 8,  ///< with step_budget_us: the next preconditioner was not ready in its step, the last one goes on; the run is no longer the same every time
    contact_cap = 1u << 9,       ///< contacts still changed by more than a tenth of their force after contact_iterations
};
constexpr StepFlag operator|(StepFlag a, StepFlag b) { return StepFlag(std::uint32_t(a) | std::uint32_t(b)); }
constexpr StepFlag operator&(StepFlag a, StepFlag b) { return StepFlag(std::uint32_t(a) & std::uint32_t(b)); }
constexpr StepFlag& operator|=(StepFlag& a, StepFlag b) { return a = a | b; }
inline constexpr StepFlag kAllStepFlags[] = {StepFlag::iteration_cap, StepFlag::residual_stalled, StepFlag::non_finite,
                                             StepFlag::frozen, StepFlag::newton_cap, StepFlag::no_equilibrium, StepFlag::preconditioner, StepFlag::budget,
                                             StepFlag::late_preconditioner, StepFlag::contact_cap};

std::string_view name(StepFlag one_bit);  ///< "iteration_cap", ...: the words of report files
std::string_view cure(StepFlag one_bit);  ///< one sentence: what to change

/// The stages of a step, in order.
enum class Stage { guard, loads, contact, elements, assemble, solve, integrate, plasticity, stress, count_ };
inline constexpr std::size_t kStageCount = std::size_t(Stage::count_);
std::string_view name(Stage stage);  ///< "guard", "loads", ...

/// What one step did. Times are wall clock; sums run over bodies and Newton iterations.
struct StepReport {
    std::uint64_t step = 0;      ///< number of this step since the world began, from 1
    double time_s = 0;           ///< simulated time at its end
    StepFlag flags = StepFlag::none;
    double step_ms = 0;
    std::array<double, kStageCount> stage_ms{};
    int cg_iterations = 0;
    int newton_iterations = 0;   ///< largest over the bodies
    int contacts = 0;            ///< that press at the end of the step
    int contact_iterations = 0;  ///< solves that contacts asked for beyond the first of each
    std::size_t contact_bytes = 0;  ///< memory that contacts hold; it grows with the most of them at a time, and only then does a step allocate
    double solve_bytes = 0;          ///< read and written by the linear solves, had the caches nothing of it; without the true residual through the elements
    double cg_relative_residual = 0;  ///< |b - A dv| / |b| in float64 arithmetic on float64 state; largest over bodies. 0 where b = 0
    /// Adds what happened to another part of the same step.
    void include(const StepReport& part);
    double setup_ms() const { return step_ms - stage_ms[std::size_t(Stage::solve)]; }
};

struct AdvanceReport {
    int steps = 0;               ///< fixed steps done
    double alpha = 0;            ///< 0..1: how far the wall clock is between the last two states; draw (1-alpha) previous + alpha current
    double dropped_s = 0;        ///< real time given up because max_catch_up_steps was reached
    StepReport last;             ///< flags are those of all the steps
};

}  // namespace supple
