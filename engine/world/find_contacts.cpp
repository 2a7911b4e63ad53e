// Which points of a body's surface touch a collider at the end of the step, or came through it on the way.
//
// Vertices are looked at everywhere; of triangles the deepest point is, where the shape has edges or is not much larger than they are: a needle
// finds no vertex. What moves less than half the thickness of a shape in a step is looked at where the step would end. What moves farther is
// followed along its way as the shape sees it, and the contact is the plane of the first touch, so that neither can pass through the other.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "supple/contact/closest.h"
#include "supple/world/contact_stages.h"
#include "supple/world/stages.h"

namespace supple {

using contact::Bounds;
using contact::Distance;

namespace {

constexpr double kAllowedDepthOfShape = 0.1;  // of its thinness
constexpr double kSweepFrom = 0.5;         // of a shape's thinness: longer ways are followed
constexpr double kNear = 1e-3;             // of the edges, or of the thinness if that is less: what counts as touched on the way
constexpr double kRoundEnough = 2.5;       // edges: a shape as round as that needs the vertices alone
constexpr double kCorner = 1e-3;           // a weight below it is none
constexpr double kProtrudes = 0.02;        // of the edges: how much deeper a triangle's inside must be than its corners; half of that to stay
constexpr double kFacing = 0.15;           // a triangle whose normal is less against the shape's does not face it
constexpr double kFromInside = 0.5;        // normals of body and shape agree by so much: the shape would come out of the body

/// A collider as a body meets it.
struct Meeting {
    StepContext& ctx;
    Body& body;
    Collider& collider;
    std::uint32_t slot;
    Bounds swept;          ///< of the collider over the step, grown by the margin; of a plane nothing
    bool everywhere;       ///< a plane
    double near_m;

