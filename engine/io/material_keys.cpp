#include "supple/io/material_keys.h"

#include "supple/io/scene_parts.h"

namespace supple::io {

namespace {

constexpr std::array<std::string_view, 13> kNumberKeys = {"mu_pa", "lambda_pa", "young_pa", "poisson", "c1_pa", "c2_pa", "c2", "bulk_pa", "a_pa",
                                                          "fibre_stiffness_pa", "fibre_exponent", "sheet_stiffness_pa", "sheet_exponent"};
constexpr std::array<std::string_view, 8> kCommonKeys = {"law", "fibre", "sheet", "fibre_stiffness_pa", "fibre_exponent", "sheet_stiffness_pa", "sheet_exponent",
                                                         "matrix_regularization"};

/// Reads the keys of one material; of one element where numbers are lists.
struct Reader {
    const JsonNode& node;
    bool from_base;
    std::size_t elements, element;

    void require(std::vector<std::string_view> keys) const {
        keys.insert(keys.end(), kCommonKeys.begin(), kCommonKeys.end());
        require_keys(node, keys, {"plastic_yield", "plastic_max", "plastic_creep_1_s", "integration"}, "is not available for hyperelastic laws in this build");
    }

    JsonNode value(const char* key) const {
        const JsonNode given = node.at(key);
        if (!given.is_array()) return given;
        if (given.size() != elements) {
            given.fail("has " + std::to_string(given.size()) + " numbers, but the mesh has " + std::to_string(elements) + " elements; give one each, or one for all");
        }
        return given.item(element);
    }
    void set(double& number, const char* key) const {
        if (node.has(key)) number = value(key).number(-kMostPascal, kMostPascal);
    }

    /// [x, y, z] for the body, or a list of these, one per element.
    void set(std::vector<Vec3>& directions, const char* key) const {
        if (!node.has(key)) return;
        const JsonNode given = node.at(key);
        directions.clear();
        if (given.is_array() && given.size() > 0 && given.item(0).is_array()) {
            for (const JsonNode& item : given.items()) directions.push_back(item.vec3());
        } else {
            directions.push_back(given.vec3());
        }
    }

    template <class Law>
    void common(Law& law) const {
        Fibres& f = law.fibres;
        set(f.fibre, "fibre");
        set(f.sheet, "sheet");
        set(f.fibre_stiffness_pa, "fibre_stiffness_pa");
        set(f.fibre_exponent, "fibre_exponent");
        set(f.sheet_stiffness_pa, "sheet_stiffness_pa");
        set(f.sheet_exponent, "sheet_exponent");
        if (node.has("matrix_regularization")) law.matrix_regularization = node.at("matrix_regularization").boolean();
    }

    template <class Law>
    void lame(Law& law) const {
        require({"mu_pa", "lambda_pa", "young_pa", "poisson"});
        const bool moduli = node.has("mu_pa") || node.has("lambda_pa"), elastic = node.has("young_pa") || node.has("poisson");
        if (moduli && elastic) node.fail("gives both mu_pa, lambda_pa and young_pa, poisson; keep one pair");
        if (elastic) {
            const double sum = law.lambda_pa + law.mu_pa;
            double young = law.mu_pa * (3 * law.lambda_pa + 2 * law.mu_pa) / sum, poisson = law.lambda_pa / (2 * sum);
            if (!from_base) node.at(node.has("young_pa") ? "poisson" : "young_pa", node.has("young_pa") ? "it goes with young_pa" : "it goes with poisson");
            if (node.has("young_pa")) young = value("young_pa").number_above(0, kMostPascal);
            if (node.has("poisson")) poisson = value("poisson").number_between(-1, 0.5);
            const Lame p = lame_parameters(young, poisson, node.where());
            law.mu_pa = p.mu_pa;
            law.lambda_pa = p.lambda_pa;
        }
        set(law.mu_pa, "mu_pa");
        set(law.lambda_pa, "lambda_pa");
    }

