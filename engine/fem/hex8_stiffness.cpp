// Stiffness of the trilinear hexahedron, by 2x2x2 Gauss points.
//
// `full`: K = sum_q w_q B^T D B with the gradients of the eight shape functions. Bending asks for displacements quadratic along the element, which are not there: it locks
// in shear; and it locks in volume where lambda >> mu.
//
// `incompatible`: the strain gets twelve inner parameters a, one element's own,
//     e = B u + G a,        G_k = (det J0 / det J) g_k(xi),
// and energy is stationary in them: K = K_uu - K_ua K_aa^-1 K_au, a 24x24 matrix again.
//   * Nine are the gradients of the quadratic displacements (1 - xi_k^2) e_i, taken with the Jacobian J0 of the centre: -2 xi_k sym(e_i (J0^-T e_k)^T). They cure bending
//     (Wilson et al. 1973; Taylor, Beresford, Wilson 1976 for J0 and the factor det J0/det J, by which sum_q w_q G = 0, so that constant stress does no work on them: the patch test,
//     whatever the shape).
//   * Three are volumetric, xi eta I, eta zeta I, zeta xi I. A trilinear displacement has a divergence with the parts 1, xi, eta, zeta and these three; the nine can cancel the linear
//     ones and these the bilinear ones, so that for lambda >> mu only the mean dilatation is constrained (Simo, Armero, Taylor 1993).
// Putting the mean dilatation in place of the whole volumetric strain (B-bar) *and* adding the nine would not do: the conformal motions, whose strain is a linear function times I, would
// then cost nothing - three hourglass modes.
#include "supple/fem/hex8_stiffness.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "supple/base/assert.h"

namespace supple::fem {

namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Strain = Eigen::Matrix<double, 6, 1>;  // xx yy zz, and engineering shears xy yz zx

constexpr int kModes = 12;

Mat6 elasticity(const Lame& lame) {
    Mat6 D = Mat6::Zero();
    D.topLeftCorner<3, 3>().setConstant(lame.lambda_pa);
    for (int i = 0; i < 3; ++i) D(i, i) += 2 * lame.mu_pa;
    for (int i = 3; i < 6; ++i) D(i, i) = lame.mu_pa;
    return D;
}

/// Strain of the displacement gradient e_i g^T.
Strain strain_of(int i, const Vec3& g) {
    Strain e = Strain::Zero();
    e[i] = g[i];
    const int xy = 3, yz = 4, zx = 5;
    if (i == 0) { e[xy] = g[1]; e[zx] = g[2]; }
    if (i == 1) { e[xy] = g[0]; e[yz] = g[2]; }
    if (i == 2) { e[yz] = g[1]; e[zx] = g[0]; }
    return e;
}

}  // namespace

Mat24 hex_stiffness(const HexShape& X, const Lame& lame, Integration integration) {
    const Mat6 D = elasticity(lame);
    const HexPoint centre = hex_point(X, Vec3::Zero());
    const Mat3 J0_inverse_T = centre.jacobian.inverse().transpose();
    Mat24 K = Mat24::Zero();
    Eigen::Matrix<double, 24, kModes> K_ua = Eigen::Matrix<double, 24, kModes>::Zero();
    Eigen::Matrix<double, kModes, kModes> K_aa = Eigen::Matrix<double, kModes, kModes>::Zero();
    for (std::size_t q = 0; q < kHexPoints; ++q) {
        const HexPoint point = hex_point(X, hex_gauss_point(q));
        Eigen::Matrix<double, 6, 24> B;
        for (int a = 0; a < 8; ++a)
            for (int i = 0; i < 3; ++i) B.col(3 * a + i) = strain_of(i, point.gradient.row(a));
        const Eigen::Matrix<double, 6, 24> DB = D * B;
        K.noalias() += point.determinant * B.transpose() * DB;
        if (integration == Integration::full) continue;
        const double factor = centre.determinant / point.determinant;
        Eigen::Matrix<double, 6, kModes> G = Eigen::Matrix<double, 6, kModes>::Zero();
        for (int k = 0; k < 3; ++k) {
            const Vec3 g = -2 * point.xi[k] * factor * J0_inverse_T.col(k);
            for (int i = 0; i < 3; ++i) G.col(3 * k + i) = strain_of(i, g);
            // lengths: a_k of the nine are displacements, of these three displacements too
            G.col(9 + k).head<3>().setConstant(factor * point.xi[k] * point.xi[(k + 1) % 3] / std::cbrt(centre.determinant));
        }
        K_ua.noalias() += point.determinant * DB.transpose() * G;
        K_aa.noalias() += point.determinant * G.transpose() * D * G;
    }
    if (integration == Integration::incompatible) K.noalias() -= K_ua * K_aa.ldlt().solve(K_ua.transpose());
    return 0.5 * (K + K.transpose());
}

