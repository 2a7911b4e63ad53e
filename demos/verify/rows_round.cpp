// Rows 17 and 19: thick cylinders and spheres under pressure, the cylinder twisted.
#include <Eigen/Geometry>
#include <cmath>
#include <memory>

#include "quadrature.h"
#include "statics.h"
#include "supple/world/evaluate.h"
#include "table.h"

namespace supple::verify {
namespace {

constexpr double kYoung = 1e5, kPoisson = 0.3, kInner = 1, kOuter = 2, kPressure = 100;

/// Lame's stress of a wall that is `kind` = 2: a cylinder in plane strain, 3: a sphere.
Mat3 lame_stress(int dimension, const Vec3& X) {
    Vec3 direction = X;
    if (dimension == 2) direction.z() = 0;
    const double r = direction.norm(), power = dimension, a = std::pow(kInner, power), b = std::pow(kOuter, power), rb = b / std::pow(r, power);
    const double radial = kPressure * a / (b - a) * (1 - rb), tangential = kPressure * a / (b - a) * (1 + rb / (power - 1));
    const Vec3 n = direction / r;
    Mat3 s = tangential * Mat3::Identity() + (radial - tangential) * n * n.transpose();
    if (dimension == 2) s(2, 2) = kPoisson * (radial + tangential);
    return s;
}

Where on_sphere(double radius) {
    return [=](const Vec3& X) { return std::abs(X.norm() - radius) < 1e-9; };
}

/// Mean over a sphere of the rest shape: growth of its radius.
double growth(const Statics& body, double radius) {
    double sum = 0;
    const auto vertices = body.select(on_sphere(radius));
    for (const std::int32_t v : vertices) sum += body.x()[std::size_t(v)].norm() - radius;
    return sum / double(vertices.size());
}

double mean_von_mises(const Statics& body, double radius) {
    double sum = 0;
    const auto vertices = body.select(on_sphere(radius));
    for (const std::int32_t v : vertices) sum += von_mises(body.nodal_stress()[std::size_t(v)]);
    return sum / double(vertices.size());
}

struct WallErrors {
    double raw = 0, recovered = 0;  ///< relative L2 norms
    double radial = 0, tangential = 0, von_mises = 0;  ///< recovered, means over the inner face
};

WallErrors wall(Kind kind, int dimension, int n, const Settings& settings) {
    VolumeMesh mesh = dimension == 2 ? quarter_tube(kind, 2 * n, n, 2, kInner, kOuter, 2 * (kOuter - kInner) / n) : shell_octant(kind, n, n, kInner, kOuter);
    Statics body(std::move(mesh), Linear{.young_pa = kYoung, .poisson = kPoisson},
                 {.threads = settings.threads, .preconditioner = dimension == 2 ? PreconditionerKind::direct : PreconditionerKind::automatic});
    for (int axis = 0; axis < 3; ++axis) body.hold(on_plane(axis, 0), {.x = axis == 0, .y = axis == 1, .z = axis == 2});
    if (dimension == 2) body.hold(everywhere(), {.x = false, .y = false, .z = true});
    const Where inside = [&](const Vec3& X) { return std::abs((dimension == 2 ? X.head<2>().norm() : X.norm()) - kInner) < 1e-9; };
    body.load(traction_forces(body.mesh(), inside, [&](const Vec3& X, const Vec3&) -> Vec3 {
        return kPressure * (dimension == 2 ? Vec3(X.x(), X.y(), 0) : X).normalized();
    }));
    body.solve();
    const auto exact = [&](const Vec3& X) { return lame_stress(dimension, X); };
    const auto nodes = body.nodal_stress(), elements = body.world().element_cauchy_stress(body.body());
    WallErrors e;
    e.raw = stress_error(body.mesh(), {}, elements, exact);
    e.recovered = stress_error(body.mesh(), nodes, {}, exact);
    const auto vertices = body.select(inside);
    for (const std::int32_t v : vertices) {
        Vec3 d = body.mesh().vertices[std::size_t(v)];
        if (dimension == 2) d.z() = 0;
        const Mat3 s = tensor(nodes[std::size_t(v)]);
        const double radial = d.dot(s * d) / d.squaredNorm();
        e.radial += radial / double(vertices.size());
        e.tangential += (dimension == 2 ? s(0, 0) + s(1, 1) - radial : (s.trace() - radial) / 2) / double(vertices.size());
        e.von_mises += von_mises(nodes[std::size_t(v)]) / double(vertices.size());
    }
    return e;
}

void lame(Table& table, const Settings& settings) {
    for (const int dimension : {2, 3}) {
        for (const Kind kind : element_kinds()) {
            const int n = dimension == 2 ? 16 : 9;
            const WallErrors coarse = wall(kind, dimension, n, settings), fine = wall(kind, dimension, 2 * n, settings);
            const std::string what = std::string(dimension == 2 ? "thick cylinder" : "thick sphere") + ", " + name(kind) + ", " + std::to_string(2 * n) + " through the wall: ";
            const Mat3 exact = lame_stress(dimension, Vec3(kInner, 0, 0));
            const double vm = dimension == 2 ? von_mises({exact(0, 0), exact(1, 1), exact(2, 2), 0, 0, 0}) : exact(1, 1) - exact(0, 0);
            table.relative(what + "radial stress inside [Pa]", exact(0, 0), fine.radial, 0.02);
            table.relative(what + "tangential stress inside [Pa]", exact(1, 1), fine.tangential, 0.02);
            table.relative(what + "von Mises inside [Pa]", vm, fine.von_mises, 0.02);
            const double raw = std::log2(coarse.raw / fine.raw), recovered = std::log2(coarse.recovered / fine.recovered);
            table.below(what + "L2 error of the elements' stress", fine.raw, 0.1, raw);
            table.below(what + "L2 error of the recovered stress", fine.recovered, 0.02, recovered);
            table.order_at_least(what + "order, elements", 0.9, raw);
            table.order_at_least(what + "order, recovered", 1.5, recovered);
        }
    }
}

/// The sphere of matter that keeps its volume, in small strain: Lame's solution at nu = .4999. Tets have their volumetric stiffness at the vertices.
void nearly_incompressible_sphere(Table& table, const Settings& settings) {
    const double poisson = 0.4999, a3 = std::pow(kInner, 3), b3 = std::pow(kOuter, 3);
    const double exact = kPressure * a3 / (b3 - a3) * ((1 - 2 * poisson) * kInner / kYoung + (1 + poisson) * b3 / (2 * kYoung * kInner * kInner));
    for (const Kind kind : element_kinds()) {
        const bool tets = kind == Kind::tets;  // their volumetric stiffness lies beside the matrix: a factor does not hold it
        const auto solve = [&](int layers) {
            auto body = std::make_unique<Statics>(shell_octant(kind, layers / 2, layers, kInner, kOuter), Linear{.young_pa = kYoung, .poisson = poisson, .volumetric = Volumetric::nodal},
                                                  StaticDef{.tolerance = 1e-6, .threads = settings.threads, .preconditioner = tets ? PreconditionerKind::automatic : PreconditionerKind::direct});
            for (int axis = 0; axis < 3; ++axis) body->hold(on_plane(axis, 0), {.x = axis == 0, .y = axis == 1, .z = axis == 2});
            body->load(traction_forces(body->mesh(), on_sphere(kInner), [&](const Vec3& X, const Vec3&) -> Vec3 { return kPressure * X.normalized(); }));
            body->solve();
            return body;
        };
        const int layers = tets ? 16 : 14;
        const auto coarse = solve(layers / 2), fine = solve(layers);
        const double u = growth(*coarse, kInner), v = growth(*fine, kInner);
        const std::string what = "thick sphere, nu = .4999, " + name(kind) + ", " + std::to_string(layers) + " through the wall: ";
        table.relative(what + "displacement inside [m]", exact, v, 0.02, std::log2((exact - u) / (exact - v)));
        table.relative(what + "von Mises inside [Pa]", 1.5 * kPressure * b3 / (b3 - a3), mean_von_mises(*fine, kInner), 0.02);
    }
}

/// Incompressible neo-Hookean sphere blown up to `stretch` times its inner radius: p = mu/2 [l^-4 + 4/l] between inner and outer face (Green and Zerna). Hexes of nu = .4998.
void inflated_sphere(Table& table, const Settings& settings) {
    const double mu = 1000, stretch = 1.5;
    const double outer = std::cbrt(std::pow(kOuter, 3) + std::pow(kInner, 3) * (std::pow(stretch, 3) - 1)) / kOuter;
    const auto potential = [](double l) { return std::pow(l, -4) + 4 / l; };
    const double pressure = mu / 2 * (potential(outer) - potential(stretch));
    const auto solve = [&](int layers) {
        auto body = std::make_unique<Statics>(shell_octant(Kind::hexes, layers / 2, layers, kInner, kOuter), NeoHookean{.mu_pa = mu, .lambda_pa = 2500 * mu},
                                              StaticDef{.tolerance = 1e-6, .threads = settings.threads});
        for (int axis = 0; axis < 3; ++axis) body->hold(on_plane(axis, 0), {.x = axis == 0, .y = axis == 1, .z = axis == 2});
        body->press(on_sphere(kInner), {pressure});
        body->solve();
        return body;
    };
    const int layers = 12;
    const auto coarse = solve(layers / 2), fine = solve(layers);
    const double exact = (stretch - 1) * kInner, u = growth(*coarse, kInner), v = growth(*fine, kInner);
    const std::string what = "neo-Hookean sphere under p(a), hexes, " + std::to_string(layers) + " through the wall: ";
    table.relative(what + "growth of the inner radius [m]", exact, v, 0.02, std::log2((exact - u) / (exact - v)));
    table.relative(what + "growth of the outer radius [m]", (outer - 1) * kOuter, growth(*fine, kOuter), 0.02);
    table.relative(what + "von Mises inside [Pa]", mu * (stretch * stretch - std::pow(stretch, -4)), mean_von_mises(*fine, kInner), 0.02);
}

// -- row 19 -----------------------------------------------------------------------------------------------

struct Torque {
    double torque = 0, force = 0;
};

Torque twisted(Kind kind, int n, const Material& material, double rate, const Settings& settings) {
    const double radius = 1, height = 1;
    Statics rod(cylinder(kind, n, 2 * n, radius, height), material, {.tolerance = 1e-5, .threads = settings.threads, .preconditioner = PreconditionerKind::automatic});
    rod.hold(on_plane(2, 0));
    Mat34 turn = Mat34::Zero();
    turn.leftCols<3>() = Eigen::AngleAxisd(rate * height, Vec3::UnitZ()).toRotationMatrix();
    rod.move(on_plane(2, height), {turn});
    rod.solve();
    Torque sum;
    const auto reactions = rod.world().reactions(rod.body());
    for (const std::int32_t v : rod.select(on_plane(2, height))) {
        sum.torque += rod.x()[std::size_t(v)].cross(reactions[std::size_t(v)]).z();
        sum.force += reactions[std::size_t(v)].z();
    }
    return sum;
}

void torsion(Table& table, const Settings& settings) {
    const double mu = 1000, rate = 0.5;
    for (const Kind kind : element_kinds()) {
        // As incompressible as each kind bears: linear tets lock.
        const Torque t = twisted(kind, 8, NeoHookean{.mu_pa = mu, .lambda_pa = (kind == Kind::tets ? 200 : 500) * mu}, rate, settings);
        table.relative("twisted cylinder, " + name(kind) + ": torque [N m]", M_PI * mu * rate / 2, t.torque, 0.02);
        table.relative("twisted cylinder, " + name(kind) + ": axial force (Poynting) [N]", -M_PI * mu * rate * rate / 4, t.force, 0.02);
    }
}

const RegisterCase row17({17, "thick cylinder and sphere under pressure", true, lame});
const RegisterCase row17b({17, "thick sphere, nearly incompressible", true, nearly_incompressible_sphere});
const RegisterCase row17c({17, "thick sphere of incompressible rubber under p(a)", true, inflated_sphere});
const RegisterCase row19({19, "torsion of a neo-Hookean cylinder", false, torsion});

}  // namespace
}  // namespace supple::verify
