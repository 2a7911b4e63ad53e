#include "framing.h"

#include <cmath>

#include <Eigen/Geometry>

namespace supple::demos {

SceneBounds bounds_of(const World& world) {
    SceneBounds all;
    for (const BodyId body : world.bodies())
        for (const Vec3& x : world.positions(body)) all.include(x);
    if (all.empty()) {
        all.include(Vec3::Constant(-0.5));
        all.include(Vec3::Constant(0.5));
    }
    return all;
}

Vec3 up_direction(const World& world) {
    const Vec3 g = world.def().gravity_m_s2;
    return g.norm() > 0 ? Vec3(-g.normalized()) : Vec3(0, 1, 0);
}

Camera frame_bodies(const World& world) {
    const SceneBounds bounds = bounds_of(world);
    const Vec3 up = up_direction(world);
    const Vec3 size = bounds.max_m - bounds.min_m;
    // Look along the shorter horizontal extent, a little from the side and from above.
    const Vec3 a = up.unitOrthogonal(), b = up.cross(a);
    const Vec3 front = std::abs(a.dot(size)) < std::abs(b.dot(size)) ? a : b;
    return frame_camera(bounds, front + 0.45 * up.cross(front) + 0.35 * up, 38, 16.0 / 9, up);
}

}  // namespace supple::demos
