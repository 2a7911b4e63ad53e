#pragma once
#include "supple/world/impl.h"

namespace supple {

// Contact inside a step. begin_colliders; find_contacts for all bodies where Newton begins; islands are made of what touches; for each: solves and
// check_contacts and model_contacts until the contacts agree with the solution; read_contacts; end_colliders.

/// Poses at the start of the step, where given motions lead, first guesses of the others.
void begin_colliders(StepContext& ctx);
/// New poses and velocities, forces on the colliders, the report of the step.
void end_colliders(StepContext& ctx);

/// The contacts of bodies around the velocity v0 + dv that their solve has reached, with colliders and with one another: what touches, what may touch, and the
/// model of each. Those that an earlier search of this step found keep what the step has made of them (`again`): their stiffness, and that they press;
/// others start from the last step.
void find_contacts(StepContext& ctx, std::span<Member> members, bool again);
/// Those of a body with another whose box its own box meets, or with itself, where both surfaces are fitted (ContactSurface::fit). Writes to the body's contacts alone.
void find_body_contacts(StepContext& ctx, Member& member, Member& other);
/// Those of its sharp edges with the other's, to ContactSet::edges of the body alone; once for two bodies, after what find_body_contacts() finds on both sides.
void find_edge_contacts(StepContext& ctx, Member& member, Member& other);
/// True if a body's contact with another body of this key (Contact::key) pressed in the last step.
bool pressed_before(const Body& body, std::int32_t other_slot, const std::array<std::int32_t, 3>& key);
/// Whether two bodies, or one with itself, are to touch where they meet.
bool may_touch(const World::Impl& world, const Member& a, const Member& b);
/// The attachments of a body, added to its contacts.
void find_attachments(StepContext& ctx, Member& member, std::span<Member> members);
/// What a vertex weighs against a force over one step: its inertia and its own elasticity [N/m].
double weight_against(const StepContext& ctx, const Body& body, std::int32_t vertex);
/// The stiffness of a contact is so many times what its vertices weigh against a force over one step.
inline constexpr double kContactStiffness = 20;
/// Parts of the edges around it that a contact may be deep.
inline constexpr double kAllowedDepth = 0.05;

/// s and models of contacts that were found at the solution at hand, which z_ref holds then.
void place_contacts(StepContext& ctx, Body& body);
/// The models at v0 itself, for a new v0 with the same contacts.
void move_contacts(StepContext& ctx, Island& island);
/// The whole solution is taken: v0 and the colliders' w have moved on by it, the forces stay those of the models.
void take_contacts(StepContext& ctx, Island& island);
/// Adds the rows of the contacts that push to ctx.scratch.appended, and the equations of the colliders that yield to ctx.scratch.eliminated.
void append_contacts(StepContext& ctx, Island& island);
/// A dw = b of a yielding collider without contacts: inertia, gravity, its coupling, and what the bodies before this one did.
void collider_equation(const StepContext& ctx, const Collider& collider, Mat66& A, Vec6& b);
/// A tool whose coupling would pull harder than it may at w + dw pulls as hard as it may from now on. True if one did.
bool cap_colliders(StepContext& ctx);
/// The end poses where w + dw leads: contacts are looked for there.
void refer_colliders(StepContext& ctx);
/// dw of the yielding colliders that goes with the island's dv.
void solve_colliders(StepContext& ctx);
/// field += h' times the contact forces that the models give at the solution, or at v0.
void add_contact_forces(StepContext& ctx, Island& island, bool at_solution, std::vector<Vec3> Workspace::* field);

struct ContactCheck {
    bool agrees = true;   ///< the models' forces are those of the contacts where the solution has led
    bool nearly = true;   ///< it is worth looking for other contacts
    bool raised = false;  ///< contacts were too deep and are stiffer now
    double error = 0;     ///< sum of the differences, as part of the sum of forces
};
/// What a solve may leave: |r|, and sqrt(r.A^-1 r); 0: nothing is known of that, and nothing may be left.
struct Unsolved {
    double residual = 0, energy = 0;
};
/// Whether the models say what the contacts do at the solution dv: to half a percent, or to what the solve itself may leave. Where they nearly do and `raise`, contacts
/// that are too deep become stiffer.
ContactCheck check_contacts(StepContext& ctx, Island& island, const Unsolved& may_leave, bool raise);
/// The solution at hand is where the next solve begins: contacts remember z, bodies dv and `bare`.
void begin_way(StepContext& ctx, Island& island);
/// How far the solution may go from there: to where the contacts' true forces no longer do work along the way. A piece of (0, 1].
double part_of_way(StepContext& ctx, Island& island);
/// Goes back to this part of the way (begin_way()).
void go_back(Island& island, double part);
/// The models of the contacts at this part of the way; what is open there, but would shut farther along it, presses from where it touches, if another solve (`again`) may find it
/// pulling.
void model_contacts(StepContext& ctx, Island& island, double part, bool again);
/// True if the solution has led so far from where the contacts were looked for that there may be others.
bool contacts_are_stale(StepContext& ctx, const Island& island);

/// No solution yet: dw is zero, and w where the next one starts from.
void rest_colliders(StepContext& ctx);
/// The colliders' velocities when `part` of the solution is taken.
void advance_colliders(StepContext& ctx, double part);

/// Memory and report of the contacts at the end of a step.
void read_contacts(StepContext& ctx, BodyId id, Body& body);
/// Of a body that is frozen.
void drop_contacts(Body& body);
/// Of one that is contained: what its solve made of the colliders is void.
void undo_contacts(StepContext& ctx, Body& body);

/// Unit quaternion of a rotation (math/polar.h has the way back), and rotation vectors.
std::array<double, 4> rotation_wxyz(const Mat3& R);
Mat3 rotation_of(const Vec3& vector);
Vec3 rotation_vector(const Mat3& R);

}  // namespace supple
