#include "supple/fem/element_passes.h"

namespace supple::fem {

Frame frame_of(const Material& material) {
    const Corotational* corotational = std::get_if<Corotational>(&material);
    if (corotational == nullptr) return Frame::rest;
    switch (corotational->rotation) {
        case Rotation::large: return Frame::large;
        case Rotation::svd: return Frame::svd;
        case Rotation::polar: break;
    }
    return Frame::polar;
}

void run_elements(Team& team, const ElementSet& set, Tet4Pass pass, double* sum) {
    pass.vertex = set.rest.vertex.data();
    pass.gradient = set.rest.gradient.data();
    pass.volume = set.rest.volume.data();
    pass.moduli = set.moduli.data();
    const auto kernel = set.kernels.elements[std::size_t(set.frame)];
    if (sum != nullptr) return run_and_sum(team, set.rest.blocks(), set.sums, pass, sum, kernel);
    team.for_range(set.rest.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
}

void run_product(Team& team, const ElementSet& set, Tet4Product pass, double* sum) {
    pass.vertex = set.rest.vertex.data();
    pass.gradient = set.rest.gradient.data();
    pass.volume = set.rest.volume.data();
    pass.moduli = set.moduli.data();
    if (sum != nullptr) return run_and_sum(team, set.rest.blocks(), set.sums, pass, sum, set.kernels.product);
    team.for_range(set.rest.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { set.kernels.product(pass, begin, end); });
}

void gather(Team& team, const PlaceMap& map, const AlignedVector<double>& value, std::vector<Vec3>& out) {
    team.for_range(out.size(), kVertexChunk,
                   [&](std::size_t begin, std::size_t end) { gather_places(map, value.data(), begin, end, out.data()); });
}

}  // namespace supple::fem
