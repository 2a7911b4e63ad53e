#pragma once
#include "supple/render/camera.h"
#include "supple/world/world.h"

namespace supple::demos {

/// Of all bodies of the world as they are now; a unit cube where there are none.
SceneBounds bounds_of(const World& world);

/// Against gravity; +y in free space.
Vec3 up_direction(const World& world);

/// A calm three-quarter view of all bodies.
Camera frame_bodies(const World& world);

}  // namespace supple::demos
