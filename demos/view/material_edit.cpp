#include "view/material_edit.h"

#include <array>
#include <type_traits>
#include <utility>

namespace supple::demos::view {
namespace {

/// Multiplies what sets a law's shear modulus, and gives it the new bulk modulus.
struct Rescale {
    double shear_ratio, mu_pa, lambda_pa, bulk_pa;

    void operator()(MooneyRivlin& law) const {
        law.c1_pa *= shear_ratio;
        law.c2_pa *= shear_ratio;
        law.bulk_pa = bulk_pa;
    }
    void operator()(ArrudaBoyce& law) const {
        law.mu_pa *= shear_ratio;
        law.bulk_pa = bulk_pa;
    }
    void operator()(VerondaWestman& law) const {
        law.c1_pa *= shear_ratio;
        law.bulk_pa = bulk_pa;
    }
    void operator()(Ogden& law) const {
        for (OgdenTerm& term : law.terms) term.mu_pa *= shear_ratio;
        law.bulk_pa = bulk_pa;
    }
    void operator()(Costa& law) const {  // its bulk modulus at small strain is K + a (b_ff + b_ss + b_nn)/9
        law.a_pa *= shear_ratio;
        law.bulk_pa = bulk_pa - law.a_pa * (law.b[0] + law.b[2] + law.b[5]) / 9;
    }
    template <class Law>
    void operator()(Law& law) const {  // StVenantKirchhoff, NeoHookean, StableNeoHookean
        law.mu_pa = mu_pa;
        law.lambda_pa = lambda_pa;
    }
};

template <std::size_t... I>
Material make_law(std::size_t law, std::index_sequence<I...>) {
    Material made;
    ((law == I ? void(made = std::variant_alternative_t<I, Material>{}) : void()), ...);
    return made;
}

}  // namespace

Moduli moduli_of(const Material& material) {
    if (const auto* law = std::get_if<Corotational>(&material)) return {law->young_pa, law->poisson};
    if (const auto* law = std::get_if<Linear>(&material)) return {law->young_pa, law->poisson};
    const Lame p = small_strain(material);
    const double sum = p.lambda_pa + p.mu_pa;
    return {p.mu_pa * (3 * p.lambda_pa + 2 * p.mu_pa) / sum, p.lambda_pa / (2 * sum)};
}

Material with_moduli(Material material, const Moduli& moduli) {
    const Lame p = lame_parameters(moduli.young_pa, moduli.poisson, "material");
    const double shear_ratio = p.mu_pa / small_strain(material).mu_pa;
    std::visit(
        [&](auto& law) {
            using Law = std::decay_t<decltype(law)>;
            if constexpr (std::is_same_v<Law, Corotational> || std::is_same_v<Law, Linear>) {
                law.young_pa = moduli.young_pa;
                law.poisson = moduli.poisson;
            } else {
                Rescale{shear_ratio, p.mu_pa, p.lambda_pa, p.lambda_pa + 2 * p.mu_pa / 3}(law);
            }
        },
        material);
    return material;
}

std::span<const std::string_view> law_names() {
    static constexpr std::array<std::string_view, std::variant_size_v<Material>> kNames = {
        "corotational", "linear",      "StVenantKirchhoff", "NeoHookean", "StableNeoHookean",
        "MooneyRivlin", "ArrudaBoyce", "VerondaWestman",    "Ogden",      "Costa"};
    return kNames;
}

Material of_law(std::size_t law, const Material& like) {
    if (law == like.index()) return like;
    Material made = make_law(law, std::make_index_sequence<std::variant_size_v<Material>>());
    std::visit(
        []([[maybe_unused]] auto& to, [[maybe_unused]] const auto& from) {
            if constexpr (requires { to.fibres = from.fibres; }) to.fibres = from.fibres;
            if constexpr (requires { to.plasticity = from.plasticity; }) {
                to.plasticity = from.plasticity;
                to.volumetric = from.volumetric;
                to.integration = from.integration;
            }
        },
        made, like);
    return with_moduli(made, moduli_of(like));
}

}  // namespace supple::demos::view
