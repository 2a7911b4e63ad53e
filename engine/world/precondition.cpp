#include "supple/world/precondition.h"

#include <algorithm>
#include <cmath>

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

/// Tangent of a configuration in system.A, with the coordinates in `held` [row] left out. Uses the body's elements: before a step's evaluation.
/// @return  rotations of its elements, [element][w x y z]
template <class Real>
std::vector<double> assemble_configuration(StepContext& ctx, Body& body, System<Real>& system, const std::vector<Vec3>& x, const std::vector<std::uint8_t>& held) {
    AlignedVector<double> quaternion(body.layout().blocks * 4 * fem::kBlock, 0.0);
    fem::seed_rotations(ctx.team, body.layout(), x, quaternion);
    fem::ElementOutputs outputs;
    outputs.tangent = true;
    body.elements->evaluate(ctx.team, x.data()->data(), quaternion.data(), outputs);
    const double h = body.work.h;
    body.work.h = scheme_step(ctx.world.def);  // the same whenever it is built
    const double mass = mass_scale(ctx, body), stiffness = stiffness_scale(ctx, body);
    body.work.h = h;
    const solve::Bsr3Pattern& pattern = body.data().pattern;
    std::vector<double> diagonal(pattern.rows);
    for (std::size_t row = 0; row < pattern.rows; ++row) diagonal[row] = mass * body.mass[std::size_t(pattern.vertex[row])];
    body.elements->assemble(ctx.team, stiffness, diagonal, system.A.value.data());
    for (std::size_t row = 0; row < pattern.rows; ++row) {
        for (std::int32_t block = pattern.row_start[row]; block < pattern.row_start[row + 1]; ++block) {
            const auto column = std::size_t(pattern.column[std::size_t(block)]);
            if (held[row] == 0 && held[column] == 0) continue;
            Real* value = system.A.value.data() + std::size_t(block) * 12;
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

template <class Real>
HierarchyInputs<Real> hierarchy_inputs(StepContext& ctx, Body& body, System<Real>& system, const std::vector<Vec3>& x, const std::vector<std::uint8_t>& held_of_vertex) {
    HierarchyInputs<Real> in;
    in.held = solve::by_row(body.data().pattern, std::span(held_of_vertex));
    in.rotation = assemble_configuration(ctx, body, system, x, in.held);
    in.elements_near.assign(body.vertices(), {-1, -1, -1});
    for (std::size_t i = 0; i < in.elements_near.size(); ++i) {
        const fem::ElementMap& around = body.layout().around;
        const auto v = std::size_t(body.data().pattern.vertex[i]);
        const std::int64_t first = around.start[v], last = around.start[v + 1];
        for (std::int64_t k = 0; k < 3 && first + k < last; ++k) {
            // Spread over the elements around the vertex, not three neighbours of one another.
            in.elements_near[i][std::size_t(k)] = around.element[std::size_t(first + k * (last - first) / 3)];
        }
    }
    for (const double v : body.layout().volume) in.volume += v;
    return in;
}

template <class Real>
std::unique_ptr<solve::LatticeMultigrid<Real>> build_hierarchy(Team& team, const TemplateData& data, Isa isa, const HierarchyInputs<Real>& in, const solve::Bsr3<Real>& A) {
    const std::vector<Vec3> points = solve::by_row(data.pattern, std::span(data.mesh.vertices));
    solve::LatticeDef def;
    def.points = points;
    def.held = in.held;
    def.rotation_of_row = in.elements_near;
    def.volume = in.volume;
    auto multigrid = std::make_unique<solve::LatticeMultigrid<Real>>(data.pattern, isa);
    multigrid->build(team, def, A, [&](std::int32_t id, double* q) { std::copy_n(in.rotation.data() + 4 * std::size_t(id), 4, q); });
    return multigrid;
}

/// The hierarchy of state.hierarchy_x, at once.
template <class Real>
void build_now(StepContext& ctx, Body& body, System<Real>& system) {
    const HierarchyInputs<Real> in = hierarchy_inputs(ctx, body, system, body.state.hierarchy_x, body.state.hierarchy_held);
    system.multigrid = build_hierarchy(ctx.team, body.data(), ctx.world.isa, in, system.A);
    system.multigrid->hold(held_by_row(body));
}

/// Asks for a hierarchy of the body as it stands. The one at work goes on meanwhile.
void ask_for_next(Body& body) {
    std::vector<std::int32_t>& m = body.state.solver;
    if (m[kMemoryPending] > 0 && m[kMemoryPending] < kStepsToBuild) {  // it has begun
        m[kMemoryAgain] = 1;
        return;
    }
    body.state.next_x = body.state.x;
    body.state.next_held = held_bits(body);
    m[kMemoryPending] = kStepsToBuild;
    m[kMemoryAgain] = 0;
}

/// Brings the next hierarchy on its way, and puts it to work when its steps have passed: always after the same number, ready or not, so that a run is the same every time.
template <class Real>
void advance_next(StepContext& ctx, Body& body, System<Real>& system) {
    std::vector<std::int32_t>& m = body.state.solver;
    if (m[kMemoryPending] == 0) return;
    if (!system.next) {
        system.next = std::make_unique<HierarchyBuild<Real>>();
        HierarchyBuild<Real>& next = *system.next;
        next.inputs = hierarchy_inputs(ctx, body, system, body.state.next_x, body.state.next_held);
        next.inputs.A = system.A;
        next.thread = std::make_unique<Background>([&next, &data = body.data(), isa = ctx.world.isa] {
            Team alone;
            next.result = build_hierarchy(alone, data, isa, next.inputs, next.inputs.A);
        });
    }
    if (--m[kMemoryPending] > 0) return;
    if (ctx.world.def.solver.step_budget_us > 0 && !system.next->thread->done()) {
        ctx.report.flags |= StepFlag::late_preconditioner;
        m[kMemoryPending] = 1;
        return;
    }
    system.next->thread->wait();
    system.multigrid = std::move(system.next->result);
    system.next.reset();
    std::swap(body.state.hierarchy_x, body.state.next_x);
    std::swap(body.state.hierarchy_held, body.state.next_held);
    system.multigrid->hold(held_by_row(body));
    m[kMemoryBase] = m[kMemorySlow] = m[kMemoryFallback] = 0;
    if (m[kMemoryAgain] != 0) ask_for_next(body);
}

/// False if the matrix has no such factor.
template <class Real>
bool build_laplacian(StepContext& ctx, Body& body, System<Real>& system) {
    const std::vector<std::uint8_t> held = held_by_row(body);
    assemble_configuration(ctx, body, system, body.state.hierarchy_x, held);
    system.laplacian = std::make_unique<solve::ScalarLaplacian<Real>>(body.vertices());
    return system.laplacian->build(system.A, held);
}

/// The first choice of `auto`: by size.
PreconditionerKind first_choice(const Body& body, PreconditionerKind asked) {
    if (body.vertices() < kSmallestForLattice && (asked == PreconditionerKind::automatic || asked == PreconditionerKind::lattice_multigrid)) {
        return PreconditionerKind::block_jacobi;
    }
    if (asked != PreconditionerKind::automatic) return asked;
    if (body.elements->is_coupled()) return PreconditionerKind::block_jacobi;  // the matrix lacks the stiffest part of the operator
    return body.vertices() >= kMultigridRows ? PreconditionerKind::lattice_multigrid : PreconditionerKind::block_jacobi;
}

void set_kind(Body& body, PreconditionerKind kind) {
    with_system(body, [](auto& system) { system.next.reset(); });
    body.state.solver.assign(kMemoryCount, 0);
    body.state.solver[kMemoryKind] = std::int32_t(kind);
    body.state.solver[kMemoryTrial] = kTrialEvery;
}

/// Looks back on a solve of `auto` by block-Jacobi alone.
void note_jacobi(Body& body, int iterations) {
    if (iterations > kJacobiLimit && body.vertices() >= kSmallestForLattice && !body.elements->is_coupled()) set_kind(body, PreconditionerKind::lattice_multigrid);
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
    RowFields& rows = ctx.world.rows;

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
        solver.set_eliminated(ctx.world.eliminated);
        const std::span<const Vec3> guesses[2] = {rows.guess[0], rows.guess[1]};
        return solver.solve(ctx.team, parts, ctx.world.appended, rows.b, std::span(guesses, warm ? 2 : 0), def, [&](const Vec3*, Vec3*) { residual(); }, rows.x, rows.residual);
    }
};

/// The solves of one body alone.
template <class Real>
struct LoneSolve {
    Body& body;
    System<Real>& system;
    RowExchange& exchange;

    solve::LinearSolveResult run(solve::Preconditioner<Real>& preconditioner, bool warm, const solve::LinearSolveDef& def) const {
        preconditioner.update(exchange.ctx.team, system.A, exchange.ctx.world.appended);
        const solve::SystemPart<Real> part{&system.A, &preconditioner, system.coupling.get(), 0};
        return exchange.run<Real>(system.solver, {&part, 1}, warm, def);
    }

    /// Goes on from where `done` stopped.
    void go_on(solve::Preconditioner<Real>& preconditioner, const solve::LinearSolveDef& def, solve::LinearSolveResult& done) const {
        exchange.rows.b = exchange.rows.residual;
        solve::LinearSolveDef rest = def;
        rest.max_iterations = def.max_iterations - done.iterations;
        if (rest.max_iterations <= 0) return;
        const int before = done.iterations;
        done = run(preconditioner, false, rest);
        done.iterations += before;
    }
};

/// Nothing but block-Jacobi, or the factor, is at work, or can be.
bool works_without_build(const Body& body) { return needs_no_build(kind_at_work(body)) || !body.preconditioner_fits || body.state.solver[kMemoryBroken] > 0; }

template <class Real>
void turn_lattice(StepContext& ctx, const Body& body, System<Real>& system) {
    system.multigrid->turn(ctx.team, [&](std::int32_t id, double* q) { read_rotation(body, body.state.quaternion, id, q); });
}

template <class Real>
solve::LinearSolveResult solve_alone(RowExchange& exchange, Body& body, System<Real>& system, bool warm, const solve::LinearSolveDef& def, bool remember) {
    StepContext& ctx = exchange.ctx;
    const bool automatic = ctx.world.def.solver.preconditioner == PreconditionerKind::automatic;
    std::vector<std::int32_t>& memory = body.state.solver;
    const LoneSolve<Real> solve{body, system, exchange};
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
    } else if (remember && automatic && memory[kMemoryTrial] == 0) {
        solve::LinearSolveDef trial = def;
        trial.max_iterations = std::min(def.max_iterations, kJacobiLimit);
        result = solve.run(*system.preconditioner, warm, trial);
        memory[kMemoryTrial] = kTrialEvery;
        if (result.converged) {
            set_kind(body, PreconditionerKind::block_jacobi);
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
            const bool small = ctx.world.def.solver.preconditioner == PreconditionerKind::automatic && body.vertices() < kMultigridRows;
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
            joint.parts.push_back({&system.A, preconditioner, system.coupling.get(), body.work.first_row});
            joint.touching.push_back({&system.A, body.work.first_row, jacobi ? nullptr : preconditioner, preconditioner->coupling_diagonal, body.work.y, body.owner});
        }
        joint.preconditioner.update(ctx.team, joint.touching, ctx.world.appended, ctx.world.eliminated, island.same_matrices && !simple);
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
        const int before = result.iterations;
        result = exchange.run<Real>(joint.solver, joint.parts, false, rest);
        result.iterations += before;
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

void restart_preconditioner(Body& body, BodyState& state) {
    const bool built_alike = body.preconditioner_fits && state.hierarchy_x == body.state.hierarchy_x && state.hierarchy_held == body.state.hierarchy_held;
    if (!built_alike) return drop_preconditioner(body);
    with_system(body, [](auto& system) { system.next.reset(); });
}

void prepare_preconditioner(StepContext& ctx, Body& body) {
    const PreconditionerKind asked = ctx.world.def.solver.preconditioner;
    if (kind_at_work(body) == PreconditionerKind::automatic) set_kind(body, first_choice(body, asked));
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
                                              FunctionRef<void()> true_residual) {
    World::Impl& world = ctx.world;
    RowExchange exchange{ctx, island, true_residual};
    exchange.begin(warm);
    if (!island.alone()) {
        if (world.def.solver.precision == Precision::single) {
            if (!world.joint_single) world.joint_single = std::make_unique<JointSystem<float>>(world.isa);
            return solve_together(exchange, *world.joint_single, warm, def);
        }
        if (!world.joint_double) world.joint_double = std::make_unique<JointSystem<double>>(world.isa);
        return solve_together(exchange, *world.joint_double, warm, def);
    }
    Body& body = *island.members[0].body;
    solve::LinearSolveResult result;
    with_system(body, [&](auto& system) { result = solve_alone(exchange, body, system, warm, def, remember); });
    return result;
}

}  // namespace supple
