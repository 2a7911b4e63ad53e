#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/function_ref.h"
#include "supple/mesh/volume_mesh.h"

namespace supple {

/// Faces of a tet, outward counter-clockwise; face f lies opposite vertex f.
inline constexpr std::array<std::array<int, 3>, 4> kTetFaces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// Faces of a hex in VTK order, outward counter-clockwise: bottom, top, then the four sides.
inline constexpr std::array<std::array<int, 4>, 6> kHexFaces{
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

/// The twelve edges of a hex in VTK order.
inline constexpr std::array<std::array<int, 2>, 12> kHexEdges{
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

/// One side of a face: half-faces are numbered element by element, four per tet, then six per hex.
using HalfFace = std::uint32_t;

/// A half-face with its vertices, outward counter-clockwise.
struct Face {
    std::int32_t element = -1;
    int corners = 3;                                       ///< 3 or 4
    std::array<std::int32_t, 4> vertices{-1, -1, -1, -1};  ///< the fourth is -1 for a triangle
};

/// Number of half-faces of a mesh. @error Error(unsupported) beyond 2^32 - 1
HalfFace half_face_count(const VolumeMesh& mesh);

Face half_face(const VolumeMesh& mesh, HalfFace h);

/// Calls visit once per geometric face (vertex set) with its half-faces, ascending: one on the boundary, two inside, more where
/// elements overlap. Order of the calls: by smallest vertex, then the others. O(n log k), k the faces at a vertex.
/// @pre vertex indices in range
void for_each_face(const VolumeMesh& mesh, FunctionRef<void(std::span<const HalfFace>)> visit);

}  // namespace supple
