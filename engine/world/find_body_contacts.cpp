// Which vertices of a body's surface touch the surface of another body, or its own, at the end of the step, or came through it on the way.
//
// A vertex presses on the nearest triangle that faces it, along that triangle's normal. Inside and outside are told by the nearest feature of the whole surface
// and its angle-weighted normal (Baerentzen and Aanaes 2005): exact for closed surfaces. A vertex that moves far against the other surface is followed on its way
// instead, and so is any vertex against its own body: there a vertex counts as behind a triangle only if it was seen to get there, for everything is behind the
// triangles on the far side of its own body.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "supple/contact/first_fall.h"
#include "supple/mesh/triangle_tree.h"
#include "supple/world/contact_stages.h"
#include "supple/world/stages.h"

namespace supple {

using contact::Bounds;

namespace {

constexpr double kReach = 2;         // mean edges: how deep a vertex may be that pressed before or is fast; what is slow and new is not deep
constexpr double kFacing = 0.1;      // a triangle faces a vertex whose normal against its own is less than minus that
constexpr double kFollow = 0.5;      // of the watched gap: longer ways against the other surface are followed
constexpr double kApart = 1;         // mean edges at rest: nearer parts of one surface do not touch one another
constexpr double kOnFeature = 1e-9;  // a barycentric coordinate below it is zero
constexpr double kBeside = 1e-6;     // barycentric: a crossing so near to a triangle is in it, so that nothing slips through between two

/// A body's surface as the vertices of one (perhaps itself) meet it.
struct Meeting {
    StepContext& ctx;
    Body& body;
    Body& other;
    std::int32_t other_slot;
    bool self;
    double margin_m, reach_m, friction;

    const ContactSurface& surface() const { return *other.contacts.surface; }
    const Triangle& triangle(std::int32_t t) const { return other.data().boundary.triangles[std::size_t(t)]; }
    const Vec3& end(std::int32_t v) const { return surface().end[std::size_t(v)]; }
    const Vec3& start(std::int32_t v) const { return other.state.x[std::size_t(v)]; }
    const Vec3& normal(std::int32_t t) const { return surface().normal[std::size_t(t)]; }
};

struct Found {
    std::int32_t triangle = -1;
    std::array<double, 3> barycentric{};
    Vec3 normal = Vec3::Zero();
    double time = -1;  ///< of a crossing on the way; negative: looked at where the step ends
};

void add_contact(Meeting& m, std::int32_t v, const Found& f) {
    const ContactSurface& own = *m.body.contacts.surface;
    Contact c;
    c.collider = kNoCollider;
    c.other = &m.other;
    c.other_slot = m.other_slot;
    c.triangle = own.triangle[std::size_t(v)];
    c.other_triangle = f.triangle;
    c.corners = 1;
    c.vertex[0] = v;
    c.weight[0] = 1;
    c.masked[0] = free_part(m.body, std::size_t(v), Vec3::Ones());
    Vec3 s0 = m.body.state.x[std::size_t(v)], s1 = own.end[std::size_t(v)];
    double compliance = 1 / weight_against(m.ctx, m.body, v);
    const Triangle& corner = m.triangle(f.triangle);
    for (std::size_t i = 0; i < 3; ++i) {
        const double w = f.barycentric[i];
        if (w <= kOnFeature) continue;
        const std::size_t k = c.corners + c.others++;
        c.vertex[k] = corner[i];
        c.weight[k] = -w;
        c.masked[k] = free_part(m.other, std::size_t(corner[i]), Vec3::Constant(-w * m.other.work.h / m.body.work.h));
        s0 -= w * m.start(corner[i]);
        s1 -= w * m.end(corner[i]);
        compliance += w * w / weight_against(m.ctx, m.other, corner[i]);
    }
    c.stiffness = kContactStiffness / compliance;
    c.allowed_depth = kAllowedDepth * std::min(own.edge_m[std::size_t(v)], m.surface().edge_m[std::size_t(corner[0])]);
    c.friction = m.friction;
    c.normal = f.normal;
    c.z_ref = s1;  // s there, until place_contacts knows the rest
    // The slide begins where they touch: from the start of the step for what touched then, on the way for what did not.
    double touched = f.time;
    if (touched < 0) {
        const double before = f.normal.dot(s0), after = f.normal.dot(s1);
        touched = before <= 0 ? 0 : after >= 0 ? 1 : before / (before - after);
    }
    c.s_touch = (1 - touched) * s0 + touched * s1;
    m.body.contacts.list.push_back(c);
}

/// Outward normal of the feature that a nearest point lies on.
Vec3 feature_normal(const Meeting& m, const Found& at) {
    const Triangle& corner = m.triangle(at.triangle);
    std::array<std::int32_t, 3> on{};
    std::size_t n = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (at.barycentric[k] > kOnFeature) on[n++] = corner[k];
    }
    if (n == 3) return at.normal;
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t t : m.surface().triangles_at(on[0])) {
        const Triangle& c = m.triangle(t);
        if (n == 2 && std::find(c.begin(), c.end(), on[1]) == c.end()) continue;
        double weight = 1;
        if (n == 1) {
            const auto k = std::size_t(std::find(c.begin(), c.end(), on[0]) - c.begin());
            const Vec3 a = (m.end(c[(k + 1) % 3]) - m.end(on[0])).normalized(), b = (m.end(c[(k + 2) % 3]) - m.end(on[0])).normalized();
            weight = std::acos(std::clamp(a.dot(b), -1.0, 1.0));
        }
        const Vec3& normal = m.normal(t);
        if (normal.allFinite()) sum += weight * normal;
    }
    return sum;
}