namespace {

/// What decides an element's stiffness but for its size and shear modulus, rounded so that the cells of a lattice agree in spite of the rounding of their vertices.
using Key = std::array<std::int64_t, 23>;

std::int64_t rounded_bits(double x) {  // to 42 bits
    int exponent = 0;
    const double mantissa = std::frexp(x, &exponent);
    return std::llround(std::ldexp(mantissa, 42)) * 4096 + exponent;
}

double size_of(const HexShape& X) {
    double size = 0;
    for (std::size_t a = 1; a < 8; ++a) size = std::max(size, (X[a] - X[0]).cwiseAbs().maxCoeff());
    return size;
}

Key key_of(const HexShape& X, double size, const Lame& lame, Integration integration) {
    Key key;
    for (std::size_t a = 1; a < 8; ++a)
        for (std::size_t c = 0; c < 3; ++c) key[3 * (a - 1) + c] = std::llround(std::ldexp((X[a] - X[0])[Eigen::Index(c)] / size, 36));
    key[21] = rounded_bits(lame.lambda_pa / lame.mu_pa);
    key[22] = std::int64_t(integration);
    return key;
}

void append(const Mat24& K, AlignedVector<double>& out) {
    for (int a = 0; a < 8; ++a)
        for (int b = a; b < 8; ++b)
            for (int j = 0; j < 3; ++j) {
                for (int i = 0; i < 3; ++i) out.push_back(K(3 * a + i, 3 * b + j));
                out.push_back(0);
            }
}

/// The class that the elements of a block share, or their inner blocks side by side.
void place_blocks(const Hex8Rest& rest, HexStiffness& stiffness) {
    for (std::size_t block = 0; block < rest.blocks(); ++block) {
        const auto class_at = [&](std::size_t lane) { return stiffness.class_of[std::min(block * kBlock + lane, rest.elements - 1)]; };
        bool same = true;
        for (std::size_t lane = 1; lane < kBlock; ++lane) same = same && class_at(lane) == class_at(0);
        if (same) {
            stiffness.place.push_back(class_at(0));
            continue;
        }
        const std::size_t own = stiffness.own.size();
        stiffness.place.push_back(-1 - std::int64_t(own / (kHexInner * kBlock)));
        stiffness.own.resize(own + kHexInner * kBlock);
        for (std::size_t a = 1; a < 8; ++a)
            for (std::size_t b = a; b < 8; ++b)
                for (std::size_t n = 0; n < 9; ++n)
                    for (std::size_t lane = 0; lane < kBlock; ++lane)
                        stiffness.own[own + (hex_pair(a - 1, b - 1, 7) * 9 + n) * kBlock + lane] =
                            stiffness.shared_d[std::size_t(class_at(lane)) * kHexBlocks + hex_pair(a, b) * 12 + n / 3 * 4 + n % 3];
    }
}

}  // namespace

HexStiffness make_hex_stiffness(const Hex8Rest& rest, std::span<const Lame> lame, std::span<const Integration> integration, bool single_precision) {
    SUPPLE_ASSERT(lame.size() == rest.elements && integration.size() == rest.elements);
    HexStiffness stiffness;
    stiffness.class_of.resize(rest.elements);
    stiffness.scale.assign(rest.blocks() * kBlock, 0.0);
    std::map<Key, std::int32_t> classes;
    for (std::size_t e = 0; e < rest.elements; ++e) {
        HexShape X = hex_shape(rest, e);
        const double size = size_of(X);
        const auto [found, is_new] = classes.try_emplace(key_of(X, size, lame[e], integration[e]), std::int32_t(classes.size()));
        stiffness.class_of[e] = found->second;
        stiffness.scale[e] = size * lame[e].mu_pa;
        if (!is_new) continue;
        for (Vec3& x : X) x /= size;
        append(hex_stiffness(X, {lame[e].lambda_pa / lame[e].mu_pa, 1}, integration[e]), stiffness.shared_d);
    }
    place_blocks(rest, stiffness);
    if (single_precision) stiffness.shared_f.assign(stiffness.shared_d.begin(), stiffness.shared_d.end());
    return stiffness;
}

}  // namespace supple::fem
