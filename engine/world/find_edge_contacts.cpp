// Where a sharp edge of one surface crosses a sharp edge of another, or its own: what no vertex sees.
//
// Two edges are the nearest features of two convex ridges where the common perpendicular n of the two lies between the normals of the faces at the one, and -n
// between those at the other: they are a face of the Minkowski difference (Gregorius 2013, "The Separating Axis Test"). Then n.s is the distance, negative where they have passed
// one another. Edges that move far are followed along their way, like vertices.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "supple/contact/first_fall.h"
#include "supple/world/contact_stages.h"
#include "supple/world/stages.h"

namespace supple {

using contact::Bounds;

namespace {

constexpr double kReach = 1;          // mean edges: how deep edges may be that pressed before; what is new is not deep, or was seen on its way
constexpr double kCross = 0.1;        // sine of the angle between edges that cross; less, and the vertices see them
constexpr double kInside = 1e-6;      // of the edges: nearer to its end a point is a vertex's
constexpr double kBetween = 0.02;     // sine by which n may leave the arc between the normals: bodies are soft
constexpr double kRim = 0.97;         // cosine between n and the normal of a face that it counts as along
constexpr double kBeside = 0.01;      // of the watched gap
constexpr double kFollow = 0.5;       // of the watched gap: longer ways are followed
constexpr double kApart = 1;          // mean edges at rest: nearer parts of one surface do not touch one another

/// One of the bodies, with an edge of it at the start and the end of the step.
struct Side {
    Body& body;
    const ContactSurface& surface;

    const SharpEdge& edge(std::int32_t e) const { return surface.sharp[std::size_t(e)]; }
    const Vec3& start(std::int32_t v) const { return body.state.x[std::size_t(v)]; }
    const Vec3& end(std::int32_t v) const { return surface.end[std::size_t(v)]; }
    Vec3 normal(const SharpEdge& e, std::size_t i) const { return surface.normal[std::size_t(e.triangle[i])]; }
    const Vec3& rest(std::int32_t v) const { return body.data().mesh.vertices[std::size_t(v)]; }
};

struct Pair {
    StepContext& ctx;
    Side one, two;
    std::int32_t other_slot;
    double margin_m, reach_m, friction;
    bool self;
};

/// Nearest points of two lines: a + s u and b + t v.
struct Crossing {
    double s = 0, t = 0;
    Vec3 cross = Vec3::Zero();  ///< u x v
    bool good = false;          ///< both inside their edges, which are not parallel
};

Crossing crossing_of(const Vec3& a, const Vec3& u, const Vec3& b, const Vec3& v) {
    Crossing x;
    x.cross = u.cross(v);
    const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), det = uu * vv - uv * uv;
    if (!(x.cross.squaredNorm() > kCross * kCross * uu * vv) || !(det > 0)) return x;
    const Vec3 r = b - a;
    x.s = (r.dot(u) * vv - r.dot(v) * uv) / det;
    x.t = (r.dot(u) * uv - r.dot(v) * uu) / det;
    x.good = std::min({x.s, x.t, 1 - x.s, 1 - x.t}) > kInside;
    return x;
}

/// True if n, perpendicular to the edge, points out between the normals of its faces.
bool between(const Vec3& n, const Vec3& along, const Vec3& n1, const Vec3& n2) {
    const Vec3 e = along.normalized();
    const double turn = n1.cross(n2).dot(e) > 0 ? 1 : -1;
    return turn * n1.cross(n).dot(e) >= -kBetween && turn * n.cross(n2).dot(e) >= -kBetween && n.dot(n1 + n2) > 0;
}

/// Neighbours at rest on one surface.
bool neighbours(const Pair& p, const SharpEdge& a, const SharpEdge& b) {
    const double apart = kApart * p.one.surface.mean_edge_m;
    for (const std::int32_t v : a.vertex) {
        for (const std::int32_t w : b.vertex)
            if ((p.one.rest(v) - p.one.rest(w)).norm() < apart) return true;
    }
    return false;
}

void add_contact(Pair& p, std::int32_t e, std::int32_t f, const Crossing& at, const Vec3& normal, double time) {
    const SharpEdge &own = p.one.edge(e), &other = p.two.edge(f);
    Contact c;
    c.collider = kNoCollider;
    c.other = &p.two.body;
    c.other_slot = p.other_slot;
    c.tag = edge_tag(f);
    c.triangle = own.triangle[0];
    c.other_triangle = other.triangle[0];
    c.corners = c.others = 2;
    double compliance = 0, edge = HUGE_VAL;
    Vec3 s0 = Vec3::Zero(), s1 = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
        const bool mine = k < 2;
        const Side& side = mine ? p.one : p.two;
        const std::int32_t v = (mine ? own : other).vertex[k % 2];
        const double part = mine ? at.s : at.t, w = (mine ? 1 : -1) * (k % 2 == 0 ? 1 - part : part);
        c.vertex[k] = v;
        c.weight[k] = w;
        c.masked[k] = free_part(side.body, std::size_t(v), Vec3::Constant(w * side.body.work.h / p.one.body.work.h));
        s0 += w * side.start(v);
        s1 += w * side.end(v);
        compliance += w * w / weight_against(p.ctx, side.body, v);
        edge = std::min(edge, side.surface.edge_m[std::size_t(v)]);
    }
    c.stiffness = kContactStiffness / compliance;
    c.allowed_depth = kAllowedDepth * edge;
    c.friction = p.friction;
    c.normal = normal;
    c.z_ref = s1;  // s there, until place_contacts knows the rest
    double touched = time;
    if (touched < 0) {
        const double before = normal.dot(s0), after = normal.dot(s1);
        touched = before <= 0 ? 0 : after >= 0 ? 1 : before / (before - after);
    }
    c.s_touch = (1 - touched) * s0 + touched * s1;
    p.one.body.contacts.edges.push_back(c);
}