/// Where a vertex comes through a triangle from the outside, both moving evenly.
std::optional<Found> crossing(const Meeting& m, const Vec3& p0, const Vec3& p1, std::int32_t t) {
    const Triangle& corner = m.triangle(t);
    const Vec3 &a0 = m.start(corner[0]), &a1 = m.end(corner[0]);
    const Vec3 e0 = m.start(corner[1]) - a0, e = m.end(corner[1]) - a1 - e0;
    const Vec3 g0 = m.start(corner[2]) - a0, g = m.end(corner[2]) - a1 - g0;
    const Vec3 r0 = p0 - a0, r = p1 - a1 - r0;
    const Vec3 n0 = e0.cross(g0), n1 = e0.cross(g) + e.cross(g0), n2 = e.cross(g);
    const auto time = contact::first_fall(r0.dot(n0), r.dot(n0) + r0.dot(n1), r.dot(n1) + r0.dot(n2), r.dot(n2));
    if (!time) return {};
    const Vec3 x = r0 + *time * r, u = e0 + *time * e, w = g0 + *time * g, n = u.cross(w);
    const double area = n.squaredNorm();
    const double beta = x.cross(w).dot(n) / area, gamma = u.cross(x).dot(n) / area, alpha = 1 - beta - gamma;
    if (!(std::min({alpha, beta, gamma}) >= -kBeside)) return {};
    Found found;
    found.triangle = t;
    found.barycentric = {std::max(alpha, 0.0), std::max(beta, 0.0), std::max(gamma, 0.0)};
    const double sum = found.barycentric[0] + found.barycentric[1] + found.barycentric[2];
    for (double& b : found.barycentric) b /= sum;
    found.normal = m.normal(t);
    found.time = *time;
    return found;
}

/// Parts of one surface that are neighbours at rest.
bool neighbours(const Meeting& m, std::int32_t v, std::int32_t t) {
    const Triangle& c = m.triangle(t);
    if (std::find(c.begin(), c.end(), v) != c.end()) return true;
    const std::vector<Vec3>& X = m.body.data().mesh.vertices;
    const double apart = nearest_on_triangle(X[std::size_t(v)], X[std::size_t(c[0])], X[std::size_t(c[1])], X[std::size_t(c[2])]).distance;
    return apart < kApart * m.surface().mean_edge_m;
}

bool came_from_behind(const Meeting& m, const Vec3& p0, std::int32_t t) {
    const Triangle& c = m.triangle(t);
    const Vec3& a = m.start(c[0]);
    return (m.start(c[1]) - a).cross(m.start(c[2]) - a).dot(p0 - a) < 0;
}

Vec3 vertex_normal(const Meeting& m, std::int32_t v) {
    const ContactSurface& own = *m.body.contacts.surface;
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t t : own.triangles_at(v)) {
        const Triangle& c = m.body.data().boundary.triangles[std::size_t(t)];
        const Vec3& a = own.end[std::size_t(c[0])];
        sum += (own.end[std::size_t(c[1])] - a).cross(own.end[std::size_t(c[2])] - a);
    }
    return sum.normalized();
}

