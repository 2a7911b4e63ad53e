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
constexpr std::int32_t kBrokenSolves = 100;    // before a preconditioner that broke down gets another chance

PreconditionerKind kind_at_work(const Body& body) { return PreconditionerKind(body.state.solver[kMemoryKind]); }

/// System::preconditioner itself: block-Jacobi, or the factor.
bool needs_no_build(PreconditionerKind kind) { return kind == PreconditionerKind::block_jacobi || kind == PreconditionerKind::direct; }

void read_rotation(const Body& body, const AlignedVector<double>& quaternion, std::int32_t element, double* wxyz) {
    const std::size_t slot = body.layout().slot[std::size_t(element)];
    const double* q = quaternion.data() + slot / fem::kBlock * 4 * fem::kBlock + slot % fem::kBlock;
    for (std::size_t k = 0; k < 4; ++k) wxyz[k] = q[k * fem::kBlock];
}

std::vector<std::uint8_t> held_bits(const Body& body) {
    std::vector<std::uint8_t> held(body.vertices());
    for (std::size_t i = 0; i < held.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) held[i] = std::uint8_t(held[i] | (body.is_held(i, c) ? 1u << c : 0u));
    }
    return held;
}

/// Matrix of the configuration that frozen parts are built from, in system.A.
void assemble_build_configuration(StepContext& ctx, Body& body, AlignedVector<double>& quaternion) {
    fem::ElementOutputs outputs;
    outputs.tangent = true;
    quaternion = body.state.hierarchy_quaternion;
    body.elements->evaluate(ctx.team, body.state.hierarchy_x.data()->data(), quaternion.data(), outputs);
    const double h = body.work.h;
    body.work.h = scheme_step(ctx.world.def);  // the same whenever it is built
    assemble(ctx, body);
    body.work.h = h;
}

template <class Real>
void build_lattice(StepContext& ctx, Body& body, System<Real>& system) {
    AlignedVector<double> quaternion;
    assemble_build_configuration(ctx, body, quaternion);
    const TemplateData& data = body.data();
    const std::vector<std::uint8_t> held = held_bits(body);
    std::vector<std::array<std::int32_t, 3>> near(body.vertices(), {-1, -1, -1});
    for (std::size_t i = 0; i < near.size(); ++i) {
        const fem::ElementMap& around = body.layout().around;
        const std::int64_t first = around.start[i], last = around.start[i + 1];
        for (std::int64_t k = 0; k < 3 && first + k < last; ++k) {
            // Spread over the elements around the vertex, not three neighbours of one another.
            near[i][std::size_t(k)] = around.element[std::size_t(first + k * (last - first) / 3)];
        }
    }
    solve::LatticeDef def;
    def.points = data.mesh.vertices;
    def.held = held;
    def.rotation_of_row = near;
    for (const double v : body.layout().volume) def.volume += v;
    if (!system.multigrid) system.multigrid = std::make_unique<solve::LatticeMultigrid<Real>>(data.pattern, ctx.world.isa);
    system.multigrid->build(ctx.team, def, system.A, [&](std::int32_t id, double* q) { read_rotation(body, quaternion, id, q); });
}

/// False if the matrix has no such factor.
template <class Real>
bool build_laplacian(StepContext& ctx, Body& body, System<Real>& system) {
    AlignedVector<double> quaternion;
    assemble_build_configuration(ctx, body, quaternion);
    system.laplacian = std::make_unique<solve::ScalarLaplacian<Real>>(body.vertices());
    return system.laplacian->build(system.A, held_bits(body));
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
    body.state.hierarchy_x = body.state.x;
    body.state.hierarchy_quaternion = body.state.quaternion;
    m[kMemoryBase] = m[kMemorySlow] = 0;
    drop_preconditioner(body);
}

template <class Real>
solve::LinearSolveResult run(StepContext& ctx, Body& body, System<Real>& system, solve::Preconditioner<Real>& preconditioner, std::span<const Vec3> b,
                             std::span<const std::span<const Vec3>> guesses, const solve::LinearSolveDef& def,
                             FunctionRef<void(const Vec3*, Vec3*)> true_residual) {
    preconditioner.update(ctx.team, system.A, ctx.world.appended);
    return system.solver.solve(ctx.team, system.A, ctx.world.appended, preconditioner, b, guesses, def, true_residual, body.work.dv, body.work.residual);
}

