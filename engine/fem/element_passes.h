#pragma once
#include <span>
#include <vector>

#include "supple/base/parallel.h"
#include "supple/fem/corners.h"
#include "supple/fem/tet4.h"
#include "supple/material/material.h"

namespace supple::fem {

/// Blocks per chunk of every loop over elements.
inline constexpr std::size_t kBlockChunk = 32;
/// Vertices per chunk of every gather.
inline constexpr std::size_t kVertexChunk = 512;

/// Tets in a frame, for the passes below: rest shape, moduli, kernels.
struct ElementSet {
    const Tet4Rest& rest;
    const CornerSums& sums;
    std::span<const double> moduli;
    const Tet4Kernels& kernels;
    Frame frame = Frame::polar;
};

/// Frame of a material's elements.
Frame frame_of(const Material& material);

/// A pass over all elements; fills in what the set knows, the caller sets positions, rotations and outputs.
/// @param sum  out, corner forces summed (CornerSums), or null: none
void run_elements(Team& team, const ElementSet& set, Tet4Pass pass, double* sum = nullptr);

/// A pass of products over all elements; the caller sets rotations, field and outputs.
void run_product(Team& team, const ElementSet& set, Tet4Product pass, double* sum = nullptr);

/// Calls kernel(pass, begin, end) chunk by chunk of `sums`; what it writes to the corners is summed into the places at `sum`, [place][x y z 0].
template <class Pass, class Kernel>
void run_and_sum(Team& team, std::size_t blocks, const CornerSums& sums, const Pass& all, double* sum, Kernel&& kernel) {
    team.for_range(blocks, sums.chunk, [&](std::size_t begin, std::size_t end) {
        alignas(64) double corner[kCornerChunk * kBlock * 16];
        Pass pass = all;
        pass.corner_force = corner;
        pass.corner_block = begin;
        kernel(pass, begin, end);
        sums.add_up(corner, begin, sum + 4 * std::size_t(sums.first[begin / sums.chunk]));
    });
}

/// out[v] = sum of the values at the places of v.
void gather(Team& team, const PlaceMap& map, const AlignedVector<double>& value, std::vector<Vec3>& out);

}  // namespace supple::fem
