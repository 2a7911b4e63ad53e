#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "supple/render/frame_view.h"

namespace supple::render {

/// Where a picture is drawn: origin at the camera's target, y along its up, the eye at distance 1. Numbers are then of one size for a cell
/// and for a bridge, and float is enough wherever the scene stands.
struct SceneFrame {
    Vec3 origin_m = Vec3::Zero();
    Mat3 axes = Mat3::Identity();  ///< rows: the scene's x, y, z
    double scale_1_m = 1;          ///< scene units per metre

    explicit SceneFrame(const Camera& camera) : origin_m(camera.target_m) {
        const Vec3 up = camera.up.normalized(), back = camera.eye_m - camera.target_m;
        const Vec3 right = up.cross(back).normalized();
        // The axes must not turn with the camera, or the grid on the ground would: take the world axis that is farthest from up.
        Vec3 x = std::abs(up.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitZ();
        x = (x - up * up.dot(x)).normalized();
        axes.row(0) = x;
        axes.row(1) = up;
        axes.row(2) = x.cross(up);
        scale_1_m = 1 / back.norm();
        camera_right = direction(right);
    }

    Eigen::Vector3f point(const Vec3& p) const { return (axes * (p - origin_m) * scale_1_m).cast<float>(); }
    Eigen::Vector3f direction(const Vec3& d) const { return (axes * d).cast<float>(); }
    float length(double metres) const { return float(metres * scale_1_m); }

    Eigen::Vector3f camera_right{1, 0, 0};
};

}  // namespace supple::render
