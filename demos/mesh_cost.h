#pragma once
#include "supple/mesh/volume_mesh.h"

namespace supple::demos {

/// What a mesh will cost, estimated before it is simulated.
struct MeshCost {
    double memory_mb = 0;  ///< of a body with its template and solver
    double step_ms = 0;    ///< one implicit Euler step at 60 Hz, corotational tissue, one thread
};

/// Numbers per element and vertex measured with `supple run` on boxes of 10,000 to 170,000 elements (mesh_cost.cpp says how). Good to a
/// factor of two: stiffness, step and shape decide how many iterations the solver takes.
MeshCost estimate_cost(const VolumeMesh& mesh);

}  // namespace supple::demos
