#pragma once
#include <span>
#include <vector>

#include "supple/fem/tet4.h"
#include "supple/material/material.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::fem {

/// Rest data of checked tetrahedra (positive volumes: mesh/check_and_repair).
/// @param before, old  where a tet is the same as old[i] of `before` (-1: none), its rest shape is copied
Tet4Rest make_rest(std::span<const Vec3> vertices, std::span<const Tet> tets, const Tet4Rest* before = nullptr, std::span<const std::int32_t> old = {});

/// Lame parameters in the layout of the kernels, [block][lambda mu][lane]. One Lame per element (the last is repeated), or one for all.
AlignedVector<double> make_moduli(std::size_t blocks, std::span<const Lame> lame);

/// mu (g_a . g_b) V of each pair of corners of an element: the part of the stiffness that no rotation changes [N/m].
/// @param pair  element * 16 + a * 4 + b
double laplacian_entry(const Tet4Rest& rest, std::span<const double> moduli, std::uint32_t pair);

/// Their sum per matrix block, over the pairs of corners that make it up [N/m].
/// @param start, pair  as fem::Contributions: element * 16 + a * 4 + b
std::vector<double> laplacian_entries(const Tet4Rest& rest, std::span<const double> moduli, std::span<const std::int64_t> start, std::span<const std::uint32_t> pair);

/// Adds the trace of the diagonal stiffness block of each vertex at rest [N/m].
void add_stiffness_trace(const Tet4Rest& rest, std::span<const double> moduli, std::span<double> trace);

}  // namespace supple::fem