    void read(StVenantKirchhoff& m) const { lame(m); }
    void read(NeoHookean& m) const { lame(m); }
    void read(StableNeoHookean& m) const { lame(m); }
    void read(MooneyRivlin& m) const {
        require({"c1_pa", "c2_pa", "bulk_pa"});
        set(m.c1_pa, "c1_pa");
        set(m.c2_pa, "c2_pa");
        set(m.bulk_pa, "bulk_pa");
    }
    void read(ArrudaBoyce& m) const {
        require({"mu_pa", "bulk_pa"});
        set(m.mu_pa, "mu_pa");
        set(m.bulk_pa, "bulk_pa");
    }
    void read(VerondaWestman& m) const {
        require({"c1_pa", "c2", "bulk_pa"});
        set(m.c1_pa, "c1_pa");
        set(m.c2, "c2");
        set(m.bulk_pa, "bulk_pa");
    }
    void read(Ogden& m) const {
        require({"terms", "bulk_pa"});
        if (node.has("terms")) {
            m.terms.clear();
            for (const JsonNode& item : node.at("terms").items()) {
                item.require_object({"mu_pa", "alpha"});
                m.terms.push_back({item.at("mu_pa").number(-kMostPascal, kMostPascal), item.at("alpha").number(-1e3, 1e3)});
            }
        }
        set(m.bulk_pa, "bulk_pa");
    }
    void read(Costa& m) const {
        require({"a_pa", "bulk_pa", "b"});
        set(m.a_pa, "a_pa");
        set(m.bulk_pa, "bulk_pa");
        if (!node.has("b")) return;
        const JsonNode b = node.at("b");
        if (!b.is_array() || b.size() != 6) b.fail("must be a list of six numbers, ff fs ss fn sn nn, found " + b.shown());
        for (std::size_t i = 0; i < 6; ++i) m.b[i] = b.item(i).number_above(0, 1e6);
    }
};

/// Where numbers are lists there is one Material per element: each keeps its own direction alone.
void keep_own_direction(std::vector<Vec3>& directions, std::size_t elements, std::size_t element) {
    if (directions.size() == elements) directions = {directions[element]};
}

}  // namespace

const char* law_name(const Material& material) {
    constexpr const char* kNames[] = {"corotational", "linear", "StVenantKirchhoff", "NeoHookean", "StableNeoHookean", "MooneyRivlin", "ArrudaBoyce",
                                      "VerondaWestman", "Ogden", "Costa"};
    static_assert(std::size(kNames) == std::variant_size_v<Material>);
    return kNames[material.index()];
}

Material default_hyperelastic(const std::string& name) {
    for (const Material& law : {Material(StVenantKirchhoff{}), Material(NeoHookean{}), Material(StableNeoHookean{}), Material(MooneyRivlin{}),
                                Material(ArrudaBoyce{}), Material(VerondaWestman{}), Material(Ogden{})}) {
        if (name == law_name(law)) return law;
    }
    return Costa{};
}

bool has_lists(const JsonNode& node) {
    for (const std::string_view key : kNumberKeys) {
        if (node.has(key) && node.at(key).is_array()) return true;
    }
    return false;
}

Material read_hyperelastic(const JsonNode& node, const Material& base, bool from_base, std::size_t elements, std::size_t element) {
    Material material = base;
    const Reader reader{node, from_base, elements, element};
    const bool lists = has_lists(node);
    std::visit(
        [&](auto& law) {
            if constexpr (requires { law.fibres; }) {
                reader.read(law);
                reader.common(law);
                if (lists) {
                    keep_own_direction(law.fibres.fibre, elements, element);
                    keep_own_direction(law.fibres.sheet, elements, element);
                }
            }
        },
        material);
    check_material(material, elements, node.where());  // throws with the name of what is out of range
    return material;
}

}  // namespace supple::io
