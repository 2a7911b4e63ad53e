// The forces of contacts and their place in the system of a step.
//
// A body's unknown is dv, a yielding collider's dw (velocity of its centre, spin). A contact's s moves by z = h' J_s dv - h J_c dw, J_s the weights of its
// vertices (those of another body's negative), J_c w = v + omega x lever. With the model f = f_ref - K (z - z_ref) on the body and its opposite on the collider, the step reads
//     [ A_s + h'^2 J_s^T K J_s     -h h' J_s^T K J_c  ] [dv]   [ b_s + h' J_s^T f(0) ]
//     [ -h h' J_c^T K J_s       A_c + h^2 J_c^T K J_c ] [dw] = [ b_c - h  J_c^T f(0) ].
// dw is eliminated: six unknowns a collider, a matrix of its own. Conjugate gradients see  A_s + h'^2 J_s^T K J_s - B A^-1 B^T  with B = h h' J_s^T K J_c and A the
// lower right block. It is symmetric and positive, and the collider feels the body as exactly as the body the collider.
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "supple/world/contact_stages.h"
#include "supple/world/stages.h"

namespace supple {

namespace {

constexpr double kAgree = 5e-3;      // of the sum of forces
constexpr double kNearly = 0.3;      // of the sum of forces: among several bodies, models that are so near show which contacts are too deep, and whether others may have come
constexpr double kOvershoot = 0.1;   // of the work that a way begins with: so much against it at its end, and the way is too long
constexpr double kWorkLeft = 0.02;   // of it, where the way ends instead
constexpr int kMostTrials = 30;
constexpr double kSteady = 0.9;      // cosine between two directions of slip that agree, and how much of Newton's step is taken then
constexpr double kRaise = 8;         // factor of the stiffness of a contact that is too deep
constexpr double kMostBoost = 4096;
constexpr double kEasy = 0.125;      // of the allowed depth: below, a raised stiffness sinks back
constexpr double kStale = 0.5;       // of the watched gaps

Mat3 cross_matrix(const Vec3& v) {
    Mat3 C;
    C << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return C;
}

/// J_c: velocity of the point at `lever` from velocity and spin of the centre.
solve::Mat36 point_velocity(const Vec3& lever) {
    solve::Mat36 J;
    J << Mat3::Identity(), -cross_matrix(lever);
    return J;
}

/// Sum of a contact's weights times field(body, vertex).
template <class Field>
Vec3 weighted(const Body& body, const Contact& c, Field&& field) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < c.vertices(); ++k) sum += c.weight[k] * field(k < c.corners ? body : *c.other, std::size_t(c.vertex[k]));
    return sum;
}

/// z of a contact for the solution dv, dw that is at hand.
Vec3 shift(const StepContext& ctx, const Body& body, const Contact& c) {
    Vec3 z = weighted(body, c, [](const Body& of, std::size_t v) -> Vec3 { return of.work.h * of.work.dv[v]; });
    if (c.collider == kNoCollider) return z;
    const Collider& collider = ctx.world.colliders[c.collider];
    if (collider.unknown()) z -= ctx.world.def.time_step_s * (collider.dw.head<3>() + collider.dw.tail<3>().cross(c.lever));
    return z;
}

template <class Visit>
void for_contacts(Island& island, Visit&& visit) {
    for (Member& member : island.members) {
        for (Contact& c : member.body->contacts.list) visit(*member.body, c);
    }
}

struct Push {
    Vec3 force = Vec3::Zero();
    Mat3 K = Mat3::Zero();
    double depth = 0;
    Vec3 slip = Vec3::Zero();  ///< direction of the friction where it slips
};

