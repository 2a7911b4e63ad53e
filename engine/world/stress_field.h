#pragma once
#include "supple/fem/elements.h"
#include "supple/world/stress.h"
#include "supple/world/template_data.h"

namespace supple {

/// Makes the field that `def` asks for of the elements' own Cauchy stresses at these positions. `scratch` is made as long as needed.
void fill_stress(const TemplateData& data, const fem::Elements& elements, std::span<const Vec3> positions, std::span<const Voigt> own_stress,
                 const StressDef& def, Team& team, std::vector<Voigt>& scratch, StressField& out);

}  // namespace supple
