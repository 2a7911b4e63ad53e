#pragma once
#include "supple/world/stages.h"

namespace supple {

/// Which preconditioner a body's solves use, and when its frozen parts are made anew. Decisions rest on sizes and iteration counts, never on
/// the clock, and their memory is part of the state (BodyState::solver): a run that is continued decides alike. (Only automatic_timed asks the clock: ChoiceTimer.)

/// Where BodyState::solver keeps what.
enum SolverMemory : std::size_t {
    kMemoryKind,        ///< PreconditionerKind at work; automatic: not chosen yet
    kMemoryBase,        ///< thousandths of an iteration per digit in the first solve with the current hierarchy, 0: none yet
    kMemorySlow,        ///< solves in a row that took half as many again
    kMemoryTrial,       ///< solves until block-Jacobi is tried again
    kMemoryBroken,      ///< solves that block-Jacobi stands in for a preconditioner that broke down
    kMemoryPending,     ///< steps until the hierarchy under way takes over, 0: none is
    kMemoryAsked,       ///< how many there were when it was asked for: fewer now, it has begun
    kMemoryAgain,       ///< 1: another one is wanted after it
    kMemoryFallback,    ///< 1: block-Jacobi until the hierarchy under way takes over: the mesh was edited, and there was none to take over
    kMemoryInherited,   ///< 1: the hierarchy at work is that of the mesh before an edit
    kMemoryCount
};

/// Makes what the body's next solves need: chooses the kind, builds frozen parts that are missing or out of date. Uses the elements and the matrix of
/// the body, so it comes before a step's evaluation. Allocates when it builds.
void prepare_preconditioner(StepContext& ctx, Body& body);

/// [vertex] bit c: coordinate c is held.
std::vector<std::uint8_t> held_bits(const Body& body);

/// What was built in `body` no longer fits its inputs: material, restored state.
void drop_preconditioner(Body& body);

/// Before an edit: builds what the body's next step would, so that the edit has it to hand on. Allocates.
void ready_for_edit(World::Impl& world, Body& body);
/// The body is that of an edit of one with the memory `before`: what was at work there is built beside the steps, and block-Jacobi stands in meanwhile.
void begin_after_edit(Body& body, const std::vector<std::int32_t>& before);
/// Then, where `from` has a hierarchy, it is that which stands in: its coarse levels go over. Nothing of it is left in `from`.
/// @param delta  of the edit; vertices and parts without parents are left to the smoother
void inherit_preconditioner(Body& from, Body& body, const TopologyDelta& delta, Isa isa);

/// A hierarchy that was taken over cannot be built again from the state: a snapshot holds it.
using Inherited = std::variant<std::monostate, std::unique_ptr<solve::LatticeMultigrid<float>>, std::unique_ptr<solve::LatticeMultigrid<double>>>;
void write_inherited(ByteWriter& out, const Body& body);
/// @error Error(corrupt_snapshot)
void read_inherited(ByteReader& in, const BodyState& state, const Body& body, Isa isa, Inherited& to);
void take_inherited(Body& body, Inherited inherited);

/// The body is about to take over a state of another time: keeps what was built if it was built from the same.
void restart_preconditioner(Body& body, BodyState& state);

/// Other coordinates are held than before. A hierarchy at work goes on without them while a new one is built beside the steps.
void supports_have_changed(Body& body);

/// Solves an island's system, work.free_rhs for work.dv, each body with its preconditioner, and goes on with block-Jacobi where one breaks down.
/// @param warm           starts from the best of zero and what the last steps suggest
/// @param remember       its iterations, for the choices above: of the first solve of a step, which are alike from step to step
/// @param again          goes on from an earlier solve of the same matrices: what touches has changed
/// @param true_residual  writes work.residual of all members for their work.dv
solve::LinearSolveResult solve_preconditioned(StepContext& ctx, Island& island, bool warm, const solve::LinearSolveDef& def, bool remember,
                                              bool again, FunctionRef<void()> true_residual);

}  // namespace supple
