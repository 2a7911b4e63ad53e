#pragma once
#include "supple/mesh/volume_mesh.h"

namespace supple {

struct ManifoldReport {
    std::size_t split_vertices = 0;  ///< vertices appended (copies) to part tets that shared only a vertex or an edge
    std::size_t removed_tets = 0;
};

/// Makes the boundary of a tet mesh a closed 2-manifold: every boundary edge has two triangles, and the triangles at every boundary
/// vertex form one fan. Parts that hang together by a vertex or an edge only are taken apart; where a boundary touches itself
/// within one part, tets go: the smaller fan at an edge, the shortest chain between two fans at a vertex (it opens the pinch).
/// Tets keep their order. O(n log n) per round, few rounds.
/// @pre mesh.hexes, regions and groups are empty; tets wound positively, indices in range
ManifoldReport make_boundary_manifold(VolumeMesh& mesh);

/// Removes the vertices that no tet uses and renumbers; keeps the order. Groups and hexes must be empty.
void drop_unused_vertices(VolumeMesh& mesh);

}  // namespace supple