    const Shape& shape() const { return collider.def.shape; }
    const Vec3& start(std::int32_t v) const { return body.state.x[std::size_t(v)]; }
    const Vec3& end(std::int32_t v) const { return body.contacts.surface->end[std::size_t(v)]; }
};

Bounds world_bounds(const Collider& collider) {
    const Bounds local = contact::bounds(collider.def.shape);
    Bounds box;
    for (int i = 0; i < 8; ++i) {
        const Vec3 corner((i & 1 ? local.max_m : local.min_m).x(), (i & 2 ? local.max_m : local.min_m).y(), (i & 4 ? local.max_m : local.min_m).z());
        box.include(collider.to_world0(corner));
        box.include(collider.to_world1(corner));
    }
    return box;
}

struct Found {
    std::array<std::int32_t, 3> vertex{-1, -1, -1};
    std::array<double, 3> weight{};
    std::int32_t triangle = -1;
    Vec3 local = Vec3::Zero();         ///< point of the shape's surface, its own frame
    Vec3 normal = Vec3::Zero();        ///< its own frame
    double time = -1;                  ///< of the first touch on the way; negative: looked at where the step ends
    double edge_m = 0;
};

void add_contact(Meeting& m, const Found& f) {
    const Body& body = m.body;
    Contact c;
    c.collider = m.slot;
    c.triangle = f.triangle;
    std::array<std::pair<std::int32_t, double>, 3> corner{};
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (f.vertex[k] < 0) continue;
        corner[c.corners++] = {f.vertex[k], f.weight[k]};
        sum += f.weight[k];
    }
    for (std::size_t k = 1; k < c.corners; ++k) {
        for (std::size_t j = k; j > 0 && corner[j].first < corner[j - 1].first; --j) std::swap(corner[j], corner[j - 1]);
    }
    Vec3 start = Vec3::Zero(), end = Vec3::Zero();
    double compliance = 0;
    for (std::size_t k = 0; k < c.corners; ++k) {
        c.vertex[k] = corner[k].first;
        c.weight[k] = corner[k].second / sum;
        c.masked[k] = free_part(body, std::size_t(c.vertex[k]), Vec3::Constant(c.weight[k]));
        start += c.weight[k] * m.start(c.vertex[k]);
        end += c.weight[k] * m.end(c.vertex[k]);
        compliance += c.weight[k] * c.weight[k] / weight_against(m.ctx, body, c.vertex[k]);
    }
    c.stiffness = kContactStiffness / compliance;
    c.allowed_depth = std::min(kAllowedDepth * f.edge_m, kAllowedDepthOfShape * m.collider.thinness_m);
    c.friction = m.collider.def.friction;
    c.normal = m.collider.R1 * f.normal;
    const Vec3 q0 = m.collider.to_world0(f.local), q1 = m.collider.to_world1(f.local);
    c.lever = q1 - m.collider.c1;
    c.z_ref = end - q1;  // s there, until place_contacts knows the rest
    const Vec3 s0 = start - q0;
    // The slide begins where they touch: from the start of the step for what touched then, on the way for what did not.
    double touched = f.time;
    if (touched < 0) {
        const double before = (m.collider.R0 * f.normal).dot(s0), after = c.normal.dot(c.z_ref);
        touched = before <= 0 ? 0 : after >= 0 ? 1 : before / (before - after);
    }
    c.s_touch = (1 - touched) * s0 + touched * c.z_ref;
    m.body.contacts.list.push_back(c);
}

/// True if a shape that meets the surface with this normal (both in the world) would come out of the body there.
bool from_inside(const Vec3& shape_normal, const Vec3& outward) { return shape_normal.dot(outward) > kFromInside * outward.norm(); }

Vec3 outward_of(const Meeting& m, std::int32_t triangle) {
    const Triangle& t = m.body.data().boundary.triangles[std::size_t(triangle)];
    return (m.start(t[1]) - m.start(t[0])).cross(m.start(t[2]) - m.start(t[0]));
}

void look_at_vertex(Meeting& m, std::int32_t v) {
    const ContactSurface& surface = *m.body.contacts.surface;
    const Collider& c = m.collider;
    Found found;
    found.vertex[0] = v;
    found.weight[0] = 1;
    found.triangle = surface.triangle[std::size_t(v)];
    found.edge_m = surface.edge_m[std::size_t(v)];
    const Vec3 p1 = c.to_local1(m.end(v));
    if (m.everywhere) {
        const Distance at = contact::distance(m.shape(), p1);
        if (at.d > surface.margin_m) return;
        found.local = p1 - at.d * at.normal;
        found.normal = at.normal;
        return add_contact(m, found);
    }
    const Vec3 p0 = c.to_local0(m.start(v));
    const Distance before = contact::distance(m.shape(), p0);
    if ((p1 - p0).norm() > kSweepFrom * c.thinness_m) {
        contact::Touch touch;
        touch.point.at = before;
        bool touches = before.d <= m.near_m && before.normal.dot(p1 - p0) < 0;  // already, and would go on through
        if (before.d > m.near_m) {
            const auto swept = contact::sweep_point(m.shape(), p0, p1, m.near_m);
            touches = swept.has_value();
            if (swept) touch = *swept;
        }
        if (touches && !from_inside(c.R0 * touch.point.at.normal, outward_of(m, found.triangle))) {
            found.time = touch.time;
            found.normal = touch.point.at.normal;
            found.local = p0 + touch.time * (p1 - p0) - touch.point.at.d * found.normal;
            return add_contact(m, found);
        }
    }
    Distance at = contact::distance(m.shape(), p1);
    if (at.d > surface.margin_m) return;
    Vec3 p = p1;
    if (before.d < 0 && before.normal.dot(at.normal) < 0.2) {  // it has passed the middle: back to where it came from
        at = before;
        p = p0;
    }
    found.local = p - at.d * at.normal;
    found.normal = at.normal;
    add_contact(m, found);
}

/// What the inside of a triangle left to this step; null: it did not press.
const ContactMemory* remembered(const Meeting& m, Triangle triangle) {
    std::sort(triangle.begin(), triangle.end());
    const std::vector<ContactMemory>& memory = m.body.state.contacts;
    const auto key = std::tie(m.slot, triangle);
    const auto at = std::lower_bound(memory.begin(), memory.end(), key, [](const ContactMemory& a, const auto& b) { return std::tie(a.collider, a.vertex) < b; });
    return at != memory.end() && std::tie(at->collider, at->vertex) == key ? &*at : nullptr;
}

/// Half way between a point of a triangle and that of the last step: a facet that turns with the force at its point would swing to and fro for ever.
void follow(const Meeting& m, const ContactMemory& memory, const Triangle& t, const std::array<Vec3, 3>& corner, contact::TrianglePoint& point) {
    Vec3 p = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
        const auto at = std::size_t(std::find(memory.vertex.begin(), memory.vertex.end(), t[k]) - memory.vertex.begin());
        double& w = point.barycentric[Eigen::Index(k)];
        w = 0.5 * (w + memory.weight[at]);
        p += w * corner[k];
    }
    point.at = contact::distance(m.shape(), p);
}

