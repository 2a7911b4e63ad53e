#pragma once
#include <array>
#include <cstdint>

#include "supple/base/id.h"
#include "supple/world/collider.h"

namespace supple {

using AttachmentId = Id<struct AttachmentTag>;

/// Ties a point of a body to a place in the world, to a collider or to another body: the two pull one another, whichever way they move.
struct AttachmentDef {
    BodyId body{};
    std::array<std::int32_t, 4> vertices{-1, -1, -1, -1};  ///< one vertex, or up to four that `weights` average; -1 behind them
    std::array<double, 4> weights{1, 0, 0, 0};             ///< of the point, sum to one
    ColliderId collider{};                                 ///< none: the world. Of any motion: what yields is pulled
    BodyId other{};                                        ///< in place of a collider: another body
    std::array<std::int32_t, 4> other_vertices{-1, -1, -1, -1};  ///< its point, as above; none: where the body's point is now, in or beside its nearest element
    std::array<double, 4> other_weights{1, 0, 0, 0};
    bool at_point = true;                                  ///< tied where the point is now; otherwise to anchor_m (not with `other`)
    Vec3 anchor_m = Vec3::Zero();                          ///< in the world, now
    double stiffness_n_m = 0;                              ///< (0, 1e12]; 0: hard, a thousand times what the vertices weigh against a force over one step
    double max_force_n = 0;                                ///< it breaks above; 0: never
};

struct AttachmentState {
    Vec3 point_m = Vec3::Zero();   ///< of the body
    Vec3 anchor_m = Vec3::Zero();  ///< where it is tied to, in the world
    Vec3 force_n = Vec3::Zero();   ///< on the body in the last step; in the step in which it broke, the one that broke it
    bool broken = false;           ///< it pulls no more; detach() forgets it
};

}  // namespace supple
