#pragma once
#include <array>

#include "supple/mesh/volume_mesh.h"

namespace supple {

/// The eight parts of a regularly refined tet, each with four corners that lie half-way between two corners of the tet (a corner itself: twice the same).
/// The octahedron in the middle is cut along the diagonal from the middle of edge 02 to that of 13 (Bey 1995, "Tetrahedral grid refinement", Computing 55):
/// refined again and again, a tet has descendants of three shapes at most. All parts are wound like the tet and have an eighth of its volume.
inline constexpr std::array<std::array<std::array<int, 2>, 4>, 8> kTetParts{{
    {{{0, 0}, {0, 1}, {0, 2}, {0, 3}}},
    {{{0, 1}, {1, 1}, {1, 2}, {1, 3}}},
    {{{0, 2}, {1, 2}, {2, 2}, {2, 3}}},
    {{{0, 3}, {1, 3}, {2, 3}, {3, 3}}},
    {{{0, 1}, {0, 2}, {0, 3}, {1, 3}}},
    {{{0, 1}, {1, 2}, {0, 2}, {1, 3}}},
    {{{0, 2}, {0, 3}, {1, 3}, {2, 3}}},
    {{{0, 2}, {1, 3}, {1, 2}, {2, 3}}},
}};

/// Cuts every tet and every hex into eight, `times` over: the parts of element e are elements 8 e .. 8 e + 7 among their kind. Old vertices keep their numbers. Regions
/// and fill are inherited; a new vertex belongs to a vertex group if all the vertices that it lies between do. Faces stay conforming, between tets and hexes as
/// they were. O(n log n), deterministic.
/// @param times  0..10
/// @error Error(invalid_argument) for another `times`, or a result of more than 2^28 elements
VolumeMesh refine(const VolumeMesh& mesh, int times = 1);

}  // namespace supple
