#pragma once
#include <cstdint>
#include <vector>

#include "supple/fem/tet4.h"
#include "supple/material/material.h"

namespace supple::fem {

/// Which material each element of a body has. Directions of fibres that are given one per element are indexed by the body's elements.
struct ElementMaterials {
    std::vector<Material> list{Material{}};   ///< validated (check_material); at least one
    std::vector<std::uint32_t> of{};          ///< [element] index into list; empty: the first for all
    std::vector<double> stiffness_factor{};   ///< [element] multiplies every modulus in pascals; empty: 1

    const Material& at(std::size_t element) const { return list[of.empty() ? 0 : of[element]]; }
    double factor(std::size_t element) const { return stiffness_factor.empty() ? 1.0 : stiffness_factor[element]; }
};

/// Lame parameters at small strain, one per element, or one for all where they are all equal.
std::vector<Lame> element_lame(const ElementMaterials& materials, std::size_t elements);

/// True if one set of kernels serves both: the same law with the same frame and the same regularization.
bool same_law(const Material& a, const Material& b);

}  // namespace supple::fem