/// Force of a contact whose s is known, and K: its derivative for normal force and stick. Where it slips, the secant limit/|trial| k: a quadratic above the
/// friction's potential that touches it, so that each solve lowers the true one (from any start: Newton's own matrix cycles); and once two solves in a row
/// slip alike, nearly Newton's, which has nothing along the slip.
Push push(const Contact& c, const Vec3& s) {
    Push p;
    if (c.attachment >= 0) {
        p.force = -c.stiffness * s;
        p.K = c.stiffness * Mat3::Identity();
        return p;
    }
    p.depth = -c.normal.dot(s);
    if (!(p.depth > 0)) return p;
    const double k = c.stiffness * c.boost, normal_force = k * p.depth;
    const Mat3 across = Mat3::Identity() - c.normal * c.normal.transpose();
    const Vec3 trial = c.memory_n - k * (across * (s - c.s_touch));
    const double limit = c.friction * normal_force, length = trial.norm();
    p.force = normal_force * c.normal;
    p.K = k * c.normal * c.normal.transpose();
    if (length <= limit) {
        p.force += trial;
        p.K += k * across;
    } else if (limit > 0) {
        const Vec3 t = trial / length;
        p.force += limit * t;
        p.slip = t;
        const double newton = c.slip.dot(t) > kSteady ? kSteady : 0;
        p.K += limit / length * k * (across - newton * t * t.transpose());
    }
    return p;
}

void set_model(Contact& c, const Vec3& z) {
    const Push p = push(c, c.s_zero + z);
    c.z_ref = z;
    c.f_ref = p.force;
    c.K = p.K;
    c.closed = p.depth > 0 || c.attachment >= 0;
    c.slip = p.slip;
}

/// A contact that is open, but shall press: it does from where it touches, and pulls here. Left open it would hold nothing in the next solve, whose full step would go far through it.
void expect(Contact& c, const Vec3& z) {
    c.z_ref = z - c.normal.dot(c.s_zero + z) * c.normal;
    c.f_ref = Vec3::Zero();
    c.K = c.stiffness * c.boost * c.normal * c.normal.transpose();
    c.closed = true;
}

}  // namespace

void move_contacts(StepContext& ctx, Island& island) {
    for (Member& member : island.members) {
        const Body& body = *member.body;
        for (Contact& c : member.body->contacts.list) {
            c.s_zero = weighted(body, c, [](const Body& of, std::size_t v) -> Vec3 { return of.work.base_x[v] + of.work.h * of.work.v0[v]; }) - c.lever;
            if (c.collider != kNoCollider) {
                const Collider& collider = ctx.world.colliders[c.collider];
                const Vec6 since = collider.w - collider.reference;
                c.s_zero -= collider.c1 + ctx.world.def.time_step_s * (since.head<3>() + since.tail<3>().cross(c.lever));
            }
            set_model(c, Vec3::Zero());
        }
    }
}

void place_contacts(StepContext& ctx, Body& body) {
    for (Contact& c : body.contacts.list) {
        const Vec3 z = shift(ctx, body, c);
        c.s_zero = c.z_ref - z;
        set_model(c, z);
        if (!c.closed && c.expected) expect(c, z);
    }
}

void take_contacts(StepContext& ctx, Island& island) {
    for (Member& member : island.members) {
        for (Contact& c : member.body->contacts.list) {
            const Vec3 z = shift(ctx, *member.body, c);
            c.s_zero += z;
            c.z_ref -= z;
        }
    }
    advance_colliders(ctx, 1);
}

namespace {

/// The row of a contact in the island's system, and its parts in those of the members.
void append_row(StepContext& ctx, const Island& island, Body& body, Contact& c) {
    const Mat3 K = body.work.h * body.work.h * c.K;
    const std::span<const Vec3> weight(c.masked.data(), c.vertices());
    Body& other = c.other != nullptr ? *c.other : body;
    for (std::size_t k = 0; k < c.vertices(); ++k) {
        const Body& owner = k < c.corners ? body : other;
        c.own_row[k] = owner.row_of(c.vertex[k]);
        c.row[k] = c.own_row[k] + std::int32_t(owner.work.first_row);
    }
    const std::span<const std::int32_t> row(c.own_row.data(), c.vertices());
    ctx.scratch.appended.push_back({{c.row.data(), c.vertices()}, weight, K});
    if (island.alone()) return;
    if (&other == &body) {
        body.work.own_rows.push_back({row, weight, K});
        return;
    }
    body.work.own_rows.push_back({row.first(c.corners), weight.first(c.corners), K});
    other.work.own_rows.push_back({row.subspan(c.corners), weight.subspan(c.corners), K});
}

}  // namespace

