#pragma once
#include <vector>

#include "supple/contact/shape_surface.h"
#include "supple/render/frame_view.h"
#include "supple/world/world.h"

namespace supple::demos {

/// The colliders of a world as surfaces of a frame. Views borrow from it until the next call.
class ColliderView {
public:
    /// @param alpha  0 = before the last step, 1 = after it
    /// @param size_m, centre  of the scene. A level plane that looks up is not drawn: the ground of the view stands for it
    void add(const World& world, double alpha, const Vec3& up, double size_m, const Vec3& centre, FrameView& view);

private:
    struct Drawn {
        ColliderId id;
        contact::ShapeSurface local;
        std::vector<Vec3> positions;
    };
    std::vector<Drawn> drawn_;
};

/// An arrow for every contact: force on the body; `per_n` metres for a newton.
void add_contact_arrows(const World& world, double per_n, FrameView& view);

}  // namespace supple::demos
