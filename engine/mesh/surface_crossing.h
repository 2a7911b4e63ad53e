#pragma once
#include <map>
#include <span>
#include <vector>

#include "supple/mesh/triangle_mesh.h"

namespace supple::mesh {

/// Two surfaces that cross, cut into triangles of which none crosses the other surface: along their common lines both have the same points and edges.
///
/// Points are numbered together: the vertices of the first surface, those of the second, then what is new; one that lies on another (within the tolerance) has the number of the
/// smaller of the two, so vertices of the first never move.
struct CrossedSurfaces {
    struct Part {
        Triangle corner;         ///< points
        std::int32_t triangle;   ///< of its surface
    };
    std::vector<Vec3> point;                    ///< [point]
    std::vector<std::int32_t> second_vertex;    ///< [vertex of the second surface] its point
    std::vector<Part> first, second;            ///< parts of the triangles that were asked for: of each surface, in order
    std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::array<std::int32_t, 2>>> lines;  ///< [edge, its smaller point first] the pairs of triangles, of the first and the second, that cross there
};

/// @param chosen     triangles of the first surface, ascending: the others are not looked at
/// @param tolerance  [m] > 0: what lies nearer together is one; well below the lengths of the edges
CrossedSurfaces cross_surfaces(const TriangleMesh& first, std::span<const std::int32_t> chosen, const TriangleMesh& second, double tolerance);

}  // namespace supple::mesh