void append_contacts(StepContext& ctx, Island& island) {
    World::Impl& world = ctx.world;
    const double hc = world.def.time_step_s;
    ctx.scratch.eliminated.clear();
    for (Collider& collider : world.colliders) {
        if (collider.generation == 0 || !collider.unknown()) continue;
        collider.row.clear();
        collider.dv.clear();
        collider.block.clear();
        collider_equation(ctx, collider, collider.A, collider.b);
    }
    for (Member& member : island.members) {
        const double hs = member.body->work.h;
        for (Contact& c : member.body->contacts.list) {
            if (!c.closed) continue;
            append_row(ctx, island, *member.body, c);
            if (c.collider == kNoCollider || !world.colliders[c.collider].unknown()) continue;
            Collider& collider = world.colliders[c.collider];
            const solve::Mat36 J = point_velocity(c.lever), KJ = c.K * J;
            collider.A += hc * hc * J.transpose() * KJ;
            collider.b -= hc * J.transpose() * c.force(Vec3::Zero());
            for (std::size_t k = 0; k < c.corners; ++k) {
                collider.row.push_back(c.row[k]);
                collider.dv.push_back(&member.body->work.dv[std::size_t(c.vertex[k])]);
                collider.block.push_back(hs * hc * c.masked[k].asDiagonal() * KJ);
            }
        }
    }
    for (Collider& collider : world.colliders) {
        if (collider.generation == 0 || !collider.unknown()) continue;
        collider.inverse = collider.A.llt().solve(Mat66::Identity());
        if (!collider.row.empty()) ctx.scratch.eliminated.push_back({collider.row, collider.block, collider.inverse});
    }
}

void solve_colliders(StepContext& ctx) {
    for (Collider& collider : ctx.world.colliders) {
        if (collider.generation == 0 || !collider.unknown()) continue;
        Vec6 sum = collider.b;
        for (std::size_t i = 0; i < collider.dv.size(); ++i) sum += collider.block[i].transpose() * *collider.dv[i];
        collider.dw = collider.inverse * sum;
    }
}

void add_contact_forces(StepContext& ctx, Island& island, bool at_solution, std::vector<Vec3> Workspace::* field) {
    for (Member& member : island.members) {
        Workspace& w = member.body->work;
        for (const Contact& c : member.body->contacts.list) {
            if (!c.closed) continue;
            const Vec3 force = c.force(at_solution ? shift(ctx, *member.body, c) : Vec3(Vec3::Zero())), impulse = w.h * force;
            std::size_t k = 0;
            for (; k < c.corners; ++k) (w.*field)[std::size_t(c.vertex[k])] += c.weight[k] * impulse;
            for (; k < c.vertices(); ++k) (c.other->work.*field)[std::size_t(c.vertex[k])] += c.weight[k] * c.other->work.h * force;
        }
    }
}

ContactCheck check_contacts(StepContext& ctx, Island& island, const Unsolved& may_leave, bool raise) {
    // What a difference of forces is as a residual; as an energy it is at most that of the contact's own spring, for the system is at least as stiff as it.
    double difference = 0, sum = 0, residual = 0, energy = 0;
    for_contacts(island, [&](const Body& body, const Contact& c) {
        const Vec3 z = shift(ctx, body, c);
        const Vec3 force = push(c, c.s_zero + z).force;
        const double off = (c.closed ? Vec3(force - c.force(z)) : force).norm();
        difference += off;
        sum += force.norm();
        for (std::size_t k = 0; k < c.vertices(); ++k) residual += c.weight[k] * c.weight[k] * off * off;
        energy += off * off / (c.stiffness * c.boost);
    });
    const double h = island.members[0].body->work.h;
    const bool within = h * std::sqrt(residual) <= may_leave.residual && std::sqrt(energy) <= may_leave.energy;
    ContactCheck check;
    check.error = sum > 0 ? difference / sum : difference > 0 ? 1 : 0;
    check.agrees = check.error <= kAgree || within;
    check.nearly = check.agrees || (!island.alone() && check.error <= kNearly);
    if (check.nearly && raise) {
        for_contacts(island, [&](const Body& body, Contact& c) {
            if (c.attachment >= 0 || c.boost >= kMostBoost || -c.normal.dot(c.s_zero + shift(ctx, body, c)) <= c.allowed_depth) return;
            c.boost *= kRaise;
            check.raised = true;
        });
    }
    return check;
}

