#pragma once
#include <functional>
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
    TriangleMesh surface;                  ///< walls last
    std::vector<std::array<Lip, 2>> lips;  ///< [triangle] the one that its normal points away from, then the one that it points into
    std::size_t faces = 0;                 ///< triangles that are no walls
    double size = 0;                       ///< mean edge of the faces [m], 0 without any
};

/// @param boundary, parent  of the edited mesh: extract_boundary(), boundary_parents()
/// @param x                 [vertex of it] where it lies: at rest, but for lips of earlier edits, which are apart
/// @param on_lip            [triangle of boundary] 1: of such a lip
/// @param height            of the walls at a point of the old boundary [m], given the mean edge of the faces; there are none on earlier lips
OpenedSurface opened_surface(const MeshEdit& edit, const BoundarySurface& boundary, std::span<const std::int32_t> parent, std::span<const Vec3> x, std::span<const char> on_lip,
                             const std::function<double(const Vec3& at, double edge)>& height);

/// Corners of the face of an element that three of its vertices lie on; none if they do not lie on one.
std::vector<std::int32_t> face_corners(const VolumeMesh& mesh, std::int32_t element, const Triangle& t);

}  // namespace supple::mesh
