#include "supple/io/material_keys.h"

#include "supple/io/scene_parts.h"

namespace supple::io {

namespace {

void require_law_keys(const JsonNode& node, std::vector<std::string_view> keys) {
    keys.push_back("law");
    require_keys(node, keys,
                 {"fibre", "sheet", "fibre_stiffness_pa", "fibre_exponent", "sheet_stiffness_pa", "sheet_exponent", "plastic_yield",
                  "matrix_regularization", "integration"},
                 "is not available for hyperelastic laws in this build");
}

void set(double& value, const JsonNode& node, const char* key) {
    if (node.has(key)) value = node.at(key).number(-kMostPascal, kMostPascal);
}

template <class Law>
Law read_lame_law(const JsonNode& node) {
    require_law_keys(node, {"mu_pa", "lambda_pa", "young_pa", "poisson"});
    Law law;
    const bool lame = node.has("mu_pa") || node.has("lambda_pa"), elastic = node.has("young_pa") || node.has("poisson");
    if (lame && elastic) node.fail("gives both mu_pa, lambda_pa and young_pa, poisson; keep one pair");
    if (elastic) {
        const Lame p = lame_parameters(node.at("young_pa", "it goes with poisson").number_above(0, kMostPascal),
                                       node.at("poisson", "it goes with young_pa").number_between(-1, 0.5), node.where());
        law.mu_pa = p.mu_pa;
        law.lambda_pa = p.lambda_pa;
    }
    set(law.mu_pa, node, "mu_pa");
    set(law.lambda_pa, node, "lambda_pa");
    return law;
}

Material read(const JsonNode& node, const std::string& law) {
    if (law == "StVenantKirchhoff") return read_lame_law<StVenantKirchhoff>(node);
    if (law == "NeoHookean") return read_lame_law<NeoHookean>(node);
    if (law == "StableNeoHookean") return read_lame_law<StableNeoHookean>(node);
    if (law == "MooneyRivlin") {
        require_law_keys(node, {"c1_pa", "c2_pa", "bulk_pa"});
        MooneyRivlin m;
        set(m.c1_pa, node, "c1_pa");
        set(m.c2_pa, node, "c2_pa");
        set(m.bulk_pa, node, "bulk_pa");
        return m;
    }
    if (law == "ArrudaBoyce") {
        require_law_keys(node, {"mu_pa", "bulk_pa"});
        ArrudaBoyce m;
        set(m.mu_pa, node, "mu_pa");
        set(m.bulk_pa, node, "bulk_pa");
        return m;
    }
    if (law == "VerondaWestman") {
        require_law_keys(node, {"c1_pa", "c2", "bulk_pa"});
        VerondaWestman m;
        set(m.c1_pa, node, "c1_pa");
        set(m.c2, node, "c2");
        set(m.bulk_pa, node, "bulk_pa");
        return m;
    }
    require_law_keys(node, {"terms", "bulk_pa"});
    Ogden m;
    if (node.has("terms")) {
        m.terms.clear();
        for (const JsonNode& item : node.at("terms").items()) {
            item.require_object({"mu_pa", "alpha"});
            m.terms.push_back({item.at("mu_pa").number(-kMostPascal, kMostPascal), item.at("alpha").number(-1e3, 1e3)});
        }
    }
    set(m.bulk_pa, node, "bulk_pa");
    return m;
}

}  // namespace

Material read_hyperelastic(const JsonNode& node, const std::string& law) {
    Material material = read(node, law);
    small_strain(material, node.where());  // throws with the name of what is out of range
    return material;
}

}  // namespace supple::io
