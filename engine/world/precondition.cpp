#include "supple/world/precondition.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "supple/base/clock.h"

namespace supple {

namespace {

// One cycle costs about as much as eight iterations of block-Jacobi (measured on bars and the bunny), so what block-Jacobi does in this many is best left to it.
constexpr int kJacobiLimit = 32;
constexpr int kCycleCost = 8;
constexpr std::size_t kMultigridRows = 1500;   // auto: bodies of so many vertices begin with the multigrid
constexpr std::size_t kSmallestForLattice = 100;  // below, no lattice is coarser than the mesh
constexpr std::int32_t kTrialEvery = 50;       // solves between two trials of block-Jacobi
constexpr std::int32_t kSlowSolves = 5;        // in a row, before the hierarchy is built anew
constexpr int kTellingIterations = 4;          // fewer say nothing about a hierarchy
constexpr std::int32_t kStepsToBuild = 16;     // a hierarchy takes about five steps' time on a thread of its own, more where the cores are busy
constexpr std::int32_t kStepsAfterEdit = 6;    // the same where one of before an edit stands in, which should not be for long
constexpr std::int32_t kStepsToWaitFor = 3;    // another edit waits for a hierarchy that is so near; one that is farther off is given up
constexpr std::int32_t kBrokenSolves = 100;    // before a preconditioner that broke down gets another chance

std::vector<std::uint8_t> held_by_row(const Body& body) {
    const std::vector<std::uint8_t> held = held_bits(body);
    return solve::by_row(body.data().pattern, std::span(held));
}

PreconditionerKind kind_at_work(const Body& body) { return PreconditionerKind(body.state.solver[kMemoryKind]); }

/// System::preconditioner itself: block-Jacobi, or the factor.
bool needs_no_build(PreconditionerKind kind) { return kind == PreconditionerKind::block_jacobi || kind == PreconditionerKind::direct; }

void read_rotation(const Body& body, const AlignedVector<double>& quaternion, std::int32_t element, double* wxyz) {
    const std::size_t slot = body.layout().slot[std::size_t(element)];
    const double* q = quaternion.data() + slot / fem::kBlock * 4 * fem::kBlock + slot % fem::kBlock;
    for (std::size_t k = 0; k < 4; ++k) wxyz[k] = q[k * fem::kBlock];
}

/// Factors of M and K in the matrix, the same whenever a preconditioner is built.
struct MatrixScales {
    double mass = 0, stiffness = 0;
};

MatrixScales scales_at_build(StepContext& ctx, Body& body) {
    const double h = body.work.h;
    body.work.h = scheme_step(ctx.world.def);
    const MatrixScales scales{mass_scale(ctx, body), stiffness_scale(ctx, body)};
    body.work.h = h;
    return scales;
}

/// Tangent of a configuration in A, with the coordinates in `held` [row] left out. Uses the elements given: not those of a body between its evaluation and its solve.
/// @return  rotations of its elements, [element][w x y z]
template <class Real>
std::vector<double> assemble_configuration(Team& team, const Body& body, const MatrixScales& scales, fem::Elements& elements, const std::vector<Vec3>& x,
                                           const std::vector<std::uint8_t>& held, solve::Bsr3<Real>& A) {
    AlignedVector<double> quaternion(body.layout().blocks * 4 * fem::kBlock, 0.0);
    fem::seed_rotations(team, body.layout(), x, quaternion);
    fem::ElementOutputs outputs;
    outputs.tangent = true;
    elements.evaluate(team, x.data()->data(), quaternion.data(), outputs);
    const solve::Bsr3Pattern& pattern = body.data().pattern;
    std::vector<double> diagonal(pattern.rows);
    for (std::size_t row = 0; row < pattern.rows; ++row) diagonal[row] = scales.mass * body.mass[std::size_t(pattern.vertex[row])];
    elements.assemble(team, scales.stiffness, diagonal, A.value.data());
    for (std::size_t row = 0; row < pattern.rows; ++row) {
        for (std::int32_t block = pattern.row_start[row]; block < pattern.row_start[row + 1]; ++block) {
            const auto column = std::size_t(pattern.column[std::size_t(block)]);
            if (held[row] == 0 && held[column] == 0) continue;
            Real* value = A.value.data() + std::size_t(block) * 12;
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t i = 0; i < 3; ++i) {
                    if ((held[row] >> i & 1) || (held[column] >> c & 1)) value[4 * c + i] = Real(row == column && i == c ? 1 : 0);
                }
        }
    }
    std::vector<double> rotation(body.element_count() * 4);
    for (std::size_t e = 0; e < body.element_count(); ++e) read_rotation(body, quaternion, std::int32_t(e), rotation.data() + 4 * e);
    return rotation;
}

/// The hierarchy of a configuration; A is scratch.
template <class Real>
std::unique_ptr<solve::LatticeMultigrid<Real>> build_hierarchy(Team& team, Isa isa, const Body& body, const MatrixScales& scales, fem::Elements& elements,
                                                               const std::vector<Vec3>& x, const std::vector<std::uint8_t>& held_of_vertex, solve::Bsr3<Real>& A) {
    const solve::Bsr3Pattern& pattern = body.data().pattern;
    const std::vector<std::uint8_t> held = solve::by_row(pattern, std::span(held_of_vertex));
    const std::vector<Vec3> points = solve::by_row(pattern, std::span(body.data().mesh.vertices));
    const std::vector<double> rotation = assemble_configuration(team, body, scales, elements, x, held, A);
    std::vector<std::array<std::int32_t, 3>> elements_near(body.vertices(), {-1, -1, -1});  // [row] up to three at each, then -1
    for (std::size_t i = 0; i < elements_near.size(); ++i) {
        const fem::ElementMap& around = body.layout().around;
        const auto v = std::size_t(pattern.vertex[i]);
        const std::int64_t first = around.start[v], last = around.start[v + 1];
        for (std::int64_t k = 0; k < 3 && first + k < last; ++k) {
            // Spread over the elements around the vertex, not three neighbours of one another.
            elements_near[i][std::size_t(k)] = around.element[std::size_t(first + k * (last - first) / 3)];
        }
    }
    solve::LatticeDef def;
    def.points = points;
    def.held = held;
    def.rotation_of_row = elements_near;
    for (const double v : body.layout().volume) def.volume += v;
    auto multigrid = std::make_unique<solve::LatticeMultigrid<Real>>(pattern, isa);
    multigrid->build(team, def, A, [&](std::int32_t id, double* q) { std::copy_n(rotation.data() + 4 * std::size_t(id), 4, q); });
    return multigrid;
}

/// The hierarchy of state.hierarchy_x, at once. Before a step's evaluation.
template <class Real>
void build_now(StepContext& ctx, Body& body, System<Real>& system) {
    system.multigrid = build_hierarchy(ctx.team, ctx.world.isa, body, scales_at_build(ctx, body), *body.elements, body.state.hierarchy_x, body.state.hierarchy_held, system.A);
    system.multigrid->hold(held_by_row(body));
    body.state.solver[kMemoryInherited] = 0;
}

/// Asks for a hierarchy of the body as it stands. The one at work goes on meanwhile.
void ask_for_next(Body& body, std::int32_t steps = kStepsToBuild) {
    std::vector<std::int32_t>& m = body.state.solver;
    if (m[kMemoryPending] > 0 && m[kMemoryPending] < m[kMemoryAsked]) {  // it has begun
        m[kMemoryAgain] = 1;
        return;
    }
    body.state.next_x = body.state.x;
    body.state.next_held = held_bits(body);
    m[kMemoryPending] = m[kMemoryAsked] = steps;
    m[kMemoryAgain] = 0;
}

/// Sets a thread to the hierarchy that was asked for, unless one is at it.
template <class Real>
void begin_next(StepContext& ctx, Body& body, System<Real>& system) {
    if (system.next) return;
    system.next = std::make_unique<HierarchyBuild<Real>>();
    HierarchyBuild<Real>& next = *system.next;
    next.x = body.state.next_x;
    next.held = body.state.next_held;
    // Matrix and elements of its own: the steps go on with the body's.
    next.thread = std::make_unique<Background>([&next, &body = std::as_const(body), isa = ctx.world.isa, scales = scales_at_build(ctx, body), tangent = ctx.world.def.solver.tangent] {
        Team alone;
        constexpr auto precision = sizeof(Real) == 4 ? fem::MatrixPrecision::single : fem::MatrixPrecision::double_;
        const auto elements = make_body_elements(body, precision, tangent, isa, true);
        solve::Bsr3<Real> A{&body.data().pattern, AlignedVector<Real>(body.data().pattern.blocks() * 12)};
        next.result = build_hierarchy(alone, isa, body, scales, *elements, next.x, next.held, A);
    });
}

/// Waits for it, and puts it to work.
template <class Real>
void take_next(Body& body, System<Real>& system) {
    std::vector<std::int32_t>& m = body.state.solver;
    system.next->thread->wait();
    system.multigrid = std::move(system.next->result);
    system.next.reset();
    std::swap(body.state.hierarchy_x, body.state.next_x);
    std::swap(body.state.hierarchy_held, body.state.next_held);
    system.multigrid->hold(held_by_row(body));
    m[kMemoryPending] = m[kMemoryBase] = m[kMemorySlow] = m[kMemoryFallback] = m[kMemoryInherited] = 0;
}

/// Brings the next hierarchy on its way, and puts it to work when its steps have passed: always after the same number, ready or not, so that a run is the same every time.
template <class Real>
void advance_next(StepContext& ctx, Body& body, System<Real>& system) {
    std::vector<std::int32_t>& m = body.state.solver;
    if (m[kMemoryPending] == 0) return;
    begin_next(ctx, body, system);
    if (--m[kMemoryPending] > 0) return;
    if (ctx.world.def.solver.step_budget_us > 0 && !system.next->thread->done()) {
        ctx.report.flags |= StepFlag::late_preconditioner;
        m[kMemoryPending] = 1;
        return;
    }
    take_next(body, system);
    if (m[kMemoryAgain] != 0) ask_for_next(body);
}

/// False if the matrix has no such factor.
template <class Real>
bool build_laplacian(StepContext& ctx, Body& body, System<Real>& system) {
    const std::vector<std::uint8_t> held = held_by_row(body);
    assemble_configuration(ctx.team, body, scales_at_build(ctx, body), *body.elements, body.state.hierarchy_x, held, system.A);
    system.laplacian = std::make_unique<solve::ScalarLaplacian<Real>>(body.vertices());
    return system.laplacian->build(system.A, held);
}

bool chooses(PreconditionerKind asked) { return asked == PreconditionerKind::automatic || asked == PreconditionerKind::automatic_timed; }

/// Whether the multigrid is of use to a body at all.
bool may_have_lattice(const Body& body) { return body.vertices() >= kSmallestForLattice && !body.elements->is_coupled(); }

/// The first choice of `auto`: by size.
PreconditionerKind first_choice(const Body& body, PreconditionerKind asked) {
    if (body.vertices() < kSmallestForLattice && (chooses(asked) || asked == PreconditionerKind::lattice_multigrid)) {
        return PreconditionerKind::block_jacobi;
    }
    if (!chooses(asked)) return asked;
    if (body.elements->is_coupled()) return PreconditionerKind::block_jacobi;  // the matrix lacks the stiffest part of the operator
    return body.vertices() >= kMultigridRows ? PreconditionerKind::lattice_multigrid : PreconditionerKind::block_jacobi;
}

void set_kind(Body& body, PreconditionerKind kind) {
    with_system(body, [](auto& system) { system.next.reset(); });
    const std::int32_t inherited = body.state.solver[kMemoryInherited];  // it lies there still
    body.state.solver.assign(kMemoryCount, 0);
    body.state.solver[kMemoryKind] = std::int32_t(kind);
    body.state.solver[kMemoryInherited] = inherited;
    body.state.solver[kMemoryTrial] = kTrialEvery;
}

/// Looks back on a solve of `auto` by block-Jacobi alone.
void note_jacobi(Body& body, int iterations) {
    if (iterations > kJacobiLimit && may_have_lattice(body)) set_kind(body, PreconditionerKind::lattice_multigrid);
}

/// Looks back on a solve by the multigrid. What a hierarchy is worth shows in iterations per digit: their number alone changes with the start.
void note_multigrid(Body& body, const solve::LinearSolveResult& result, bool automatic) {
    std::vector<std::int32_t>& m = body.state.solver;
    const int iterations = result.iterations;
    if (automatic && m[kMemoryTrial] > 0 && iterations * kCycleCost <= kJacobiLimit) --m[kMemoryTrial];
    const double digits = std::log10(result.start_residual / result.residual);
    if (iterations < kTellingIterations || !(digits >= 1)) return;
    const auto cost = std::int32_t(std::min(1e6, 1000 * iterations / digits));
    if (m[kMemoryBase] == 0) {
        m[kMemoryBase] = cost;
        m[kMemorySlow] = 0;
        return;
    }
    m[kMemorySlow] = cost > m[kMemoryBase] + m[kMemoryBase] / 2 ? m[kMemorySlow] + 1 : 0;
    if (m[kMemorySlow] < kSlowSolves) return;
    m[kMemorySlow] = 0;
    if (m[kMemoryPending] == 0) ask_for_next(body);
}

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

/// Nothing but block-Jacobi, or the factor, is at work, or can be.
bool works_without_build(const Body& body) { return needs_no_build(kind_at_work(body)) || !body.preconditioner_fits || body.state.solver[kMemoryBroken] > 0; }

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

std::vector<std::uint8_t> held_bits(const Body& body) {
    std::vector<std::uint8_t> held(body.vertices());
    for (std::size_t i = 0; i < held.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) held[i] = std::uint8_t(held[i] | (body.is_held(i, c) ? 1u << c : 0u));
    }
    return held;
}

