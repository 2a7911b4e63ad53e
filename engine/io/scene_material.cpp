#include "supple/io/material_keys.h"
#include "supple/io/scene_parts.h"

namespace supple::io {

namespace {

double read_young(const JsonNode& node) { return node.number_above(0, kMostPascal); }
double read_poisson(const JsonNode& node) { return node.number_between(-1, 0.5); }

using ReadNumber = double (*)(const JsonNode&);

/// A number for the whole body, or a list with one per element.
void read_constant_or_array(const JsonNode& node, const BodyTemplate& shape, ReadNumber read, double& constant, std::vector<double>& per_element) {
    if (!node.is_array()) {
        constant = read(node);
        return;
    }
    const std::size_t elements = shape.mesh().element_count();
    if (node.size() != elements) {
        std::string message = "has " + std::to_string(node.size()) + " numbers, but the mesh has " + std::to_string(elements) + " elements; give one each";
        const std::size_t removed = shape.report().degenerate + shape.report().duplicate_elements;
        if (removed > 0) message += " (" + std::to_string(removed) + " degenerate or repeated elements of the file were removed)";
        node.fail(message);
    }
    per_element.resize(elements);
    for (std::size_t e = 0; e < elements; ++e) per_element[e] = read(node.item(e));
}

void require_material_keys(const JsonNode& node) {
    require_keys(node, {"law", "rotation", "integration", "young_pa", "poisson", "plastic_yield", "plastic_max", "plastic_creep_1_s", "volumetric"},
                 {"fibre", "sheet", "fibre_stiffness_pa", "fibre_exponent",
                  "sheet_stiffness_pa", "sheet_exponent", "matrix_regularization", "mu_pa", "lambda_pa", "bulk_pa", "c1_pa", "c2_pa", "c2", "terms",
                  "a_pa", "b"},
                 "is not available for this law in this build; linear and corotational materials have law, rotation, integration, young_pa, poisson, volumetric and the plastic keys");
}

Rotation read_rotation(const JsonNode& node) {
    const std::string word = node.choice({"polar", "large", "svd"});
    return word == "large" ? Rotation::large : word == "svd" ? Rotation::svd : Rotation::polar;
}

void read_material(const JsonNode& node, BodyDef& def) {
    // The law comes first: the keys of one that is not there yet must not be called unknown.
    const std::string name = node.has("law") ? node.at("law").choice({"corotational", "linear", "StVenantKirchhoff", "NeoHookean", "StableNeoHookean",
                                                                      "MooneyRivlin", "ArrudaBoyce", "VerondaWestman", "Ogden"},
                                                                     {"Costa"}) : "corotational";
    if (name != "corotational" && name != "linear") {
        def.material = read_hyperelastic(node, name);
        return;
    }
    require_material_keys(node);
    Linear elastic;
    if (node.has("young_pa")) read_constant_or_array(node.at("young_pa"), *def.shape, read_young, elastic.young_pa, def.young_pa_per_element);
    if (node.has("poisson")) read_constant_or_array(node.at("poisson"), *def.shape, read_poisson, elastic.poisson, def.poisson_per_element);
    for (const auto& [key, value] : {std::pair{"plastic_yield", &elastic.plasticity.yield}, std::pair{"plastic_max", &elastic.plasticity.max},
                                     std::pair{"plastic_creep_1_s", &elastic.plasticity.creep_1_s}}) {
        if (node.has(key)) *value = node.at(key).number(0, 1e15);
    }
    if (node.has("volumetric")) {
        elastic.volumetric = node.at("volumetric").choice({"element", "nodal"}) == "nodal" ? Volumetric::nodal : Volumetric::element;
    }
    if (node.has("integration")) elastic.integration = node.at("integration").choice({"incompatible", "full"}) == "full" ? Integration::full : Integration::incompatible;
    def.material = elastic;
    if (name == "linear") {
        if (node.has("rotation")) node.at("rotation").fail("the linear law has no rotation: it is for small displacements; use \"corotational\"");
        return;
    }
    Corotational turned{.young_pa = elastic.young_pa, .poisson = elastic.poisson, .plasticity = elastic.plasticity, .volumetric = elastic.volumetric,
                        .integration = elastic.integration};
    if (node.has("rotation")) turned.rotation = read_rotation(node.at("rotation"));
    def.material = turned;
}

/// young_pa and poisson of a linear or corotational material.
Linear elastic_of(const Material& material) {
    if (const auto* corotational = std::get_if<Corotational>(&material)) return {corotational->young_pa, corotational->poisson, corotational->plasticity, corotational->volumetric};
    return std::get<Linear>(material);
}

std::vector<double>& filled(std::vector<double>& per_element, std::size_t elements, double constant) {
    if (per_element.empty()) per_element.assign(elements, constant);
    return per_element;
}

void read_region(const JsonNode& node, BodyDef& def) {
    require_keys(node, with_selection_keys({"material", "stiffness_factor"}));
    const VolumeMesh& mesh = def.shape->mesh();
    const std::vector<std::int32_t> elements = select_elements(mesh, read_selection(node, mesh));
    if (elements.empty()) node.fail("the region holds no element: an element belongs to it when all its vertices are selected; make the selection larger");
    if (!node.has("material") && !node.has("stiffness_factor")) node.fail("the region changes nothing; give \"material\" or \"stiffness_factor\"");
    if (is_hyperelastic(def.material)) node.unsupported("regions change young_pa and poisson of linear and corotational bodies; in this build a hyperelastic body is of one material");
    const Linear law = elastic_of(def.material);
    if (node.has("material")) {
        const JsonNode material = node.at("material");
        for (const char* key : {"law", "rotation", "integration"}) {
            if (material.has(key)) material.at(key).unsupported("a region of this build changes young_pa and poisson, not the law");
        }
        require_material_keys(material);
        if (material.has("young_pa")) {
            const double young = read_young(material.at("young_pa"));
            for (std::int32_t e : elements) filled(def.young_pa_per_element, mesh.element_count(), law.young_pa)[std::size_t(e)] = young;
        }
        if (material.has("poisson")) {
            const double poisson = read_poisson(material.at("poisson"));
            for (std::int32_t e : elements) filled(def.poisson_per_element, mesh.element_count(), law.poisson)[std::size_t(e)] = poisson;
        }
    }
    if (node.has("stiffness_factor")) {
        const JsonNode factor = node.at("stiffness_factor");
        const double value = factor.number_above(0, kMostPascal);
        for (std::int32_t e : elements) {
            double& young = filled(def.young_pa_per_element, mesh.element_count(), law.young_pa)[std::size_t(e)];
            young *= value;
            if (!(young > 0 && young <= kMostPascal)) factor.fail(factor.shown() + " makes Young's modulus " + to_text(young) + " Pa, outside (0, 1e15]");
        }
    }
}

}  // namespace

void read_materials(const JsonNode& body, BodyDef& def) {
    if (body.has("material")) read_material(body.at("material"), def);
    if (!body.has("regions")) return;
    for (const JsonNode& region : body.at("regions").items()) read_region(region, def);
}

}  // namespace supple::io