void begin_way(StepContext& ctx, Island& island) {
    for_contacts(island, [&](const Body& body, Contact& c) { c.z_from = shift(ctx, body, c); });
    for (Member& member : island.members) {
        Workspace& w = member.body->work;
        std::copy(w.dv.begin(), w.dv.end(), w.dv_from.begin());
        std::copy(w.bare.begin(), w.bare.end(), w.bare_from.begin());
    }
}

double part_of_way(StepContext& ctx, Island& island) {
    // All but the contacts is linear: its work along the way is that of the residuals with the models, without the models' own. What yields is in balance with the models at both ends.
    double from = 0, to = 0;
    for (const Member& member : island.members) {
        const Workspace& w = member.body->work;
        for (std::size_t i = 0; i < w.dv.size(); ++i) {
            const Vec3 way = w.dv[i] - w.dv_from[i];
            from += way.dot(w.free_rhs[i]);
            to += way.dot(w.residual[i]);
        }
    }
    for_contacts(island, [&](const Body& body, Contact& c) {
        c.way = shift(ctx, body, c) - c.z_from;
        if (!c.closed) return;
        from -= c.force(c.z_from).dot(c.way);
        to -= c.force(c.z_from + c.way).dot(c.way);
    });
    const auto work = [&](double part) {
        double sum = (1 - part) * from + part * to;
        for_contacts(island, [&](const Body&, const Contact& c) { sum += push(c, c.s_zero + c.z_from + part * c.way).force.dot(c.way); });
        return sum;
    };
    const double start = work(0);
    double low = 0, high = 1, at_low = start, at_high = work(1), part = 1;
    if (!(start > 0) || !(at_high < -kOvershoot * start)) return 1;
    for (int trial = 0; trial < kMostTrials; ++trial) {
        part = trial % 3 == 2 ? 0.5 * (low + high) : low + (high - low) * at_low / (at_low - at_high);
        const double here = work(part);
        if (std::abs(here) <= kWorkLeft * start) break;
        (here > 0 ? low : high) = part;
        (here > 0 ? at_low : at_high) = here;
    }
    return part;
}

void go_back(Island& island, double part) {
    for (Member& member : island.members) {
        Workspace& w = member.body->work;
        for (std::size_t i = 0; i < w.dv.size(); ++i) {
            w.dv[i] = w.dv_from[i] + part * (w.dv[i] - w.dv_from[i]);
            w.bare[i] = w.bare_from[i] + part * (w.bare[i] - w.bare_from[i]);
        }
    }
}

void model_contacts(StepContext& ctx, Island& island, double part, bool again) {
    for_contacts(island, [&](const Body& body, Contact& c) {
        const Vec3 z = shift(ctx, body, c);
        if (part == 1) return set_model(c, z);
        const bool shuts = c.normal.dot(c.s_zero + z) < 0;
        const Vec3 there = c.z_from + part * (z - c.z_from);
        set_model(c, there);
        if (again && !c.closed && shuts) expect(c, there);  // farther along the way it would
    });
}

bool contacts_are_stale(StepContext& ctx, const Island& island) {
    for (const Member& member : island.members) {
        const Body& body = *member.body;
        const bool looked = ctx.world.living_colliders > 0 || !island.alone() || may_touch(ctx.world, member, member);
        if (!looked || !body.contacts.surface) continue;  // attachments are everywhere the same
        const ContactSurface& surface = *body.contacts.surface;
        const Workspace& w = body.work;
        const double limit = kStale * surface.margin_m;
        for (const std::int32_t v : body.data().boundary_vertices) {
            const auto i = std::size_t(v);
            if (!((w.base_x[i] + w.h * (w.v0[i] + w.dv[i]) - surface.end[i]).squaredNorm() <= limit * limit)) return true;
        }
        for (const Collider& collider : ctx.world.colliders) {
            if (collider.generation == 0 || !collider.unknown()) continue;
            const Vec6 moved = ctx.world.def.time_step_s * (collider.w + collider.dw - collider.reference);
            if (moved.head<3>().norm() + moved.tail<3>().norm() * collider.reach_m > limit) return true;
        }
    }
    return false;
}

