#pragma once
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple::mesh {

/// A surface of triangles, counter-clockwise from outside where it is closed; it may have holes, cross itself or hold several parts.
struct TriangleMesh {
    std::vector<Vec3> vertices;       ///< [m]
    std::vector<Triangle> triangles;  ///< three indices into vertices each
};

}  // namespace supple::mesh