/// Out of the second edge, into the first; zero if their ridges do not face one another there.
Vec3 direction(const Pair& p, const SharpEdge& own, const SharpEdge& other, const Crossing& x, const Vec3& u, const Vec3& v) {
    const Vec3 a1 = p.one.normal(own, 0), a2 = p.one.normal(own, 1), b1 = p.two.normal(other, 0), b2 = p.two.normal(other, 1);
    Vec3 n = x.cross.normalized();
    if (n.dot(b1 + b2) < 0) n = -n;
    return between(n, v, b1, b2) && between(Vec3(-n), u, a1, a2) ? n : Vec3(Vec3::Zero());
}

/// True if n lies along a face at one of the edges, and an end of an edge touches the other body: the rim of two faces that press on one another. Their vertices carry them
/// where there are any.
bool seen_by_vertices(const Pair& p, const SharpEdge& own, const SharpEdge& other, const Vec3& n) {
    double along = 0;
    for (const std::size_t i : {0, 1}) along = std::max({along, -n.dot(p.one.normal(own, i)), n.dot(p.two.normal(other, i))});
    if (along < kRim) return false;
    const auto touches = [&](const Side& side, const SharpEdge& edge, const Body& against) {
        return std::any_of(side.body.contacts.list.begin(), side.body.contacts.list.end(), [&](const Contact& c) {
            if (c.other != &against || c.corners != 1 || (c.vertex[0] != edge.vertex[0] && c.vertex[0] != edge.vertex[1])) return false;
            return c.z_ref.cross(c.normal).norm() < kBeside * p.margin_m;  // over a face, not beside it
        });
    };
    return touches(p.one, own, p.two.body) || touches(p.two, other, p.one.body);
}

