#include "supple/fem/hyper_parameters.h"

#include <algorithm>

namespace supple::fem {

namespace {

struct Listed {
    Law law;
    std::vector<double> values;
};

Listed list(const StVenantKirchhoff& m) { return {Law::st_venant_kirchhoff, {m.mu_pa, m.lambda_pa}}; }
Listed list(const NeoHookean& m) { return {Law::neo_hookean, {m.mu_pa, m.lambda_pa}}; }
Listed list(const StableNeoHookean& m) { return {Law::stable_neo_hookean, {m.mu_pa, m.lambda_pa}}; }
Listed list(const MooneyRivlin& m) { return {Law::mooney_rivlin, {m.c1_pa, m.c2_pa, m.bulk_pa}}; }
Listed list(const ArrudaBoyce& m) { return {Law::arruda_boyce, {m.mu_pa, m.bulk_pa}}; }
Listed list(const VerondaWestman& m) { return {Law::veronda_westman, {m.c1_pa, m.c2, m.bulk_pa}}; }
Listed list(const Ogden& m) {
    Listed listed{Law::ogden, {m.bulk_pa}};
    for (const OgdenTerm& term : m.terms) listed.values.insert(listed.values.end(), {term.mu_pa, term.alpha});
    return listed;
}
Listed list(const Linear&) { return {}; }
Listed list(const Corotational&) { return {}; }

}  // namespace

HyperParameters make_hyper_parameters(const ElementGroup& group, const ElementMaterials& materials) {
    std::vector<Listed> listed;
    std::vector<double> inversion;
    for (const Material& material : materials.materials) {
        listed.push_back(std::visit([](const auto& m) { return list(m); }, material));
        // A turned-out element is pushed back about as hard as a thoroughly squeezed one: ten times the small-strain stiffness of uniaxial strain.
        const Lame small = small_strain(material);
        inversion.push_back(10 * (std::max(small.lambda_pa, 0.0) + 2 * small.mu_pa));
    }
    const auto material_of = [&](std::size_t i) {
        const std::size_t element = std::size_t(group.element[std::min(i, group.element.size() - 1)]);
        return materials.material_of_element.empty() ? 0 : std::size_t(materials.material_of_element[element]);
    };
    HyperParameters parameters;
    parameters.law = listed[material_of(0)].law;
    parameters.count = listed[material_of(0)].values.size() + 1;
    parameters.field.resize(group.blocks() * parameters.count * kBlock);
    for (std::size_t i = 0; i < group.blocks() * kBlock; ++i) {
        const std::size_t m = material_of(i);
        double* field = parameters.field.data() + i / kBlock * parameters.count * kBlock + i % kBlock;
        field[0] = inversion[m];
        for (std::size_t k = 1; k < parameters.count; ++k) field[k * kBlock] = listed[m].values[k - 1];
    }
    return parameters;
}

}  // namespace supple::fem
