#pragma once
// Structured meshes of the cases: boxes whose vertices are mapped, and patches of them welded together.
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple::verify {

enum class Kind { tets, hexes };

inline std::string name(Kind kind) { return kind == Kind::tets ? "tets" : "hexes"; }

/// The kinds of elements that every case runs through.
inline const std::vector<Kind>& element_kinds() {
    static const std::vector<Kind> kinds{Kind::tets, Kind::hexes};
    return kinds;
}

using Map = std::function<Vec3(const Vec3&)>;

/// The unit cube in cells[0] x cells[1] x cells[2] cells (six tets each, or one hex), each vertex moved to map(vertex).
VolumeMesh mapped_box(Kind kind, std::array<int, 3> cells, const Map& map);

/// A box from the origin to `size`.
VolumeMesh box(Kind kind, std::array<int, 3> cells, const Vec3& size);

/// A box from the origin whose cells are cut crosswise: four triangles of the x-y plane a cell, as prisms of three tets through the one cell along z. In bending as good as half as many
/// cells more with one diagonal each.
VolumeMesh crossed_box(std::array<int, 2> cells, const Vec3& size);

/// Patches as one mesh: vertices nearer than 1e-9 of the size of it are one.
VolumeMesh welded(const std::vector<VolumeMesh>& patches);

/// The octant x, y, z >= 0 of a spherical shell: three patches of n x n cells over the surface, `layers` through the wall.
VolumeMesh shell_octant(Kind kind, int n, int layers, double inner_m, double outer_m);

/// A quarter of a hollow cylinder, x, y >= 0, along z: n cells around, `layers` through the wall, `along` over the height.
VolumeMesh quarter_tube(Kind kind, int n, int layers, int along, double inner_m, double outer_m, double height_m);

/// A solid cylinder around z, from z = 0: a square of n x n cells in four patches of n x n.
VolumeMesh cylinder(Kind kind, int n, int along, double radius_m, double height_m);

/// The unit cube with its inner vertices shaken by up to `shake` of a cell: no two elements alike.
VolumeMesh irregular_cube(Kind kind, int cells, double shake, std::uint64_t seed);

/// Makes a face or direction denser: s in [0, 1] to a growing spacing, the last step `ratio` times the first.
double graded(double s, double ratio);

}  // namespace supple::verify
