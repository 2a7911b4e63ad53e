#pragma once
#include <span>
#include <vector>

#include "supple/material/material.h"
#include "supple/world/body_template.h"
#include "supple/world/stress.h"

namespace supple {

/// Elastic state of a body in a configuration that the caller gives; no world, no history, float64.
struct Evaluation {
    std::vector<Vec3> forces_n;             ///< internal force per vertex, towards rest: -dW/dx
    double energy_j = 0;
    std::vector<Voigt> element_stress_pa;   ///< Cauchy
    std::vector<Voigt> vertex_stress_pa;    ///< volume-weighted mean of the elements' tensors
};

/// @param positions_m  one per vertex of the mesh
/// @error Error(invalid_argument) on a wrong count or a non-finite position
Evaluation evaluate(const BodyTemplate& shape, const Material& material, std::span<const Vec3> positions_m);

/// df = (df/dx) d [N]. Corotational: with the rotations held (warped tangent, R K R^T), or with their derivative for Tangent::exact (of bent hexes but for its part that is not symmetric), not projected.
/// Hyperelastic: the consistent tangent, not projected.
/// @error Error(invalid_argument) also for an exact tangent of rotation `large`
std::vector<Vec3> force_differential(const BodyTemplate& shape, const Material& material,
                                     std::span<const Vec3> positions_m, std::span<const Vec3> direction_m,
                                     Tangent tangent = Tangent::automatic);

}  // namespace supple