/// The deepest point of a triangle, where that is not one of its vertices.
void look_at_triangle(Meeting& m, std::int32_t triangle) {
    const ContactSurface& surface = *m.body.contacts.surface;
    const Collider& c = m.collider;
    const Triangle& t = m.body.data().boundary.triangles[std::size_t(triangle)];
    std::array<Vec3, 3> from, to;
    double way = 0, edge = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        from[k] = c.to_local0(m.start(t[k]));
        to[k] = c.to_local1(m.end(t[k]));
        way = std::max(way, (to[k] - from[k]).norm());
        edge += surface.edge_m[std::size_t(t[k])] / 3;
    }
    Found found;
    found.vertex = t;
    found.triangle = triangle;
    found.edge_m = edge;
    contact::TrianglePoint point;
    const std::array<Vec3, 3>* corner = &to;
    std::array<Vec3, 3> on_the_way;
    std::optional<contact::Touch> touch;
    if (way > kSweepFrom * c.thinness_m) {
        const contact::TrianglePoint before = contact::deepest_on_triangle(m.shape(), from[0], from[1], from[2]);
        Vec3 along = Vec3::Zero();
        for (std::size_t k = 0; k < 3; ++k) along += before.barycentric[Eigen::Index(k)] * (to[k] - from[k]);
        if (before.at.d > m.near_m) {
            touch = contact::sweep_triangle(m.shape(), from, to, m.near_m);
        } else if (before.at.normal.dot(along) < 0) {  // already, and would go on through
            touch = contact::Touch{0, before};
        }
    }
    if (touch) {
        for (std::size_t k = 0; k < 3; ++k) on_the_way[k] = from[k] + touch->time * (to[k] - from[k]);
        corner = &on_the_way;
        point = touch->point;
        found.time = touch->time;
    } else {
        point = contact::deepest_on_triangle(m.shape(), to[0], to[1], to[2]);
        if (point.at.d > surface.margin_m) return;
    }
    const ContactMemory* memory = remembered(m, t);
    if (!touch && memory != nullptr) follow(m, *memory, t, to, point);
    const Vec3& w = point.barycentric;
    if (w.maxCoeff() > 1 - kCorner) return;  // a vertex: looked at by itself
    const auto& p = *corner;
    if (!touch) {
        const double least = std::min({contact::distance(m.shape(), p[0]).d, contact::distance(m.shape(), p[1]).d, contact::distance(m.shape(), p[2]).d});
        if (point.at.d > least - (memory != nullptr ? 0.5 : 1.0) * kProtrudes * edge) return;  // about as deep at a corner
    }
    // Edges and corners of a shape have no normal of their own: contact is along the triangle's.
    Vec3 normal = point.at.normal;
    const Vec3 outward = (p[1] - p[0]).cross(p[2] - p[0]);
    if (normal.dot(outward) > kFromInside * outward.norm()) return;
    if (c.feature_radius_m == 0) {
        if (normal.dot(outward) > -kFacing * outward.norm()) return;  // the side of an edge whose other triangle faces the shape
        normal = -outward.normalized();
    }
    found.weight = {w[0], w[1], w[2]};
    found.normal = normal;
    found.local = w[0] * p[0] + w[1] * p[1] + w[2] * p[2] - point.at.d * normal;
    add_contact(m, found);
}

auto key(const Contact& c) { return std::tuple(c.collider, c.other_slot, c.attachment, c.key(), c.vertex); }

/// As memory orders them.
int compare(const Contact& c, const ContactMemory& m) {
    if (c.collider != m.collider) return c.collider < m.collider ? -1 : 1;
    if (c.other_slot != m.other) return c.other_slot < m.other ? -1 : 1;
    const std::array<std::int32_t, 3> key = c.key();
    return key == m.vertex ? 0 : key < m.vertex ? -1 : 1;
}

