#pragma once
/// The laws in principal stretches, as every kind of element calls them. Kernel units only.
#include "supple/fem/tet4_hyper.h"
#include "supple/fem/tet4_lanes.h"
#include "supple/material/laws/arruda_boyce.h"
#include "supple/material/laws/inversion.h"
#include "supple/material/laws/mooney_rivlin.h"
#include "supple/material/laws/neo_hookean.h"
#include "supple/material/laws/ogden.h"
#include "supple/material/laws/st_venant_kirchhoff.h"
#include "supple/material/laws/stable_neo_hookean.h"
#include "supple/material/laws/veronda_westman.h"
#include "supple/math/lane_eigen.h"
#include "supple/math/lane_svd.h"

namespace supple::fem {
inline namespace SUPPLE_ISA {
namespace {

/// Step 2. parameter: of these lanes, fields kBlock apart; [0] is the stiffness of the inversion.
template <Law law>
void apply_law(const double* parameter, std::size_t parameters, Principal& e) {
    const auto field = [&](std::size_t i) { return load(parameter + i * kBlock); };
    const Lanes k = field(0);
    const Lanes p[3] = {parameters > 1 ? field(1) : k, parameters > 2 ? field(2) : k, parameters > 3 ? field(3) : k};
    if constexpr (law == Law::st_venant_kirchhoff) st_venant_kirchhoff(p, e);
    if constexpr (law == Law::stable_neo_hookean) stable_neo_hookean(p, e);
    if constexpr (law == Law::neo_hookean) with_inversion(k, e, [&](Principal& x) { neo_hookean(p, x); });
    if constexpr (law == Law::mooney_rivlin) with_inversion(k, e, [&](Principal& x) { mooney_rivlin(p, x); });
    if constexpr (law == Law::arruda_boyce) with_inversion(k, e, [&](Principal& x) { arruda_boyce(p, x); });
    if constexpr (law == Law::veronda_westman) with_inversion(k, e, [&](Principal& x) { veronda_westman(p, x); }, kExponentialFloor);
    if constexpr (law == Law::ogden) {
        with_inversion(k, e, [&](Principal& x) {
            ogden_volume(field(1), x);
            for (std::size_t i = 2; i + 1 < parameters; i += 2) ogden_term(field(i), field(i + 1), x);
        });
    }
}

/// Sets negative eigenvalues of a symmetric 3x3 to zero.
[[gnu::noinline]] inline void clamp_eigenvalues(Lanes A[3][3]) {
    const Lanes zero(0.0);
    Matrix H, Q;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) H.m[i][j] = A[i][j];
    symmetric_eigen(H, Q);
    const Lanes value[3] = {larger(H.m[0][0], zero), larger(H.m[1][1], zero), larger(H.m[2][2], zero)};
    for (int i = 0; i < 3; ++i) {
        for (int j = i; j < 3; ++j) {
            Lanes sum(0.0);
            for (int k = 0; k < 3; ++k) sum = sum + value[k] * Q.m[i][k] * Q.m[j][k];
            A[i][j] = A[j][i] = sum;
        }
    }
}

/// Sets negative eigenvalues of d2W/dF2 to zero: the 3x3 of W_ij by its eigenvectors, the six quotients one by one.
inline void project(Principal& e) {
    const Lanes zero(0.0);
    const auto& A = e.second;
    const Lanes minor = A[0][0] * A[1][1] - A[0][1] * A[0][1];
    const Lanes det = minor * A[2][2] - A[0][0] * A[1][2] * A[1][2] - A[1][1] * A[0][2] * A[0][2] + Lanes(2.0) * A[0][1] * A[1][2] * A[0][2];
    const LaneMask positive = (A[0][0] > zero) & (minor > zero) & (det > zero);
    if (any_of(!positive)) clamp_eigenvalues(e.second);  // where all are positive it would change nothing
    for (int i = 0; i < 3; ++i) {
        e.symmetric[i] = larger(e.symmetric[i], zero);
        e.antisymmetric[i] = larger(e.antisymmetric[i], zero);
    }
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple::fem
