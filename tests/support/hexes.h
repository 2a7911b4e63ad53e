#pragma once
// Free shapes of one hexahedron.
#include <Eigen/Dense>

#include "supple/fem/hex8_geometry.h"
#include "supple/material/material.h"
#include "bodies.h"

namespace supple::test {

inline constexpr Integration kBoth[] = {Integration::full, Integration::incompatible};

inline fem::HexShape shaken_cube(double shake, std::uint64_t seed) {
    Random random(seed);
    fem::HexShape X;
    for (std::size_t a = 0; a < 8; ++a) {
        X[a] = Vec3(fem::kHexCorner[a][0], fem::kHexCorner[a][1], fem::kHexCorner[a][2]) / 2 + random.vector(shake);
    }
    return X;
}

inline Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& K) { return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues(); }

}  // namespace supple::test