void drop_preconditioner(Body& body) {
    body.preconditioner_fits = false;
    body.state.solver[kMemoryInherited] = 0;
    with_system(body, [](auto& system) { system.next.reset(); });
}

void supports_have_changed(Body& body) {
    // By the state alone, whether or not the hierarchy has been built here yet: a continued run decides alike.
    if (kind_at_work(body) == PreconditionerKind::lattice_multigrid) {
        if (body.preconditioner_fits) with_system(body, [&](auto& system) { system.multigrid->hold(held_by_row(body)); });
        ask_for_next(body);
        return;
    }
    drop_preconditioner(body);
    body.state.hierarchy_held = held_bits(body);
    body.state.solver[kMemoryPending] = body.state.solver[kMemoryAgain] = 0;
}

void ready_for_edit(World::Impl& world, Body& body) {
    if (kind_at_work(body) != PreconditionerKind::lattice_multigrid) return;
    const std::vector<std::int32_t>& m = body.state.solver;
    StepReport unread;
    StepContext ctx{world.team_for(body.element_count()), world, world.scratch, unread, world.time_s()};
    with_system(body, [&](auto& system) {
        if (m[kMemoryPending] > 0 && m[kMemoryPending] <= kStepsToWaitFor) {
            begin_next(ctx, body, system);
            take_next(body, system);
            body.preconditioner_fits = true;
        } else if (!body.preconditioner_fits && m[kMemoryFallback] == 0) {
            build_now(ctx, body, system);
            body.preconditioner_fits = true;
        }
    });
}