void look_at_pair(Pair& p, std::int32_t e, std::int32_t f) {
    const SharpEdge &own = p.one.edge(e), &other = p.two.edge(f);
    if (p.self && (f <= e || neighbours(p, own, other))) return;
    const Vec3 &a1 = p.one.end(own.vertex[0]), &b1 = p.two.end(other.vertex[0]);
    const Vec3 u1 = p.one.end(own.vertex[1]) - a1, v1 = p.two.end(other.vertex[1]) - b1;
    const Vec3 &a0 = p.one.start(own.vertex[0]), &b0 = p.two.start(other.vertex[0]);
    const Vec3 u0 = p.one.start(own.vertex[1]) - a0, v0 = p.two.start(other.vertex[1]) - b0;
    const Vec3 way = a1 + 0.5 * u1 - b1 - 0.5 * v1 - (a0 + 0.5 * u0 - b0 - 0.5 * v0);
    if (p.self || way.norm() > kFollow * p.margin_m) {
        // (a - b).(u x v) along the way, positive while they are apart.
        const Vec3 normals = p.two.normal(other, 0) + p.two.normal(other, 1);
        const double sign = u0.cross(v0).dot(normals) < 0 ? -1 : 1;
        const Vec3 r0 = a0 - b0, r = a1 - b1 - r0, u = u1 - u0, v = v1 - v0;
        const Vec3 c0 = u0.cross(v0), c1 = u0.cross(v) + u.cross(v0), c2 = u.cross(v);
        const auto time = contact::first_fall(sign * r0.dot(c0), sign * (r.dot(c0) + r0.dot(c1)), sign * (r.dot(c1) + r0.dot(c2)), sign * r.dot(c2));
        if (time) {
            const Vec3 ut = u0 + *time * u, vt = v0 + *time * v;
            const Crossing x = crossing_of(a0 + *time * (a1 - a0), ut, b0 + *time * (b1 - b0), vt);
            const Vec3 n = x.good ? direction(p, own, other, x, ut, vt) : Vec3(Vec3::Zero());
            if (!n.isZero(0) && !seen_by_vertices(p, own, other, n)) return add_contact(p, e, f, x, n, *time);
        }
    }
    const Crossing x = crossing_of(a1, u1, b1, v1);
    if (!x.good) return;
    const Vec3 s = a1 + x.s * u1 - b1 - x.t * v1;
    if (!(s.squaredNorm() <= p.reach_m * p.reach_m)) return;
    const Vec3 n = direction(p, own, other, x, u1, v1);
    if (n.isZero(0)) return;
    const double gap = n.dot(s);
    if (gap > p.margin_m) return;
    if (gap < 0 && (p.self || gap < -p.margin_m) && !pressed_before(p.one.body, p.other_slot, {own.vertex[0], own.vertex[1], edge_tag(f)})) return;
    if (!seen_by_vertices(p, own, other, n)) add_contact(p, e, f, x, n, -1);
}

}  // namespace

void find_edge_contacts(StepContext& ctx, Member& member, Member& other) {
    const ContactSurface &own = *member.body->contacts.surface, &with = *other.body->contacts.surface;
    if (own.sharp.empty() || with.sharp.empty()) return;
    const double margin = 0.5 * (own.margin_m + with.margin_m), reach = kReach * std::min(own.mean_edge_m, with.mean_edge_m);
    Bounds box = with.box;
    box.grow(margin);
    if (!box.overlaps(own.box)) return;
    const double friction = std::sqrt(member.body->def.friction * other.body->def.friction);
    Pair pair{ctx, {*member.body, own}, {*other.body, with}, std::int32_t(other.id.index), margin, std::max(reach, margin), friction, &member == &other};
    for (std::size_t e = 0; e < own.sharp.size(); ++e) {
        Bounds way;
        for (const std::int32_t v : own.sharp[e].vertex) {
            way.include(pair.one.start(v));
            way.include(pair.one.end(v));
        }
        if (!box.overlaps(way)) continue;
        way.grow(margin);
        with.tree.overlapping(way, [&](std::int32_t t) {
            for (const std::int32_t f : with.sharp_of[std::size_t(t)]) {
                if (f >= 0) look_at_pair(pair, std::int32_t(e), f);
            }
        });
    }
}

}  // namespace supple
