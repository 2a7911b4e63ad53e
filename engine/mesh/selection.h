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
/// The points nearer than radius_m to the segment from a_m to b_m.
struct InsideCapsule {
    Vec3 a_m, b_m;
    double radius_m;
};
struct VertexList {
    std::vector<std::int32_t> vertices;
};
struct InGroup {
    std::string name;  ///< a vertex group or a region (its vertices)
};
/// Elements by number, tets first; taken whole, and the vertices of them.
struct ElementList {
    std::vector<std::int32_t> elements;
};
struct Everything {};

/// Which vertices a support, motion or load acts on; boxes, spheres and capsules are closed and look at rest positions.
using Selection = std::variant<Everything, InsideBox, InsideSphere, VertexList, InGroup, InsideCapsule, ElementList>;

/// Which elements a selection takes: those with all their vertices selected, or those whose centre lies in the box, sphere or capsule (thin shapes, painted
/// regions). InGroup with a region's name is the region's elements in both
/// cases, an ElementList its own.
enum class ElementRule { all_vertices, centre };

/// Selected vertex ids, ascending, no duplicates. A vertex or element list out of range or an unknown group is an Error that names the known groups.
std::vector<std::int32_t> select_vertices(const VolumeMesh& mesh, const Selection& selection);

/// Selected elements, ascending.
/// @error as select_vertices(); Error(invalid_argument) for ElementRule::centre with a vertex list or group, which have no inside
std::vector<std::int32_t> select_elements(const VolumeMesh& mesh, const Selection& selection, ElementRule rule = ElementRule::all_vertices);

}  // namespace supple
