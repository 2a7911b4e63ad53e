// Row 9: Costa's law with its frame turned.
#include <Eigen/Geometry>
#include <cmath>

#include "random.h"
#include "statics.h"
#include "supple/world/evaluate.h"
#include "table.h"

namespace supple::verify {
namespace {

const std::array<double, 6> kB{8, 4, 2, 5, 3, 1};  // ff fs ss fn sn nn: all different

Costa orthotropic(const Mat3& frame) {
    Costa m{.a_pa = 1000, .bulk_pa = 28000.0 / 3, .b = kB};
    m.fibres.fibre = {frame.col(0)};
    m.fibres.sheet = {frame.col(1)};
    return m;
}

Mat3 stress(const BodyTemplate& shape, const Material& m, const Mat3& F) {
    std::vector<Vec3> x;
    for (const Vec3& X : shape.mesh().vertices) x.push_back(F * X);
    const Voigt s = evaluate(shape, m, x).element_stress_pa[0];
    Mat3 S;
    S << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    return S;
}

void fibre_frame(Table& table, const Settings&) {
    for (const Kind kind : element_kinds()) {
        const auto shape = BodyTemplate::build(box(kind, {1, 1, 1}, Vec3::Ones()));
        Random random(11);
        double worst = 0;
        for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ()), Vec3(Vec3(1, 2, 3).normalized())}) {
            const Mat3 Q = Eigen::AngleAxisd(M_PI / 6, axis).toRotationMatrix();
            for (int k = 0; k < 10; ++k) {
                const Mat3 F = Mat3::Identity() + random.matrix(0.2);
                const Mat3 turned = stress(*shape, orthotropic(Q), F), load_turned = Q * stress(*shape, orthotropic(Mat3::Identity()), Q.transpose() * F * Q) * Q.transpose();
                worst = std::max(worst, (turned - load_turned).norm() / turned.norm());
            }
        }
        table.below("Costa, " + name(kind) + ": frame turned by 30 degrees against the load turned by -30", worst, 1e-10);
        const std::array<std::array<int, 2>, 3> planes{{{0, 1}, {0, 2}, {1, 2}}};
        const std::array<double, 3> b{kB[1], kB[3], kB[4]};
        const std::array<const char*, 3> names{"fs", "fn", "sn"};
        const Mat3 Q = Eigen::AngleAxisd(0.7, Vec3(1, -1, 2).normalized()).toRotationMatrix();
        for (std::size_t p = 0; p < 3; ++p) {
            const Vec3 i = Q.col(planes[p][0]), j = Q.col(planes[p][1]);
            const double g = 1e-6;
            const Mat3 S = stress(*shape, orthotropic(Q), Mat3::Identity() + g / 2 * (i * j.transpose() + j * i.transpose()));
            table.relative("Costa, " + name(kind) + ": shear modulus a b/2 in the plane " + names[p] + " [Pa]", 1000 * b[p] / 2, i.dot(S * j) / g, 1e-5);
        }
    }
}

const RegisterCase row9({9, "fibre frame", false, fibre_frame});

}  // namespace
}  // namespace supple::verify
