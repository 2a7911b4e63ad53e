#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "supple/base/id.h"
#include "supple/contact/shape.h"
#include "supple/world/loads.h"

namespace supple {

using ColliderId = Id<struct ColliderTag>;

enum class ColliderMotion {
    fixed,      ///< stays where it is put
    kinematic,  ///< follows its target or its keyframes whatever is in its way
    tool,       ///< has a mass and is drawn to its target by a spring whose force is limited: a hand, a haptic device
    dynamic,    ///< has a mass; moved by gravity and by the soft bodies it touches
};

/// Where a collider is told to be. Linear between the entries (rotations along the shortest arc), constant before the first and after the last.
struct PoseKeys {
    std::vector<double> times_s{};                         ///< strictly ascending
    std::vector<Vec3> positions_m{};                       ///< as many; empty: the definition's position
    std::vector<std::array<double, 4>> rotations_wxyz{};   ///< as many; empty: the definition's rotation

    std::size_t size() const { return times_s.size(); }
    Pose at(double time_s, const Pose& otherwise) const;   ///< `otherwise` has the definition's pose
};

/// What draws a tool to its target: force = stiffness (target - position) - damping (velocity), of at most max_force_n, and likewise about its centre.
struct ToolCoupling {
    double stiffness_n_m = 500;      ///< (0, 1e9]
    double damping_n_s_m = 0;        ///< [0, 1e9]; 0: critical for the tool's mass
    double max_force_n = 0;          ///< 0: no limit
    double torsion_nm_rad = 0;       ///< (0, 1e9]; 0: stiffness times the square of the radius of gyration
    double max_torque_nm = 0;        ///< 0: no limit
};

/// A rigid solid that soft bodies touch. Rigid ones do not touch one another: that is the host's rigid engine's part.
struct ColliderDef {
    std::string name{};              ///< for messages; "collider <index>" if empty
    Shape shape = PlaneShape{};
    Pose pose{};
    double friction = 0.3;           ///< Coulomb's coefficient, [0, 10]
    ColliderMotion motion = ColliderMotion::fixed;
    PoseKeys keys{};                 ///< of a kinematic collider or a tool: its target over simulated time
    double mass_kg = 0;              ///< of a tool or a dynamic one, > 0; spread evenly through the shape
    Vec3 velocity_m_s = Vec3::Zero(), spin_rad_s = Vec3::Zero();  ///< of a dynamic one at the start
    ToolCoupling coupling{};         ///< of a tool
};

struct ColliderState {
    Pose pose{};
    Vec3 velocity_m_s = Vec3::Zero();   ///< of its centre of mass (of its origin where it has no mass)
    Vec3 spin_rad_s = Vec3::Zero();
    Vec3 force_n = Vec3::Zero();        ///< of all soft bodies on it, in the last step
    Vec3 torque_nm = Vec3::Zero();      ///< of these, about its centre of mass (its origin)
    Vec3 coupling_force_n = Vec3::Zero();  ///< of a tool's spring on it: what a hand feels is the opposite
    Pose target{};                      ///< of a tool or a kinematic one
};

/// A contact that pressed in the last step. Forces act on the body; the collider, or the other body, takes the opposite.
struct ContactPoint {
    BodyId body;
    ColliderId collider;                   ///< none: another body, or the body itself
    BodyId other;                          ///< none: a collider
    std::int32_t other_triangle = -1;      ///< of the other's boundary
    std::array<double, 3> other_barycentric{};
    std::int32_t triangle = -1;            ///< of BodyTemplate::boundary()
    std::array<double, 3> barycentric{};   ///< of the point in it
    Vec3 position_m = Vec3::Zero();        ///< of the body's surface
    Vec3 normal = Vec3::Zero();            ///< unit, out of the collider or the other body
    double depth_m = 0;                    ///< how far the surface is inside
    double normal_force_n = 0;             ///< along the normal
    Vec3 friction_force_n = Vec3::Zero();  ///< across it
};

}  // namespace supple
