// Row 20: a manufactured solution. The body force that makes u = A d sin(pi x) sin(pi y) sin(pi z) an equilibrium comes from the law's closed form by complex steps.
#include <cmath>

#include "laws.h"
#include "quadrature.h"
#include "statics.h"
#include "table.h"

namespace supple::verify {
namespace {

const Vec3 kAmplitude(0.03, 0.02, -0.025);

Vec3 displacement(const Vec3& X) { return kAmplitude * (std::sin(M_PI * X[0]) * std::sin(M_PI * X[1]) * std::sin(M_PI * X[2])); }

template <class T>
Tensor<T> displacement_gradient(const Eigen::Matrix<T, 3, 1>& X) {
    Eigen::Matrix<T, 1, 3> g;
    for (int j = 0; j < 3; ++j) {
        g[j] = M_PI;
        for (int k = 0; k < 3; ++k) g[j] *= k == j ? std::cos(M_PI * X[k]) : std::sin(M_PI * X[k]);
    }
    return kAmplitude.template cast<T>() * g;
}

/// -Div P(I + grad u).
Vec3 body_force(const Material& m, const Vec3& X) {
    using Complex = std::complex<double>;
    constexpr double h = 1e-30;
    Vec3 force = Vec3::Zero();
    for (int j = 0; j < 3; ++j) {
        Eigen::Matrix<Complex, 3, 1> Z = X.cast<Complex>();
        Z[j] += Complex(0, h);
        const Tensor<Complex> F = Tensor<Complex>::Identity() + displacement_gradient<Complex>(Z);
        force -= first_piola<Complex>(m, F).col(j).imag() / h;
    }
    return force;
}

FieldErrors errors(Kind kind, int n, const Material& material, const Settings& settings) {
    Statics cube(box(kind, {n, n, n}, Vec3::Ones()), material, {.tolerance = 1e-8, .threads = settings.threads, .preconditioner = PreconditionerKind::automatic});
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {0.0, 1.0}) cube.hold(on_plane(axis, side));
    cube.load(body_forces(cube.mesh(), [&](const Vec3& X) { return body_force(material, X); }));
    cube.solve();
    return field_errors(cube.mesh(), cube.x(), displacement, displacement_gradient<double>);
}

void manufactured(Table& table, const Settings& settings) {
    constexpr double kBulk = 5000.0 / 3;  // Poisson's ratio 1/4: no locking on the way to the asymptotic rate
    std::vector<NamedLaw> laws = all_laws(kBulk);
    for (NamedLaw& law : laws)
        if (law.name == "Ogden") law.material = Ogden{.terms = {{800, 2}, {1200, 4}}, .bulk_pa = kBulk};  // exponents that the closed form here can take
    for (const Kind kind : element_kinds()) {
        std::vector<NamedLaw> with = with_costa(laws);
        if (auto* costa = std::get_if<Costa>(&with.back().material)) costa->bulk_pa = kBulk - 2000.0 / 3;  // its K acts as Lame's lambda
        for (const NamedLaw& law : with) {
            const FieldErrors coarse = errors(kind, 8, law.material, settings), fine = errors(kind, 16, law.material, settings);
            table.order("manufactured solution, " + law.name + ", " + name(kind) + ": L2 order", 2, std::log2(coarse.l2 / fine.l2), 0.1);
            table.order("manufactured solution, " + law.name + ", " + name(kind) + ": H1 order", 1, std::log2(coarse.h1 / fine.h1), 0.1);
        }
    }
}

const RegisterCase row20({20, "manufactured solution", true, manufactured});

}  // namespace
}  // namespace supple::verify
