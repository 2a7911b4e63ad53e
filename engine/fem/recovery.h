#pragma once
#include <span>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple {

/// How a stress at a vertex is made of the stresses of elements.
enum class Recovery {
    raw,              ///< plain mean of the elements that meet there
    volume_weighted,  ///< their mean weighted by rest volume
    spr,              ///< superconvergent patch recovery: a linear field fitted to the patch
};

namespace fem {

/// Stress at vertices as a weighted sum of elements' stresses: depends on the rest shape alone, so recovery is a gather.
struct RecoveryWeights {
    std::vector<std::int64_t> start;     ///< [vertex + 1]
    std::vector<std::int32_t> element;   ///< in the order of the mesh
    std::vector<double> weight;          ///< sums to one per vertex; no entry at a vertex of no element
    std::size_t fallbacks = 0;           ///< spr: vertices whose patches fix no linear field, recovered by volume

    Voigt at(std::span<const Voigt> element_stress, std::size_t vertex) const;
};

/// Weights of one kind of recovery.
///
/// spr (O. C. Zienkiewicz, J. Z. Zhu, Int. J. Numer. Meth. Engng 33, 1331-1364, 1992): the least-squares fit of a0 + a.X to the stresses at the
/// centres of the elements of a patch, X rest coordinates. The patch of a vertex inside is the elements around it. A vertex of the boundary takes the mean of what the
/// patches of its neighbours inside say at its place; where it has none, its own patch with the elements around its neighbours. A patch
/// that fixes no linear field, or magnifies noise more than tenfold (sum of |weights|), is passed over; where all are, the volume weights
/// stand in and are counted. Reproduces linear fields exactly. A jump between two materials is smoothed, as by every nodal stress.
/// @param boundary_vertices  ascending
RecoveryWeights make_recovery(const VolumeMesh& mesh, std::span<const std::int32_t> boundary_vertices, Recovery recovery);

}  // namespace fem
}  // namespace supple
