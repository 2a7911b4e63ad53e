// Sharp edges of soft bodies that cross: what no vertex sees.
#include <gtest/gtest.h>

#include "support/bodies.h"

namespace supple {
namespace {

WorldDef quick() {
    WorldDef def;
    def.threads = 1;
    return def;
}

/// A bar along x (or z) of square section, an edge of it up and one down; two cells along, so that no vertex is near its middle third.
std::shared_ptr<const BodyTemplate> diamond(bool along_x, double length, double side, int cells) {
    VolumeMesh mesh = make_tet_box({.min_m = {-length / 2, -side / 2, -side / 2}, .max_m = {length / 2, side / 2, side / 2}, .cells = {cells, 2, 2}});
    const double c = std::sqrt(0.5);
    for (Vec3& x : mesh.vertices) {
        const Vec3 turned(x.x(), c * (x.y() - x.z()), c * (x.y() + x.z()));
        x = along_x ? turned : Vec3(-turned.z(), turned.y(), turned.x());
    }
    return BodyTemplate::build(std::move(mesh));
}

double height(const World& world, BodyId id) {
    double sum = 0;
    for (const Vec3& x : world.positions(id)) sum += x.y() / double(world.positions(id).size());
    return sum;
}

/// Two bars crossed, edge on edge: the lower one held at its ends, the upper one led along y.
struct Crossed {
    World world;
    BodyId low, high;
    std::size_t edges = 0;
    static constexpr double kHalf = 0.0212132;  // from the middle to an edge
    explicit Crossed(double gap, double speed, WorldDef def = quick(), bool led = true) : world(def) {
        const Material material = Corotational{.young_pa = 2e5, .poisson = 0.4};
        low = world.add_body({.shape = diamond(true, 0.3, 0.03, 3), .material = material});
        high = world.add_body({.shape = diamond(false, 0.3, 0.03, 3), .material = material, .translation_m = {0.003, 2 * kHalf + gap, 0.002}, .velocity_m_s = Vec3(0, -speed, 0)});
        if (!led) return;
        world.fix(low, InsideBox{{-1, -1, -1}, {-0.149, 1, 1}});
        world.fix(low, InsideBox{{0.149, -1, -1}, {1, 1, 1}});
        world.fix(high, InsideBox{{-1, -1, -1}, {1, 1, -0.14}}, {true, false, true});
        world.fix(high, InsideBox{{-1, -1, 0.14}, {1, 1, 1}}, {true, false, true});
    }
    bool step() {
        const StepReport report = world.step();
        for (const ContactPoint& c : world.contacts()) edges += std::max({c.barycentric[0], c.barycentric[1], c.barycentric[2]}) < 0.999;
        return (report.flags & StepFlag::non_finite) == StepFlag::none;
    }
};

TEST(ContactEdges, CrossedBarsBearTheWeight) {
    WorldDef def = quick();
    def.gravity_m_s2 = Vec3(0, -2, 0);
    def.solver.rayleigh_mass_1_s = 5;
    Crossed bars(1e-4, 0, def);
    for (int n = 0; n < 900; ++n) ASSERT_TRUE(bars.step());
    const double weight = 2 * test::total_mass(bars.world, bars.high);
    Vec3 between = Vec3::Zero();
    ASSERT_FALSE(bars.world.contacts().empty());
    for (const ContactPoint& c : bars.world.contacts()) {
        const Vec3 force = c.normal_force_n * c.normal + c.friction_force_n;
        between += c.body == bars.high ? force : Vec3(-force);
        EXPECT_LT(c.depth_m, 1e-3);
    }
    EXPECT_NEAR(between.y(), weight, 1e-4 * weight);
    EXPECT_GT(bars.edges, 100u) << "it is edges that bear it";
}

TEST(ContactEdges, FastBarsDoNotPass) {
    for (const double speed : {1.0, 4.0}) {
        Crossed bars(0.02, speed);
        for (int n = 0; n < 60; ++n) {
            ASSERT_TRUE(bars.step());
            ASSERT_GT(height(bars.world, bars.high), height(bars.world, bars.low)) << speed << " m/s, step " << n;
        }
        EXPECT_GT(bars.edges, 0u) << speed;
    }
}

TEST(ContactEdges, AnImpactOfEdgesConservesMomentum) {
    WorldDef def = quick();
    def.gravity_m_s2 = Vec3::Zero();
    def.time_step_s = 1.0 / 240;
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-10;
    Crossed bars(0.002, 1, def, false);
    const auto momentum = [&] { return Vec3(test::momentum(bars.world, bars.low) + test::momentum(bars.world, bars.high)); };
    const Vec3 before = momentum();
    for (int n = 0; n < 40; ++n) {
        ASSERT_TRUE(bars.step());
        ASSERT_LT((momentum() - before).norm(), 1e-6 * before.norm()) << "step " << n;
    }
    EXPECT_GT(bars.edges, 0u);
    EXPECT_GT(test::momentum(bars.world, bars.high).y(), test::momentum(bars.world, bars.low).y()) << "they part";
}

TEST(ContactEdges, FlatBarsCrossedWithoutAVertexBetweenThem) {
    // Faces of few large triangles: the corners of the square where they meet are crossings of edges alone.
    WorldDef def = quick();
    def.solver.rayleigh_mass_1_s = 5;
    World world(def);
    const Material material = Corotational{.young_pa = 5e5, .poisson = 0.4};
    const auto bar = [](const Vec3& half, std::array<int, 3> cells) { return BodyTemplate::build(make_tet_box({.min_m = -half, .max_m = half, .cells = cells})); };
    const BodyId low = world.add_body({.shape = bar({0.15, 0.02, 0.02}, {3, 1, 1}), .material = material});
    const BodyId high = world.add_body({.shape = bar({0.02, 0.02, 0.15}, {1, 1, 3}), .material = material, .translation_m = {0.002, 0.0401, 0.003}});
    world.fix(low, InsideBox{{-1, -1, -1}, {-0.149, 1, 1}});
    world.fix(low, InsideBox{{0.149, -1, -1}, {1, 1, 1}});
    for (int n = 0; n < 600; ++n) world.step();
    const double weight = 9.81 * test::total_mass(world, high);
    double between = 0;
    for (const ContactPoint& c : world.contacts()) {
        EXPECT_LT(c.depth_m, 1e-3);
        between += (c.body == high ? 1 : -1) * (c.normal_force_n * c.normal + c.friction_force_n).y();
    }
    EXPECT_NEAR(between, weight, 1e-3 * weight);
    EXPECT_GT(height(world, high), height(world, low) + 0.038);
}

}  // namespace
}  // namespace supple
