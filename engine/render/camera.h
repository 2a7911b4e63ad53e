#pragma once
#include "supple/render/frame_view.h"

namespace supple {

struct SceneBounds {
    Vec3 min_m = Vec3::Constant(1e300), max_m = Vec3::Constant(-1e300);

    bool empty() const { return !(min_m.array() <= max_m.array()).all(); }
    void include(const Vec3& p) {
        min_m = min_m.cwiseMin(p);
        max_m = max_m.cwiseMax(p);
    }
};

/// Box of the points, e.g. world.positions(body); empty bounds for no points.
SceneBounds bounds_of(std::span<const Vec3> points);

/// A camera that looks at the middle of the bounds and shows the sphere around them with a small margin.
/// @param direction  from the target towards the eye, any length but zero
/// @param fov_deg    vertical, 1..170
/// @param aspect     width / height of the picture
/// @error Error(invalid_argument) for empty or not finite bounds, a zero direction, a direction along `up`, fov or aspect out of range
Camera frame_camera(const SceneBounds& bounds, const Vec3& direction, double fov_deg = 40, double aspect = 16.0 / 9,
                    const Vec3& up = Vec3(0, 1, 0));

struct CameraRay {
    Vec3 origin_m, direction;  ///< direction has length 1
};

/// The ray through a point of the picture: x from the left, y from the top, both 0..1. For picking.
/// @error Error(invalid_argument) for a camera that require_legal refuses
CameraRay camera_ray(const Camera& camera, double x, double y, double aspect);

/// @error Error(invalid_argument) unless eye and target differ, up is not along the line of sight, all is finite and fov_deg is in 1..170
void require_legal(const Camera& camera);

}  // namespace supple
