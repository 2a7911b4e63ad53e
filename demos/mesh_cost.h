#pragma once
#include "supple/mesh/volume_mesh.h"

namespace supple::demos {

/// What a mesh will cost, estimated before it is simulated.
struct MeshCost {
    double memory_mb = 0;  ///< of a body with its template and solver
    double step_ms = 0;    ///< one implicit Euler step at 60 Hz, corotational tissue, one thread
};

/// From measurements of boxes and of real meshes (mesh_cost.cpp lists them). Good to a factor of two: stiffness, step and shape decide how many iterations the solver
/// takes, and a body that bends far takes more.
MeshCost estimate_cost(const VolumeMesh& mesh);

}  // namespace supple::demos