void look_at_vertex(Meeting& m, std::int32_t v) {
    const ContactSurface& own = *m.body.contacts.surface;
    const Vec3 &p0 = m.body.state.x[std::size_t(v)], &p1 = own.end[std::size_t(v)];
    const bool pressed = pressed_before(m.body, m.other_slot, {v, -1, -1});
    const double reach = pressed || (p1 - p0).squaredNorm() > m.margin_m * m.margin_m ? m.reach_m : m.margin_m;
    Bounds box{p0, p0};
    box.include(p1);
    Bounds segment = box;
    segment.grow(kBeside * m.reach_m);  // as far beside a triangle as a crossing may lie
    box.grow(reach);
    Vec3 normal = Vec3::Zero();
    Found nearest, facing;
    double nearest_m = HUGE_VAL, facing_m = HUGE_VAL, facing_dot = 0;
    std::optional<Found> crossed;
    m.surface().tree.overlapping(box, [&](std::int32_t t) {
        const Triangle& c = m.triangle(t);
        const Vec3& n = m.normal(t);
        if (!n.allFinite()) return;
        if (normal.isZero(0)) normal = vertex_normal(m, v);
        const double against = n.dot(normal);
        const bool faces = against <= -kFacing;
        if (m.self && (!faces || neighbours(m, v, t))) return;
        const Vec3 way = p1 - p0 - (m.end(c[0]) + m.end(c[1]) + m.end(c[2]) - m.start(c[0]) - m.start(c[1]) - m.start(c[2])) / 3;
        const bool fast = way.squaredNorm() > kFollow * kFollow * m.margin_m * m.margin_m;
        // What slides along a face comes through the side of an edge, by the hair that it lies too deep: only what faces it stops it.
        if (faces && (m.self || fast) && m.surface().tree.box(t).overlaps(segment)) {
            const auto through = crossing(m, p0, p1, t);
            if (through && (!crossed || through->time < crossed->time)) crossed = through;
        }
        const double same = 1e-9 * m.margin_m;  // a point of an edge is as far from both sides
        const double farther = faces ? std::max(nearest_m, facing_m + same) : nearest_m;
        Bounds around{m.end(c[0]), m.end(c[0])};
        around.include(m.end(c[1]));
        around.include(m.end(c[2]));
        if (around.squared_distance(p1) > farther * farther) return;
        const NearestPoint at = nearest_on_triangle(p1, m.end(c[0]), m.end(c[1]), m.end(c[2]));
        const Found here{t, at.barycentric, n, -1};
        if (at.distance < nearest_m) {
            nearest_m = at.distance;
            nearest = here;
        }
        // The far side of a body that has come over the vertex would push it on through, and the body with it.
        if (!faces || (fast && !pressed && came_from_behind(m, p0, t))) return;
        if (at.distance < facing_m - same || (at.distance < facing_m + same && against < facing_dot)) {
            facing_m = at.distance;
            facing_dot = against;
            facing = here;
        }
    });
    if (crossed) return add_contact(m, v, *crossed);
    if (facing.triangle < 0) return;
    const auto gap = [&](const Found& at) {
        const Triangle& c = m.triangle(at.triangle);
        return p1 - at.barycentric[0] * m.end(c[0]) - at.barycentric[1] * m.end(c[1]) - at.barycentric[2] * m.end(c[2]);
    };
    const double over = facing.normal.dot(gap(facing));
    const bool inside = m.self ? over < 0 : feature_normal(m, nearest).dot(gap(nearest)) < 0;
    if (inside) {
        if (over < 0 && facing_m <= reach && (!m.self || pressed)) add_contact(m, v, facing);
    } else if (over >= 0 && facing_m <= m.margin_m) {
        add_contact(m, v, facing);
    }
}

}  // namespace

bool pressed_before(const Body& body, std::int32_t other_slot, const std::array<std::int32_t, 3>& key) {
    const std::vector<ContactMemory>& memory = body.state.contacts;
    const auto wanted = std::tuple(kNoCollider, other_slot, key);
    const auto of = [](const ContactMemory& c) { return std::tuple(c.collider, c.other, c.vertex); };
    const auto at = std::lower_bound(memory.begin(), memory.end(), wanted, [&](const ContactMemory& c, const auto& k) { return of(c) < k; });
    return at != memory.end() && of(*at) == wanted;
}

bool may_touch(const World::Impl& world, const Member& a, const Member& b) {
    for (const auto& one : world.contact_switches) {
        if ((one.a == a.id && one.b == b.id) || (one.a == b.id && one.b == a.id)) return one.on;
    }
    return a.id == b.id ? a.body->def.touches_itself : a.body->def.touches_bodies && b.body->def.touches_bodies;
}

void find_body_contacts(StepContext& ctx, Member& member, Member& other) {
    const ContactSurface& own = *member.body->contacts.surface;
    const ContactSurface& surface = *other.body->contacts.surface;
    const double margin = 0.5 * (own.margin_m + surface.margin_m), reach = kReach * surface.mean_edge_m;
    Bounds box = surface.box;
    box.grow(margin);
    if (!box.overlaps(own.box)) return;
    const double friction = std::sqrt(member.body->def.friction * other.body->def.friction);
    Meeting m{ctx, *member.body, *other.body, std::int32_t(other.id.index), &member == &other, margin, reach, friction};
    for (const std::int32_t v : member.body->data().boundary_vertices) {
        Bounds way{member.body->state.x[std::size_t(v)], member.body->state.x[std::size_t(v)]};
        way.include(own.end[std::size_t(v)]);
        if (box.overlaps(way)) look_at_vertex(m, v);
    }
}

}  // namespace supple
