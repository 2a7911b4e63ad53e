// The solves of an island, each body with the preconditioner that precondition.cpp has made for it.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "supple/base/clock.h"
#include "supple/world/preconditioner_choice.h"

namespace supple {

namespace {

/// A vertex field of one member in the order of the rows of its island, and back.
void to_rows(Team& team, const Body& body, const std::vector<Vec3>& field, std::vector<Vec3>& rows) {
    const std::vector<std::int32_t>& vertex = body.data().pattern.vertex;
    team.for_range(vertex.size(), solve::kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) rows[body.work.first_row + i] = field[std::size_t(vertex[i])];
    });
}
void from_rows(Team& team, const Body& body, const std::vector<Vec3>& rows, std::vector<Vec3>& field) {
    const std::vector<std::int32_t>& vertex = body.data().pattern.vertex;
    team.for_range(vertex.size(), solve::kRowChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) field[std::size_t(vertex[i])] = rows[body.work.first_row + i];
    });
}

/// What all members want to know, laid out for the solver.
struct RowExchange {
    StepContext& ctx;
    Island& island;
    FunctionRef<void()> true_residual;
    RowFields& rows = ctx.scratch.rows;

    /// @param warm  the guesses of the last steps, too
    void begin(bool warm) {
        rows.resize(island.rows);
        for (const Member& m : island.members) {
            const Body& body = *m.body;
            to_rows(ctx.team, body, body.work.free_rhs, rows.b);
            to_rows(ctx.team, body, body.work.dv, rows.x);
            if (!warm) continue;
            to_rows(ctx.team, body, body.state.dv1, rows.guess[0]);
            to_rows(ctx.team, body, body.state.dv2, rows.guess[1]);
        }
    }
    /// work.residual for the solution so far.
    void residual() {
        for (const Member& m : island.members) from_rows(ctx.team, *m.body, rows.x, m.body->work.dv);
        true_residual();
        for (const Member& m : island.members) to_rows(ctx.team, *m.body, m.body->work.residual, rows.residual);
    }
    template <class Real>
    solve::LinearSolveResult run(solve::LinearSolver<Real>& solver, std::span<const solve::SystemPart<Real>> parts, bool warm, const solve::LinearSolveDef& def) {
        solver.set_eliminated(ctx.scratch.eliminated);
        const std::span<const Vec3> guesses[2] = {rows.guess[0], rows.guess[1]};
        return solver.solve(ctx.team, parts, ctx.scratch.appended, rows.b, std::span(guesses, warm ? 2 : 0), def, [&](const Vec3*, Vec3*) { residual(); }, rows.x, rows.residual);
    }
};

/// The solves of one body alone.
template <class Real>
struct LoneSolve {
    Body& body;
    System<Real>& system;
    RowExchange& exchange;

    solve::LinearSolveResult run(solve::Preconditioner<Real>& preconditioner, bool warm, const solve::LinearSolveDef& def) const {
        if (system.by_elements) {
            preconditioner.update(exchange.ctx.team, system.element_operator, exchange.ctx.scratch.appended);
        } else {
            preconditioner.update(exchange.ctx.team, system.A, exchange.ctx.scratch.appended);
        }
        const solve::SystemPart<Real> part{&system.A, &preconditioner, system.coupling.get(), 0, system.by_elements ? &system.element_operator : nullptr};
        return exchange.run<Real>(system.solver, {&part, 1}, warm, def);
    }

    /// Goes on from where `done` stopped.
    void go_on(solve::Preconditioner<Real>& preconditioner, const solve::LinearSolveDef& def, solve::LinearSolveResult& done) const {
        exchange.rows.b = exchange.rows.residual;
        solve::LinearSolveDef rest = def;
        rest.max_iterations = def.max_iterations - done.iterations;
        if (rest.max_iterations <= 0) return;
        const solve::LinearSolveResult before = done;
        done = run(preconditioner, false, rest);
        done.iterations += before.iterations;
        done.bytes += before.bytes;
    }
};

template <class Real>
void turn_lattice(StepContext& ctx, const Body& body, System<Real>& system) {
    system.multigrid->turn(ctx.team, [&](std::int32_t id, double* q) { read_rotation(body, body.state.quaternion, id, q); });
}

