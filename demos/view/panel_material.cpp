#include <algorithm>
#include <array>
#include <cstdio>

#include "supple/base/error.h"
#include "view/gui.h"
#include "view/material_edit.h"
#include "view/panels.h"

namespace supple::demos::view {
namespace {

bool is_heterogeneous(const BodyDef& def) {
    return !def.material_per_element.empty() || !def.young_pa_per_element.empty() || !def.poisson_per_element.empty() || !def.regions.empty() ||
           !def.stiffness_factor_per_element.empty();
}

template <class Choice, std::size_t N>
bool law_choice(const char* label, const char* id, Choice& value, const std::array<std::string_view, N>& names, const char* help) {
    int chosen = int(value);
    if (!choice(label, id, chosen, names, help)) return false;
    value = Choice(chosen);
    return true;
}

constexpr std::array<std::string_view, 3> kRotations = {"large", "polar", "svd"};
constexpr std::array<std::string_view, 2> kVolumetric = {"element", "nodal"};
constexpr std::array<std::string_view, 2> kIntegration = {"incompatible", "full"};

/// What the linear and corotational laws have beside their moduli.
template <class Law>
bool element_choices(Law& law, const VolumeMesh& mesh) {
    bool changed = false;
    if constexpr (std::is_same_v<Law, Corotational>)
        changed |= law_choice("Rotation", "rotation", law.rotation, kRotations, "large is cheapest, polar is exact, svd forgets every tangle");
    if (!mesh.tets.empty())
        changed |= law_choice("Volume", "volumetric", law.volumetric, kVolumetric, "nodal does not lock as Poisson's ratio nears 1/2; it costs two to three solves");
    if (!mesh.hexes.empty()) changed |= law_choice("Integration", "integration", law.integration, kIntegration, "incompatible modes bend without locking");
    return changed;
}

/// True where the material was changed.
bool edit(Material& material, const VolumeMesh& mesh) {
    bool changed = false;
    int law = int(material.index());
    if (choice("Law", "law", law, law_names(), "another law with the same stiffness at small strain")) {
        material = of_law(std::size_t(law), material);
        changed = true;
    }
    Moduli moduli = moduli_of(material);
    bool stiffer = slider("Young", "young", moduli.young_pa, 10, 1e9, "%.7g Pa",
                          "Young's modulus at small strain: tissue 1e3 to 1e5 Pa, rubber 1e6; Ctrl click to type a number", true);
    stiffer |= slider("Poisson", "poisson", moduli.poisson, 0.01, 0.499, "%.3f", "Poisson's ratio at small strain: 0.5 would be incompressible");
    if (stiffer) {
        material = with_moduli(material, moduli);
        changed = true;
    }
    if (auto* c = std::get_if<Corotational>(&material)) changed |= element_choices(*c, mesh);
    if (auto* l = std::get_if<Linear>(&material)) changed |= element_choices(*l, mesh);
    return changed;
}

void describe(const World& world, BodyId body) {
    const auto young = world.element_young_pa(body);
    if (young.empty()) return;
    const auto [low, high] = std::minmax_element(young.begin(), young.end());
    char line[200];
    std::snprintf(line, sizeof line, "The elements' modulus goes from %.3g to %.3g Pa.", *low, *high);
    if (*high > *low * (1 + 1e-9)) quiet_sentence(line);
}

}  // namespace

void material_panel(Desk& desk) {
    if (!header("Material", true)) return;
    const std::vector<BodyId> bodies = desk.session.world().bodies();
    if (bodies.empty()) return;
    desk.body = std::min(desk.body, bodies.size() - 1);
    const BodyId body = bodies[desk.body];
    const BodyDef& def = desk.session.world().definition(body);
    try {
        Material material = def.material;
        if (edit(material, desk.session.world().shape(body).mesh())) desk.session.set_material(desk.body, material);
        double factor = desk.session.stiffness_factor(desk.body);
        if (slider("Factor", "factor", factor, 0.01, 100, "x %.3g", "multiplies all moduli, whatever their differences", true)) desk.session.set_stiffness_factor(desk.body, factor);
    } catch (const Error& error) {
        desk.say(error.what(), true);
    }
    describe(desk.session.world(), body);
    if (is_heterogeneous(desk.session.world().definition(body)) && (!def.material_per_element.empty() || !def.young_pa_per_element.empty()))
        quiet_sentence("It differs from element to element: the factor keeps that, a new law or modulus replaces it.");
    char line[160];
    std::snprintf(line, sizeof line, "Density %.4g kg/m3.", def.density_kg_m3);
    quiet_sentence(line);
}

}  // namespace supple::demos::view
