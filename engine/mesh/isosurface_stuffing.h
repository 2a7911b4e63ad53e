#pragma once
#include <cstdint>

#include "supple/base/function_ref.h"
#include "supple/mesh/volume_mesh.h"

namespace supple {

class Team;

/// A shape given by a function of position [m]: negative inside, positive outside, zero on the surface. Distance-like values place
/// the surface fastest, but only the sign matters in the end: an occupancy or a winding number (0.5 - w) works as well.
using ImplicitShape = FunctionRef<double(const Vec3&)>;

struct StuffingDef {
    Vec3 min_m = Vec3::Zero();  ///< box that holds the shape; where it lies also places the lattice
    Vec3 max_m = Vec3::Ones();
    double edge_m = 0.1;  ///< long lattice edge, > 0 (short ones: 0.87 of it); a shape of volume V gets about 12 V / edge^3 tets

    /// A lattice vertex nearer to the surface than this fraction of the edge to it moves onto the surface. The defaults bound every
    /// dihedral angle to 8.9..158.8 degrees (Labelle and Shewchuk 2007); (0.24999, 0.41189) bounds them to 10.7..164.8.
    double alpha_long = kAlphaLong;    ///< (0, 0.5)
    double alpha_short = kAlphaShort;  ///< (0, 0.5)

    Vec3 shift = Vec3::Zero();  ///< moves the lattice by this part of an edge, -0.5..0.5: a flat side of the shape then meets it elsewhere

    static constexpr double kAlphaLong = 0.22383;
    static constexpr double kAlphaShort = 0.39700;
};

/// What stuff_isosurface() had to do where the shape is finer than the lattice; all zero for a well-resolved shape.
struct StuffingReport {
    std::int64_t evaluations = 0;    ///< calls of the shape
    std::size_t filled_tets = 0;     ///< tets with all vertices on the surface, kept because their centre is inside
    std::size_t split_vertices = 0;  ///< copies made where parts touched in a vertex or edge only
    std::size_t removed_tets = 0;    ///< tets taken away to open places where the boundary touched itself
};

/// Fills an implicit shape with well-shaped tetrahedra on a body-centred cubic lattice (isosurface stuffing). The boundary is a
/// closed manifold whose vertices lie on the surface; features smaller than edge_m are lost. Deterministic: the same mesh for the
/// same input on every thread count. Time and memory O(lattice points) = O(2 box volume / edge_m^3).
/// @param team  shares the evaluations; the shape is then called from all of its threads at once. Null: one thread
/// @error Error(invalid_argument) for an illegal definition, a value of the shape that is NaN, a shape that reaches beyond the box
///        or that has no inside at this edge length, or a lattice of more than 2^30 points
VolumeMesh stuff_isosurface(ImplicitShape shape, const StuffingDef& def, StuffingReport* report = nullptr, Team* team = nullptr);

}  // namespace supple
