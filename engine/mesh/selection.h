#pragma once
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple {

struct InsideBox {
    Vec3 min_m, max_m;
};
struct InsideSphere {
    Vec3 centre_m;
    double radius_m;
};
struct VertexList {
    std::vector<std::int32_t> vertices;
};
struct InGroup {
    std::string name;  ///< a vertex group or a region (its vertices)
};
struct Everything {};

/// Which vertices a support, motion or load acts on; boxes and spheres are closed and look at rest positions.
using Selection = std::variant<Everything, InsideBox, InsideSphere, VertexList, InGroup>;

/// Selected vertex ids, ascending, no duplicates. A vertex list out of range or an unknown group is an Error that names the known groups.
std::vector<std::int32_t> select_vertices(const VolumeMesh& mesh, const Selection& selection);

/// Selected elements: those with all their vertices selected (InGroup with a region's name: the region's elements).
std::vector<std::int32_t> select_elements(const VolumeMesh& mesh, const Selection& selection);

}  // namespace supple
