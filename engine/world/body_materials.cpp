#include "supple/world/body_materials.h"

#include <cmath>

#include "supple/base/error.h"
#include "supple/mesh/selection.h"

namespace supple {

namespace {

[[noreturn]] void refuse(const std::string& field, const std::string& message) { throw Error(ErrorCode::invalid_argument, "BodyDef." + field, message); }

template <class T>
void check_count(const std::vector<T>& values, std::size_t elements, const char* field) {
    if (values.empty() || values.size() == elements) return;
    refuse(field, "has " + std::to_string(values.size()) + " values, the mesh has " + std::to_string(elements) +
                      " elements; give one per element in mesh order, or none");
}

void check_positive(double value, const std::string& field, const char* fix) {
    if (!(std::isfinite(value) && value > 0)) refuse(field, to_text(value) + " must be finite and above 0; " + fix);
}

constexpr const char* kFactorFix = "it multiplies the moduli of the material";
constexpr const char* kDensityFix = "water and soft tissue have about 1000";

/// The material of one element with the arrays' moduli.
Material with_moduli(const Material& base, const double* young_pa, const double* poisson, const std::string& where) {
    Material material = base;
    const auto set = [&](auto& m) {
        if (young_pa != nullptr) m.young_pa = *young_pa;
        if (poisson != nullptr) m.poisson = *poisson;
        lame_parameters(m.young_pa, m.poisson, where);
    };
    if (auto* linear = std::get_if<Linear>(&material)) set(*linear);
    if (auto* corotational = std::get_if<Corotational>(&material)) set(*corotational);
    return material;
}

/// One material for all, or one per element.
void apply_base(const BodyDef& def, std::size_t elements, fem::ElementMaterials& to) {
    check_count(def.material_per_element, elements, "material_per_element");
    check_count(def.young_pa_per_element, elements, "young_pa_per_element");
    check_count(def.poisson_per_element, elements, "poisson_per_element");
    const bool materials = !def.material_per_element.empty(), young = !def.young_pa_per_element.empty(), poisson = !def.poisson_per_element.empty();
    check_material(def.material, elements, "BodyDef.material");
    to.materials = {def.material};
    if (!materials && !young && !poisson) return;
    to.materials.clear();
    to.material_of_element.resize(elements);
    for (std::size_t e = 0; e < elements; ++e) {
        const std::string index = std::to_string(e);
        const Material& base = materials ? def.material_per_element[e] : def.material;
        if (materials) check_material(base, elements, "BodyDef.material_per_element[" + index + "]");
        if ((young || poisson) && is_hyperelastic(base)) {
            refuse("young_pa_per_element", "arrays of young_pa and poisson belong to the linear and corotational laws; give a hyperelastic law's parameters in material_per_element");
        }
        to.materials.push_back(with_moduli(base, young ? &def.young_pa_per_element[e] : nullptr, poisson ? &def.poisson_per_element[e] : nullptr,
                                      "BodyDef, element " + index));
        to.material_of_element[e] = std::int32_t(e);
    }
}

template <class T>
std::vector<T>& filled(std::vector<T>& per_element, std::size_t elements, T value) {
    if (per_element.size() != elements) per_element.assign(elements, value);
    return per_element;
}

void apply_region(const MaterialRegion& region, const std::string& name, const VolumeMesh& mesh, BodyMaterials& to) {
    const std::size_t elements = mesh.element_count();
    const std::vector<std::int32_t> selected = select_elements(mesh, region.where, region.rule);
    if (selected.empty())
        refuse(name, std::string("holds no element: an element belongs to it when ") +
                         (region.rule == ElementRule::centre ? "its centre is selected" : "all its vertices are selected") + "; make the selection larger");
    check_positive(region.stiffness_factor, name + ".stiffness_factor", kFactorFix);
    if (region.density_kg_m3 != 0) check_positive(region.density_kg_m3, name + ".density_kg_m3", "0 keeps the body's");
    if (region.material) {
        check_material(*region.material, elements, "BodyDef." + name + ".material");
        for (const std::int32_t e : selected) filled(to.elements.material_of_element, elements, std::int32_t(0))[std::size_t(e)] = std::int32_t(to.elements.materials.size());
        to.elements.materials.push_back(*region.material);
    }
    if (region.stiffness_factor != 1) {
        for (const std::int32_t e : selected) filled(to.elements.stiffness_factor, elements, 1.0)[std::size_t(e)] *= region.stiffness_factor;
    }
    if (region.density_kg_m3 > 0) {
        for (const std::int32_t e : selected) filled(to.density_kg_m3, elements, to.density_kg_m3[0])[std::size_t(e)] = region.density_kg_m3;
    }
}

/// Elements that hold matter in a part only: as much less stiff and heavy.
void apply_fill(const std::vector<double>& fill, BodyMaterials& to) {
    for (std::size_t e = 0; e < fill.size(); ++e) {
        if (!(fill[e] > 0 && fill[e] <= 1)) refuse("shape", "element " + std::to_string(e) + " is filled by " + to_text(fill[e]) + "; legal is (0, 1]");
        filled(to.elements.stiffness_factor, fill.size(), 1.0)[e] *= fill[e];
        filled(to.density_kg_m3, fill.size(), to.density_kg_m3[0])[e] *= fill[e];
    }
}

}  // namespace

BodyMaterials resolve_materials(const BodyDef& def, const VolumeMesh& mesh) {
    const std::size_t elements = mesh.element_count();
    BodyMaterials to;
    check_positive(def.density_kg_m3, "density_kg_m3", kDensityFix);
    check_count(def.density_kg_m3_per_element, elements, "density_kg_m3_per_element");
    check_count(def.stiffness_factor_per_element, elements, "stiffness_factor_per_element");
    for (std::size_t e = 0; e < def.density_kg_m3_per_element.size(); ++e) {
        check_positive(def.density_kg_m3_per_element[e], "density_kg_m3_per_element[" + std::to_string(e) + "]", kDensityFix);
    }
    for (std::size_t e = 0; e < def.stiffness_factor_per_element.size(); ++e) {
        check_positive(def.stiffness_factor_per_element[e], "stiffness_factor_per_element[" + std::to_string(e) + "]", kFactorFix);
    }
    to.density_kg_m3 = def.density_kg_m3_per_element.empty() ? std::vector<double>{def.density_kg_m3} : def.density_kg_m3_per_element;
    to.elements.stiffness_factor = def.stiffness_factor_per_element;
    apply_base(def, elements, to.elements);
    for (std::size_t r = 0; r < def.regions.size(); ++r) apply_region(def.regions[r], "regions[" + std::to_string(r) + "]", mesh, to);
    check_count(mesh.fill, elements, "shape: fill");
    apply_fill(mesh.fill, to);
    return to;
}

std::vector<double> young_moduli(std::span<const Lame> lame) {
    std::vector<double> young;
    for (const Lame& l : lame) young.push_back(l.mu_pa * (3 * l.lambda_pa + 2 * l.mu_pa) / (l.lambda_pa + l.mu_pa));
    return young;
}

}  // namespace supple
