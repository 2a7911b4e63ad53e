#include "supple/render/stage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "supple/base/error.h"

namespace supple::render {

using Eigen::Matrix4f;
using Eigen::Vector3f;
using Eigen::Vector4f;

namespace {

Matrix4f look_along(const Vector3f& eye, const Vector3f& forward, const Vector3f& right, const Vector3f& above) {
    Matrix4f m = Matrix4f::Identity();
    m.row(0).head<3>() = right;
    m.row(1).head<3>() = above;
    m.row(2).head<3>() = -forward;
    m.block<3, 1>(0, 3) = -m.block<3, 3>(0, 0) * eye;
    return m;
}

Vector4f extended(const Vector3f& v, float w) { return {v.x(), v.y(), v.z(), w}; }

/// 1, 2 or 5 times a power of ten, not below `least`.
double round_spacing(double least) {
    const double power = std::pow(10.0, std::floor(std::log10(least)));
    for (const double digit : {1.0, 2.0, 5.0})
        if (digit * power >= least) return digit * power;
    return 10 * power;
}

}  // namespace

Stage::Stage(const FrameView& view, const SceneFrame& frame, const Vector3f& low, const Vector3f& high, float aspect, int shadow_size) {
    eye = frame.point(view.camera.eye_m);
    forward = -eye.normalized();
    const Vector3f unit_right = frame.camera_right, unit_above = unit_right.cross(forward);
    const float half = std::tan(float(view.camera.fov_deg * std::numbers::pi / 360));
    right = unit_right * half * aspect;
    above = unit_above * half;

    if (view.ground_height_m) {
        if (!std::isfinite(*view.ground_height_m))
            throw Error(ErrorCode::invalid_argument, "FrameView.ground_height_m", "is not finite; leave it empty for no ground");
        ground_height = frame.length(*view.ground_height_m - view.camera.target_m.dot(view.camera.up.normalized()));
        has_ground = eye.y() > ground_height;
        grid_spacing = frame.length(round_spacing(0.16 / frame.scale_1_m));
    }

    // Near and far: as tight as the scene allows, for the sake of the depth buffer.
    const Vector3f middle = 0.5f * (low + high);
    const float radius = 0.5f * (high - low).norm(), away = (eye - middle).norm();
    float near_plane = std::max(0.6f * (away - radius), 0.004f * (away + radius));
    float far_plane = 1.05f * (away + radius);
    if (has_ground) {
        near_plane = std::min(near_plane, std::max(0.5f * (eye.y() - ground_height), 0.004f));
        far_plane = std::max(far_plane, 1.5f * ground_radius + 1 + (eye.y() - ground_height));
    }
    Matrix4f projection = Matrix4f::Zero();
    projection(0, 0) = 1 / (half * aspect);
    projection(1, 1) = 1 / half;
    projection(2, 2) = -(far_plane + near_plane) / (far_plane - near_plane);
    projection(2, 3) = -2 * far_plane * near_plane / (far_plane - near_plane);
    projection(3, 2) = -1;
    view_projection = projection * look_along(eye, forward, unit_right, unit_above);

    place_lights(view, frame);
    fit_shadow(low, high, shadow_size);
}

void Stage::place_lights(const FrameView& view, const SceneFrame& frame) {
    // The set of lights turns with the camera's heading but stays upright.
    const Vector3f up = Vector3f::UnitY(), side = frame.camera_right;
    const Vector3f back = side.cross(up).normalized();  // level, from the target towards the eye
    if (view.key_light) {
        if (!view.key_light->allFinite() || !(view.key_light->norm() > 0))
            throw Error(ErrorCode::invalid_argument, "FrameView.key_light", "must be a finite direction towards the light, not zero");
        to_key = frame.direction(view.key_light->normalized());
    } else {
        to_key = (-0.62f * side + 1.15f * up + 0.55f * back).normalized();
    }
    // The fill comes from the other side, the rim from behind, opposite the key.
    const Vector3f level_key = Vector3f(to_key.x(), 0, to_key.z());
    to_fill = (0.9f * side + 0.25f * up + 0.6f * back).normalized();
    if (to_fill.dot(level_key) > 0.3f * level_key.norm()) to_fill = (-0.9f * side + 0.25f * up + 0.6f * back).normalized();
    to_rim = (0.45f * side + 0.55f * up - 1.0f * back).normalized();
}

void Stage::fit_shadow(const Vector3f& low, const Vector3f& high, int shadow_size) {
    // The sphere around the casters. Its radius moves in steps and its middle from texel to texel, so that the edges of shadows do not
    // crawl.
    const float exact = std::max(0.5f * (high - low).norm(), 1e-6f) * 1.03f;
    light_radius = std::exp2(std::ceil(std::log2(exact) * 4) / 4);
    const Vector3f u = to_key.unitOrthogonal(), v = to_key.cross(u);
    const float texel = 2 * light_radius / float(shadow_size);
    const Vector3f middle = 0.5f * (low + high);
    const auto snap = [&](const Vector3f& axis) { return std::round(middle.dot(axis) / (2 * texel)) * 2 * texel; };
    const Vector3f centre = snap(u) * u + snap(v) * v + middle.dot(to_key) * to_key;
    to_light = Matrix4f::Identity();
    to_light.row(0) = extended(u, -u.dot(centre)) / light_radius;
    to_light.row(1) = extended(v, -v.dot(centre)) / light_radius;
    to_light.row(2) = extended(-to_key, to_key.dot(centre)) / light_radius;
}

Vector3f Stage::ground_depth() const {
    // Three corners of the map, followed along the light to the ground: depth is affine in u and v.
    const Matrix4f from_light = to_light.inverse();
    const auto depth = [&](float u, float v) {
        const Vector3f on_near = (from_light * Vector4f(2 * u - 1, 2 * v - 1, -1, 1)).head<3>();
        const float along = (on_near.y() - ground_height) / std::max(to_key.y(), 1e-3f);
        return along / (2 * light_radius);
    };
    return {depth(0, 0), depth(1, 0) - depth(0, 0), depth(0, 1) - depth(0, 0)};
}

FrameUniforms Stage::uniforms(int picture_height, int shadow_size, int ground_shadow_size) const {
    FrameUniforms f;
    f.view_projection = view_projection;
    Matrix4f to_unit = Matrix4f::Identity();
    to_unit.diagonal().head<3>().setConstant(0.5f);
    to_unit.block<3, 1>(0, 3).setConstant(0.5f);
    f.shadow_matrix = to_unit * to_light;
    f.sight = extended(forward, 1 - 1 / std::sqrt(1 + right.squaredNorm() + above.squaredNorm()));
    f.eye = extended(eye, 0.5f * float(picture_height) / above.norm());
    f.key_direction = extended(to_key, 2 * light_radius);
    f.fill_direction = extended(to_fill, 0);
    f.rim_direction = extended(to_rim, 0);
    f.ground = {ground_height, has_ground ? 1.0f : 0.0f, ground_radius, grid_spacing};
    f.ground_occlusion.setZero();
    f.shadow_texel = {2 * light_radius / float(shadow_size), 1.0f / float(shadow_size), 0.10f, 1.0f / float(ground_shadow_size)};
    return f;
}

}  // namespace supple::render
