#include "supple/fem/element_passes.h"

#include "supple/math/polar.h"

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

void run_elements(Team& team, const ElementSet& set, Tet4Pass pass) {
    pass.vertex = set.rest.vertex.data();
    pass.gradient = set.rest.gradient.data();
    pass.volume = set.rest.volume.data();
    pass.moduli = set.moduli.data();
    team.for_range(set.rest.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { set.kernels.elements[std::size_t(set.frame)](pass, begin, end); });
}

void stiffness_product(Team& team, const ElementSet& set, const double* quaternion, const double* twist, std::span<const Vec3> field,
                       AlignedVector<double>& corner, std::vector<Vec3>& out) {
    Tet4Product pass;
    pass.vertex = set.rest.vertex.data();
    pass.gradient = set.rest.gradient.data();
    pass.volume = set.rest.volume.data();
    pass.moduli = set.moduli.data();
    pass.quaternion = quaternion;
    pass.twist = twist;
    pass.field = field.data()->data();
    pass.corner_force = corner.data();
    team.for_range(set.rest.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { set.kernels.product(pass, begin, end); });
    gather(team, set.corners, corner, out);
}

void gather(Team& team, const CornerMap& corners, const AlignedVector<double>& corner, std::vector<Vec3>& out) {
    team.for_range(out.size(), kVertexChunk,
                   [&](std::size_t begin, std::size_t end) { gather_corners(corners, corner.data(), begin, end, out.data()); });
}

void seed_rotations(Team& team, const Tet4Rest& rest, std::span<const Vec3> positions, AlignedVector<double>& quaternion) {
    team.for_range(rest.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin * kBlock; i < end * kBlock; ++i) {
            const std::size_t block = i / kBlock, lane = i % kBlock;
            const auto vertex = [&](std::size_t a) -> const Vec3& {
                return positions[std::size_t(rest.vertex[(block * 4 + a) * kBlock + lane])];
            };
            Mat3 F = Mat3::Zero();
            for (std::size_t k = 0; k < 3; ++k) {
                const double* g = rest.gradient.data() + (block * 9 + 3 * k) * kBlock + lane;
                F += (vertex(k + 1) - vertex(0)) * Vec3(g[0], g[kBlock], g[2 * kBlock]).transpose();
            }
            const std::array<double, 4> q = polar_quaternion(F);
            for (std::size_t c = 0; c < 4; ++c) quaternion[(block * 4 + c) * kBlock + lane] = q[c];
        }
    });
}

}  // namespace supple::fem
