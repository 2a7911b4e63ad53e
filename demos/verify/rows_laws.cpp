// Rows 1 to 4 and 6 to 8: the laws, element by element, against their closed forms.
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <map>
#include <type_traits>

#include "laws.h"
#include "meshes.h"
#include "random.h"
#include "supple/world/evaluate.h"
#include "table.h"

namespace supple::verify {
namespace {

using Shape = std::shared_ptr<const BodyTemplate>;
using Field = std::vector<Vec3>;

/// One tetrahedron, or the unit cube as one hexahedron.
Shape one_element(Kind kind) {
    if (kind == Kind::hexes) return BodyTemplate::build(box(kind, {1, 1, 1}, Vec3::Ones()));
    VolumeMesh mesh;
    mesh.vertices = {Vec3(0, 0, 0), Vec3(1, 0.1, 0), Vec3(0.2, 0.9, 0.1), Vec3(0.1, 0.3, 1.1)};
    mesh.tets = {{0, 1, 2, 3}};
    return BodyTemplate::build(std::move(mesh));
}

Field at(const BodyTemplate& shape, const Mat3& F) {
    Field x;
    for (const Vec3& X : shape.mesh().vertices) x.push_back(F * X);
    return x;
}

Voigt stress(const BodyTemplate& shape, const Material& m, const Mat3& F) { return evaluate(shape, m, at(shape, F)).element_stress_pa[0]; }

double largest(const Field& f) {
    double size = 0;
    for (const Vec3& v : f) size = std::max(size, v.norm());
    return size;
}

double dot(const Field& a, const Field& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
    return sum;
}

Field moved(const Field& x, double s, const Field& d) {
    Field y = x;
    for (std::size_t i = 0; i < x.size(); ++i) y[i] += s * d[i];
    return y;
}

Field random_field(Random& random, std::size_t n, double size) {
    Field d(n);
    for (Vec3& v : d) v = random.vector(size);
    return d;
}

// -- row 1 ------------------------------------------------------------------------------------------------

void rigid_motion(Table& table, const Settings&) {
    for (const Kind kind : element_kinds()) {
        const auto shape = BodyTemplate::build(irregular_cube(kind, 3, 0.2, 1));
        double edge = 1;  // shortest
        for (const auto& e : shape->boundary().edges)
            edge = std::min(edge, (shape->mesh().vertices[std::size_t(e[0])] - shape->mesh().vertices[std::size_t(e[1])]).norm());
        double worst = 0;
        Random random(2);
        for (const NamedLaw& law : with_costa(all_laws())) {
            if (std::holds_alternative<Linear>(law.material)) continue;  // small displacements: knows no rotation
            const Lame lame = small_strain(law.material);
            for (int k = 0; k < 20; ++k) {
                const Mat3 R = random.rotation();
                const Vec3 t = random.vector(10);
                Field x;
                double reach = 0;
                for (const Vec3& X : shape->mesh().vertices) {
                    x.push_back(R * X + t);
                    reach = std::max(reach, x.back().norm());
                }
                const double scale = (lame.lambda_pa + 2 * lame.mu_pa) * edge * edge * reach / edge;
                worst = std::max(worst, largest(evaluate(*shape, law.material, x).forces_n) / scale);
            }
        }
        table.below("rigid motion, every law, " + name(kind) + ": force / (stiffness x size)", worst, 1e-12);
    }
}

// -- rows 2 and 3 -----------------------------------------------------------------------------------------

/// d/ds f(x + s d) at 0: central differences of fourth order, step h.
template <class F>
std::invoke_result_t<F, double> difference(double h, const F& f) {
    return (8.0 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h);
}

/// Away from where the energy has kinks (the floor of the extension through inversion at 0.1, equal and opposite singular values), which differences cannot cross.
bool smooth_spot(const Mat3& F) {
    const Vec3 s = F.jacobiSvd().singularValues();
    const double s3 = F.determinant() < 0 ? -s[2] : s[2];
    return std::abs(s3 - 0.1) > 1e-2 && std::abs(s[1] - 0.1) > 1e-2 && (s3 > 0 || s[1] + s3 > 0.05);
}

double force_error(const BodyTemplate& shape, const Material& m, const Mat3& F) {
    const Field x = at(shape, F), f = evaluate(shape, m, x).forces_n;
    double worst = 0;
    for (std::size_t v = 0; v < x.size(); ++v) {
        for (int c = 0; c < 3; ++c) {
            const double slope = difference(1e-4, [&](double s) {
                Field y = x;
                y[v][c] += s;
                return evaluate(shape, m, y).energy_j;
            });
            worst = std::max(worst, std::abs(f[v][c] + slope));
        }
    }
    return worst / largest(f);
}

void force_is_the_gradient(Table& table, const Settings&) {
    for (const Kind kind : element_kinds()) {
        const Shape shape = one_element(kind);
        for (const bool inverted : {false, true}) {
            Random random(3);
            double worst = 0;
            for (const NamedLaw& law : with_costa(all_laws())) {
                if (kind == Kind::hexes && is_corotational(law.material)) continue;  // one rotation per hexahedron: a force without an energy
                for (int k = 0; k < 20;) {
                    const Mat3 F = inverted ? Mat3(random.matrix(1.2)) : Mat3(Mat3::Identity() + random.matrix(0.25));
                    if (inverted != (F.determinant() < 0) || (!inverted && F.determinant() < 0.3) || !smooth_spot(F)) continue;
                    worst = std::max(worst, force_error(*shape, law.material, F));
                    ++k;
                }
            }
            table.below("force = -dW/dx, every law, " + name(kind) + (inverted ? ", inverted" : ""), worst, 1e-7);
        }
    }
}

void tangent_is_the_derivative(Table& table, const Settings&) {
    for (const Kind kind : element_kinds()) {
        const Shape shape = one_element(kind);
        Random random(4);
        double worst = 0, asymmetry = 0;
        for (const NamedLaw& law : with_costa(all_laws())) {
            if (kind == Kind::hexes && is_corotational(law.material)) continue;
            const Tangent tangent = is_corotational(law.material) ? Tangent::exact : Tangent::automatic;
            for (int k = 0; k < 20; ++k) {
                Mat3 F = Mat3::Identity() + random.matrix(0.25);
                if (F.determinant() < 0.3) continue;
                const Field x = at(*shape, F), d = random_field(random, x.size(), 1), e = random_field(random, x.size(), 1);
                const Field Kd = force_differential(*shape, law.material, x, d, tangent), Ke = force_differential(*shape, law.material, x, e, tangent);
                double error = 0;
                for (std::size_t v = 0; v < x.size(); ++v) {
                    const Vec3 slope = difference(1e-4, [&](double s) -> Vec3 { return evaluate(*shape, law.material, moved(x, s, d)).forces_n[v]; });
                    error = std::max(error, (Kd[v] - slope).norm());
                }
                worst = std::max(worst, error / largest(Kd));
                asymmetry = std::max(asymmetry, std::abs(dot(e, Kd) - dot(d, Ke)) / std::sqrt(dot(Kd, Kd) * dot(e, e)));
            }
        }
        table.below("tangent = dF/dx, every law, " + name(kind), worst, 1e-6);
        table.below("tangent symmetric, " + name(kind), asymmetry, 1e-12);
    }
}

// -- row 4 ------------------------------------------------------------------------------------------------

void small_strain_moduli(Table& table, const Settings&) {
    for (const Kind kind : element_kinds()) {
        const Shape shape = one_element(kind);
        for (const NamedLaw& law : with_costa(all_laws())) {
            Mat3 F = Mat3::Identity();
            F(0, 1) = 1e-6;
            table.relative(law.name + ", " + name(kind) + ": shear modulus [Pa]", 1000, stress(*shape, law.material, F)[3] / 1e-6, 1e-4);
            table.relative(law.name + ", " + name(kind) + ": bulk modulus [Pa]", 1e4, stress(*shape, law.material, (1 + 1e-6) * Mat3::Identity())[0] / 3e-6, 1e-4);
        }
    }
}

// -- rows 6 to 8 ------------------------------------------------------------------------------------------

/// P11 at an axial stretch with free sides: the lateral stretch by bisection.
double uniaxial(const BodyTemplate& shape, const Material& m, double stretch) {
    double low = 0.5, high = 1.5;
    for (int i = 0; i < 60; ++i) {
        const double t = 0.5 * (low + high);
        (stress(shape, m, Vec3(stretch, t, t).asDiagonal())[1] > 0 ? high : low) = t;
    }
    return stress(shape, m, Vec3(stretch, low, low).asDiagonal())[0] * low * low;
}

const std::map<std::string, std::array<double, 4>> kUniaxial{
    {"ArrudaBoyce", {-744.463, 264.013, 486.983, 1014.258}},      {"MooneyRivlin", {-810.969, 254.839, 455.375, 875.697}},
    {"NeoHookean", {-725.973, 266.189, 494.085, 1040.508}},       {"Ogden", {-718.592, 270.760, 513.495, 1165.972}},
    {"StVenantKirchhoff", {-418.065, 335.323, 766.452, 2721.774}}, {"VerondaWestman", {-992.988, 312.808, 748.606, 3407.888}},
    {"StableNeoHookean", {-724.698, 266.283, 494.355, 1041.219}}, {"Costa", {-723.416, 303.634, 687.806, 3467.824}}};

const std::map<std::string, std::array<double, 2>> kShear{
    {"ArrudaBoyce", {200.238, 503.757}},       {"MooneyRivlin", {200, 500}},         {"NeoHookean", {200, 500}},       {"Ogden", {201.661, 525.494}},
    {"StVenantKirchhoff", {245.333, 1208.333}}, {"VerondaWestman", {233.315, 1148.721}}, {"StableNeoHookean", {200, 500}}, {"Costa", {216.662, 827.991}}};

void uniaxial_stretch(Table& table, const Settings&) {
    constexpr std::array<double, 4> stretch{0.8, 1.1, 1.2, 1.5};
    for (const Kind kind : element_kinds()) {
        const Shape shape = one_element(kind);
        for (const NamedLaw& law : with_costa(hyperelastic_laws())) {
            for (std::size_t k = 0; k < stretch.size(); ++k) {
                char what[80];
                std::snprintf(what, sizeof what, "%s, %s, stretch %.1f: P11 [Pa]", law.name.c_str(), name(kind).c_str(), stretch[k]);
                table.relative(what, kUniaxial.at(law.name)[k], uniaxial(*shape, law.material, stretch[k]), 1e-5);
            }
        }
    }
}

void simple_shear(Table& table, const Settings&) {
    constexpr std::array<double, 2> gamma{0.2, 0.5};
    for (const Kind kind : element_kinds()) {
        const Shape shape = one_element(kind);
        double rivlin = 0;
        for (const NamedLaw& law : with_costa(hyperelastic_laws())) {
            for (std::size_t k = 0; k < gamma.size(); ++k) {
                Mat3 F = Mat3::Identity();
                F(0, 1) = gamma[k];
                const Voigt s = stress(*shape, law.material, F);
                char what[80];
                std::snprintf(what, sizeof what, "%s, %s, shear %.1f: sigma12 [Pa]", law.name.c_str(), name(kind).c_str(), gamma[k]);
                table.relative(what, kShear.at(law.name)[k], s[3], 1e-5);
                if (law.name != "Costa") rivlin = std::max(rivlin, std::abs(s[0] - s[1] - gamma[k] * s[3]) / s[3]);
            }
        }
        table.below("isotropic laws, " + name(kind) + ": Rivlin's sigma11 - sigma22 = gamma sigma12", rivlin, 1e-8);
    }
}

double hydrostatic_stress(const std::string& law, double s) {
    constexpr double mu = 1000, la = 28000.0 / 3, K = 1e4;
    const double J = s * s * s, L = std::log(J), al = 1 + mu / (la + mu);
    if (law == "NeoHookean") return (la * L + mu * (std::pow(J, 2.0 / 3) - 1)) / J;
    if (law == "StVenantKirchhoff") return (3 * la + 2 * mu) * (s * s - 1) / (2 * s);
    if (law == "StableNeoHookean") return mu * s * s / J + (la + mu) * (J - al);
    if (law == "Costa") {
        const double a = mu, b = 2, E = (s * s - 1) / 2, Qb = 3 * b * E * E * std::pow(J, -4.0 / 3);
        return a * b * std::exp(Qb) * std::pow(J, -7.0 / 3) * E + la * L;
    }
    return K * L / J;
}

void hydrostatic(Table& table, const Settings&) {
    for (const Kind kind : element_kinds()) {
        const Shape shape = one_element(kind);
        for (const NamedLaw& law : with_costa(hyperelastic_laws())) {
            for (const double s : {0.8, 1.3}) {
                char what[80];
                std::snprintf(what, sizeof what, "%s, %s, F = %.1f I: sigma [Pa]", law.name.c_str(), name(kind).c_str(), s);
                table.relative(what, hydrostatic_stress(law.name, s), stress(*shape, law.material, s * Mat3::Identity())[0], 1e-6);
            }
        }
    }
}

const RegisterCase row1({1, "rigid motion", false, rigid_motion});
const RegisterCase row2({2, "force is the gradient of the energy", false, force_is_the_gradient});
const RegisterCase row3({3, "tangent is the derivative of the force", false, tangent_is_the_derivative});
const RegisterCase row4({4, "small-strain moduli", false, small_strain_moduli});
const RegisterCase row6({6, "uniaxial stretch, free sides", false, uniaxial_stretch});
const RegisterCase row7({7, "simple shear", false, simple_shear});
const RegisterCase row8({8, "hydrostatic", false, hydrostatic});

}  // namespace
}  // namespace supple::verify
