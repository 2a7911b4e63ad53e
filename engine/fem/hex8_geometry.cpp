#include "supple/fem/hex8_geometry.h"

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "supple/base/error.h"
#include "supple/fem/hex8.h"
#include "supple/fem/hex8_hyper.h"

namespace supple::fem {

double hex_shape_function(std::size_t corner, const Vec3& xi) {
    double n = 0.125;
    for (int k = 0; k < 3; ++k) n *= 1 + xi[k] * kHexCorner[corner][std::size_t(k)];
    return n;
}

HexPoint hex_point(const HexShape& X, const Vec3& xi) {
    HexPoint point;
    point.xi = xi;
    HexGradients local;
    for (std::size_t a = 0; a < 8; ++a) {
        const auto& c = kHexCorner[a];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
            local(Eigen::Index(a), Eigen::Index(k)) = 0.125 * c[k] * (1 + c[i] * xi[Eigen::Index(i)]) * (1 + c[j] * xi[Eigen::Index(j)]);
        }
    }
    point.jacobian.setZero();
    // Relative to corner 0: a mesh far from the origin loses no digits.
    for (std::size_t a = 1; a < 8; ++a) point.jacobian += (X[a] - X[0]) * local.row(Eigen::Index(a));
    point.determinant = point.jacobian.determinant();
    point.gradient = local * point.jacobian.inverse();
    return point;
}

Vec3 hex_gauss_point(std::size_t q) { return Vec3(kHexCorner[q][0], kHexCorner[q][1], kHexCorner[q][2]) / std::sqrt(3.0); }

HexShape hex_shape(std::span<const Vec3> vertices, const Hex& hex) {
    HexShape X;
    for (std::size_t a = 0; a < 8; ++a) X[a] = vertices[std::size_t(hex[a])];
    return X;
}

namespace {

/// Throws where the map is folded. @param place  words for the point
void require_unfolded(const HexPoint& point, const std::string& where, std::int32_t number, const std::string& place) {
    if (point.determinant > 0) return;
    throw Error(ErrorCode::invalid_argument, where,
                "hex " + std::to_string(number) + " (counted from 0 among the hexes) is folded: its Jacobian is " + to_text(point.determinant) + " " + place +
                    " and must be above 0; its corners must be in VTK order (round the bottom, then round the top) and its faces must not cross: remesh there");
}

}  // namespace

Hex8Rest make_hex_rest(std::span<const Vec3> vertices, std::span<const Hex> hexes, std::span<const std::int32_t> numbers, const std::string& where,
                       const Hex8Rest* before, std::span<const std::int32_t> old) {
    Hex8Rest rest;
    rest.elements = hexes.size();
    const std::size_t blocks = rest.blocks();
    rest.vertex.resize(blocks * 8 * kBlock);
    rest.edge.resize(blocks * 21 * kBlock);
    rest.gradient.resize(blocks * 21 * kBlock);
    rest.volume.resize(blocks * kBlock);
    for (std::size_t i = 0; i < blocks * kBlock; ++i) {
        const bool tail = i >= hexes.size();
        const std::size_t element = tail ? hexes.size() - 1 : i;
        if (before != nullptr && !tail && old[i] >= 0) {
            const std::size_t block = i / kBlock, lane = i % kBlock, was = std::size_t(old[i]), from = was / kBlock, from_lane = was % kBlock;
            for (std::size_t a = 0; a < 8; ++a) rest.vertex[(block * 8 + a) * kBlock + lane] = hexes[i][a];
            for (std::size_t k = 0; k < 21; ++k) {
                rest.edge[(block * 21 + k) * kBlock + lane] = before->edge[(from * 21 + k) * kBlock + from_lane];
                rest.gradient[(block * 21 + k) * kBlock + lane] = before->gradient[(from * 21 + k) * kBlock + from_lane];
            }
            rest.volume[i] = before->volume[was];
            continue;
        }
        const HexShape X = hex_shape(vertices, hexes[element]);
        require_unfolded(hex_point(X, Vec3::Zero()), where, numbers[element], "at its centre");
        double volume = 0;
        HexGradients mean = HexGradients::Zero();
        for (std::size_t q = 0; q < kHexPoints; ++q) {
            const HexPoint point = hex_point(X, hex_gauss_point(q));
            require_unfolded(point, where, numbers[element], "at the integration point towards its corner " + std::to_string(q));
            volume += point.determinant;
            mean += point.determinant * point.gradient;
        }
        mean /= volume;
        const std::size_t block = i / kBlock, lane = i % kBlock;
        for (std::size_t a = 0; a < 8; ++a) rest.vertex[(block * 8 + a) * kBlock + lane] = hexes[element][a];
        for (std::size_t a = 1; a < 8; ++a) {
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t at = (block * 21 + 3 * (a - 1) + c) * kBlock + lane;
                rest.edge[at] = X[a][Eigen::Index(c)] - X[0][Eigen::Index(c)];
                rest.gradient[at] = mean(Eigen::Index(a), Eigen::Index(c));
            }
        }
        rest.volume[i] = tail ? 0.0 : volume;
    }
    return rest;
}

HexShape hex_shape(const Hex8Rest& rest, std::size_t element) {
    HexShape X;
    X[0].setZero();
    for (std::size_t a = 1; a < 8; ++a)
        for (std::size_t c = 0; c < 3; ++c) X[a][Eigen::Index(c)] = rest.edge[(element / kBlock * 21 + 3 * (a - 1) + c) * kBlock + element % kBlock];
    return X;
}

AlignedVector<double> make_hex_points(const Hex8Rest& rest) {
    AlignedVector<double> points(rest.blocks() * kHexPoints * kHexPoint * kBlock);
    for (std::size_t i = 0; i < rest.blocks() * kBlock; ++i) {
        const HexShape X = hex_shape(rest, i);  // free lanes have shapes too
        for (std::size_t q = 0; q < kHexPoints; ++q) {
            const HexPoint point = hex_point(X, hex_gauss_point(q));
            double* to = points.data() + (i / kBlock * kHexPoints + q) * kHexPoint * kBlock + i % kBlock;
            for (std::size_t n = 0; n < 21; ++n) to[n * kBlock] = point.gradient(Eigen::Index(n / 3 + 1), Eigen::Index(n % 3));
            to[21 * kBlock] = point.determinant;
        }
    }
    return points;
}

void add_stiffness_trace(const Hex8Rest& rest, std::span<const Lame> lame, std::span<double> trace) {
    for (std::size_t e = 0; e < rest.elements; ++e) {
        const HexShape X = hex_shape(rest, e);
        const double k = lame[e].lambda_pa + 4 * lame[e].mu_pa;  // tr(lambda g g^T + mu g g^T + mu |g|^2 I) = k |g|^2
        for (std::size_t q = 0; q < kHexPoints; ++q) {
            const HexPoint point = hex_point(X, hex_gauss_point(q));
            for (std::size_t a = 0; a < 8; ++a) {
                trace[std::size_t(rest.vertex[(e / kBlock * 8 + a) * kBlock + e % kBlock])] += k * point.determinant * point.gradient.row(Eigen::Index(a)).squaredNorm();
            }
        }
    }
}

}  // namespace supple::fem
