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
    std::span<const double> moduli;
    const Tet4Kernels& kernels;
    Frame frame = Frame::polar;
};

/// Frame of a material's elements.
Frame frame_of(const Material& material);

/// A pass over all elements; fills in what the set knows, the caller sets positions, rotations and outputs.
void run_elements(Team& team, const ElementSet& set, Tet4Pass pass);

/// A pass of products over all elements; the caller sets rotations, field and outputs.
void run_product(Team& team, const ElementSet& set, Tet4Product pass);

/// out[v] = sum of the corner values at v.
void gather(Team& team, const CornerMap& corners, const AlignedVector<double>& corner, std::vector<Vec3>& out);

}  // namespace supple::fem
