#pragma once
#include <optional>
#include <span>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple {

/// The boundary of a volume mesh: the faces that one element alone has (quads as two triangles), outward counter-clockwise.
struct BoundarySurface {
    std::vector<Triangle> triangles;                 ///< vertex ids of the volume mesh, in the order of their elements
    std::vector<std::int32_t> element;               ///< per triangle: the element it bounds
    std::vector<std::array<std::int32_t, 2>> edges;  ///< edges of the boundary faces, each once, no diagonals of quads: wireframes;
                                                     ///< ascending, the smaller vertex first
};

/// A quad is cut through its smallest vertex. O(n log n), deterministic. Expects a mesh that passed check_and_repair().
BoundarySurface extract_boundary(const VolumeMesh& mesh);
/// The same of half-faces (mesh/topology.h) that are known to be of one element alone, ascending. O(n).
BoundarySurface boundary_of(const VolumeMesh& mesh, std::span<const std::uint32_t> half_faces);

struct Ray {
    Vec3 origin = Vec3::Zero();
    Vec3 direction = Vec3(0, 0, -1);  ///< any length but zero
};

struct RayHit {
    std::int32_t triangle = -1;  ///< index into BoundarySurface::triangles
    std::array<double, 3> barycentric{};
    double distance = 0;  ///< in lengths of ray.direction
};

/// First front- or back-facing triangle hit at the given positions; linear scan. Watertight: a ray never slips between two
/// triangles that share an edge or a vertex. Edge-on and non-finite triangles are passed over; of equal distances the lowest
/// index wins.
/// @error Error(invalid_argument) for a zero or non-finite direction, a non-finite origin or a vertex id out of range
std::optional<RayHit> intersect(const Ray& ray, std::span<const Triangle> triangles, std::span<const Vec3> positions);

}  // namespace supple
