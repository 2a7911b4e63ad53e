// Bodies at rest on rigid shapes: force balance, friction, Hertz.
#include <gtest/gtest.h>

#include <utility>

#include <numbers>

#include "supple/contact/distance_grid.h"
#include "supple/contact/shape_surface.h"
#include "support/bodies.h"

namespace supple {
namespace {

WorldDef quick(double h = 1.0 / 120) {
    WorldDef def;
    def.threads = 1;
    def.time_step_s = h;
    return def;
}

MeshShape mesh_box(const Vec3& half) {
    const contact::ShapeSurface s = contact::surface_of(BoxShape{half}, 1);
    return {contact::DistanceGrid::build(s.vertices, s.triangles)};
}

/// Every shape under a block: its top at y = 0, wide enough.
std::vector<ColliderDef> tables() {
    std::vector<ColliderDef> tables;
    tables.push_back({.shape = PlaneShape{}});
    tables.push_back({.shape = BoxShape{Vec3(0.3, 0.1, 0.3)}, .pose = {Vec3(0.05, -0.1, 0.05), {1, 0, 0, 0}}});
    tables.push_back({.shape = CylinderShape{0.3, 0.05}, .pose = {Vec3(0.05, -0.05, 0.05), {1, 0, 0, 0}}});
    tables.push_back({.shape = mesh_box(Vec3(0.2, 0.1, 0.2)), .pose = {Vec3(0.05, -0.1, 0.05), {1, 0, 0, 0}}});
    tables.push_back({.shape = SphereShape{2}, .pose = {Vec3(0.05, -2, 0.05), {1, 0, 0, 0}}});
    tables.push_back({.shape = CapsuleShape{1, 1}, .pose = {Vec3(0.05, -1, 0.05), {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}});
    return tables;
}

TEST(ContactRest, ContactForcesBalanceTheWeightOnEveryShape) {
    for (const Precision precision : {Precision::single, Precision::double_}) {
        for (const ColliderDef& table : tables()) {
            SCOPED_TRACE("shape " + std::to_string(table.shape.index()));
            WorldDef def = quick();
            def.solver.precision = precision;
            def.solver.rayleigh_mass_1_s = 5;
            World world(def);
            const BodyId body = world.add_body({.shape = test::cube(4, 0.1), .material = Corotational{.young_pa = 5e4, .poisson = 0.4}, .translation_m = {0, 0.002, 0}});
            const ColliderId id = world.add_collider(table);
            ASSERT_TRUE(test::run_to_rest(world, 1e-6, 600));
            const double weight = test::total_mass(world, body) * 9.81;
            EXPECT_LT((world.contact_force_n() - Vec3(0, weight, 0)).norm(), 1e-4 * weight) << world.contact_force_n().transpose();
            EXPECT_LT((world.collider_state(id).force_n + world.contact_force_n()).norm(), 1e-12 * weight);
            EXPECT_GT(world.contacts().size(), 3u);
            Vec3 sum = Vec3::Zero();
            for (const ContactPoint& c : world.contacts()) {
                EXPECT_EQ(c.body, body);
                EXPECT_EQ(c.collider, id);
                EXPECT_NEAR(c.normal.norm(), 1, 1e-9);
                EXPECT_GT(c.normal_force_n, -1e-6 * weight);
                EXPECT_LE(c.friction_force_n.norm(), 1.02 * table.friction * c.normal_force_n + 1e-6 * weight);
                EXPECT_LT(c.depth_m, 2e-4) << "a hundredth of an edge";
                EXPECT_LT(std::abs(c.normal.dot(c.friction_force_n)), 1e-9 * weight);
                sum += c.normal_force_n * c.normal + c.friction_force_n;
                const Triangle& t = world.shape(body).boundary().triangles[std::size_t(c.triangle)];
                Vec3 at = Vec3::Zero();
                for (std::size_t k = 0; k < 3; ++k) at += c.barycentric[k] * world.positions(body)[std::size_t(t[k])];
                EXPECT_LT((at - c.position_m).norm(), 1e-9);
            }
            EXPECT_LT((sum - world.contact_force_n()).norm(), 1e-9 * weight);
        }
    }
}

TEST(ContactRest, ReactionsAndContactsShareTheWeight) {
    WorldDef def = quick();
    def.solver.rayleigh_mass_1_s = 5;
    def.solver.cg_relative_tolerance = 1e-6;  // of the right-hand side, which the fall makes large
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({16, 4, 4}), .material = Corotational{.young_pa = 5e4, .poisson = 0.4}});
    world.fix(body, test::at_x(0));
    world.add_collider({.shape = BoxShape{Vec3(0.02, 0.05, 0.2)}, .pose = {Vec3(0.39, -0.06, 0.05), {1, 0, 0, 0}}});  // the end of the bar sags onto it
    const Vec3 weight(0, test::total_mass(world, body) * 9.81, 0);
    // In every step, from the fall to where it lies: what the forces do not balance is the change of momentum. (The triangles over the box's edge may shift by micrometres for ever.)
    Vec3 momentum = Vec3::Zero();
    for (int i = 0; i < 900; ++i) {
        world.step();
        const Vec3 before = std::exchange(momentum, test::momentum(world, body));
        const Vec3 inertia = (momentum - before) / def.time_step_s + def.solver.rayleigh_mass_1_s * momentum;
        ASSERT_LT((world.contact_force_n() + world.reaction_n() - weight - inertia).norm(), 1e-4 * weight.norm()) << "step " << i;
    }
    for (const Vec3& v : world.velocities(body)) EXPECT_LT(v.norm(), 1e-3);
    EXPECT_LT((world.contact_force_n() + world.reaction_n() - weight).norm(), 1e-3 * weight.norm());
    EXPECT_GT(world.contact_force_n().y(), 0.1 * weight.y());
    EXPECT_LT((world.reaction_n(body, test::at_x(0)) - world.reaction_n()).norm(), 1e-12);
    EXPECT_EQ(world.reaction_n(body, test::at_x(0.4)), Vec3::Zero());
}

TEST(ContactRest, ABlockOnAnInclineSticksAndSlipsAtTheCoefficientOfFriction) {
    for (const double mu : {0.2, 0.6}) {
        for (const double part : {0.98, 1.02}) {
            WorldDef def = quick();
            const double angle = std::atan(part * mu);
            def.gravity_m_s2 = 9.81 * Vec3(std::sin(angle), -std::cos(angle), 0);
            World world(def);
            const BodyId body = world.add_body({.shape = BodyTemplate::build(make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3(0.2, 0.05, 0.1), .cells = {8, 2, 4}})),
                                                .material = Corotational{.young_pa = 1e6, .poisson = 0.3}});
            world.add_collider({.friction = mu});
            for (int n = 0; n < 360; ++n) EXPECT_EQ(world.step().flags, StepFlag::none);
            const double m = test::total_mass(world, body), before = test::momentum(world, body).x() / m;
            for (int n = 0; n < 120; ++n) world.step();
            const double after = test::momentum(world, body).x() / m;
            const double theory = 9.81 * std::cos(angle) * (part * mu - mu);  // over one second
            if (part < 1) {
                EXPECT_LT(std::abs(after), 1e-6) << "mu " << mu << ": it sticks, and does not creep";
            } else {
                EXPECT_NEAR(after - before, theory, 0.005 * 9.81 * mu * std::cos(angle)) << "mu " << mu;
                EXPECT_GT(after - before, 0.6 * theory);
            }
        }
    }
}

