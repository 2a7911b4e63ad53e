#include "supple/fem/rest.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>

#include "supple/base/assert.h"

namespace supple::fem {

Tet4Rest make_rest(std::span<const Vec3> vertices, std::span<const Tet> tets, const Tet4Rest* before, std::span<const std::int32_t> old) {
    Tet4Rest rest;
    rest.elements = tets.size();
    rest.vertices = vertices.size();
    const std::size_t blocks = rest.blocks();
    rest.vertex.resize(blocks * 4 * kBlock);
    rest.gradient.resize(blocks * 9 * kBlock);
    rest.volume.resize(blocks * kBlock);
    for (std::size_t i = 0; i < blocks * kBlock; ++i) {
        const bool tail = i >= tets.size();
        const Tet& tet = tets[tail ? tets.size() - 1 : i];
        const std::size_t block = i / kBlock, lane = i % kBlock;
        for (std::size_t a = 0; a < 4; ++a) rest.vertex[(block * 4 + a) * kBlock + lane] = tet[a];
        if (before != nullptr && !tail && old[i] >= 0) {
            const std::size_t was = std::size_t(old[i]);
            const double* from = before->gradient.data() + was / kBlock * 9 * kBlock + was % kBlock;
            double* to = rest.gradient.data() + block * 9 * kBlock + lane;
            for (std::size_t k = 0; k < 9; ++k) to[k * kBlock] = from[k * kBlock];
            rest.volume[i] = before->volume[was];
            continue;
        }
        Mat3 Dm;  // columns: rest edges from corner 0
        for (int k = 0; k < 3; ++k) Dm.col(k) = vertices[std::size_t(tet[std::size_t(k) + 1])] - vertices[std::size_t(tet[0])];
        const double det = Dm.determinant();
        SUPPLE_ASSERT(det > 0);
        const Mat3 G = Dm.inverse();  // row k is the gradient of the barycentric coordinate of corner k + 1
        for (int k = 0; k < 3; ++k)
            for (int c = 0; c < 3; ++c) rest.gradient[(block * 9 + std::size_t(3 * k + c)) * kBlock + lane] = G(k, c);
        rest.volume[i] = tail ? 0.0 : det / 6;
    }
    return rest;
}

AlignedVector<double> make_moduli(std::size_t blocks, std::span<const Lame> lame) {
    AlignedVector<double> moduli(blocks * 2 * kBlock);
    for (std::size_t i = 0; i < blocks * kBlock; ++i) {
        const Lame& l = lame[std::min(i, lame.size() - 1)];
        moduli[(i / kBlock * 2) * kBlock + i % kBlock] = l.lambda_pa;
        moduli[(i / kBlock * 2 + 1) * kBlock + i % kBlock] = l.mu_pa;
    }
    return moduli;
}

namespace {

Vec3 rest_gradient(const Tet4Rest& rest, std::size_t element, std::size_t corner) {
    const double* g = rest.gradient.data() + element / kBlock * 9 * kBlock + element % kBlock;
    if (corner > 0) return {g[(3 * corner - 3) * kBlock], g[(3 * corner - 2) * kBlock], g[(3 * corner - 1) * kBlock]};
    return -(rest_gradient(rest, element, 1) + rest_gradient(rest, element, 2) + rest_gradient(rest, element, 3));
}

double modulus(std::span<const double> moduli, std::size_t element, std::size_t which) {
    return moduli[(element / kBlock * 2 + which) * kBlock + element % kBlock];
}

}  // namespace

double laplacian_entry(const Tet4Rest& rest, std::span<const double> moduli, std::uint32_t pair) {
    const std::size_t element = pair >> 4;
    return modulus(moduli, element, 1) * rest.volume[element] *
           rest_gradient(rest, element, (pair >> 2) & 3).dot(rest_gradient(rest, element, pair & 3));
}

std::vector<double> laplacian_entries(const Tet4Rest& rest, std::span<const double> moduli, std::span<const std::int64_t> start, std::span<const std::uint32_t> pair) {
    struct Gradients {
        std::array<Vec3, 4> g;
        double weight;
    };
    std::vector<Gradients> of(rest.elements);
    for (std::size_t e = 0; e < rest.elements; ++e) {
        for (std::size_t a = 1; a < 4; ++a) of[e].g[a] = rest_gradient(rest, e, a);
        of[e].g[0] = -(of[e].g[1] + of[e].g[2] + of[e].g[3]);
        of[e].weight = modulus(moduli, e, 1) * rest.volume[e];
    }
    std::vector<double> out(start.size() - 1, 0.0);
    for (std::size_t b = 0; b < out.size(); ++b) {
        for (std::int64_t i = start[b]; i < start[b + 1]; ++i) {
            const std::uint32_t p = pair[std::size_t(i)];
            const Gradients& element = of[p >> 4];
            out[b] += element.weight * element.g[(p >> 2) & 3].dot(element.g[p & 3]);
        }
    }
    return out;
}

void add_stiffness_trace(const Tet4Rest& rest, std::span<const double> moduli, std::span<double> trace) {
    // tr(lambda g g^T + mu g g^T + mu |g|^2 I) = (lambda + 4 mu) |g|^2
    for (std::size_t e = 0; e < rest.elements; ++e) {
        const double k = rest.volume[e] * (modulus(moduli, e, 0) + 4 * modulus(moduli, e, 1));
        for (std::size_t a = 0; a < 4; ++a) {
            trace[std::size_t(rest.vertex[(e / kBlock * 4 + a) * kBlock + e % kBlock])] += k * rest_gradient(rest, e, a).squaredNorm();
        }
    }
}

}  // namespace supple::fem
