#include "supple/fem/recovery.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "supple/fem/element_geometry.h"

namespace supple::fem {

namespace {

using Vec4 = Eigen::Vector4d;
using Mat4 = Eigen::Matrix4d;

constexpr double kMostMagnification = 10;

struct Share {
    std::int32_t element;
    double weight;
};
using Shares = std::vector<Share>;

/// The elements of a mesh round their vertices.
struct Incidence {
    std::vector<Vec3> centre;                         ///< [element]
    std::vector<double> volume;
    std::vector<std::array<std::int32_t, 8>> corner;
    std::vector<std::size_t> corners;
    std::vector<std::vector<std::int32_t>> around;    ///< [vertex] elements, ascending

    explicit Incidence(const VolumeMesh& mesh) : around(mesh.vertices.size()) {
        for (std::size_t e = 0; e < mesh.element_count(); ++e) {
            const ElementGeometry g = element_geometry(mesh, e);
            centre.push_back(g.centre);
            volume.push_back(g.volume);
            corner.push_back(g.vertex);
            corners.push_back(g.corners);
            for (std::size_t a = 0; a < g.corners; ++a) around[std::size_t(g.vertex[a])].push_back(std::int32_t(e));
        }
    }

    std::vector<std::int32_t> neighbours(std::size_t vertex) const {
        std::vector<std::int32_t> all;
        for (const std::int32_t e : around[vertex]) all.insert(all.end(), corner[std::size_t(e)].begin(), corner[std::size_t(e)].begin() + std::ptrdiff_t(corners[std::size_t(e)]));
        std::sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
        return all;
    }

    std::vector<std::int32_t> wide_patch(std::size_t vertex) const {
        std::vector<std::int32_t> all;
        for (const std::int32_t v : neighbours(vertex)) all.insert(all.end(), around[std::size_t(v)].begin(), around[std::size_t(v)].end());
        std::sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
        return all;
    }
};

/// Weights with which the fit over a patch gives its value at `place`; empty if the patch does not bear it.
Shares fit(const Incidence& mesh, const std::vector<std::int32_t>& patch, const Vec3& place) {
    if (patch.size() < 4) return {};
    Vec3 middle = Vec3::Zero();
    for (const std::int32_t e : patch) middle += mesh.centre[std::size_t(e)] / double(patch.size());
    double size = 0;
    for (const std::int32_t e : patch) size = std::max(size, (mesh.centre[std::size_t(e)] - middle).norm());
    if (!(size > 0)) return {};
    const auto basis = [&](const Vec3& x) {
        const Vec3 u = (x - middle) / size;
        return Vec4(1, u.x(), u.y(), u.z());
    };
    Mat4 normal = Mat4::Zero();
    for (const std::int32_t e : patch) {
        const Vec4 p = basis(mesh.centre[std::size_t(e)]);
        normal += p * p.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Mat4> eigen(normal);
    if (!(eigen.eigenvalues()[0] > 1e-10 * eigen.eigenvalues()[3])) return {};
    const Vec4 row = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().cwiseProduct(eigen.eigenvectors().transpose() * basis(place));
    Shares shares;
    double magnification = 0;
    for (const std::int32_t e : patch) {
        shares.push_back({e, row.dot(basis(mesh.centre[std::size_t(e)]))});
        magnification += std::abs(shares.back().weight);
    }
    return magnification <= kMostMagnification ? shares : Shares{};
}

/// Mean of several fits: one entry per element.
Shares mean(std::vector<Shares> fits) {
    Shares all;
    for (const Shares& f : fits) {
        for (const Share& s : f) all.push_back({s.element, s.weight / double(fits.size())});
    }
    std::stable_sort(all.begin(), all.end(), [](const Share& a, const Share& b) { return a.element < b.element; });
    Shares merged;
    for (const Share& s : all) {
        if (merged.empty() || merged.back().element != s.element) {
            merged.push_back(s);
        } else {
            merged.back().weight += s.weight;
        }
    }
    return merged;
}

Shares spr_shares(const Incidence& mesh, const std::vector<Vec3>& X, const std::vector<bool>& on_boundary, std::size_t v) {
    if (on_boundary[v]) {
        std::vector<Shares> fits;
        for (const std::int32_t n : mesh.neighbours(v)) {
            if (on_boundary[std::size_t(n)]) continue;
            Shares f = fit(mesh, mesh.around[std::size_t(n)], X[v]);
            if (!f.empty()) fits.push_back(std::move(f));
        }
        if (!fits.empty()) return mean(std::move(fits));
    } else if (Shares own = fit(mesh, mesh.around[v], X[v]); !own.empty()) {
        return own;
    }
    return fit(mesh, mesh.wide_patch(v), X[v]);
}

Shares mean_shares(const Incidence& mesh, std::size_t v, bool by_volume) {
    Shares shares;
    double total = 0;
    for (const std::int32_t e : mesh.around[v]) {
        shares.push_back({e, by_volume ? mesh.volume[std::size_t(e)] : 1.0});
        total += shares.back().weight;
    }
    for (Share& s : shares) s.weight /= total;
    return shares;
}

}  // namespace

Voigt RecoveryWeights::at(std::span<const Voigt> element_stress, std::size_t vertex) const {
    Voigt sum{};
    for (std::int64_t i = start[vertex]; i < start[vertex + 1]; ++i) {
        const Voigt& s = element_stress[std::size_t(element[std::size_t(i)])];
        for (std::size_t c = 0; c < 6; ++c) sum[c] += weight[std::size_t(i)] * s[c];
    }
    return sum;
}

RecoveryWeights make_recovery(const VolumeMesh& mesh, std::span<const std::int32_t> boundary_vertices, Recovery recovery) {
    const Incidence incidence(mesh);
    std::vector<bool> on_boundary(mesh.vertices.size(), false);
    for (const std::int32_t v : boundary_vertices) on_boundary[std::size_t(v)] = true;
    RecoveryWeights weights;
    weights.start.push_back(0);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        Shares shares;
        if (!incidence.around[v].empty()) {
            if (recovery == Recovery::spr) {
                shares = spr_shares(incidence, mesh.vertices, on_boundary, v);
                if (shares.empty()) ++weights.fallbacks;
            }
            if (shares.empty()) shares = mean_shares(incidence, v, recovery != Recovery::raw);
        }
        for (const Share& s : shares) {
            weights.element.push_back(s.element);
            weights.weight.push_back(s.weight);
        }
        weights.start.push_back(std::int64_t(weights.element.size()));
    }
    return weights;
}

}  // namespace supple::fem
