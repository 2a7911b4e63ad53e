#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

#include "supple/material/material.h"
#include "supple/math/types.h"

namespace supple {

/// What check_derivatives() found. Errors are relative to the largest force (or force differential) at the sample.
struct DerivativeCheck {
    std::size_t samples = 0;
    bool has_energy = true;       ///< false for Rotation::large, whose force is nobody's gradient; force_error is then 0
    double force_error = 0;       ///< force against -dW/dx
    double tangent_error = 0;     ///< force_differential() against differences of forces
    Mat3 worst_force_at = Mat3::Identity(), worst_tangent_at = Mat3::Identity();  ///< F of the worst sample
    std::string tangent;          ///< which tangents were tried, in which directions

    bool passed(double tolerance = 1e-5) const { return samples > 0 && force_error <= tolerance && tangent_error <= tolerance; }
};

/// Derivatives of a law against central differences on a single tetrahedron, over deformations that stretch, compress, shear and, every third, turn the
/// element inside out. Places where a second derivative jumps (the floor of the extension through inversion) or a rotation is undefined
/// (two opposite stretches) are left out, and so is the tangent of a law with ln J below that floor, where it is approximate by design. The warped tangent of a corotational law holds its rotation, so it is tried in the directions that do not turn the
/// element: R times a symmetric matrix, for `large` R times an upper triangular one.
/// @error Error(invalid_argument) for illegal parameters
DerivativeCheck check_derivatives(const Material& material, std::size_t samples = 200, std::uint64_t seed = 1);

}  // namespace supple
