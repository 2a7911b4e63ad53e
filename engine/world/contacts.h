#pragma once
#include <array>
#include <memory>
#include <vector>

#include "supple/contact/moving_triangles.h"
#include "supple/math/types.h"
#include "supple/solve/preconditioner.h"
#include "supple/world/attachment.h"
#include "supple/world/collider.h"

namespace supple {

struct Body;
struct TemplateData;

/// What a contact leaves to the next step. Part of a body's state; no padding, so that its bytes are its value.
struct ContactMemory {
    std::uint32_t collider = 0, generation = 0;
    std::array<std::int32_t, 3> vertex{-1, -1, -1};  ///< whose weights are not zero, ascending; -1 behind them. Of two edges: the own ends, and edge_tag() of the other
    std::int32_t other = -1;                         ///< slot of the other body, its generation above; -1: a collider
    std::array<double, 3> friction_n{};              ///< on the body
    std::array<double, 3> weight{};                  ///< of the vertices
    double boost = 1;                                ///< of the stiffness
};
static_assert(sizeof(ContactMemory) == 80);

inline constexpr std::uint32_t kNoCollider = 0xffffffff;

/// A point of a body's surface that touches a collider or a surface of another body (or its own), or may do so before the step is over.
///
/// s = point of the body - point of the other at the end of the step; gap = n.s. The contact pushes with f_n = max(0, -k gap) and rubs with
/// f_t = the part of (friction of the last step - k slide) within Coulomb's cone, slide = the change of s since the last step, or since they touched.
/// f(s) is replaced by f_ref - K (s - s_ref), and again with the s of each solve until that says nothing new (semi-smooth Newton; the friction's
/// dependence on the normal force is taken from the solve before, which keeps K symmetric).
///
/// An attachment is a contact that pulls as it pushes: f = -k s.
struct Contact {
    static constexpr std::size_t kMost = 8;  ///< vertices: of an attachment, four on either side
    std::uint32_t collider = 0;       ///< kNoCollider: the world, or another body
    std::int32_t other_slot = -1;     ///< of the other body; -1: none
    Body* other = nullptr;            ///< may be the body itself
    std::int32_t attachment = -1;     ///< its slot; -1: a contact
    std::int32_t tag = -1;            ///< of an edge against an edge: edge_tag() of the other's; -1: none
    std::array<std::int32_t, kMost> vertex{-1, -1, -1, -1, -1, -1, -1, -1};  ///< `corners` of the body, then `others` of the other
    std::array<double, kMost> weight{};  ///< of the others negative: s is the sum over both
    std::array<Vec3, kMost> masked{}; ///< per coordinate, zero where held; of the others times their h' over the body's
    std::array<std::int32_t, kMost> row{};      ///< in the system of the island
    std::array<std::int32_t, kMost> own_row{};  ///< in the matrix of the vertex's body
    std::uint32_t corners = 0, others = 0;
    std::int32_t triangle = -1, other_triangle = -1;
    Vec3 normal = Vec3::Zero();       ///< out of the collider or the other body
    Vec3 lever = Vec3::Zero();        ///< from the collider's centre to the point
    double stiffness = 0;             ///< k [N/m] before boost
    double boost = 1;
    double allowed_depth = 0;         ///< deeper, and the stiffness is raised [m]
    double friction = 0;
    Vec3 memory_n = Vec3::Zero();     ///< friction of the last step
    Vec3 s_touch = Vec3::Zero();      ///< s where the slide began
    Vec3 s_zero = Vec3::Zero();       ///< s at v0: s = s_zero + z, z linear in the solution
    // The model f = f_ref - K (z - z_ref), and whether it pushes.
    Vec3 z_ref = Vec3::Zero(), f_ref = Vec3::Zero();
    Vec3 z_from = Vec3::Zero(), way = Vec3::Zero();  ///< z where the solve at work began, and how far it has gone from there
    Mat3 K = Mat3::Zero();
    bool closed = false;
    bool expected = false;            ///< it pressed before the last search: until a solve says otherwise it does
    Vec3 slip = Vec3::Zero();         ///< direction of its friction where it slips, else zero

