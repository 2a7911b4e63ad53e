// Probes: peak, mean and time over a threshold of a part of a body.
#include <gtest/gtest.h>

#include "supple/world/probe.h"
#include "support/bodies.h"

namespace supple {
namespace {

WorldDef still() {
    WorldDef def;
    def.threads = 1;
    def.time_step_s = 0.01;
    def.gravity_m_s2 = Vec3::Zero();
    return def;
}

TEST(WorldProbe, PeakAndVolumeWeightedMeanOfAKnownField) {
    World world(still());
    const auto shape = test::irregular_cube(3, 0.3, 1);
    const BodyId body = world.add_body({.shape = shape, .material = Linear{1e5, 0}, .translation_m = {1, 0, 0}});
    test::Random random(1);
    std::vector<Vec3> x = test::copy(world.positions(body)), v(x.size(), Vec3::Zero());
    for (Vec3& p : x) p += random.vector(0.05);
    const auto start = world.start_positions(body);
    world.set_state(body, x, v);
    const InsideBox half{{-1, -1, -1}, {2.0 / 3 + 0.05, 2, 2}};
    Probe probe(world, body, {.name = "half", .where = half});
    EXPECT_TRUE(probe.on_elements());
    const ProbeSample& s = probe.read(world);
    const auto elements = select_elements(shape->mesh(), half);
    ASSERT_LT(elements.size(), shape->mesh().tets.size());
    double peak = 0, sum = 0, volume = 0;
    std::int32_t at = -1;
    const auto& X = shape->mesh().vertices;
    for (const std::int32_t e : elements) {
        const Tet& t = shape->mesh().tets[std::size_t(e)];
        const double V = tet_volume(X[std::size_t(t[0])], X[std::size_t(t[1])], X[std::size_t(t[2])], X[std::size_t(t[3])]);
        const double stress = world.element_von_mises(body)[std::size_t(e)];
        if (stress > peak) at = e;
        peak = std::max(peak, stress);
        sum += V * stress;
        volume += V;
    }
    EXPECT_NEAR(s.peak_von_mises_pa, peak, 1e-9 * peak);
    EXPECT_EQ(s.peak_at, at);
    EXPECT_NEAR(s.mean_von_mises_pa, sum / volume, 1e-9 * peak);
    double farthest = 0;
    for (const std::int32_t i : select_vertices(shape->mesh(), half)) farthest = std::max(farthest, (x[std::size_t(i)] - start[std::size_t(i)]).norm());
    EXPECT_NEAR(s.peak_displacement_m, farthest, 1e-12);
    EXPECT_GT(s.mean_displacement_m, 0);
    EXPECT_LT(s.mean_displacement_m, farthest);
}

TEST(WorldProbe, MeanDisplacementIsThatOfTheVolume) {
    // u = (x, 0, 0) on the unit cube: the mean over the volume is a half, whatever the mesh.
    World world(still());
    const auto shape = test::irregular_cube(4, 0.3, 2);
    const BodyId body = world.add_body({.shape = shape});
    std::vector<Vec3> x = shape->mesh().vertices, v(x.size(), Vec3::Zero());
    for (Vec3& p : x) p.x() *= 2;
    world.set_state(body, x, v);
    Probe probe(world, body, {});
    EXPECT_NEAR(probe.read(world).mean_displacement_m, 0.5, 1e-12);
    EXPECT_NEAR(probe.sample().peak_displacement_m, 1, 1e-12);
}

TEST(WorldProbe, CountsTheTimeOverItsThresholds) {
    // A bar whose end is pulled by 0.1 % per step, nu = 0: sigma = E e, above 1000 Pa from the step on that pulls more than 1 %.
    WorldDef def = still();
    def.solver.precision = Precision::double_;
    World world(def);
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1}), .material = Linear{1e5, 0}});
    Motion motion;
    motion.where = Everything{};
    motion.affine.times_s = {0, 0.3};
    Mat34 stretch = Mat34::Identity();
    motion.affine.values.push_back(stretch);
    stretch(0, 0) = 1.03;
    motion.affine.values.push_back(stretch);
    world.prescribe(body, motion);
    Probe probe(world, body, {.name = "all", .threshold_pa = 1050, .threshold_m = 0.4 * 0.0205});
    for (int n = 0; n < 30; ++n) {
        world.step();
        probe.read(world);
        EXPECT_NEAR(probe.sample().peak_von_mises_pa, 100 * (n + 1), 1e-3);
    }
    EXPECT_NEAR(probe.sample().over_threshold_s, 0.20, 1e-12);
    EXPECT_NEAR(probe.sample().displaced_s, 0.10, 1e-12);
    probe.read(world);
    EXPECT_NEAR(probe.sample().over_threshold_s, 0.20, 1e-12) << "reading twice is no time";
    world.reset();
    EXPECT_EQ(probe.read(world).over_threshold_s, 0);
}

TEST(WorldProbe, ASurfacePatchIsReadAtItsVertices) {
    World world(still());
    const auto shape = test::bar({4, 2, 2});
    const BodyId body = world.add_body({.shape = shape, .material = Linear{1e5, 0}});
    test::Random random(3);
    std::vector<Vec3> x = shape->mesh().vertices, v(x.size(), Vec3::Zero());
    for (Vec3& p : x) p += random.vector(0.003);
    world.set_state(body, x, v);
    Probe probe(world, body, {.where = test::at_x(0.4)});
    EXPECT_FALSE(probe.on_elements());
    double peak = 0;
    for (const std::int32_t i : select_vertices(shape->mesh(), test::at_x(0.4))) peak = std::max(peak, world.von_mises(body)[std::size_t(i)]);
    EXPECT_NEAR(probe.read(world).peak_von_mises_pa, peak, 1e-9 * peak);
    EXPECT_NEAR(shape->mesh().vertices[std::size_t(probe.sample().peak_at)].x(), 0.4, 1e-12);
}

TEST(WorldProbe, RefusesNothingToWatch) {
    World world(still());
    const BodyId body = world.add_body({.shape = test::bar({4, 1, 1})});
    EXPECT_THROW(Probe(world, body, {.where = test::at_x(7)}), Error);
    EXPECT_THROW(Probe(world, body, {.threshold_pa = 0}), Error);
    EXPECT_THROW(Probe(world, body, {.threshold_m = -1}), Error);
}

}  // namespace
}  // namespace supple
