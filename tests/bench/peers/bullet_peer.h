#pragma once
#include <memory>

#include "peer.h"

namespace supple::peers {

/// Bullet's btDeformable: corotated linear elasticity, backward Euler with one Newton iteration, conjugate gradients preconditioned by the
/// mass, held vertices by projection; float32, one thread. Collisions and sleeping are off.
std::unique_ptr<Peer> make_bullet(const Problem& problem);

}  // namespace supple::peers
