// Newton's iteration: the tangent as it is and its fallback, supports that move far, the end that rounding sets.
#include <gtest/gtest.h>

#include "supple/world/evaluate.h"
#include "supple/world/prepared_loads.h"
#include "supple/world/template_data.h"
#include "support/bodies.h"

namespace supple {
namespace {

WorldDef resting(double tolerance, PreconditionerKind preconditioner = PreconditionerKind::direct) {
    WorldDef def;
    def.threads = 1;
    def.time_step_s = 1;
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.integrator = Integrator::quasi_static;
    def.solver.newton_tolerance = tolerance;
    def.solver.preconditioner = preconditioner;
    return def;
}

std::vector<Material> laws() {
    return {Corotational{.young_pa = 1e5, .poisson = 0.4}, NeoHookean{4e4, 3.6e5}, StableNeoHookean{4e4, 3.6e5}, StVenantKirchhoff{4e4, 6e4}, MooneyRivlin{1.6e4, 4e3, 4e5}};
}

Motion turned_end(double angle, double compression) {
    Motion motion;
    motion.where = test::at_x(0.4);
    Mat34 A;
    A << Eigen::AngleAxisd(angle, Vec3::UnitX()).toRotationMatrix(), Vec3(-compression, 0, 0);
    motion.affine = {{}, {A}};
    return motion;
}

/// Residual of the free vertices, and reactions, both by the library's own evaluation.
std::pair<double, double> balance(const World& world, BodyId body, const Material& m) {
    const auto f = evaluate(world.shape(body), m, world.positions(body)).forces_n;
    double free = 0, held = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        const double x = world.shape(body).mesh().vertices[i].x();
        (x > 1e-9 && x < 0.4 - 1e-9 ? free : held) += f[i].squaredNorm();
    }
    return {std::sqrt(free), std::sqrt(held)};
}

TEST(Newton, EndsQuadraticallyWhereProjectionsAreActive) {
    for (const auto& shape : {test::bar({12, 3, 3}), test::hex_bar({12, 3, 3})}) {
        for (const Material& m : laws()) {
            for (const PreconditionerKind kind : {PreconditionerKind::direct, PreconditionerKind::block_jacobi}) {
                if (!shape->mesh().hexes.empty() && m.index() == 0) continue;  // their tangent is warped
                World loose(resting(1e-4, kind)), tight(resting(1e-11, kind));
                int iterations[2] = {0, 0};
                for (World* world : {&loose, &tight}) {
                    const BodyId body = world->add_body({.shape = shape, .material = m});
                    world->fix(body, test::at_x(0));
                    world->prescribe(body, turned_end(1.2, 0.05));
                    const StepReport report = world->step();
                    EXPECT_EQ(report.flags, StepFlag::none) << "law " << m.index();
                    iterations[world == &tight] = report.newton_iterations;
                    if (world == &tight) {
                        const auto [free, held] = balance(*world, body, m);
                        EXPECT_LT(free, 1e-10 * held);
                    }
                }
                EXPECT_LE(iterations[1], iterations[0] + 3) << "law " << m.index() << ": seven digits more";
                EXPECT_LE(iterations[1], 20) << "law " << m.index();
            }
        }
    }
}

/// A strut pressed far beyond Euler's load, a little askew: the tangent of the straight strut is indefinite, and the equilibrium to be found is the bow.
TEST(Newton, BeyondAnUnstableTangentItFindsTheStableEquilibrium) {
    for (const PreconditionerKind kind : {PreconditionerKind::direct}) {  // a factor shows every negative mode
        for (const Material& m : {laws()[0], laws()[2]}) {
            VolumeMesh mesh = make_tet_box({.min_m = Vec3::Zero(), .max_m = {0.4, 0.02, 0.04}, .cells = {40, 2, 2}});
            for (Vec3& v : mesh.vertices) v.y() += 1e-4 * std::sin(M_PI * v.x() / 0.4);
            World world(resting(1e-8, kind));
            const BodyId body = world.add_body({.shape = BodyTemplate::build(std::move(mesh)), .material = m});
            world.fix(body, test::at_x(0));
            world.prescribe(body, turned_end(0, 0.04));
            int sum = 0;
            StepReport report = world.step();
            sum += report.newton_iterations;
            EXPECT_EQ(report.flags, StepFlag::none) << name(report.flags);
            double bow = 0;
            for (const Vec3& x : world.positions(body)) bow = std::max(bow, x.y());
            EXPECT_GT(bow, 0.06);
        }
    }
}

TEST(Newton, SupportsThatMoveMoreThanACellTakeTheBodyAlong) {
    for (const auto& shape : {test::bar({16, 4, 4}), test::hex_bar({16, 4, 4})}) {
        for (const Material& m : laws()) {
            if (m.index() == 2) continue;  // StVenantKirchhoff: softens when it is pressed, and folds
            World world(resting(1e-8));
            const BodyId body = world.add_body({.shape = shape, .material = m});
            world.fix(body, test::at_x(0));
            world.prescribe(body, turned_end(0, 0.06));  // two and a half cells
            const StepReport report = world.step();
            EXPECT_EQ(report.flags, StepFlag::none) << "law " << m.index() << " " << name(report.flags);
            EXPECT_LE(report.newton_iterations, 15) << "law " << m.index();
        }
    }
}

TEST(Newton, AToleranceBelowRoundingIsMetAsFarAsRoundingAllows) {
    for (const auto& shape : {test::bar({8, 2, 2}), test::hex_bar({8, 2, 2})}) {
        for (const Material& m : laws()) {
            for (const double far : {0.0, 30.0}) {
                WorldDef def = resting(1e-17);
                def.gravity_m_s2 = Vec3(0, -1, 0);
                World world(def);
                const BodyId body = world.add_body({.shape = shape, .material = m, .translation_m = Vec3(far, 0, 0)});
                world.fix(body, test::at_x(0));
                const StepReport report = world.step();
                EXPECT_EQ(report.flags, StepFlag::none) << "law " << m.index() << " " << name(report.flags);
                EXPECT_LE(report.newton_iterations, 40);
                const StepReport again = world.step();
                EXPECT_EQ(again.flags, StepFlag::none) << "law " << m.index();
                EXPECT_LE(again.newton_iterations, 3);
            }
        }
    }
}

TEST(Newton, AnUnbalanceAboveRoundingIsNotTakenForIt) {
    WorldDef def = resting(1e-12);
    def.gravity_m_s2 = Vec3(0, -1, 0);
    def.solver.newton_iterations = 1;  // not enough, however small the parts
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({8, 2, 2}), .material = NeoHookean{1e4, 4e4}});
    world.fix(body, test::at_x(0));
    EXPECT_EQ(world.step().flags & StepFlag::no_equilibrium, StepFlag::no_equilibrium);
}

