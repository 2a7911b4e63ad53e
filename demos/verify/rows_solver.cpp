// Row 25: plastic hysteresis, solvers that agree, threads that agree to the bit, shapes that come back.
#include <algorithm>
#include <cmath>

#include "random.h"
#include "statics.h"
#include "table.h"

namespace supple::verify {
namespace {

constexpr double kYoung = 1e5, kPoisson = 0.3, kYield = 0.02, kStrain = 0.06;

/// Work per volume over the second cycle of uniaxial strain between -kStrain and kStrain, a second each; every vertex is moved, so that each element sees the same.
double hysteresis(Kind kind, double h, double creep) {
    WorldDef def;
    def.time_step_s = h;
    def.threads = 1;
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.precision = Precision::double_;
    World world(def);
    const BodyId body = world.add_body({.shape = BodyTemplate::build(box(kind, {1, 1, 1}, Vec3::Ones())),
                                        .material = Corotational{.young_pa = kYoung, .poisson = kPoisson, .plasticity = {.yield = kYield, .creep_1_s = creep}}});
    Motion motion;
    motion.affine.times_s = {0, 0.25, 0.75, 1.25, 1.75};
    for (const double strain : {0.0, kStrain, -kStrain, kStrain, -kStrain}) {
        Mat34 A = Mat34::Zero();
        A.leftCols<3>() = Mat3::Identity();
        A(0, 0) += strain;
        motion.affine.values.push_back(A);
    }
    world.prescribe(body, motion);
    const int steps = int(std::lround(1 / h));
    double work = 0, last_stress = 0, last_strain = 0;
    for (int k = 1; k <= 7 * steps / 4; ++k) {
        world.step();
        const double strain = world.positions(body).back().x() - 1, stress = world.element_cauchy_stress(body)[0][0];
        if (k > 3 * steps / 4) work += 0.5 * (stress + last_stress) * (strain - last_strain);
        last_stress = stress;
        last_strain = strain;
    }
    return work;
}

void plasticity(Table& table, const Settings&) {
    // The deviator's norm is |e| sqrt(2/3) and stays at the yield strain y; over a cycle the plastic strain's norm moves by 2 (2 a sqrt(2/3) - 2 y) against 2 mu y.
    const double mu = kYoung / (2 * (1 + kPoisson)), area = 2 * mu * kYield * 2 * (2 * kStrain * std::sqrt(2.0 / 3) - 2 * kYield);
    table.relative("J2 hysteresis, uniaxial strain: work per cycle [J/m^3]", area, hysteresis(Kind::tets, 1.0 / 400, HUGE_VAL), 0.01);
    const double fine = hysteresis(Kind::tets, 1.0 / 1600, 5);
    table.relative("finite creep rate: the work at h = 1/200 s against that at 1/1600 s [J/m^3]", fine, hysteresis(Kind::tets, 1.0 / 200, 5), 0.02);
}

/// Positions of a hanging bar after some steps.
struct Run {
    std::vector<Vec3> x;
    std::uint64_t hash = 0;
};

Run hanging_bar(Kind kind, PreconditionerKind preconditioner, Precision precision, int threads, double tolerance, int cells) {
    WorldDef def;
    def.time_step_s = 0.01;
    def.threads = threads;
    def.solver.precision = precision;
    def.solver.cg_relative_tolerance = tolerance;
    def.solver.preconditioner = preconditioner;
    World world(def);
    const BodyId body = world.add_body({.shape = BodyTemplate::build(box(kind, {4 * cells, cells, cells}, Vec3(0.4, 0.1, 0.1))), .material = Corotational{.young_pa = 2e5, .poisson = 0.4}});
    world.fix(body, InsideBox{Vec3(-1, -1, -1), Vec3(1e-9, 1, 1)});
    for (int k = 0; k < 10; ++k) world.step();
    return {{world.positions(body).begin(), world.positions(body).end()}, world.hash()};
}

double difference(const Run& a, const Run& b) {
    double worst = 0, size = 0;
    for (std::size_t i = 0; i < a.x.size(); ++i) {
        worst = std::max(worst, (a.x[i] - b.x[i]).norm());
        size = std::max(size, b.x[i].norm());
    }
    return worst / size;
}

void solvers(Table& table, const Settings&) {
    using enum PreconditionerKind;
    for (const Kind kind : element_kinds()) {
        const Run direct_run = hanging_bar(kind, direct, Precision::double_, 1, 1e-12, 4);
        for (const auto& [what, preconditioner] : {std::pair("automatic", automatic), std::pair("block Jacobi", block_jacobi)})
            table.below(std::string("conjugate gradients against a sparse factor, ") + what + ", " + name(kind) + ": positions, relative",
                        difference(hanging_bar(kind, preconditioner, Precision::double_, 1, 1e-9, 4), direct_run), 1e-6);
        table.below("float32 against float64, " + name(kind) + ": positions, relative", difference(hanging_bar(kind, automatic, Precision::single, 1, 1e-6, 4), direct_run), 1e-5);
        const Run alone = hanging_bar(kind, automatic, Precision::single, 1, 1e-5, 8);
        for (const int threads : {2, 4, 16}) {
            const Run together = hanging_bar(kind, automatic, Precision::single, threads, 1e-5, 8);
            table.below(std::to_string(threads) + " threads against 1, " + name(kind) + ": positions, relative" + (together.hash == alone.hash ? " (the same bits)" : ""),
                        difference(together, alone), 1e-5);
        }
    }
}

/// A cube as it may be thrown at the engine: pressed flat, shrunk, or every vertex moved by up to a cell.
Vec3 mangled(std::uint64_t seed, double shrink, const Vec3& X, Random& random) {
    if (seed % 3 == 0) return Vec3(0.05, 0.05, 0.05) + shrink * (X - Vec3(0.05, 0.05, 0.05));
    if (seed % 3 == 1) return Vec3(X.x(), X.y(), 0);
    return X + random.vector(0.05);
}

/// Largest relative change of the distance between two vertices after the body was released for ten seconds.
double recovery(Kind kind, const Material& material, std::uint64_t seed) {
    WorldDef def;
    def.time_step_s = 0.02;
    def.threads = 1;
    def.gravity_m_s2 = Vec3::Zero();
    if (is_hyperelastic(material)) {  // a single linear solve a step overshoots where a law is this far from its tangent; Newton's line search does not
        def.solver.newton_iterations = 30;
        def.solver.newton_tolerance = 1e-3;
    }
    World world(def);
    const BodyId body = world.add_body({.shape = BodyTemplate::build(box(kind, {2, 2, 2}, Vec3::Constant(0.1))), .material = material});
    Random random(seed);
    std::vector<Vec3> x;
    const auto& rest = world.shape(body).mesh().vertices;
    for (std::size_t i = 0; i < rest.size(); ++i) x.push_back(mangled(seed, is_hyperelastic(material) ? 0.5 : 0.01, rest[i], random));
    world.set_state(body, x, std::vector<Vec3>(x.size(), Vec3::Zero()));
    for (int k = 0; k < 500; ++k) world.step();
    double worst = 0;
    for (std::size_t i = 0; i < rest.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            worst = std::max(worst, std::abs((world.positions(body)[i] - world.positions(body)[j]).norm() / (rest[i] - rest[j]).norm() - 1));
    return worst;
}

void shapes_come_back(Table& table, const Settings&) {
    for (const Kind kind : element_kinds()) {
        for (const auto& [what, material] : {std::pair("corotational", Material(Corotational{.young_pa = 1e5, .poisson = 0.3})),
                                             std::pair("StableNeoHookean", Material(StableNeoHookean{.mu_pa = 4e4, .lambda_pa = 6e4}))}) {
            double worst = 0;
            for (std::uint64_t seed = 1; seed <= 12; ++seed) worst = std::max(worst, recovery(kind, material, seed));
            table.below(std::string("cube pressed flat, shrunk or tangled, then released, ") + what + ", " + name(kind) + ": distances, relative", worst, 1e-3);
        }
    }
    table.note("shrunk to 1 % (corotational) and to half (StableNeoHookean: below a stretch of mu/((lambda + mu) a) its energy has a minimum at a point, as the law is written).");
}

const RegisterCase row25a({25, "plastic hysteresis", false, plasticity});
const RegisterCase row25b({25, "solvers and threads agree", false, solvers});
const RegisterCase row25c({25, "shapes come back", false, shapes_come_back});

}  // namespace
}  // namespace supple::verify
