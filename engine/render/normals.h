#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple::render {

/// A surface cut open along its crisp edges: a vertex on a crease becomes one corner for each smooth side.
struct SmoothTopology {
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of corners
    std::vector<std::int32_t> vertex_of;                  ///< corner -> vertex of the user; vertices of no triangle have no corner
    struct Edge {
        std::int32_t a, b;             ///< vertices of the user
        std::int32_t triangle, other;  ///< other is -1 on a border
        bool crisp;
    };
    bool closed = false;      ///< no edge is a border: only the outside can be seen
    std::vector<Edge> edges;  ///< each edge once (an edge of more than two triangles: once per pair)
};

/// @param positions          per vertex [m], the shape whose angles decide
/// @param crease_angle_deg   0..180: edges whose faces turn by more than this are crisp. Faces without area turn by nothing.
/// @param inner              per triangle, or empty: edges between triangles of different values are crisp, too
/// A closed surface that is wound inwards (its volume is negative) is turned, so that its outside is drawn.
/// @error none; the indices are checked by the caller
SmoothTopology split_at_creases(std::span<const Vec3> positions, std::span<const Triangle> triangles, double crease_angle_deg, std::span<const char> inner = {});

/// Unit normals per corner, weighted so that they are exact for vertices on a sphere: each face adds (e1 x e2) / (|e1|^2 |e2|^2).
/// A corner whose faces all vanish gets (0, 1, 0).
/// @param positions  per corner, any unit
/// @source N. Max, "Weights for computing vertex normals from facet normals", J. Graphics Tools 4(2), 1999
void compute_normals(const SmoothTopology& topology, std::span<const Eigen::Vector3f> positions, std::vector<Eigen::Vector3f>& normals);

}  // namespace supple::render
