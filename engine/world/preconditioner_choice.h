#pragma once
#include "supple/world/precondition.h"

namespace supple {

/// What BodyState::solver remembers of the choice of a body's preconditioner, and what is made of it: decisions alone, nothing is built here.

inline constexpr int kJacobiLimit = 32;               ///< iterations: what block-Jacobi does in so many is best left to it. A cycle costs about as much as eight (measured on bars and the bunny)
inline constexpr std::size_t kMultigridRows = 1500;   ///< auto: bodies of so many vertices begin with the multigrid
inline constexpr std::size_t kSmallestForLattice = 100;  ///< below, no lattice is coarser than the mesh
inline constexpr std::int32_t kTrialEvery = 50;       ///< solves between two trials of block-Jacobi
inline constexpr std::int32_t kStepsToBuild = 16;     ///< a hierarchy takes about five steps' time on a thread of its own, more where the cores are busy
inline constexpr std::int32_t kBrokenSolves = 100;    ///< before a preconditioner that broke down gets another chance

inline PreconditionerKind kind_at_work(const Body& body) { return PreconditionerKind(body.state.solver[kMemoryKind]); }
/// System::preconditioner itself: block-Jacobi, or the factor.
inline bool needs_no_build(PreconditionerKind kind) { return kind == PreconditionerKind::block_jacobi || kind == PreconditionerKind::direct; }
/// Nothing but block-Jacobi, or the factor, is at work, or can be.
inline bool works_without_build(const Body& body) { return needs_no_build(kind_at_work(body)) || !body.preconditioner_fits || body.state.solver[kMemoryBroken] > 0; }
inline bool chooses(PreconditionerKind asked) { return asked == PreconditionerKind::automatic || asked == PreconditionerKind::automatic_timed; }
/// Whether the multigrid is of use to a body at all.
inline bool may_have_lattice(const Body& body) { return body.vertices() >= kSmallestForLattice && !body.elements->is_coupled(); }

/// The first choice of `auto`: by size.
PreconditionerKind first_choice(const Body& body, PreconditionerKind asked);
void set_kind(Body& body, PreconditionerKind kind);
/// Asks for a hierarchy of the body as it stands. The one at work goes on meanwhile.
void ask_for_next(Body& body, std::int32_t steps = kStepsToBuild);
/// Looks back on a solve of `auto` by block-Jacobi alone.
void note_jacobi(Body& body, int iterations);
/// Looks back on a solve by the multigrid. What a hierarchy is worth shows in iterations per digit: their number alone changes with the start.
void note_multigrid(Body& body, const solve::LinearSolveResult& result, bool automatic);
/// Unit quaternion of an element's frame, out of [block][w x y z][lane].
void read_rotation(const Body& body, const AlignedVector<double>& quaternion, std::int32_t element, double* wxyz);

}  // namespace supple
