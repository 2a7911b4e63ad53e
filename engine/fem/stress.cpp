#include "supple/fem/stress.h"

#include <cmath>

namespace supple::fem {

double von_mises(const Voigt& s) {
    const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
    return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

Voigt element_stress(const ElementLayout& layout, const double* block_stress, std::size_t element) {
    const std::size_t slot = layout.slot[element];
    Voigt stress;
    for (std::size_t c = 0; c < 6; ++c) stress[c] = block_stress[(slot / kBlock * 6 + c) * kBlock + slot % kBlock];
    return stress;
}

Voigt recover_at_vertex(const ElementMap& map, std::span<const double> volume, std::span<const Voigt> element_stress, std::size_t vertex) {
    Voigt sum{};
    double total = 0;
    for (std::int64_t i = map.start[vertex]; i < map.start[vertex + 1]; ++i) {
        const std::size_t element = std::size_t(map.element[std::size_t(i)]);
        total += volume[element];
        for (std::size_t c = 0; c < 6; ++c) sum[c] += volume[element] * element_stress[element][c];
    }
    if (total > 0) {
        for (double& s : sum) s /= total;
    }
    return sum;
}

}  // namespace supple::fem
