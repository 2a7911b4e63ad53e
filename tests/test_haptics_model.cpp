// Local models of a body under a tool, against the full system; and the simulation and the loop together.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "supple/base/error.h"
#include "supple/haptics/plain_devices.h"
#include "supple/haptics/tool_link.h"
#include "support/bodies.h"
#include "support/haptics.h"

namespace supple::haptics {
namespace {

/// A slab 0.1 x 0.04 x 0.1 m that stands on y = 0, its top at y = 0.04; a ball above its middle on a device.
struct Bench {
    World world;
    BodyId body;
    PlayedDevice device;
    HapticLoop loop;
    ToolLink link;
    TickReport last;

    static WorldDef def(double rate) {
        WorldDef d;
        d.threads = 1;
        d.time_step_s = 1 / rate;
        d.gravity_m_s2 = Vec3::Zero();
        d.solver.rayleigh_mass_1_s = 5;
        d.solver.rayleigh_stiffness_s = 0.002;
        return d;
    }
    static Trajectory press(double depth, double over_s) {
        return {.times_s = {0, 0.05, 0.05 + over_s}, .positions_m = {Vec3(0.003, 0.055, 0.002), Vec3(0.003, 0.055, 0.002), Vec3(0.003, 0.052 - depth, 0.002)}};
    }
    explicit Bench(double rate, Trajectory path, ToolLinkDef link_def = {.shape = SphereShape{0.012}}, LoopDef loop_def = {.fade_in_s = 0})
        : world(def(rate)), body(make_body(world)), device(device_preset("omega_x"), std::move(path)), loop(device, loop_def), link(world, loop, link_def) {}
    static BodyId make_body(World& world) {
        const BodyId id = world.add_body({.shape = BodyTemplate::build(make_tet_box({.min_m = Vec3(-0.05, 0, -0.05), .max_m = Vec3(0.05, 0.04, 0.05), .cells = {10, 5, 10}})),
                                          .material = Corotational{.young_pa = 1e4, .poisson = 0.4}});
        world.fix(id, InsideBox{Vec3(-1, -1, -1), Vec3(1, 1e-9, 1)});
        return id;
    }
    /// One step of the simulation and the ticks beside it; its result comes at its end.
    void step() {
        link.publish();
        link.before_step();
        world.step();
        link.after_step();
        const int ticks = int(std::lround(world.def().time_step_s / 1e-3));
        for (int i = 0; i < ticks; ++i) last = loop.tick(world.def().time_step_s / ticks);
    }
    void run(double seconds) {
        for (int i = 0; i < int(seconds / world.def().time_step_s + 0.5); ++i) step();
    }
};

TEST(HapticsResponse, SolvesTheSystemOfTheStep) {
    Bench b(100, Bench::press(-0.01, 0.1));
    EXPECT_THROW(BodyResponse(b.world, b.body), Error) << "no step yet";
    b.world.step();
    const BodyResponse response(b.world, b.body);
    const Inspector inspect(b.world, b.body);
    const SolverDef& s = b.world.def().solver;
    const double h = 0.01;
    MatX A = MatX::Zero(inspect.rows(), inspect.rows());
    inspect.add_to(SystemMatrix::mass, 1 + h * s.rayleigh_mass_1_s, 0, 0, A);
    inspect.add_to(SystemMatrix::stiffness, h * h + h * s.rayleigh_stiffness_s, 0, 0, A);
    const auto n = response.vertices();
    std::vector<Vec3> force(n, Vec3::Zero()), u(n, Vec3::Zero());
    std::size_t top = 0;
    for (std::size_t i = 0; i < n; ++i)
        if ((b.world.positions(b.body)[i] - Vec3(0, 0.04, 0)).norm() < (b.world.positions(b.body)[top] - Vec3(0, 0.04, 0)).norm()) top = i;
    force[top] = Vec3(0.3, -1, 0.1);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(A.rows());
    f.segment<3>(3 * Eigen::Index(top)) = h * h * force[top];
    for (std::size_t i = 0; i < n; ++i) {
        for (int c = 0; c < 3; ++c) {
            const Eigen::Index row = 3 * Eigen::Index(i) + c;
            if (response.is_free(std::int32_t(i), c)) continue;
            A.row(row).setZero();
            A.col(row).setZero();
            A(row, row) = 1;
        }
    }
    const Eigen::VectorXd exact = A.llt().solve(f);
    const auto solved = response.solve(force, u, 1e-8);
    EXPECT_LE(solved.relative_residual, 1e-8);
    double difference = 0;
    for (std::size_t i = 0; i < n; ++i) difference = std::max(difference, (u[i] - exact.segment<3>(3 * Eigen::Index(i))).norm());
    EXPECT_LT(difference, 1e-4 * u[top].norm()) << "float32 matrix of the step";
    // All vertices as a patch: the same again.
    MatX whole;
    std::vector<std::int32_t> all(n);
    for (std::size_t i = 0; i < n; ++i) all[i] = std::int32_t(i);
    response.submatrix(all, whole);
    EXPECT_LT((whole - A).norm(), 1e-5 * A.norm());
}

TEST(HapticsResponse, WhatTheBodyStandsOnHoldsItUp) {
    WorldDef def = Bench::def(60);
    def.gravity_m_s2 = Vec3(0, -9.81, 0);
    World world(def);
    const BodyId body = world.add_body({.shape = BodyTemplate::build(make_tet_box({.min_m = Vec3(-0.05, 0, -0.05), .max_m = Vec3(0.05, 0.04, 0.05), .cells = {5, 2, 5}})),
                                        .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
    const ColliderId floor = world.add_collider({.shape = PlaneShape{}});
    for (int i = 0; i < 60; ++i) world.step();
    ASSERT_GT(world.contacts().size(), 10u);
    double mass = 0;
    for (const double m : world.masses(body)) mass += m;
    std::vector<Vec3> force(world.positions(body).size()), u(force.size(), Vec3::Zero());
    for (std::size_t i = 0; i < force.size(); ++i) force[i] = Vec3(0, -world.masses(body)[i] / mass, 0);  // 1 N, spread like its weight
    const auto sinks = [&](ColliderId without) {
        std::fill(u.begin(), u.end(), Vec3::Zero());
        EXPECT_LE(BodyResponse(world, body, without).solve(force, u, 1e-8).relative_residual, 1e-8);
        double sum = 0;
        for (std::size_t i = 0; i < u.size(); ++i) sum -= world.masses(body)[i] / mass * u[i].y();
        return sum;
    };
    const double h = def.time_step_s;
    EXPECT_NEAR(sinks(floor), h * h / (mass * (1 + h * def.solver.rayleigh_mass_1_s)), 1e-3 * h * h / mass) << "without its floor it falls";
    EXPECT_LT(sinks({}), 0.1 * h * h / mass);
}

/// The response of the full system at each contact of the model to a force along its normal there, against n.W n.
double worst_compliance_error(Bench& b, const LocalModel& model, int& compared) {
    const BodyResponse response(b.world, b.body, b.link.collider());
    const auto n = response.vertices();
    double worst = 0;
    compared = 0;
    for (std::size_t i = 0; i < model.contacts; ++i) {
        for (const ContactPoint& c : b.world.contacts()) {
            if ((c.position_m - model.contact[i].position_m).norm() > 1e-12) continue;
            const Triangle& t = b.world.shape(b.body).boundary().triangles[std::size_t(c.triangle)];
            std::vector<Vec3> force(n, Vec3::Zero()), u(n, Vec3::Zero());
            for (std::size_t k = 0; k < 3; ++k) force[std::size_t(t[k])] += c.barycentric[k] * c.normal;
            response.solve(force, u, 1e-7);
            double full = 0;
            for (std::size_t k = 0; k < 3; ++k) full += c.barycentric[k] * u[std::size_t(t[k])].dot(c.normal);
            Mat3 W;
            for (std::size_t r = 0; r < 9; ++r) W(Eigen::Index(r / 3), Eigen::Index(r % 3)) = model.W(3 * i + r / 3, 3 * i + r % 3);
            worst = std::max(worst, std::abs(c.normal.dot(W * c.normal) - full) / full);
            ++compared;
            break;
        }
    }
    return worst;
}

TEST(HapticsModel, ComplianceIsThatOfTheFullSystem) {
    for (const int correct_every : {1, 0}) {
        ToolLinkDef def{.shape = SphereShape{0.012}};
        def.model = {.patch_vertices = 60, .correct_every = correct_every, .correction_tolerance = 1e-4};
        Bench b(60, Bench::press(0.008, 0.2), def);
        b.run(0.5);
        const auto model = std::make_unique<LocalModel>();
        ModelBuilder builder(def.model);
        const ModelReport report = builder.build(b.world, b.link.collider(), *model);
        ASSERT_GE(model->contacts, 4u);
        EXPECT_TRUE(model->finite());
        EXPECT_FALSE(report.indefinite);
        EXPECT_EQ(report.patch_vertices, 60u);
        const auto n = Eigen::Index(3 * model->contacts);
        MatX W(n, n);
        for (Eigen::Index r = 0; r < n; ++r)
            for (Eigen::Index c = 0; c < n; ++c) W(r, c) = model->W(std::size_t(r), std::size_t(c));
        EXPECT_LT((W - W.transpose()).norm(), 1e-12 * W.norm());
        EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatX>(W).eigenvalues().minCoeff(), -1e-9 * W.norm());
        int compared = 0;
        const double worst = worst_compliance_error(b, *model, compared);
        EXPECT_GE(compared, 4);
        if (correct_every > 0) {
            EXPECT_LT(worst, 0.04) << "corrected";
            EXPECT_GT(report.far_field, 0.01);
        } else {
            EXPECT_GT(worst, 0.06) << "a clamped rim alone is too stiff: the correction is what helps";
        }
    }
}

TEST(HapticsModel, SumOfForcesSurvivesMerging) {
    // A flat tool that touches far more vertices than a model has places for.
    ToolLinkDef def{.shape = CylinderShape{0.03, 0.005}};
    Bench b(60, Bench::press(0.013, 0.2), def);
    b.run(0.4);
    std::size_t pressed = b.world.contacts().size();
    ASSERT_GT(pressed, kMostLocalContacts);
    const auto model = std::make_unique<LocalModel>();
    ModelBuilder builder;
    const ModelReport report = builder.build(b.world, b.link.collider(), *model);
    EXPECT_LE(model->contacts, kMostLocalContacts);
    EXPECT_GT(report.merged, 0u);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < model->contacts; ++i) sum += model->contact[i].force_n;
    EXPECT_LT((sum - b.world.collider_state(b.link.collider()).force_n).norm(), 1e-9 * sum.norm());
}

TEST(HapticsModel, SeesWhatComesBeforeItIsTouched) {
    Bench b(60, {.times_s = {0}, .positions_m = {Vec3(0.003, 0.052 + 0.003, 0.002)}});  // 3 mm above the top
    b.run(0.1);
    const auto model = std::make_unique<LocalModel>();
    ModelBuilder builder;
    builder.build(b.world, b.link.collider(), *model);
    ASSERT_GT(model->contacts, 0u);
    EXPECT_NEAR(model->contact[0].gap_m, 0.003, 2e-4);
    EXPECT_GT(model->contact[0].normal.y(), 0.95);
    EXPECT_EQ(b.last.force_n, Vec3(0, 0, 0));
}

TEST(HapticsModel, AtRestTheHandFeelsWhatTheSimulationSays) {
    double reference = 0;
    for (const double rate : {200.0, 60.0, 30.0}) {
        Bench b(rate, Bench::press(0.008, 0.3));
        b.run(1.2);
        const Vec3 simulated = b.world.collider_state(b.link.collider()).force_n;
        const ModelReport& cost = b.link.report();
        std::printf("%4.0f Hz: %.3f N; model of %zu contacts on %zu vertices in %.0f us: %.0f finding, %.0f patch, %.0f correction\n", rate, b.last.force_n.y(), cost.contacts,
                    cost.patch_vertices, cost.total_us, cost.find_us, cost.patch_us, cost.correction_us);
        EXPECT_GT(simulated.y(), 0.1);
        EXPECT_LT((b.last.force_n - simulated).norm(), 0.01 * simulated.norm()) << rate << " Hz: " << b.last.force_n.transpose() << " against " << simulated.transpose();
        EXPECT_LT(b.last.jump_n, 0.01 * simulated.norm());
        if (rate == 200) reference = simulated.y();
        EXPECT_NEAR(simulated.y(), reference, 0.02 * reference) << rate;
    }
}

TEST(HapticsModel, PullsWhatItHolds) {
    // Down, a touch, hold, and 6 mm up: the hand is drawn down by what the simulation says, and let go it feels nothing.
    Bench b(60, {.times_s = {0, 0.2, 0.4, 0.6}, .positions_m = {Vec3(0.003, 0.055, 0.002), Vec3(0.003, 0.0515, 0.002), Vec3(0.003, 0.0515, 0.002), Vec3(0.003, 0.0575, 0.002)}});
    b.run(0.3);
    EXPECT_GT(b.last.force_n.y(), 0);
    EXPECT_GT(b.link.grab(0.001), 0u);
    b.run(1.0);
    const Vec3 held = b.last.force_n;
    EXPECT_LT(held.y(), -0.1);
    const Vec3 simulated = b.world.collider_state(b.link.collider()).coupling_force_n;  // what balances the pull in the simulation
    EXPECT_LT((held + simulated).norm(), 0.02 * held.norm()) << held.transpose() << " against " << -simulated.transpose();
    b.link.release();
    b.run(0.5);
    EXPECT_EQ(b.last.force_n, Vec3(0, 0, 0));
}

TEST(HapticsModel, TheSameBitsEveryTime) {
    const auto run = [] {
        Bench b(60, Bench::press(0.01, 0.1));
        std::vector<double> forces;
        for (int i = 0; i < 20; ++i) {
            b.step();
            for (int c = 0; c < 3; ++c) forces.push_back(b.last.force_n[c]);
        }
        return forces;
    };
    const auto first = run();
    EXPECT_GT(std::abs(first.back()) + std::abs(first[first.size() - 2]), 0);
    EXPECT_EQ(first, run());
}

TEST(HapticsModel, ALinkLeavesNoTrace) {
    World world(Bench::def(60));
    Bench::make_body(world);
    FedDevice device(device_preset("touch"));
    HapticLoop loop(device, {});
    {
        ToolLink link(world, loop, {});
        link.before_step();
        EXPECT_EQ(world.colliders().size(), 0u) << "not before the handle has said where it is";
        device.put({Vec3(0.2, 0.3, 0)});
        loop.tick(1e-3);
        link.before_step();
        ASSERT_EQ(world.colliders().size(), 1u);
        EXPECT_EQ(world.collider_state(link.collider()).pose.position_m, Vec3(0.2, 0.3, 0));
    }
    EXPECT_EQ(world.colliders().size(), 0u);
}

}  // namespace
}  // namespace supple::haptics