void begin_after_edit(Body& body, const std::vector<std::int32_t>& before) {
    std::vector<std::int32_t>& m = body.state.solver;
    m.assign(kMemoryCount, 0);
    body.preconditioner_fits = false;
    if (body.vertices() < kSmallestForLattice) return;  // chosen anew
    m[kMemoryKind] = before[kMemoryKind];
    m[kMemoryTrial] = kTrialEvery;
    if (kind_at_work(body) != PreconditionerKind::lattice_multigrid) return;
    m[kMemoryFallback] = 1;
    ask_for_next(body);
}

void inherit_preconditioner(Body& from, Body& body, const TopologyDelta& delta, Isa isa) {
    std::vector<std::int32_t>& m = body.state.solver;
    if (m[kMemoryFallback] == 0 || !from.preconditioner_fits || kind_at_work(from) != PreconditionerKind::lattice_multigrid) return;
    std::vector<std::array<std::int32_t, 4>> parent(body.vertices());  // [row] rows
    std::vector<std::array<double, 4>> weight(body.vertices());
    for (std::size_t row = 0; row < parent.size(); ++row) {
        const auto& parents = delta.vertex_parents[std::size_t(body.data().pattern.vertex[row])];
        for (std::size_t k = 0; k < 4; ++k) parent[row][k] = parents.vertex[k] < 0 ? -1 : from.row_of(parents.vertex[k]);
        weight[row] = parents.weight;
    }
    std::vector<std::int32_t> rotation = delta.element_to_new;
    for (std::size_t e = delta.element_parent.size(); e-- > 0;) {  // of parts the first
        if (delta.element_parent[e] >= 0 && delta.element_to_new[std::size_t(delta.element_parent[e])] < 0) rotation[std::size_t(delta.element_parent[e])] = std::int32_t(e);
    }
    const auto take = [&]<class Real>(System<Real>& system) {
        System<Real>& old = std::get<System<Real>>(from.system);
        system.multigrid = std::make_unique<solve::LatticeMultigrid<Real>>(body.data().pattern, isa);
        system.multigrid->follow(*old.multigrid, {parent, weight, rotation});
        system.multigrid->hold(held_by_row(body));
    };
    with_system(body, take);
    from.preconditioner_fits = false;
    body.preconditioner_fits = true;
    m[kMemoryBase] = from.state.solver[kMemoryBase];
    m[kMemoryPending] = m[kMemoryAgain] = m[kMemoryFallback] = 0;
    m[kMemoryInherited] = 1;
    ask_for_next(body, kStepsAfterEdit);
}