void remember(const World::Impl& world, const ContactMemory& m, Contact& c) {
    const std::uint32_t generation = c.other != nullptr ? world.slots[std::size_t(c.other_slot)].generation : world.colliders[c.collider].generation;
    if (m.generation != generation) return;
    c.boost = m.boost;
    Vec3 friction(m.friction_n[0], m.friction_n[1], m.friction_n[2]);
    if (c.other == nullptr) {
        const Collider& collider = world.colliders[c.collider];
        friction = collider.R1 * (collider.R0.transpose() * friction);
    }
    c.memory_n = friction - c.normal.dot(friction) * c.normal;
}

/// Friction and stiffness of the last step.
void sort_and_remember(const World::Impl& world, Body& body) {
    std::vector<Contact>& list = body.contacts.list;
    std::sort(list.begin(), list.end(), [](const Contact& a, const Contact& b) {
        const auto one = key(a), two = key(b);
        return one != two ? one < two : a.triangle < b.triangle;
    });
    list.erase(std::unique(list.begin(), list.end(), [](const Contact& a, const Contact& b) { return key(a) == key(b); }), list.end());
    const std::vector<ContactMemory>& memory = body.state.contacts;
    auto m = memory.begin();
    for (Contact& c : list) {
        if (c.attachment >= 0) continue;
        while (m != memory.end() && compare(c, *m) > 0) ++m;
        if (m == memory.end() || compare(c, *m) != 0) continue;
        remember(world, *m, c);
    }
}

/// What contacts came to earlier in this step. The stiffness was raised because they were too deep, and forgotten they would be so again; what pressed along another normal will press along this one.
void keep_step(const std::vector<Contact>& before, std::vector<Contact>& list) {
    const auto of = [](const Contact& c) { return std::tuple(c.collider, c.other_slot, c.attachment, c.key()); };
    auto b = before.begin();
    for (Contact& c : list) {
        while (b != before.end() && of(*b) < of(c)) ++b;
        if (b == before.end() || of(*b) != of(c)) continue;
        c.boost = b->boost;
        c.expected = b->closed;
    }
}

/// Where the surface would end.
void follow_surface(Body& body) {
    ContactSurface& surface = *body.contacts.surface;
    const Workspace& w = body.work;
    surface.box = Bounds{};
    for (const std::int32_t v : body.data().boundary_vertices) {
        const auto i = std::size_t(v);
        surface.end[i] = w.base_x[i] + w.h * (w.v0[i] + w.dv[i]);
        surface.box.include(surface.end[i]);
        surface.box.include(body.state.x[i]);
    }
    surface.fitted = surface.needed = false;
}

/// Pairs of members whose boxes meet, both ways round, each with itself among them: sweep and prune along x.
void find_near(Scratch& scratch, std::span<Member> members) {
    scratch.sweep.clear();
    scratch.near.clear();
    const auto box = [&](std::int32_t i) {
        const ContactSurface& surface = *members[std::size_t(i)].body->contacts.surface;
        Bounds grown = surface.box;
        grown.grow(0.5 * surface.margin_m);
        return grown;
    };
    for (std::size_t i = 0; i < members.size(); ++i) {
        if (!members[i].body->contacts.surface) continue;
        scratch.sweep.push_back(std::int32_t(i));
        scratch.near.push_back({std::int32_t(i), std::int32_t(i)});
    }
    std::sort(scratch.sweep.begin(), scratch.sweep.end(), [&](std::int32_t a, std::int32_t b) {
        const double x = box(a).min_m.x(), y = box(b).min_m.x();
        return x != y ? x < y : a < b;
    });
    for (std::size_t i = 0; i < scratch.sweep.size(); ++i) {
        const Bounds one = box(scratch.sweep[i]);
        for (std::size_t j = i + 1; j < scratch.sweep.size(); ++j) {
            const Bounds two = box(scratch.sweep[j]);
            if (!(two.min_m.x() <= one.max_m.x())) break;
            if (!one.overlaps(two)) continue;
            scratch.near.push_back({scratch.sweep[i], scratch.sweep[j]});
            scratch.near.push_back({scratch.sweep[j], scratch.sweep[i]});
        }
    }
    std::sort(scratch.near.begin(), scratch.near.end());
}