TEST(ContactRest, WithoutFrictionNothingSticks) {
    WorldDef def = quick();
    def.gravity_m_s2 = Vec3(0.5, -9.81, 0);
    World world(def);
    const BodyId body = world.add_body({.shape = test::cube(3, 0.1), .material = Corotational{.young_pa = 1e5, .poisson = 0.3}});
    world.add_collider({.friction = 0});
    for (int n = 0; n < 240; ++n) world.step();
    EXPECT_NEAR(test::momentum(world, body).x() / test::total_mass(world, body), 0.5 * 240 / 120.0, 1e-3);
}

/// A quarter of a ball's lower half, radius 1: a box of tets drawn onto it, finer towards the lower pole at (0, 0, -1).
std::shared_ptr<const BodyTemplate> quarter_ball(int cells, double grading) {
    VolumeMesh mesh = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {cells, cells, cells}});
    for (Vec3& p : mesh.vertices) {
        const Vec3 q(std::pow(p.x(), grading), std::pow(p.y(), grading), 1 - std::pow(1 - p.z(), grading));
        const double largest = q.maxCoeff(), length = q.norm();
        // Squares become spheres of the same "radius".
        const Vec3 ball = length > 0 ? Vec3(q * (largest / length)) : q;
        p = Vec3(ball.x(), ball.y(), -ball.z());
    }
    for (Tet& t : mesh.tets) std::swap(t[2], t[3]);
    return BodyTemplate::build(std::move(mesh));
}

TEST(ContactRest, ASoftSphereOnAPlaneFollowsHertz) {
    // The equator is pushed down by delta, by symmetry free to widen: F = 4/3 E/(1 - nu^2) sqrt(R) delta^(3/2), for contact radii well below R.
    constexpr double kYoung = 1e5, kPoisson = 0.3;
    WorldDef def;
    def.threads = 1;
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.integrator = Integrator::quasi_static;
    def.time_step_s = 0.1;
    World world(def);
    const auto shape = quarter_ball(18, 2);
    const BodyId body = world.add_body({.shape = shape, .material = Corotational{.young_pa = kYoung, .poisson = kPoisson}});
    world.fix(body, InsideBox{{-1e-9, -2, -2}, {1e-9, 2, 2}}, {true, false, false});
    world.fix(body, InsideBox{{-2, -1e-9, -2}, {2, 1e-9, 2}}, {false, true, false});
    Motion down;
    down.where = InsideBox{{-2, -2, -1e-9}, {2, 2, 1e-9}};
    down.axes = {false, false, true};
    const std::vector<double> depths = {0.01, 0.02, 0.03, 0.04};
    down.displacement_m.times_s = {0};
    down.displacement_m.values = {Vec3::Zero()};
    for (std::size_t i = 0; i < depths.size(); ++i) {
        down.displacement_m.times_s.push_back(0.1 * double(i + 1));
        down.displacement_m.values.push_back(Vec3(0, 0, -depths[i]));
    }
    world.prescribe(body, down);
    world.add_collider({.shape = PlaneShape{Vec3(0, 0, 1), -1}, .friction = 0});
    for (const double delta : depths) {
        const StepReport report = world.step();
        EXPECT_EQ(report.flags, StepFlag::none);
        const double force = 4 * world.contact_force_n().z();
        const double theory = 4.0 / 3 * kYoung / (1 - kPoisson * kPoisson) * std::pow(delta, 1.5);
        std::printf("delta %.3f  force %.2f  Hertz %.2f  ratio %.4f  contacts %d\n", delta, force, theory, force / theory, report.contacts);
        EXPECT_NEAR(force / theory, 1, 0.1) << "delta " << delta;
        EXPECT_NEAR(world.reaction_n().z(), -world.contact_force_n().z(), 1e-4 * force);
    }
}

}  // namespace
}  // namespace supple
