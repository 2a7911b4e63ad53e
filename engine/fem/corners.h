#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "supple/fem/tet4.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::fem {

/// Which elements meet at each vertex: the transpose of the element list.
struct ElementMap {
    std::vector<std::int64_t> start;     ///< [vertex + 1]
    std::vector<std::int32_t> element;   ///< as numbered in the mesh, ascending per vertex
};
ElementMap make_element_map(const VolumeMesh& mesh);

/// Forces of tetrahedra summed while they are in the cache: the corners of a chunk of elements are summed into one place per vertex that it touches, and the vertices gather places.
struct CornerSums {
    std::size_t chunk = 0;                     ///< blocks in a chunk, at most kCornerChunk
    std::vector<std::uint32_t> first;          ///< [chunk + 1] where the places of a chunk begin
    std::vector<std::int32_t> vertex;          ///< [place]
    std::vector<std::uint16_t> count;          ///< [place] corners that it sums; ascending in a chunk, so that their loops are foreseen by the processor
    AlignedVector<std::uint16_t> corner;       ///< [..] element * 4 + a, from the chunk's first element on, place by place: as many in a chunk as it has corners, free lanes left out

    /// sum = the corner values of a chunk, [place][x y z 0]. value: of the blocks from `begin` on, [element][corner][x y z 0].
    void add_up(const double* value, std::size_t begin, double* sum) const;
};
inline constexpr std::size_t kCornerChunk = 64;  ///< 2048 corners: their numbers fit 16 bits, their values a second-level cache

CornerSums make_corner_sums(const Tet4Rest& rest, std::size_t chunk);

/// Which values are summed at each vertex, in this order. Sums over it are a gather, so they are deterministic and free of atomics.
struct PlaceMap {
    std::vector<std::int64_t> start;   ///< [vertex + 1]
    std::vector<std::uint32_t> place;
};

/// out[v] = sum of value[place] over the places of v, for v in [begin, end). value: [place][x y z 0].
void gather_places(const PlaceMap& map, const double* value, std::size_t begin, std::size_t end, Vec3* out);

}  // namespace supple::fem