/// automatic_timed: the one of block-Jacobi and the multigrid that rests has a try, in less time than the other takes.
/// @return  what it did, if there was a trial
template <class Real>
std::optional<solve::LinearSolveResult> try_other(const LoneSolve<Real>& solve, bool warm, const solve::LinearSolveDef& def) {
    Body& body = solve.body;
    const PreconditionerKind kind = kind_at_work(body);
    const bool jacobi = kind == PreconditionerKind::block_jacobi;
    if ((!jacobi && kind != PreconditionerKind::lattice_multigrid) || !body.preconditioner_fits || body.state.solver[kMemoryBroken] > 0 || !body.timer.trial_is_due()) return std::nullopt;
    if (jacobi && solve.system.by_elements && sizeof(Real) == sizeof(double)) return std::nullopt;  // the multigrid would ask for the matrix
    solve::LinearSolveDef trial = def;
    const std::int64_t end = now_ns() + std::int64_t(1e6 * body.timer.trial_ms());
    if (def.deadline_ns == 0 || end < def.deadline_ns) trial.deadline_ns = end;
    if (jacobi) turn_lattice(solve.exchange.ctx, body, solve.system);
    const solve::LinearSolveResult result = jacobi ? solve.run(*solve.system.multigrid, warm, trial) : solve.run(*solve.system.preconditioner, warm, trial);
    if (!result.converged || now_ns() > end) {
        body.timer.lost();
    } else if (body.timer.won()) {
        set_kind(body, jacobi ? PreconditionerKind::lattice_multigrid : PreconditionerKind::block_jacobi);
    }
    return result;
}

template <class Real>
solve::LinearSolveResult solve_with_own(const LoneSolve<Real>& solve, bool warm, const solve::LinearSolveDef& def, bool remember, bool again) {
    RowExchange& exchange = solve.exchange;
    Body& body = solve.body;
    System<Real>& system = solve.system;
    StepContext& ctx = exchange.ctx;
    const bool automatic = ctx.world.def.solver.preconditioner == PreconditionerKind::automatic;
    std::vector<std::int32_t>& memory = body.state.solver;
    solve::LinearSolveResult result;
    if (works_without_build(body)) {
        result = solve.run(*system.preconditioner, warm, def);
        if (memory[kMemoryBroken] > 0) {
            --memory[kMemoryBroken];
        } else if (remember && automatic && kind_at_work(body) == PreconditionerKind::block_jacobi) {
            note_jacobi(body, result.iterations);
        }
        return result;
    }
    const bool lattice = kind_at_work(body) == PreconditionerKind::lattice_multigrid;
    if (lattice) turn_lattice(ctx, body, system);
    if (!lattice) {
        result = solve.run(*system.laplacian, warm, def);
    } else if (automatic && (again || (remember && memory[kMemoryTrial] == 0))) {
        // What is left when contacts have changed is near them: the coarse levels, which do not see contacts, have little to say.
        solve::LinearSolveDef trial = def;
        trial.max_iterations = std::min(def.max_iterations, kJacobiLimit);
        result = solve.run(*system.preconditioner, warm, trial);
        if (!again) memory[kMemoryTrial] = kTrialEvery;
        if (result.converged) {
            if (!again) set_kind(body, PreconditionerKind::block_jacobi);
            return result;
        }
        if (result.iterations < trial.max_iterations || result.out_of_time) return result;
        solve.go_on(*system.multigrid, def, result);
    } else {
        result = solve.run(*system.multigrid, warm, def);
        if (!result.breakdown && !result.indefinite && remember) note_multigrid(body, result, automatic);
    }
    if (result.breakdown && !result.indefinite) {
        ctx.report.flags |= StepFlag::preconditioner;
        memory[kMemoryBroken] = kBrokenSolves;
        solve.go_on(*system.preconditioner, def, result);
    }
    return result;
}

template <class Real>
solve::LinearSolveResult solve_alone(RowExchange& exchange, Body& body, System<Real>& system, bool warm, const solve::LinearSolveDef& def, bool remember, bool again) {
    const LoneSolve<Real> solve{body, system, exchange};
    if (!remember || exchange.ctx.world.def.solver.preconditioner != PreconditionerKind::automatic_timed) return solve_with_own(solve, warm, def, remember, again);
    if (const auto trial = try_other(solve, warm, def)) {
        const bool late = def.deadline_ns != 0 && now_ns() > def.deadline_ns;
        if (trial->converged || trial->indefinite || late || trial->iterations >= def.max_iterations || !std::isfinite(trial->residual)) return *trial;
        exchange.rows.b = exchange.rows.residual;
        solve::LinearSolveDef rest = def;
        rest.max_iterations -= trial->iterations;
        solve::LinearSolveResult result = solve_with_own(solve, false, rest, false, again);
        result.iterations += trial->iterations;
        result.bytes += trial->bytes;
        return result;
    }
    const std::int64_t begin = now_ns();
    const solve::LinearSolveResult result = solve_with_own(solve, warm, def, true, again);
    if (result.converged && result.iterations > 0) body.timer.note(1e-6 * double(now_ns() - begin));
    return result;
}

