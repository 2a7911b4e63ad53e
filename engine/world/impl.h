#pragma once
#include "supple/base/disjoint_sets.h"
#include "supple/world/island.h"

namespace supple {

/// What the solve of an island writes on, apart from its bodies.
struct Scratch {
    std::vector<solve::AppendedRow> appended;
    std::vector<solve::EliminatedBody> eliminated;  ///< colliders that yield to the island
    RowFields rows;
    std::vector<std::int32_t> sweep;                ///< find_contacts(): members by the begin of their boxes
    std::vector<std::array<std::int32_t, 2>> near;  ///< members whose boxes meet
    std::unique_ptr<JointSystem<float>> joint_single;   ///< made with the first island of several members
    std::unique_ptr<JointSystem<double>> joint_double;

    /// A body may need its first solve, or a spring may leave its cap, in any step: not the moment to allocate.
    void make_room(const Island& island, std::size_t drags) {
        rows.resize(island.rows);
        appended.reserve(drags);
        sweep.reserve(island.members.size());
        near.reserve(island.members.size());
    }
    std::size_t contact_bytes() const {
        return eliminated.capacity() * sizeof(solve::EliminatedBody) + appended.capacity() * sizeof(solve::AppendedRow) +
               (joint_single ? joint_single->preconditioner.bytes() : 0) + (joint_double ? joint_double->preconditioner.bytes() : 0);
    }
};

struct World::Impl {
    WorldDef def;
    Isa isa = best_isa();
    int threads = 1;
    Team alone;                      ///< for bodies too small to share
    std::unique_ptr<Team> crew;      ///< `threads` strong; made when the bodies are large enough, one or all together

    struct Slot {
        std::uint32_t generation = 1;
        std::unique_ptr<Body> body;  ///< null: free
    };
    std::vector<Slot> slots;
    std::vector<std::uint32_t> order;  ///< slots of the living bodies as they were added
    std::vector<Drag> drags;
    std::uint32_t next_drag_generation = 1;

    std::vector<Collider> colliders;
    std::uint32_t next_collider_generation = 1;
    std::size_t living_colliders = 0;
    std::vector<ContactPoint> contact_report;
    std::vector<Attachment> attachments;
    std::uint32_t next_attachment_generation = 1;
    std::size_t living_attachments = 0;

    std::vector<std::unique_ptr<Body>> retired;  ///< bodies before an edit whose preconditioner is still being built on its thread

    std::uint64_t step = 0;
    double accumulator_s = 0;
    Scratch scratch;                           ///< of the island at work
    std::vector<std::unique_ptr<Scratch>> aside;  ///< of islands that are stepped side by side, one each
    std::vector<Member> active;                ///< scratch of a step: the bodies that take part in it
    std::vector<Island> islands;               ///< scratch of a step; more than are in use, so that their memory stays
    std::size_t living_islands = 0;
    std::vector<Island*> small;                ///< of them, those that are stepped side by side
    DisjointSets together;                     ///< scratch of form_islands(), as is
    std::vector<std::size_t> first_at_collider;
    Island lone;                               ///< a member of an island that came apart

    /// Contact of a pair of bodies (or of one with itself) that was switched by hand.
    struct ContactSwitch {
        BodyId a, b;
        bool on = false;
    };
    std::vector<ContactSwitch> contact_switches;

    Team& team_for(std::size_t elements) { return crew && elements >= kMinElementsForThreads ? *crew : alone; }
    Body& body(BodyId id) const;
    Drag& drag(DragId id);
    Collider& collider(ColliderId id);
    Attachment& attachment(AttachmentId id);
    double time_s() const { return double(step) * def.time_step_s; }
};

/// Elements of all bodies.
std::size_t element_count(const World::Impl& world);
/// Makes the crew, once the bodies are enough to share.
void need_crew(World::Impl& world);
/// Every body that may touch something knows its surface.
void give_contact_surfaces(World::Impl& world);
/// Fills world.islands from the contacts of world.active: bodies that touch one another, are tied together or touch the same collider that yields.
void form_islands(World::Impl& world);

/// What the stages of a step share.
struct StepContext {
    Team& team;
    World::Impl& world;
    Scratch& scratch;
    StepReport& report;
    double time_s;  ///< at the end of the step
    std::int64_t body_end_ns = 0;  ///< when the body at work must be done: its part of step_budget_us by elements; 0 = no budget
    std::int64_t deadline_ns = 0;  ///< for the solves of the body at work, on the clock of now_ns(); 0 = none
};

StepReport do_step(World::Impl& world) noexcept;

}  // namespace supple
