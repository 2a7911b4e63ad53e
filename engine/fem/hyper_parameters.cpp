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

HyperParameters make_hyper_parameters(const Tet4Rest& rest, const Material& material) {
    const Listed listed = std::visit([](const auto& m) { return list(m); }, material);
    HyperParameters parameters;
    parameters.law = listed.law;
    parameters.count = listed.values.size() + 1;
    parameters.field.resize(rest.blocks() * parameters.count * kBlock);
    // A turned-out element is pushed back about as hard as a thoroughly squeezed one: ten times the small-strain stiffness of uniaxial strain.
    const Lame small = small_strain(material);
    const double inversion = 10 * (std::max(small.lambda_pa, 0.0) + 2 * small.mu_pa);
    for (std::size_t block = 0; block < rest.blocks(); ++block) {
        for (std::size_t i = 0; i < parameters.count; ++i) {
            std::fill_n(parameters.field.begin() + std::ptrdiff_t((block * parameters.count + i) * kBlock), kBlock,
                        i == 0 ? inversion : listed.values[i - 1]);
        }
    }
    return parameters;
}

}  // namespace supple::fem