void write_inherited(ByteWriter& out, const Body& body) {
    if (body.state.solver[kMemoryInherited] == 0) return;
    std::visit(
        [&](const auto& system) {
            if constexpr (!std::is_same_v<std::remove_cvref_t<decltype(system)>, std::monostate>) system.multigrid->save(out);
        },
        body.system);
}

void read_inherited(ByteReader& in, const BodyState& state, const Body& body, Isa isa, Inherited& to) {
    if (state.solver[kMemoryInherited] == 0) return;
    Team alone;
    const auto read = [&]<class Real>(const System<Real>&) {
        auto made = std::make_unique<solve::LatticeMultigrid<Real>>(body.data().pattern, isa);
        made->load(alone, in, body.element_count());
        to = std::move(made);
    };
    if (const auto* single = std::get_if<System<float>>(&body.system)) read(*single);
    if (const auto* dbl = std::get_if<System<double>>(&body.system)) read(*dbl);
}

void restart_preconditioner(Body& body, BodyState& state) {
    const bool built_alike = body.preconditioner_fits && body.state.solver[kMemoryInherited] == 0 && state.solver[kMemoryInherited] == 0 &&
                             state.hierarchy_x == body.state.hierarchy_x && state.hierarchy_held == body.state.hierarchy_held;
    if (!built_alike) return drop_preconditioner(body);
    with_system(body, [](auto& system) { system.next.reset(); });
}