TEST(Newton, ABodyAtRestMeetsItsToleranceAtOnce) {
    for (const auto& shape : {test::bar({8, 2, 2}), test::hex_bar({8, 2, 2})}) {
        for (const Material& m : laws()) {
            for (const double gravity : {0.0, -9.81}) {
                for (const double cg : {1e-5, 1e-10}) {
                    WorldDef def;
                    def.threads = 1;
                    def.time_step_s = 0.05;
                    def.gravity_m_s2 = Vec3(0, gravity, 0);
                    def.solver.precision = Precision::double_;
                    def.solver.cg_relative_tolerance = cg;
                    def.solver.newton_iterations = 30;
                    def.solver.newton_tolerance = 1e-8;
                    def.solver.rayleigh_mass_1_s = 15;
                    World world(def);
                    const BodyId body = world.add_body({.shape = shape, .material = m, .translation_m = Vec3(1, 2, 3)});
                    world.fix(body, test::at_x(0));
                    int capped = 0, last = 0;
                    for (int k = 0; k < 400; ++k) {
                        const StepReport report = world.step();
                        if (report.flags != StepFlag::none) ++capped;
                        last = report.newton_iterations;
                    }
                    EXPECT_EQ(capped, 0);
                    EXPECT_LE(last, 3);
                }
            }
        }
    }
}

// -- the stiffness of a pressure that follows ---------------------------------------------------------

struct PressureStiffness {
    std::shared_ptr<const BodyTemplate> shape;
    PreparedLoads loads;
    Team alone;
    std::vector<Vec3> x;

