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

void require_linear_keys(const JsonNode& node) {
    for (const char* key : {"fibre", "sheet", "fibre_stiffness_pa", "fibre_exponent", "sheet_stiffness_pa", "sheet_exponent", "matrix_regularization"}) {
        if (node.has(key)) node.at(key).unsupported(std::string(key) + " belongs to the hyperelastic laws, whose stress knows the full strain; choose one of them, e.g. \"law\": \"NeoHookean\"");
    }
    require_keys(node, {"law", "rotation", "integration", "young_pa", "poisson", "plastic_yield", "plastic_max", "plastic_creep_1_s", "volumetric"},
                 {"mu_pa", "lambda_pa", "bulk_pa", "c1_pa", "c2_pa", "c2", "terms", "a_pa", "b"},
                 "is not available for this law in this build; linear and corotational materials have law, rotation, integration, young_pa, poisson, volumetric and the plastic keys");
}

Rotation read_rotation(const JsonNode& node) {
    const std::string word = node.choice({"polar", "large", "svd"});
    return word == "large" ? Rotation::large : word == "svd" ? Rotation::svd : Rotation::polar;
}

void read_plasticity(const JsonNode& node, Plasticity& plasticity) {
    for (const auto& [key, value] : {std::pair{"plastic_yield", &plasticity.yield}, std::pair{"plastic_max", &plasticity.max},
                                     std::pair{"plastic_creep_1_s", &plasticity.creep_1_s}}) {
        if (node.has(key)) *value = node.at(key).number(0, 1e15);
    }
}

/// What linear and corotational materials have besides young_pa and poisson.
template <class Elastic>
void read_elastic(const JsonNode& node, Elastic& m) {
    read_plasticity(node, m.plasticity);
    if (node.has("volumetric")) m.volumetric = node.at("volumetric").choice({"element", "nodal"}) == "nodal" ? Volumetric::nodal : Volumetric::element;
    if (node.has("integration")) m.integration = node.at("integration").choice({"incompatible", "full"}) == "full" ? Integration::full : Integration::incompatible;
    if constexpr (requires { m.rotation; }) {
        if (node.has("rotation")) m.rotation = read_rotation(node.at("rotation"));
    } else if (node.has("rotation")) {
        node.at("rotation").fail("the linear law has no rotation: it is for small displacements; use \"corotational\"");
    }
}

std::string read_law(const JsonNode& node, const char* default_law) {
    return node.has("law") ? node.at("law").choice({"corotational", "linear", "StVenantKirchhoff", "NeoHookean", "StableNeoHookean", "MooneyRivlin",
                                                    "ArrudaBoyce", "VerondaWestman", "Ogden", "Costa"})
                           : default_law;
}

void read_material(const JsonNode& node, BodyDef& def) {
    const std::size_t elements = def.shape->mesh().element_count();
    const std::string name = read_law(node, "corotational");
    if (name != "corotational" && name != "linear") {
        const Material base = default_hyperelastic(name);
        def.material = read_hyperelastic(node, base, false, elements);
        if (!has_lists(node)) return;
        for (std::size_t e = 0; e < elements; ++e) def.material_per_element.push_back(read_hyperelastic(node, base, false, elements, e));
        return;
    }
    require_linear_keys(node);
    const auto read = [&](auto elastic) {
        if (node.has("young_pa")) read_constant_or_array(node.at("young_pa"), *def.shape, read_young, elastic.young_pa, def.young_pa_per_element);
        if (node.has("poisson")) read_constant_or_array(node.at("poisson"), *def.shape, read_poisson, elastic.poisson, def.poisson_per_element);
        read_elastic(node, elastic);
        def.material = elastic;
    };
    if (name == "linear") return read(Linear{});
    read(Corotational{});
}

bool has_arrays(const BodyDef& def) {
    return !def.young_pa_per_element.empty() || !def.poisson_per_element.empty() || !def.material_per_element.empty();
}

/// Material of a region. What it does not name is the body's where that has the same law, else the law's default.
Material read_region_material(const JsonNode& node, const BodyDef& def) {
    const std::string body_law = law_name(def.material), law = read_law(node, body_law.c_str());
    if (has_arrays(def) && !node.has("law")) {
        node.fail("the body gives its parameters element by element, so what this region does not name has no single value; name its \"law\" and all of its parameters");
    }
    const bool from_body = law == body_law && !has_arrays(def);
    if (law != "corotational" && law != "linear") {
        if (has_lists(node)) node.fail("a region has one value of each parameter; lists per element belong to the body's material");
        return read_hyperelastic(node, from_body ? def.material : default_hyperelastic(law), from_body, def.shape->mesh().element_count());
    }
    require_linear_keys(node);
    Material material = from_body ? def.material : law == "linear" ? Material(Linear{}) : Material(Corotational{});
    const auto set = [&](auto& m) {
        if (node.has("young_pa")) m.young_pa = read_young(node.at("young_pa"));
        if (node.has("poisson")) m.poisson = read_poisson(node.at("poisson"));
        read_elastic(node, m);
    };
    if (auto* linear = std::get_if<Linear>(&material)) set(*linear);
    if (auto* corotational = std::get_if<Corotational>(&material)) set(*corotational);
    return material;
}

void read_region(const JsonNode& node, BodyDef& def) {
    require_keys(node, with_selection_keys({"elements", "material", "stiffness_factor", "density_kg_m3"}));
    const VolumeMesh& mesh = def.shape->mesh();
    MaterialRegion region;
    region.where = read_selection(node, mesh);
    if (node.has("elements") && node.at("elements").choice({"all_vertices", "centre"}) == "centre") region.rule = ElementRule::centre;
    if (select_elements(mesh, region.where, region.rule).empty()) {
        node.fail(region.rule == ElementRule::centre
                      ? "the region holds no element: no element's centre is selected; make the selection larger"
                      : "the region holds no element: an element belongs to it when all its vertices are selected; make the selection larger, or give \"elements\": \"centre\"");
    }
    if (!node.has("material") && !node.has("stiffness_factor") && !node.has("density_kg_m3")) {
        node.fail("the region changes nothing; give \"material\", \"stiffness_factor\" or \"density_kg_m3\"");
    }
    if (node.has("material")) region.material = read_region_material(node.at("material"), def);
    if (node.has("stiffness_factor")) region.stiffness_factor = node.at("stiffness_factor").number_above(0, 1e12);
    if (node.has("density_kg_m3")) region.density_kg_m3 = node.at("density_kg_m3").number_above(0, 1e9);
    def.regions.push_back(std::move(region));
}

}  // namespace

void read_materials(const JsonNode& body, BodyDef& def) {
    if (body.has("material")) read_material(body.at("material"), def);
    if (!body.has("regions")) return;
    for (const JsonNode& region : body.at("regions").items()) read_region(region, def);
}

}  // namespace supple::io
