#pragma once
#include <span>
#include <vector>

#include "supple/base/parallel.h"
#include "supple/fem/tet4.h"
#include "supple/math/types.h"

namespace supple::fem {

/// Volumetric stiffness at the vertices: the cure for the locking of nearly incompressible linear tetrahedra.
///
/// An element keeps of its lambda no more than mu (Poisson's ratio 1/4); the rest, k = lambda - mu, acts on the mean dilatation of the elements around each vertex,
///     W = sum_v (k_v/2) V_v theta_v^2,     theta_v = sum_e (V_e/4) tr(e_e) / V_v,     V_v = sum_e V_e/4,     k_v = sum_e (V_e/4) k_e / V_v,
/// so that each element feels the pressure p_e = (1/4) sum_v k_v theta_v. With fewer conditions of constant volume than vertices nothing locks; what the elements keep
/// holds the modes that an average does not see. Exact for a homogeneous strain.
/// Its tangent, one term of rank one for each vertex, couples the second neighbours: it stays out of the matrix and is applied from the element records.
/// Source: Bonet, Burton 1998 (averaged nodal pressure tetrahedra); Puso, Solberg 2006 (stabilised by a part left in the elements).
class NodalVolume {
public:
    /// @param excess  [block][lane] k of each element [Pa], >= 0
    NodalVolume(const Tet4Rest& rest, std::span<const double> excess);

    /// p_e of given dilatations. Both [block][lane].
    void pressures(Team& team, const double* dilatation, double* pressure);
    /// Adds each element's share of W to energy [block][lane], for the dilatations of the last pressures().
    void add_energy(double* energy) const;

    /// y += scale K_v x from element records (Tet4Pass): rotations as they were recorded. Both [vertex][x y z 0].
    template <class Real>
    void multiply_add(Team& team, const Real* record, double scale, const Real* x, Real* y);
    /// Adds the diagonal blocks of K_v [N/m].
    template <class Real>
    void add_diagonal(Team& team, const Real* record, std::span<Mat3> out) const;

private:
    void average(Team& team);

    const Tet4Rest& rest_;
    std::vector<std::int64_t> start_;      ///< [vertex + 1]
    std::vector<std::uint32_t> corner_;    ///< element * 4 + a of each corner at a vertex
    std::vector<double> modulus_;          ///< [vertex] k_v / V_v
    AlignedVector<double> element_;        ///< [block][lane] scratch: (V_e/4) tr(e), then V_e p_e
    std::vector<double> vertex_;           ///< [vertex] k_v theta_v
    std::vector<double> theta_;            ///< [vertex]
};

}  // namespace supple::fem