/// The contacts of a body with colliders.
void find_touching(StepContext& ctx, Body& body) {
    World::Impl& world = ctx.world;
    ContactSurface& surface = *body.contacts.surface;
    for (std::uint32_t slot = 0; slot < world.colliders.size(); ++slot) {
        Collider& collider = world.colliders[slot];
        if (collider.generation == 0) continue;
        const bool everywhere = std::holds_alternative<PlaneShape>(collider.def.shape);
        const double reach = std::min(collider.thinness_m, surface.mean_edge_m);
        Meeting m{ctx, body, collider, slot, {}, everywhere, kNear * reach};
        if (!everywhere) {
            m.swept = world_bounds(collider);
            m.swept.grow(surface.margin_m);
            if (!m.swept.overlaps(surface.box)) continue;
        }
        for (const std::int32_t v : body.data().boundary_vertices) {
            if (!everywhere) {
                Bounds segment{m.start(v), m.start(v)};
                segment.include(m.end(v));
                if (!m.swept.overlaps(segment)) continue;
            }
            look_at_vertex(m, v);
        }
        if (everywhere || collider.feature_radius_m > kRoundEnough * surface.longest_edge_m) continue;
        surface.fit(body.data().boundary.triangles, body.state.x);
        surface.tree.overlapping(m.swept, [&](std::int32_t triangle) { look_at_triangle(m, triangle); });
    }
}

}  // namespace

double weight_against(const StepContext& ctx, const Body& body, std::int32_t v) {
    const auto i = std::size_t(v);
    const double inertia = is_static(ctx) ? 0 : body.mass[i] / (body.work.h * body.work.h);
    return inertia + body.stiffness_trace[i] / 3;
}

void find_contacts(StepContext& ctx, std::span<Member> members, bool again) {
    World::Impl& world = ctx.world;
    Scratch& scratch = ctx.scratch;
    refer_colliders(ctx);
    ctx.team.for_chunks(members.size(), [&](std::size_t i) {
        if (members[i].body->contacts.surface) follow_surface(*members[i].body);
    });
    find_near(scratch, members);
    std::erase_if(scratch.near, [&](const auto& pair) { return !may_touch(world, members[std::size_t(pair[0])], members[std::size_t(pair[1])]); });
    for (const auto& pair : scratch.near) members[std::size_t(pair[1])].body->contacts.surface->needed = true;
    // From here on each member writes to what is its own alone.
    ctx.team.for_chunks(members.size(), [&](std::size_t i) {
        Body& body = *members[i].body;
        body.contacts.list.swap(body.contacts.before);
        body.contacts.list.clear();
        body.contacts.edges.clear();
        if (!again) body.contacts.before.clear();
        if (body.contacts.surface && body.contacts.surface->needed) body.contacts.surface->fit(body.data().boundary.triangles, body.state.x);
    });
    const auto for_near = [&](std::size_t i, auto&& visit) {
        const std::array<std::int32_t, 2> first{std::int32_t(i), 0};
        for (auto near = std::lower_bound(scratch.near.begin(), scratch.near.end(), first); near != scratch.near.end() && std::size_t((*near)[0]) == i; ++near) visit(members[std::size_t((*near)[1])]);
    };
    ctx.team.for_chunks(members.size(), [&](std::size_t i) {
        if (world.living_colliders > 0) find_touching(ctx, *members[i].body);
        for_near(i, [&](Member& other) { find_body_contacts(ctx, members[i], other); });
    });
    ctx.team.for_chunks(members.size(), [&](std::size_t i) {
        for_near(i, [&](Member& other) {
            if (&members[i] <= &other) find_edge_contacts(ctx, members[i], other);
        });
    });
    if (world.living_attachments > 0)
        for (Member& member : members) find_attachments(ctx, member, members);
    ctx.team.for_chunks(members.size(), [&](std::size_t i) {
        Body& body = *members[i].body;
        std::vector<Contact>& list = body.contacts.list;
        list.insert(list.end(), body.contacts.edges.begin(), body.contacts.edges.end());
        if (list.empty()) return;
        sort_and_remember(world, body);
        keep_step(body.contacts.before, list);
        place_contacts(ctx, body);
    });
}

}  // namespace supple
