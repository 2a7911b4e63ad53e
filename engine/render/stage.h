#pragma once
#include "supple/render/scene_frame.h"

namespace supple::render {

/// The uniform block `Frame` of shaders/frame.glsl (std140), field by field.
struct FrameUniforms {
    Eigen::Matrix4f view_projection, shadow_matrix;
    Eigen::Vector4f sight, eye, key_direction, fill_direction, rim_direction, ground, ground_occlusion, shadow_texel;
};

/// Camera, lights and shadow frustum of one picture, in scene units.
struct Stage {
    Eigen::Vector3f eye, forward, right, above;  ///< right and above reach the border of the picture at distance 1
    Eigen::Vector3f to_key, to_fill, to_rim;
    Eigen::Matrix4f view_projection, to_light;  ///< to_light: clip space of the shadow map
    float light_radius = 1;                     ///< half width of the shadow map

    /// @param low, high  bounds of all that casts a shadow
    Stage(const FrameView& view, const SceneFrame& frame, const Eigen::Vector3f& low, const Eigen::Vector3f& high, float aspect,
          int shadow_size);

    FrameUniforms uniforms(int picture_height, int shadow_size, int ground_shadow_size) const;
    bool has_ground = false;  ///< there is one, and the eye is above it
    float ground_height = 0;
    float ground_radius = 4.5f;  ///< where light and shadow on it fade out
    float grid_spacing = 0;      ///< 0: no grid

    /// Depth of the ground in the shadow map: x + y u + z v.
    Eigen::Vector3f ground_depth() const;

private:
    void place_lights(const FrameView& view, const SceneFrame& frame);
    void fit_shadow(const Eigen::Vector3f& low, const Eigen::Vector3f& high, int shadow_size);
};

}  // namespace supple::render
