#pragma once
#include <string>
#include <vector>

#include "supple/mesh/triangle_mesh.h"

namespace supple::mesh {

/// What check_surface() found; nothing is changed.
struct SurfaceReport {
    std::size_t degenerate_triangles = 0;   ///< with a repeated vertex, or of area <= 1e-12 x (longest edge)^2
    std::size_t duplicate_triangles = 0;    ///< with the vertices of an earlier one
    std::size_t unreferenced_vertices = 0;  ///< of no triangle
    std::size_t duplicate_vertices = 0;     ///< at the very position of an earlier one
    std::size_t open_edges = 0;             ///< of one triangle alone: rims of holes
    std::size_t crowded_edges = 0;          ///< of more than two triangles: not a manifold
    std::size_t turned_edges = 0;           ///< of two triangles that run along it the same way: one of them faces wrongly
    std::size_t pinched_vertices = 0;       ///< whose triangles form more than one fan
    std::size_t components = 0;             ///< parts joined by edges
    double area_m2 = 0;
    double volume_m3 = 0;  ///< enclosed, signed: negative where the triangles face inwards; of no meaning unless closed
    Vec3 min_m = Vec3::Zero(), max_m = Vec3::Zero();  ///< of the vertices that triangles use

    /// Without a rim, every edge between two triangles that agree on which side is out.
    bool is_closed() const { return open_edges == 0 && crowded_edges == 0 && turned_edges == 0; }
    /// Plain sentences, one per finding; empty for a closed surface without faults.
    std::vector<std::string> sentences() const;
};

/// Refuses indices out of range and coordinates that are not finite. @error Error(invalid_argument)
void require_sound(const TriangleMesh& mesh);

/// Degenerate triangles count as such and for their edges. O(n log n).
/// @error Error(invalid_argument) where an index is out of range, or a coordinate is not finite
SurfaceReport check_surface(const TriangleMesh& mesh);

}  // namespace supple::mesh
