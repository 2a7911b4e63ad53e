#include "supple/fem/element_materials.h"

namespace supple::fem {

std::vector<Lame> element_lame(const ElementMaterials& materials, std::size_t elements) {
    std::vector<Lame> of_list;
    for (const Material& material : materials.list) of_list.push_back(small_strain(material));
    if (materials.of.empty() && materials.stiffness_factor.empty()) return of_list;
    std::vector<Lame> lame(elements);
    for (std::size_t e = 0; e < elements; ++e) {
        const Lame& l = of_list[materials.of.empty() ? 0 : materials.of[e]];
        const double factor = materials.factor(e);
        lame[e] = {factor * l.lambda_pa, factor * l.mu_pa};
    }
    return lame;
}

bool same_law(const Material& a, const Material& b) {
    if (a.index() != b.index() || is_regularized(a) != is_regularized(b)) return false;
    const auto *p = std::get_if<Corotational>(&a), *q = std::get_if<Corotational>(&b);
    return p == nullptr || p->rotation == q->rotation;
}

}  // namespace supple::fem