    PressureStiffness(std::shared_ptr<const BodyTemplate> s, const Selection& where) : shape(std::move(s)), x(shape->mesh().vertices) {
        Load load;
        load.where = where;
        load.kind = LoadKind::pressure;
        load.amount.values = {700};
        loads.add(shape->data(), "body", load);
        test::Random random(5);
        for (Vec3& v : x) v += random.vector(0.1);
    }
    /// -df/dx d by central differences.
    std::vector<Vec3> difference(const std::vector<Vec3>& d) {
        constexpr double h = 1e-5;
        std::vector<Vec3> up(x), down(x), f1(x.size(), Vec3::Zero()), f0(x.size(), Vec3::Zero());
        for (std::size_t i = 0; i < x.size(); ++i) {
            up[i] += h * d[i];
            down[i] -= h * d[i];
        }
        loads.add_followers(alone, 0, up, f1);
        loads.add_followers(alone, 0, down, f0);
        for (std::size_t i = 0; i < x.size(); ++i) f1[i] = (f0[i] - f1[i]) / (2 * h);
        return f1;
    }
    std::vector<Vec3> product(const std::vector<Vec3>& d) const {
        std::vector<Vec3> out(x.size(), Vec3::Zero());
        loads.add_stiffness_product(0, x, d, out);
        return out;
    }
    /// The same from the matrix.
    std::vector<Vec3> matrix_product(const std::vector<Vec3>& d) const {
        const auto& pattern = shape->data().pattern;
        std::vector<double> value(pattern.column.size() * 12, 0.0);
        loads.add_stiffness(0, x, 1, value.data());
        std::vector<Vec3> out(x.size(), Vec3::Zero());
        for (std::size_t row = 0; row < x.size(); ++row)
            for (std::int32_t b = pattern.row_start[row]; b < pattern.row_start[row + 1]; ++b)
                for (int c = 0; c < 3; ++c)
                    for (int i = 0; i < 3; ++i) out[std::size_t(pattern.vertex[row])][i] += value[std::size_t(b) * 12 + std::size_t(4 * c + i)] * d[std::size_t(pattern.vertex[std::size_t(pattern.column[std::size_t(b)])])][c];
        return out;
    }
};

double inner(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
    return sum;
}

TEST(FollowerPressure, ItsStiffnessIsTheDerivativeOfItsForces) {
    for (const auto& shape : {test::bar({3, 2, 2}), test::hex_bar({3, 2, 2})}) {
        test::Random random(6);
        for (const bool closed : {true, false}) {
            PressureStiffness s(shape, closed ? Selection(Everything{}) : Selection(InsideBox{Vec3(-1, 0.1 - 1e-9, -1), Vec3(1, 1, 1)}));
            std::vector<Vec3> d, e;
            for (std::size_t i = 0; i < s.x.size(); ++i) {
                d.push_back(random.vector(1));
                e.push_back(random.vector(1));
            }
            const auto Kd = s.product(d), Ke = s.product(e), exact = s.difference(d);
            EXPECT_LT(test::relative_difference(s.matrix_product(d), Kd), 1e-13);
            EXPECT_NEAR(inner(e, Kd), 0.5 * (inner(e, exact) + inner(d, s.difference(e))), 1e-7 * std::sqrt(inner(Kd, Kd) * inner(e, e)));
            EXPECT_NEAR(inner(e, Kd), inner(d, Ke), 1e-13 * std::sqrt(inner(Kd, Kd) * inner(e, e)));
            if (closed) {
                EXPECT_LT(test::relative_difference(Kd, exact), 1e-7);
            } else {
                EXPECT_GT(test::relative_difference(Kd, exact), 1e-2) << "the edge should show";
            }
        }
    }
}

/// A hollow cube blown up by half: with the stiffness of its pressure Newton ends quadratically.
TEST(FollowerPressure, NewtonEndsQuadraticallyUnderIt) {
    VolumeMesh mesh = make_hex_box({.min_m = Vec3::Zero(), .max_m = Vec3::Constant(0.4), .cells = {4, 4, 4}});
    std::erase_if(mesh.hexes, [&](const Hex& hex) {
        return std::all_of(hex.begin(), hex.end(), [&](std::int32_t v) { return (mesh.vertices[std::size_t(v)].array() - 0.2).abs().maxCoeff() < 0.1 + 1e-9; });
    });
    int iterations[2] = {0, 0};
    for (const double tolerance : {1e-4, 1e-10}) {
        World world(resting(tolerance));
        const BodyId body = world.add_body({.shape = BodyTemplate::build(VolumeMesh(mesh)), .material = NeoHookean{1e4, 4e4}});
        world.fix(body, InsideBox{Vec3(-1, -1, -1), Vec3(1, 1, 1e-9)});
        Load load;
        load.where = InsideBox{Vec3::Constant(0.1 - 1e-9), Vec3::Constant(0.3 + 1e-9)};
        load.kind = LoadKind::pressure;
        load.amount.values = {5000};
        world.add_load(body, load);
        const StepReport report = world.step();
        EXPECT_EQ(report.flags, StepFlag::none) << name(report.flags);
        iterations[tolerance < 1e-5] = report.newton_iterations;
        double grown = 0;
        for (const Vec3& x : world.positions(body)) grown = std::max(grown, x.z() - 0.4);
        EXPECT_GT(grown, 0.02);
    }
    EXPECT_LE(iterations[1], iterations[0] + 2);
}

}  // namespace
}  // namespace supple
