// Bodies of hexahedra, and of tets and hexes, in motion: stiffness of slender and nearly incompressible bodies, momentum, long runs, history, picking.
#include <gtest/gtest.h>

#include "supple/world/evaluate.h"
#include "support/bodies.h"

namespace supple {
namespace {

WorldDef resting_world() {
    WorldDef def;
    def.gravity_m_s2 = Vec3::Zero();
    def.time_step_s = 1;  // implicit Euler with a long step: a few of them are the static solution
    def.threads = 1;
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-10;
    def.solver.cg_max_iterations = 100000;
    return def;
}

/// Deflection of a single layer of hexes, 1 x 0.1 x 0.1 m in `cells` cells, under a small load at its end, over Timoshenko's.
double cantilever_ratio(int cells, const Material& material) {
    const double L = 1, a = 0.1, E = 1e6, nu = 0.3, P = 1e-2;
    World world(resting_world());
    const auto shape = BodyTemplate::build(make_hex_box({.min_m = Vec3::Zero(), .max_m = {L, a, a}, .cells = {cells, 1, 1}}));
    const BodyId body = world.add_body({.shape = shape, .material = material, .density_kg_m3 = 1});
    // The clamped section may thin: only its x, and what keeps it in place. A clamp that holds it all is singular.
    world.fix(body, test::at_x(0), {true, false, false});
    world.fix(body, VertexList{{0}}, {true, true, true});
    world.fix(body, VertexList{{cells + 1}}, {true, false, true});
    world.fix(body, VertexList{{2 * (cells + 1)}}, {true, true, false});
    world.add_load(body, {test::at_x(L), LoadKind::total_force, {{0}, {Vec3(0, P, 0)}}});
    EXPECT_TRUE(test::run_to_rest(world, 1e-12, 400));
    const double tip = test::mean_position(world, body, test::at_x(L)).y() - a / 2;
    const double I = a * a * a * a / 12, kappa = 10 * (1 + nu) / (12 + 11 * nu), G = E / (2 * (1 + nu));
    return tip / (P * L * L * L / (3 * E * I) + P * L / (kappa * G * a * a));
}

TEST(WorldHex, ASlenderCantileverOfOneLayerBendsAsTimoshenkoSaysAndLocksWhenFullyIntegrated) {
    for (const bool corotational : {false, true}) {
        const auto ratio = [&](Integration integration) {
            if (corotational) return cantilever_ratio(10, Corotational{.young_pa = 1e6, .poisson = 0.3, .integration = integration});
            return cantilever_ratio(10, Linear{.young_pa = 1e6, .poisson = 0.3, .integration = integration});
        };
        EXPECT_NEAR(ratio(Integration::incompatible), 1, 0.015);
        EXPECT_LT(ratio(Integration::full), 0.75) << "shear locking has vanished";
    }
}

/// A block of 4^3 hexes on the floor, all but its upper side held, pressed in the middle of that side: how far it gives.
double pressed_block(const Material& material) {
    World world(resting_world());
    const auto shape = BodyTemplate::build(make_hex_box({.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {4, 4, 4}}));
    const BodyId body = world.add_body({.shape = shape, .material = material, .density_kg_m3 = 1});
    for (const int axis : {0, 2}) {
        for (const double side : {0.0, 1.0}) {
            InsideBox box{Vec3::Constant(-1), Vec3::Constant(2)};
            box.min_m[axis] = side - 1e-9;
            box.max_m[axis] = side + 1e-9;
            world.fix(body, box, {true, true, true});
        }
    }
    world.fix(body, InsideBox{Vec3(-1, -1, -1), Vec3(2, 1e-9, 2)});
    world.add_load(body, {InsideBox{Vec3(0.4, 0.99, 0.4), Vec3(0.6, 1.01, 0.6)}, LoadKind::total_force, {{0}, {Vec3(0, -1e-4, 0)}}});
    EXPECT_TRUE(test::run_to_rest(world, 1e-13, 300));
    return 1 - test::mean_position(world, body, InsideBox{Vec3(0.4, 0.99, 0.4), Vec3(0.6, 1.01, 0.6)}).y();
}

TEST(WorldHex, NearlyIncompressibleMatterLocksOnlyWhenFullyIntegrated) {
    const auto give = [](Integration integration, double poisson) {
        return pressed_block(Linear{.young_pa = 1, .poisson = poisson, .integration = integration});
    };
    // From nu = 0.45 on, less than a tenth of the compliance is in the volume: what is lost beyond is locking.
    EXPECT_GT(give(Integration::incompatible, 0.4999) / give(Integration::incompatible, 0.45), 0.7);
    EXPECT_LT(give(Integration::full, 0.4999) / give(Integration::full, 0.45), 0.5);
    EXPECT_LT(give(Integration::full, 0.4999), 0.4 * give(Integration::incompatible, 0.4999));
    const Lame lame = lame_parameters(1, 0.4999, "test");
    EXPECT_GT(pressed_block(NeoHookean{lame.mu_pa, lame.lambda_pa}), 2 * give(Integration::full, 0.4999)) << "hyperelastic hexes lock";
}

TEST(WorldHex, AHangingBarSwingsFor300Steps) {
    for (const Material& material : {Material(Corotational{.young_pa = 1e5, .poisson = 0.4}),
                                     Material(Corotational{.rotation = Rotation::large, .young_pa = 1e5, .poisson = 0.4}), Material(NeoHookean{4e4, 1e5}),
                                     Material(Costa{4e4, 1e5, {3, 2, 2, 2, 2, 2}, {.fibre = {Vec3(1, 0.3, 0)}}})}) {
        WorldDef def;
        def.time_step_s = 0.01;
        def.threads = 1;
        def.solver.rayleigh_mass_1_s = 4;  // the swing dies down to a four-hundredth
        World world(def);
        const BodyId body = world.add_body({.shape = test::hex_bar({8, 2, 2}), .material = material});
        world.fix(body, test::at_x(0));
        const double before = world.energy().total_j();
        double lowest = 1;
        for (int n = 0; n < 300; ++n) {
            ASSERT_EQ(world.step().flags, StepFlag::none) << n;
            lowest = std::min(lowest, test::mean_position(world, body, test::at_x(0.4)).y());
        }
        EXPECT_LT(lowest, 0.0);
        EXPECT_GT(lowest, -0.35);
        EXPECT_LT(world.energy().total_j(), before + 1e-6) << "energy came from nowhere";
        EXPECT_NEAR(world.reaction_n(body).y(), 4 * 9.81, 0.4) << "the support carries the bar";
    }
}

/// A cube of hexes whose uppermost layer is cut into tets; four laws over its elements where asked.
BodyDef mixed_body(bool several_laws) {
    VolumeMesh mesh = make_hex_box({.min_m = Vec3::Zero(), .max_m = Vec3::Constant(0.1), .cells = {3, 3, 3}});
    const VolumeMesh tets = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3::Constant(0.1), .cells = {3, 3, 3}});
    mesh.hexes.resize(18);
    mesh.tets.assign(tets.tets.begin() + 18 * 6, tets.tets.end());
    BodyDef def;
    def.shape = BodyTemplate::build(std::move(mesh));
    def.material = Corotational{.young_pa = 2e4, .poisson = 0.4};
    if (several_laws) {
        const Material laws[4] = {def.material, NeoHookean{1e4, 4e4}, StableNeoHookean{8e3, 2e4}, Costa{4e3, 2e4, {6, 2, 3, 2, 2, 3}, {.fibre = {Vec3(1, 1, 0)}}}};
        for (std::size_t e = 0; e < def.shape->mesh().element_count(); ++e) def.material_per_element.push_back(laws[e % 4]);
    }
    return def;
}

