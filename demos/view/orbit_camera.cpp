#include "view/orbit_camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple::demos::view {
namespace {

constexpr double kSteepest = 1.5;  // [rad] above or below the horizon: the line of sight must not meet the vertical

Vec3 right_of(const Camera& camera) { return (camera.target_m - camera.eye_m).cross(camera.up).normalized(); }

}  // namespace

void OrbitCamera::look(const Camera& camera) {
    require_legal(camera);
    camera_ = camera;
    camera_.up.normalize();
}

void OrbitCamera::orbit(double right_rad, double up_rad) {
    const Vec3 right = right_of(camera_);
    Vec3 back = camera_.eye_m - camera_.target_m;
    const double height = std::asin(std::clamp(back.normalized().dot(camera_.up), -1.0, 1.0));
    const double rise = std::clamp(height + up_rad, -kSteepest, kSteepest) - height;
    back = Eigen::AngleAxisd(-rise, right) * back;
    back = Eigen::AngleAxisd(right_rad, camera_.up) * back;
    camera_.eye_m = camera_.target_m + back;
}

void OrbitCamera::pan(double right, double up) {
    const Vec3 forward = camera_.target_m - camera_.eye_m, side = right_of(camera_);
    const double height_m = 2 * forward.norm() * std::tan(camera_.fov_deg * std::numbers::pi / 360);
    const Vec3 move = height_m * (right * side + up * side.cross(forward.normalized()));
    camera_.eye_m += move;
    camera_.target_m += move;
}

void OrbitCamera::zoom(double factor) {
    const Vec3 back = camera_.eye_m - camera_.target_m;
    camera_.eye_m = camera_.target_m + std::clamp(factor, 0.01, 100.0) * back;
}

void OrbitCamera::frame(const SceneBounds& bounds, double aspect) {
    camera_ = frame_camera(bounds, camera_.eye_m - camera_.target_m, camera_.fov_deg, std::clamp(aspect, 0.1, 10.0), camera_.up);
}

}  // namespace supple::demos::view
