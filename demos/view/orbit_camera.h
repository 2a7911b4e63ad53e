#pragma once
#include "supple/render/camera.h"

namespace supple::demos::view {

/// A camera that a hand turns around a point, the vertical staying vertical.
class OrbitCamera {
public:
    /// Takes over from another camera. `up` of that one is the vertical from now on.
    void look(const Camera& camera);
    void orbit(double right_rad, double up_rad);
    /// Moves sideways, in heights of the picture at the target's distance.
    void pan(double right, double up);
    /// Nearer by a factor below 1, farther above.
    void zoom(double factor);
    /// Shows all of the bounds from where it looks.
    void frame(const SceneBounds& bounds, double aspect);

    const Camera& camera() const { return camera_; }

private:
    Camera camera_;
};

}  // namespace supple::demos::view