TEST(WorldHex, AMixedBodyKeepsItsMomentumAndComesToRest) {
    for (const bool several_laws : {false, true}) {
        WorldDef def;
        def.gravity_m_s2 = Vec3::Zero();
        def.threads = 1;
        def.solver.precision = Precision::double_;
        def.solver.cg_relative_tolerance = 1e-12;
        World world(def);
        const BodyId body = world.add_body(mixed_body(several_laws));
        test::Random random(40);
        auto x = test::copy(world.positions(body)), v = x;
        for (Vec3& p : x) p += random.vector(0.004);
        for (Vec3& u : v) u = Vec3(0.3, -0.2, 0.5) + random.vector(0.2);
        world.set_state(body, x, v);
        const Vec3 before = test::momentum(world, body);
        const double energy = world.energy().elastic_j;
        for (int n = 0; n < 200; ++n) ASSERT_EQ(world.step().flags, StepFlag::none);
        EXPECT_LT((test::momentum(world, body) - before).norm(), 1e-10 * before.norm());
        EXPECT_LT(world.energy().elastic_j, 0.05 * energy);
    }
}

/// Hash of a world of hexes and mixed bodies after some steps, with a touch.
std::uint64_t hash_after(int threads, Precision precision, int steps, World** keep = nullptr) {
    WorldDef def;
    def.time_step_s = 0.01;
    def.threads = threads;
    def.solver.precision = precision;
    static std::unique_ptr<World> world;
    world = std::make_unique<World>(def);
    const BodyId bar = world->add_body({.shape = test::hex_bar({40, 11, 10}), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
    world->fix(bar, test::at_x(0));
    BodyDef other = mixed_body(true);
    other.translation_m = Vec3(0, 1, 0);
    world->add_body(other);
    for (int n = 0; n < steps; ++n) EXPECT_EQ(world->step().flags, StepFlag::none);
    if (keep != nullptr) *keep = world.get();
    return world->hash();
}

TEST(WorldHex, TheNumberOfThreadsDoesNotMatter) {
    for (const Precision precision : {Precision::single, Precision::double_}) {
        const std::uint64_t one = hash_after(1, precision, 3);
        EXPECT_EQ(hash_after(3, precision, 3), one);
        EXPECT_NE(hash_after(1, precision, 2), one);
    }
}

TEST(WorldHex, ASnapshotContinuesBitForBit) {
    World* world = nullptr;
    hash_after(1, Precision::single, 2, &world);
    const auto saved = world->save();
    for (int n = 0; n < 3; ++n) world->step();
    const std::uint64_t expected = world->hash();
    hash_after(1, Precision::single, 0, &world);
    world->restore(saved);
    for (int n = 0; n < 3; ++n) world->step();
    EXPECT_EQ(world->hash(), expected);
}

TEST(WorldHex, PickingGivesTheHex) {
    World world;
    const BodyId body = world.add_body({.shape = test::hex_bar({4, 1, 1})});
    const auto hit = world.pick({{0.27, 0.03, 1}, {0, 0, -1}});
    ASSERT_TRUE(hit.has_value());
    EXPECT_EQ(hit->body, body);
    EXPECT_EQ(hit->element, 2);
    EXPECT_LT((hit->position_m - Vec3(0.27, 0.03, 0.1)).norm(), 1e-12);
    const DragId drag = world.begin_drag(*hit);
    world.move_drag(drag, hit->position_m + Vec3(0, 0.05, 0));
    for (int n = 0; n < 20; ++n) EXPECT_EQ(world.step().flags, StepFlag::none);
    EXPECT_GT(world.drag_state(drag).force_n.norm(), 0);
}

TEST(WorldHex, MaterialsOfElementsAreChecked) {
    World world;
    BodyDef def = mixed_body(true);
    def.material_per_element[5] = NeoHookean{-1, 1};
    EXPECT_THROW(world.add_body(def), Error);
    def = mixed_body(true);
    def.material_per_element.pop_back();
    EXPECT_THROW(world.add_body(def), Error);
}

struct Equilibrium {
    int iterations = 0;
    Vec3 tip;
    double twist = 0;  // of the end [rad]
};

/// A beam held at one end, its other end pulled, bent and twisted by dead forces; in ten load steps.
Equilibrium twisted_beam(Tangent tangent, Integration integration) {
    WorldDef def = resting_world();
    def.solver.integrator = Integrator::quasi_static;
    def.solver.tangent = tangent;
    def.solver.newton_tolerance = 1e-10;
    def.solver.newton_iterations = 300;
    World world(def);
    const BodyId body = world.add_body({.shape = test::hex_bar({16, 4, 4}), .material = Corotational{.young_pa = 1e5, .poisson = 0.3, .integration = integration}});
    world.fix(body, test::at_x(0));
    const auto push = [&](double y_m, const Vec3& force_n) {
        const InsideBox edge{{0.4 - 1e-9, y_m - 1e-9, -1}, {0.4 + 1e-9, y_m + 1e-9, 1}};
        world.add_load(body, {edge, LoadKind::total_force, {{0, 10}, {Vec3::Zero(), force_n}}});
    };
    push(0.1, Vec3(100, -10, 30));
    push(0, Vec3(100, -10, -30));
    Equilibrium result;
    for (int k = 0; k < 10; ++k) {
        const StepReport report = world.step();
        EXPECT_EQ(report.flags, StepFlag::none) << name(report.flags);
        result.iterations += report.newton_iterations;
    }
    result.tip = test::mean_position(world, body, test::at_x(0.4));
    const auto x = world.positions(body);
    const Vec3 side = x[x.size() - 1] - x[16];  // across the end, from its lowest corner
    result.twist = std::atan2(side.z(), side.y()) - M_PI / 4;
    return result;
}

TEST(WorldHex, NewtonTakesFewIterationsWithTheExactTangent) {
    for (const Integration integration : {Integration::incompatible, Integration::full}) {
        const Equilibrium exact = twisted_beam(Tangent::exact, integration), warped = twisted_beam(Tangent::warped, integration);
        EXPECT_LT(2 * exact.iterations, warped.iterations);
        EXPECT_LT((exact.tip - warped.tip).norm(), 1e-7) << "the tangent must not move the equilibrium";
        EXPECT_GT(exact.twist, 0.2);
        EXPECT_NEAR(exact.twist, warped.twist, 1e-5);
    }
}

TEST(WorldHex, BodyForcesReachEveryCorner) {
    World world(resting_world());
    const BodyDef def = mixed_body(false);
    const BodyId body = world.add_body(def);
    world.fix(body, Everything{});
    world.add_load(body, {Everything{}, LoadKind::body_force, {{0}, {Vec3(0, -1000, 0)}}});
    world.step();
    EXPECT_NEAR(world.reaction_n(body).y(), 1000 * 1e-3, 1e-12);
}

}  // namespace
}  // namespace supple
