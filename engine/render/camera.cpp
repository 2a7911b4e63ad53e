#include "supple/render/camera.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "supple/base/error.h"

namespace supple {
namespace {

double half_angle(double fov_deg) { return fov_deg * std::numbers::pi / 360; }

std::string text_of(const Vec3& v) { return "(" + to_text(v.x()) + ", " + to_text(v.y()) + ", " + to_text(v.z()) + ")"; }

}  // namespace

SceneBounds bounds_of(std::span<const Vec3> points) {
    SceneBounds bounds;
    for (const Vec3& p : points) bounds.include(p);
    return bounds;
}

void require_legal(const Camera& camera) {
    require_in_range(camera.fov_deg, 1, 170, "Camera.fov_deg", "40 is a calm angle");
    const Vec3 sight = camera.target_m - camera.eye_m;
    if (!sight.allFinite() || !(sight.norm() > 0))
        throw Error(ErrorCode::invalid_argument, "Camera.eye_m",
                    "eye " + text_of(camera.eye_m) + " and target " + text_of(camera.target_m) + " must be finite and differ");
    if (!camera.up.allFinite() || !(camera.up.cross(sight).norm() > 1e-6 * sight.norm() * camera.up.norm()))
        throw Error(
            ErrorCode::invalid_argument, "Camera.up",
            text_of(camera.up) + " must not be zero or lie along the line of sight " + text_of(sight) + "; tilt the camera a little");
}

Camera frame_camera(const SceneBounds& bounds, const Vec3& direction, double fov_deg, double aspect, const Vec3& up) {
    if (bounds.empty() || !bounds.min_m.allFinite() || !bounds.max_m.allFinite())
        throw Error(ErrorCode::invalid_argument, "frame_camera.bounds", "are empty or not finite; include() at least one point");
    if (!direction.allFinite() || !(direction.norm() > 0))
        throw Error(ErrorCode::invalid_argument, "frame_camera.direction",
                    text_of(direction) + " has no length; it points from the target to the eye");
    require_in_range(fov_deg, 1, 170, "frame_camera.fov_deg", "40 is a calm angle");
    require_in_range(aspect, 0.1, 10, "frame_camera.aspect", "it is width / height");
    Camera camera;
    camera.target_m = 0.5 * (bounds.min_m + bounds.max_m);
    camera.up = up;
    camera.fov_deg = fov_deg;
    const double radius = std::max(0.5 * (bounds.max_m - bounds.min_m).norm(), 1e-9);
    const double vertical = half_angle(fov_deg), horizontal = std::atan(aspect * std::tan(vertical));
    camera.eye_m = camera.target_m + direction.normalized() * (1.08 * radius / std::sin(std::min(vertical, horizontal)));
    require_legal(camera);
    return camera;
}

CameraRay camera_ray(const Camera& camera, double x, double y, double aspect) {
    require_legal(camera);
    const Vec3 forward = (camera.target_m - camera.eye_m).normalized();
    const Vec3 right = forward.cross(camera.up).normalized(), above = right.cross(forward);
    const double t = std::tan(half_angle(camera.fov_deg));
    return {camera.eye_m, (forward + (2 * x - 1) * t * aspect * right + (1 - 2 * y) * t * above).normalized()};
}

}  // namespace supple
