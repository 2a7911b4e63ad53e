#include "supple/world/precondition.h"

#include <algorithm>
#include <utility>

#include "supple/world/preconditioner_choice.h"

namespace supple {

namespace {

constexpr std::int32_t kStepsAfterEdit = 6;    // as kStepsToBuild, where a hierarchy of before an edit stands in, which should not be for long
constexpr std::int32_t kStepsToWaitFor = 3;    // another edit waits for a hierarchy that is so near; one that is farther off is given up

std::vector<std::uint8_t> held_by_row(const Body& body) {
    const std::vector<std::uint8_t> held = held_bits(body);
    return solve::by_row(body.data().pattern, std::span(held));
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

}  // namespace supple