void take_inherited(Body& body, Inherited inherited) {
    const auto take = [&]<class Real>(System<Real>& system) {
        auto* made = std::get_if<std::unique_ptr<solve::LatticeMultigrid<Real>>>(&inherited);
        if (made == nullptr) return;
        system.multigrid = std::move(*made);
        system.multigrid->hold(held_by_row(body));
        body.preconditioner_fits = true;
    };
    with_system(body, take);
}

void prepare_preconditioner(StepContext& ctx, Body& body) {
    const PreconditionerKind asked = ctx.world.def.solver.preconditioner;
    if (kind_at_work(body) == PreconditionerKind::automatic) set_kind(body, first_choice(body, asked));
    if (asked == PreconditionerKind::automatic_timed && kind_at_work(body) == PreconditionerKind::block_jacobi) {
        // The multigrid that is to have a try is made beside the steps.
        if (!body.preconditioner_fits && body.timer.trial_is_due() && body.state.solver[kMemoryPending] == 0 && may_have_lattice(body)) ask_for_next(body);
        with_system(body, [&](auto& system) {
            if (body.state.solver[kMemoryPending] == 0) return;
            advance_next(ctx, body, system);
            body.preconditioner_fits = body.state.solver[kMemoryPending] == 0;
        });
        return;
    }
    if (needs_no_build(kind_at_work(body))) return;
    bool good = true;
    with_system(body, [&](auto& system) {
        const bool lattice = kind_at_work(body) == PreconditionerKind::lattice_multigrid;
        if (!body.preconditioner_fits && body.state.solver[kMemoryFallback] == 0) {
            if (lattice) {
                build_now(ctx, body, system);
            } else {
                good = build_laplacian(ctx, body, system);
            }
        }
        if (lattice) advance_next(ctx, body, system);
    });
    if (!good) {
        ctx.report.flags |= StepFlag::preconditioner;
        set_kind(body, PreconditionerKind::block_jacobi);
    }
    body.preconditioner_fits = good && body.state.solver[kMemoryFallback] == 0;
}

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