/// Goes on from where `done` stopped.
template <class Real>
void go_on(StepContext& ctx, Body& body, System<Real>& system, solve::Preconditioner<Real>& preconditioner, const solve::LinearSolveDef& def,
           FunctionRef<void(const Vec3*, Vec3*)> true_residual, solve::LinearSolveResult& done) {
    body.work.free_rhs = body.work.residual;
    solve::LinearSolveDef rest = def;
    rest.max_iterations = def.max_iterations - done.iterations;
    if (rest.max_iterations <= 0) return;
    const solve::LinearSolveResult before = done;
    done = run(ctx, body, system, preconditioner, body.work.free_rhs, {}, rest, true_residual);
    done.iterations += before.iterations;
    done.bytes += before.bytes;
}

}  // namespace

void drop_preconditioner(Body& body) { body.preconditioner_fits = false; }

void prepare_preconditioner(StepContext& ctx, Body& body) {
    const PreconditionerKind asked = ctx.world.def.solver.preconditioner;
    if (kind_at_work(body) == PreconditionerKind::automatic) set_kind(body, first_choice(body, asked));
    if (body.preconditioner_fits || needs_no_build(kind_at_work(body))) return;
    bool good = true;
    with_system(body, [&](auto& system) {
        if (kind_at_work(body) == PreconditionerKind::scalar_laplacian) {
            good = build_laplacian(ctx, body, system);
        } else {
            build_lattice(ctx, body, system);
        }
    });
    if (!good) {
        ctx.report.flags |= StepFlag::preconditioner;
        set_kind(body, PreconditionerKind::block_jacobi);
    }
    body.preconditioner_fits = good;
}

solve::LinearSolveResult solve_preconditioned(StepContext& ctx, Body& body, std::span<const std::span<const Vec3>> guesses,
                                              const solve::LinearSolveDef& def, bool remember, FunctionRef<void(const Vec3*, Vec3*)> true_residual) {
    const bool automatic = ctx.world.def.solver.preconditioner == PreconditionerKind::automatic;
    std::vector<std::int32_t>& memory = body.state.solver;
    solve::LinearSolveResult result;
    with_system(body, [&](auto& system) {
        const auto rotation = [&](std::int32_t id, double* q) { read_rotation(body, body.state.quaternion, id, q); };
        std::span<const Vec3> b = body.work.free_rhs;
        if (needs_no_build(kind_at_work(body)) || !body.preconditioner_fits || memory[kMemoryBroken] > 0) {
            result = run(ctx, body, system, *system.preconditioner, b, guesses, def, true_residual);
            if (memory[kMemoryBroken] > 0) {
                --memory[kMemoryBroken];
            } else if (remember && automatic && kind_at_work(body) == PreconditionerKind::block_jacobi) {
                note_jacobi(body, result.iterations);
            }
            return;
        }
        const bool lattice = kind_at_work(body) == PreconditionerKind::lattice_multigrid;
        if (lattice) system.multigrid->turn(ctx.team, rotation);
        if (!lattice) {
            result = run(ctx, body, system, *system.laplacian, b, guesses, def, true_residual);
        } else if (remember && automatic && memory[kMemoryTrial] == 0) {
            solve::LinearSolveDef trial = def;
            trial.max_iterations = std::min(def.max_iterations, kJacobiLimit);
            result = run(ctx, body, system, *system.preconditioner, b, guesses, trial, true_residual);
            memory[kMemoryTrial] = kTrialEvery;
            if (result.converged) return set_kind(body, PreconditionerKind::block_jacobi);
            if (result.iterations < trial.max_iterations || result.out_of_time) return;
            go_on(ctx, body, system, *system.multigrid, def, true_residual, result);
        } else {
            result = run(ctx, body, system, *system.multigrid, b, guesses, def, true_residual);
            if (!result.breakdown && remember) note_multigrid(body, result, automatic);
        }
        if (result.breakdown) {
            ctx.report.flags |= StepFlag::preconditioner;
            memory[kMemoryBroken] = kBrokenSolves;
            go_on(ctx, body, system, *system.preconditioner, def, true_residual, result);
        }
    });
    return result;
}

}  // namespace supple
