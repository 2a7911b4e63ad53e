#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple::fem {

/// Which element corners meet at each vertex: the transpose of the element list. Sums over it are a gather, so they are deterministic
/// and free of atomics.
struct CornerMap {
    std::vector<std::int64_t> start;     ///< [vertex + 1]
    std::vector<std::uint32_t> corner;   ///< place of the corner's value; ascending per vertex. Tets alone: element * 4 + a
    std::vector<std::int32_t> element;   ///< the element of each, as numbered in the mesh
};

CornerMap make_corner_map(std::size_t vertices, std::span<const Tet> tets);

/// out[v] = sum of corner_value[corner] over the corners of v, for v in [begin, end). corner_value: [place][x y z 0].
void gather_corners(const CornerMap& map, const double* corner_value, std::size_t begin, std::size_t end, Vec3* out);

}  // namespace supple::fem
