#include "supple/world/preconditioner_choice.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

constexpr int kCycleCost = 8;               // of a cycle, in iterations of block-Jacobi
constexpr std::int32_t kSlowSolves = 5;     // in a row, before the hierarchy is built anew
constexpr int kTellingIterations = 4;       // fewer say nothing about a hierarchy

}  // namespace

void read_rotation(const Body& body, const AlignedVector<double>& quaternion, std::int32_t element, double* wxyz) {
    const std::size_t slot = body.layout().slot[std::size_t(element)];
    const double* q = quaternion.data() + slot / fem::kBlock * 4 * fem::kBlock + slot % fem::kBlock;
    for (std::size_t k = 0; k < 4; ++k) wxyz[k] = q[k * fem::kBlock];
}

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

void note_jacobi(Body& body, int iterations) {
    if (iterations > kJacobiLimit && may_have_lattice(body)) set_kind(body, PreconditionerKind::lattice_multigrid);
}

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

void ask_for_next(Body& body, std::int32_t steps) {
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

}  // namespace supple
