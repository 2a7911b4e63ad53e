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

/// The elements of one body, for the passes below: rest shape, moduli and the two ways round the incidence.
struct ElementSet {
    const Tet4Rest& rest;
    const CornerMap& corners;
    std::span<const double> moduli;
    const Tet4Kernels& kernels;
    Frame frame = Frame::polar;
};

/// Frame of a material's elements.
Frame frame_of(const Material& material);

/// A pass over all elements; fills in what the set knows, the caller sets positions, rotations and outputs.
void run_elements(Team& team, const ElementSet& set, Tet4Pass pass);

/// out = K field, with the given rotations (and twist stiffness, Tet4Pass, or null): float64, matrix-free. `corner` is scratch, 16 numbers per lane.
void stiffness_product(Team& team, const ElementSet& set, const double* quaternion, const double* twist, std::span<const Vec3> field,
                       AlignedVector<double>& corner, std::vector<Vec3>& out);

/// out[v] = sum of the corner values at v.
void gather(Team& team, const CornerMap& corners, const AlignedVector<double>& corner, std::vector<Vec3>& out);

/// Element rotations of a configuration found afresh, without a starting guess: [block][w x y z][lane].
void seed_rotations(Team& team, const Tet4Rest& rest, std::span<const Vec3> positions, AlignedVector<double>& quaternion);

}  // namespace supple::fem