template <class Real>
solve::LinearSolveResult solve_together(RowExchange& exchange, JointSystem<Real>& joint, bool warm, const solve::LinearSolveDef& def) {
    StepContext& ctx = exchange.ctx;
    Island& island = exchange.island;
    joint.solver.resize(island.rows);
    bool built = false;  // a preconditioner that may break down is at work
    const auto set_parts = [&](bool simple) {
        joint.parts.clear();
        joint.touching.clear();
        for (const Member& m : island.members) {
            Body& body = *m.body;
            System<Real>& system = std::get<System<Real>>(body.system);
            solve::Preconditioner<Real>* preconditioner = system.preconditioner.get();
            bool jacobi = kind_at_work(body) != PreconditionerKind::direct;
            // What touches asks for many solves with little work each: there small bodies are better off with what is quickly made.
            const bool small = chooses(ctx.world.def.solver.preconditioner) && body.vertices() < kMultigridRows;
            if (!simple && !small && !works_without_build(body)) {
                built = true;
                jacobi = false;
                if (kind_at_work(body) == PreconditionerKind::lattice_multigrid) {
                    turn_lattice(ctx, body, system);
                    preconditioner = system.multigrid.get();
                } else {
                    preconditioner = system.laplacian.get();
                }
            }
            if (!jacobi) preconditioner->update(ctx.team, system.A, body.work.own_rows);
            joint.parts.push_back({&system.A, preconditioner, system.coupling.get(), body.work.first_row, nullptr});
            joint.touching.push_back({&system.A, body.work.first_row, jacobi ? nullptr : preconditioner, preconditioner->coupling_diagonal, body.work.y, body.owner});
        }
        joint.preconditioner.update(ctx.team, joint.touching, ctx.scratch.appended, ctx.scratch.eliminated, island.same_matrices && !simple);
        joint.solver.set_joint(&joint.preconditioner);
    };
    set_parts(false);
    island.same_matrices = true;
    solve::LinearSolveResult result = exchange.run<Real>(joint.solver, joint.parts, warm, def);
    for (const Member& m : island.members) {
        std::int32_t& broken = m.body->state.solver[kMemoryBroken];  // iterations are not remembered: they are those of what touches
        if (broken > 0) --broken;
    }
    if (built && result.breakdown && !result.indefinite) {
        ctx.report.flags |= StepFlag::preconditioner;
        for (const Member& m : island.members) {
            if (!needs_no_build(kind_at_work(*m.body))) m.body->state.solver[kMemoryBroken] = kBrokenSolves;
        }
        solve::LinearSolveDef rest = def;
        rest.max_iterations = std::max(1, def.max_iterations - result.iterations);
        exchange.rows.b = exchange.rows.residual;
        set_parts(true);
        const solve::LinearSolveResult before = result;
        result = exchange.run<Real>(joint.solver, joint.parts, false, rest);
        result.iterations += before.iterations;
        result.bytes += before.bytes;
    }
    return result;
}

}  // namespace

solve::LinearSolveResult solve_preconditioned(StepContext& ctx, Island& island, bool warm, const solve::LinearSolveDef& def, bool remember,
                                              bool again, FunctionRef<void()> true_residual) {
    const World::Impl& world = ctx.world;
    Scratch& scratch = ctx.scratch;
    RowExchange exchange{ctx, island, true_residual};
    exchange.begin(warm);
    if (!island.alone()) {
        if (world.def.solver.precision == Precision::single) {
            if (!scratch.joint_single) scratch.joint_single = std::make_unique<JointSystem<float>>(world.isa);
            return solve_together(exchange, *scratch.joint_single, warm, def);
        }
        if (!scratch.joint_double) scratch.joint_double = std::make_unique<JointSystem<double>>(world.isa);
        return solve_together(exchange, *scratch.joint_double, warm, def);
    }
    Body& body = *island.members[0].body;
    solve::LinearSolveResult result;
    with_system(body, [&](auto& system) { result = solve_alone(exchange, body, system, warm, def, remember, again); });
    return result;
}

}  // namespace supple
