#pragma once
#include <Eigen/Geometry>

#include "supple/render/camera.h"
#include "view/tool.h"

namespace supple::demos::view {

/// The part of the window that shows the scene, in the units of the cursor, from the window's upper left corner.
struct Viewport {
    float x = 0, y = 0, width = 1, height = 1;

    bool contains(float px, float py) const { return px >= x && py >= y && px < x + width && py < y + height; }
    double aspect() const { return double(width) / double(height); }

    /// What a cursor at (px, py) points at.
    Pointer pointer(const Camera& camera, float px, float py) const {
        const CameraRay ray = camera_ray(camera, double(px - x) / double(width), double(py - y) / double(height), aspect());
        Pointer p;
        p.ray = {ray.origin_m, ray.direction};
        p.forward = (camera.target_m - camera.eye_m).normalized();
        p.right = p.forward.cross(camera.up).normalized();
        return p;
    }
};

}  // namespace supple::demos::view
