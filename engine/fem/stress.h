#pragma once
#include <span>
#include <vector>

#include "supple/fem/element_layout.h"

namespace supple::fem {

/// sqrt(3/2 s:s), s the deviator [Pa].
double von_mises(const Voigt& cauchy);

/// Stress of an element of the mesh out of the blocks that an evaluation filled, [block][xx yy zz xy yz zx][lane].
Voigt element_stress(const ElementLayout& layout, const double* block_stress, std::size_t element);

/// Volume-weighted mean of the tensors of the elements around a vertex; zero where there is none.
Voigt recover_at_vertex(const ElementMap& map, std::span<const double> volume, std::span<const Voigt> element_stress, std::size_t vertex);

}  // namespace supple::fem