void rest_colliders(StepContext& ctx) {
    for (Collider& collider : ctx.world.colliders) {
        if (collider.generation == 0 || !collider.unknown()) continue;
        collider.from = collider.w;
        collider.dw = Vec6::Zero();
    }
}

void advance_colliders(StepContext& ctx, double part) {
    for (Collider& collider : ctx.world.colliders) {
        if (collider.generation != 0 && collider.unknown()) collider.w = collider.from + part * collider.dw;
    }
}

namespace {

/// The opposite of a force on a body, on the collider.
void push_back_on(StepContext& ctx, Collider& collider, const Vec3& force, const Vec3& lever) {
    const Vec3 torque = lever.cross(force);
    collider.force -= force;
    collider.torque -= torque;
    collider.impulse.head<3>() -= ctx.world.def.time_step_s * force;
    collider.impulse.tail<3>() -= ctx.world.def.time_step_s * torque;
}

}  // namespace

void read_contacts(StepContext& ctx, BodyId id, Body& body) {
    ContactSet& set = body.contacts;
    set.report.clear();
    body.state.contacts.clear();
    for (const Contact& c : set.list) {
        if (!c.closed) continue;
        const Vec3 force = c.force(Vec3::Zero());
        if (c.collider != kNoCollider) push_back_on(ctx, ctx.world.colliders[c.collider], force, c.lever);
        if (c.attachment >= 0) {
            Attachment& attachment = ctx.world.attachments[std::size_t(c.attachment)];
            attachment.force = force;
            attachment.broken = attachment.def.max_force_n > 0 && force.norm() > attachment.def.max_force_n;
            continue;
        }
        ContactPoint point;
        point.body = id;
        std::uint32_t generation;
        if (c.other != nullptr) {
            generation = ctx.world.slots[std::size_t(c.other_slot)].generation;
            point.other = {std::uint32_t(c.other_slot), generation};
            point.other_triangle = c.other_triangle;
            const Triangle& corner = c.other->data().boundary.triangles[std::size_t(c.other_triangle)];
            for (std::size_t k = c.corners; k < c.vertices(); ++k) {
                for (std::size_t j = 0; j < 3; ++j) {
                    if (corner[j] == c.vertex[k]) point.other_barycentric[j] = -c.weight[k];
                }
            }
        } else {
            generation = ctx.world.colliders[c.collider].generation;
            point.collider = {c.collider, generation};
        }
        point.triangle = c.triangle;
        const Triangle& corner = body.data().boundary.triangles[std::size_t(c.triangle)];
        for (std::size_t k = 0; k < c.corners; ++k) {
            point.position_m += c.weight[k] * (body.work.base_x[std::size_t(c.vertex[k])] + body.work.h * (body.work.v0[std::size_t(c.vertex[k])]));
            for (std::size_t j = 0; j < 3; ++j) {
                if (corner[j] == c.vertex[k]) point.barycentric[j] = c.weight[k];
            }
        }
        point.normal = c.normal;
        point.depth_m = -c.normal.dot(c.s_zero);
        point.normal_force_n = c.normal.dot(force);
        point.friction_force_n = force - point.normal_force_n * c.normal;
        set.report.push_back(point);

        ContactMemory memory;
        memory.collider = c.collider;
        memory.generation = generation;
        memory.other = c.other_slot;
        memory.vertex = c.key();
        for (std::size_t k = 0; k < std::min<std::size_t>(c.corners, 3); ++k) memory.weight[k] = c.weight[k];
        memory.friction_n = {point.friction_force_n[0], point.friction_force_n[1], point.friction_force_n[2]};
        memory.boost = point.depth_m < kEasy * c.allowed_depth ? std::max(1.0, c.boost / 2) : c.boost;
        body.state.contacts.push_back(memory);
    }
}

void undo_contacts(StepContext& ctx, Body& body) {
    drop_contacts(body);
    for (Collider& collider : ctx.world.colliders) {
        collider.w = collider.begin;
        collider.dw = Vec6::Zero();
    }
}

void drop_contacts(Body& body) {
    body.contacts.list.clear();
    body.contacts.report.clear();
    body.state.contacts.clear();
}

}  // namespace supple
