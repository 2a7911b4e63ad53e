#pragma once
/// Carries a law that needs positive stretches through flat and inverted elements (after Irving, Teran, Fedkiw 2004).
///
/// Below the floor s* (0.1; 0.3 for laws with exponentials of J^-1, which would be astronomic at 0.1) the energy goes on from the clamped stretches t_i = max(s_i, s*), with d_i = s_i - t_i <= 0:
///     W(s) = W(t) + sum_i W_i(t) d_i + k/2 sum_i d_i^2
/// so that W_i(s) = W_i(t) + k d_i where clamped and W_j(t) + sum_i W_ij(t) d_i elsewhere: continuous force, its own energy, and a spring k that
/// pushes back however far the element is turned inside out.
#include "supple/material/laws/principal.h"

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

inline constexpr double kStretchFloor = 0.1, kExponentialFloor = 0.3;

/// Evaluates law(e) with the extension. k: its stiffness [Pa].
template <class Law>
inline void with_inversion(Lanes k, Principal& e, Law&& law, double lowest = kStretchFloor) {
    const Lanes floor(lowest), zero(0.0), one(1.0), half(0.5), near(1e-3);
    const Lanes s[3] = {e.s[0], e.s[1], e.s[2]};
    const LaneMask clamped[3] = {s[0] < floor, s[1] < floor, s[2] < floor};
    for (int i = 0; i < 3; ++i) e.s[i] = larger(s[i], floor);
    law(e);
    const LaneMask any = clamped[0] | clamped[1] | clamped[2];
    if (any_of(any)) {
        Lanes d[3], on[3], first[3];
        for (int i = 0; i < 3; ++i) {
            d[i] = s[i] - e.s[i];
            on[i] = choose(clamped[i], one, zero);
        }
        for (int i = 0; i < 3; ++i) {
            e.W = e.W + e.first[i] * d[i] + half * k * d[i] * d[i];
            Lanes cross(0.0);
            for (int j = 0; j < 3; ++j) {
                if (j != i) cross = cross + e.second[i][j] * d[j];
            }
            first[i] = e.first[i] + k * d[i] + (one - on[i]) * cross;
        }
        for (int i = 0; i < 3; ++i) {
            e.first[i] = first[i];
            for (int j = 0; j < 3; ++j) {
                e.second[i][j] = i == j ? choose(clamped[i], k, e.second[i][i]) : (one - on[i] * on[j]) * e.second[i][j];
            }
        }
        for (int p = 0; p < 3; ++p) {
            const int i = kPairI[p], j = kPairJ[p];
            const Lanes difference = s[i] - s[j], sum = s[i] + s[j];
            const LaneMask equal = magnitude(difference) < near;
            const Lanes quotient = choose(equal, half * (e.second[i][i] + e.second[j][j]) - e.second[i][j],
                                          (first[i] - first[j]) / choose(equal, one, difference));
            // s_i = -s_j: the quotient may be infinite; bound its denominator away from zero
            const Lanes bounded = choose(magnitude(sum) < near, choose(sum < zero, Lanes(0.0) - near, near), sum);
            e.symmetric[p] = choose(any, quotient, e.symmetric[p]);
            e.antisymmetric[p] = choose(any, (first[i] + first[j]) / bounded, e.antisymmetric[p]);
        }
    }
    for (int i = 0; i < 3; ++i) e.s[i] = s[i];
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
