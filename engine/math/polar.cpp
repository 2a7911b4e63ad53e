#include "supple/math/polar.h"

#include <Eigen/Eigenvalues>

namespace supple {

std::array<double, 4> polar_quaternion(const Mat3& F) {
    const double scale = F.cwiseAbs().maxCoeff();
    if (!(scale > 0)) return {1, 0, 0, 0};
    const Mat3 A = F / scale;
    // q^T K q = tr(R(q)^T A) for unit q = (w, x, y, z).
    Eigen::Matrix4d K;
    K << A(0, 0) + A(1, 1) + A(2, 2), A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1),  //
        0, A(0, 0) - A(1, 1) - A(2, 2), A(0, 1) + A(1, 0), A(0, 2) + A(2, 0),                   //
        0, 0, A(1, 1) - A(0, 0) - A(2, 2), A(1, 2) + A(2, 1),                                   //
        0, 0, 0, A(2, 2) - A(0, 0) - A(1, 1);
    K.triangularView<Eigen::StrictlyLower>() = K.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(K);
    Eigen::Vector4d q = solver.eigenvectors().col(3);
    if (q[0] < 0) q = -q;
    return {q[0], q[1], q[2], q[3]};
}

Mat3 rotation_matrix(const std::array<double, 4>& wxyz) {
    const auto [w, x, y, z] = wxyz;
    Mat3 R;
    R << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
    return R;
}

}  // namespace supple
