#pragma once
#include "supple/fem/elements.h"
#include "supple/world/world.h"

namespace supple {

/// Material and density of every element, from all that a definition says of them.
struct BodyMaterials {
    fem::ElementMaterials elements;
    std::vector<double> density_kg_m3;  ///< one for all, or one per element
};

/// Order: material, or material_per_element; young_pa_per_element and poisson_per_element; regions, one after the other, the later ones over the earlier;
/// stiffness factors multiply, those of regions and those per element.
/// @error Error(invalid_argument) naming the field of BodyDef
BodyMaterials resolve_materials(const BodyDef& def, const VolumeMesh& mesh);

/// Young's modulus of each [Pa].
std::vector<double> young_moduli(std::span<const Lame> lame);

}  // namespace supple
