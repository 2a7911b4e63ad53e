#include "laws.h"

namespace supple::verify {

std::vector<NamedLaw> hyperelastic_laws(double bulk_pa) {
    const double la = bulk_pa - 2000.0 / 3;
    return {
        {"ArrudaBoyce", ArrudaBoyce{.mu_pa = 1000 / 1.0851367078791743, .bulk_pa = bulk_pa}},
        {"MooneyRivlin", MooneyRivlin{.c1_pa = 300, .c2_pa = 200, .bulk_pa = bulk_pa}},
        {"NeoHookean", NeoHookean{.mu_pa = 1000, .lambda_pa = la}},
        {"Ogden", Ogden{.terms = {{2000, 3}}, .bulk_pa = bulk_pa}},
        {"StVenantKirchhoff", StVenantKirchhoff{.mu_pa = 1000, .lambda_pa = la}},
        {"VerondaWestman", VerondaWestman{.c1_pa = 500, .c2 = 2, .bulk_pa = bulk_pa}},
        {"StableNeoHookean", StableNeoHookean{.mu_pa = 1000, .lambda_pa = la}},
    };
}

std::vector<NamedLaw> all_laws(double bulk_pa) {
    const double mu = 1000, K = bulk_pa, young = 9 * K * mu / (3 * K + mu), poisson = (3 * K - 2 * mu) / (2 * (3 * K + mu));
    std::vector<NamedLaw> laws = hyperelastic_laws(bulk_pa);
    laws.push_back({"linear", Linear{.young_pa = young, .poisson = poisson}});
    laws.push_back({"corotational", Corotational{.young_pa = young, .poisson = poisson}});
    return laws;
}

std::vector<NamedLaw> with_costa(std::vector<NamedLaw> laws) {
    laws.push_back({"Costa", Costa{.a_pa = 1000, .bulk_pa = 28000.0 / 3, .b = {2, 2, 2, 2, 2, 2}}});
    return laws;
}

}  // namespace supple::verify
