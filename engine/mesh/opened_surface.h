#pragma once
#include <span>
#include <vector>

#include "supple/mesh/mesh_edit.h"
#include "supple/mesh/surface.h"

namespace supple::mesh {

/// The faces that an edit laid open, each once though it may be two lips, and walls that go on from where they reach the old boundary, outward: for surfaces near the boundary.
struct OpenedSurface {
    struct Lip {
        std::int32_t element = -1;                        ///< of the edited mesh; -1: what was there is gone
        std::array<std::int32_t, 3> vertex{-1, -1, -1};   ///< [corner] of the edited mesh; at the outer end of a wall its count more than where the wall begins
    };
    TriangleMesh surface;                  ///< at rest; walls last
    std::vector<std::array<Lip, 2>> lips;  ///< [triangle] the one that its normal points away from, then the one that it points into
    std::size_t faces = 0;                 ///< triangles that are no walls
    double size = 0;                       ///< mean edge of the faces [m], 0 without any
};

/// @param boundary, parent  of the edited mesh: extract_boundary(), boundary_parents()
/// @param height            of the walls, in mean edges
OpenedSurface opened_surface(const MeshEdit& edit, const BoundarySurface& boundary, std::span<const std::int32_t> parent, double height);

}  // namespace supple::mesh
