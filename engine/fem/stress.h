#pragma once
#include <span>
#include <vector>

#include "supple/fem/corners.h"
#include "supple/fem/tet4.h"

namespace supple::fem {

/// sqrt(3/2 s:s), s the deviator [Pa].
double von_mises(const Voigt& cauchy);

/// Volume-weighted mean of the tensors of the elements around a vertex; zero where there is none.
Voigt recover_at_vertex(const CornerMap& map, std::span<const double> volume, std::span<const Voigt> element_stress, std::size_t vertex);

}  // namespace supple::fem
