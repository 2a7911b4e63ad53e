#pragma once
#include <span>
#include <string_view>

#include "supple/material/material.h"

namespace supple::demos::view {

/// What every law has in common: its small-strain elasticity.
struct Moduli {
    double young_pa = 0;
    double poisson = 0;
};

Moduli moduli_of(const Material& material);

/// The same law with other moduli at small strain: its shape parameters (exponents, ratios), fibres, plasticity and choices stay.
/// @error Error(invalid_argument) from lame_parameters()
Material with_moduli(Material material, const Moduli& moduli);

/// Names of the laws, in the order of the alternatives of Material.
std::span<const std::string_view> law_names();

/// Another law with the small-strain moduli, and where it has such the fibres and the plasticity, of `like`.
/// @param law  below law_names().size()
Material of_law(std::size_t law, const Material& like);

}  // namespace supple::demos::view