    Vec3 force(const Vec3& z) const { return f_ref - K * (z - z_ref); }
    std::size_t vertices() const { return corners + others; }
    /// ContactMemory::vertex of it.
    std::array<std::int32_t, 3> key() const { return {vertex[0], corners > 1 ? vertex[1] : -1, corners > 2 ? vertex[2] : tag}; }
};

/// Sets edges of the other body apart from vertices and from none.
inline std::int32_t edge_tag(std::int32_t sharp_edge) { return -2 - sharp_edge; }

/// An edge of a body's surface where it is sharp and convex at rest.
struct SharpEdge {
    std::array<std::int32_t, 2> vertex{};    ///< ascending
    std::array<std::int32_t, 2> triangle{};  ///< on either side
};

/// What contact needs of a body's surface. Made with the first collider, or the first other body that it may touch.
struct ContactSurface {
    explicit ContactSurface(const TemplateData& data);
    contact::MovingTriangles tree;
    std::vector<std::int32_t> triangle;  ///< [vertex] a boundary triangle at it; -1 inside
    std::vector<double> edge_m;          ///< [vertex] mean length of its boundary edges
    std::vector<std::int32_t> around_start, around;  ///< [vertex] -> boundary triangles at it
    std::vector<SharpEdge> sharp;
    std::vector<std::array<std::int32_t, 3>> sharp_of;  ///< [triangle] the sharp edges that it is the first triangle of; -1: none
    double mean_edge_m = 0, longest_edge_m = 0;
    std::vector<Vec3> end;               ///< [vertex] where it would be at the end of the step
    contact::Bounds box;                 ///< of start and end
    bool needed = false;                 ///< by another body, or by itself: the tree must be fitted before anyone looks
    bool fitted = false;                 ///< the tree is, to start and end; and so are the normals
    std::vector<Vec3> normal;            ///< [triangle] outward at the end, unit; not finite where it is flat
    double margin_m = 0;                 ///< contacts up to this gap are watched
    /// Fits the tree to the way from `start` to `end` of these triangles, once for each `end`. Who asks it brings the margin.
    void fit(std::span<const Triangle> triangles, std::span<const Vec3> start);
    std::span<const std::int32_t> triangles_at(std::int32_t v) const {
        const auto i = std::size_t(v);
        return std::span(around).subspan(std::size_t(around_start[i]), std::size_t(around_start[i + 1] - around_start[i]));
    }
};

/// The contacts of one body in the step at work, and those that pressed in the last one.
struct ContactSet {
    std::unique_ptr<ContactSurface> surface;
    std::vector<Contact> list;           ///< ascending by collider and vertices
    std::vector<Contact> edges;          ///< scratch of find_contacts(): of edges with edges, before they join the list
    std::vector<Contact> before;         ///< scratch of find_contacts(): those that an earlier search of the step found
    std::vector<ContactPoint> report;
};

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat66 = Eigen::Matrix<double, 6, 6>;

/// A collider in a world.
struct Collider {
    std::uint32_t generation = 0;        ///< 0: this slot is empty
    ColliderDef def;
    double thinness_m = 0, feature_radius_m = 0;
    double reach_m = 0;                  ///< of its farthest point from its centre
    double mass = 0;                     ///< 0: its motion is given
    Vec3 centre = Vec3::Zero();          ///< of mass, in its own frame
    Mat3 inertia = Mat3::Identity();     ///< about the centre, its own axes
    ToolCoupling coupling;               ///< with the defaults filled in

    // Everything that moves.
    Pose pose, target;
    Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero(), coupling_force = Vec3::Zero();

    // During a step: poses at its start and, with the velocity `reference`, at its end; of unknown colliders the velocity w (linear, spin) that the solve
    // corrects by dw: A dw = b + sum over contacts.
    Mat3 R0 = Mat3::Identity(), R1 = Mat3::Identity();
    Vec3 c0 = Vec3::Zero(), c1 = Vec3::Zero();
    Vec6 begin = Vec6::Zero(), from = Vec6::Zero(), w = Vec6::Zero(), dw = Vec6::Zero(), reference = Vec6::Zero();
    Vec6 impulse = Vec6::Zero();         ///< of the bodies that the step has done with
    Mat66 A = Mat66::Identity(), inverse = Mat66::Identity();
    Vec6 b = Vec6::Zero();
    bool capped_force = false, capped_torque = false;
    Vec3 force_at_cap = Vec3::Zero(), torque_at_cap = Vec3::Zero();
    std::vector<std::int32_t> row;       ///< of the island at work
    std::vector<const Vec3*> dv;         ///< [row] the velocity change there
    std::vector<solve::Mat36> block;     ///< [row] coupling of its contacts between island and collider

    /// All that moves, as numbers: snapshots, hashes.
    using Moving = std::array<double, 29>;
    Moving moving() const;
    void set_moving(const Moving& numbers);
    /// To where its definition puts it at a moment.
    void start_at(double time_s);
    bool unknown() const { return mass > 0; }
    Vec3 to_world0(const Vec3& p) const { return c0 + R0 * (p - centre); }
    Vec3 to_world1(const Vec3& p) const { return c1 + R1 * (p - centre); }
    Vec3 to_local0(const Vec3& p) const { return centre + R0.transpose() * (p - c0); }
    Vec3 to_local1(const Vec3& p) const { return centre + R1.transpose() * (p - c1); }
};

/// An attachment in a world.
struct Attachment {
    std::uint32_t generation = 0;        ///< 0: this slot is empty
    AttachmentDef def;
    std::int32_t corners = 0, others = 0;  ///< vertices in use, of the body and the other
    Vec3 anchor = Vec3::Zero();          ///< in the frame of the collider, or in the world
    Vec3 force = Vec3::Zero();
    std::int32_t broken = 0;

    template <class Points>
    Vec3 mean(const Points& p) const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < std::size_t(corners); ++i) sum += def.weights[i] * p[std::size_t(def.vertices[i])];
        return sum;
    }
    template <class Points>
    Vec3 other_mean(const Points& p) const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < std::size_t(others); ++i) sum += def.other_weights[i] * p[std::size_t(def.other_vertices[i])];
        return sum;
    }
};

}  // namespace supple
