// Stacks of soft bodies at rest: no creep, no jitter, no slow sliding.
#include <gtest/gtest.h>

#include "support/bodies.h"

namespace supple {
namespace {

/// Boxes of different size, stiffness, density and mesh on a plane, each shifted against the one below.
struct Stack {
    World world;
    std::vector<BodyId> bodies;
    std::vector<std::vector<Vec3>> settled;
    double weight = 0;

    static WorldDef def() {
        WorldDef def;
        def.threads = 1;
        def.time_step_s = 1.0 / 60;
        return def;
    }
    explicit Stack(int count) : world(def()) {
        const double young[] = {1e5, 3e5, 6e4, 2e5, 1e5, 4e5, 8e4, 1.5e5, 3e5, 1e5};
        double y = 0;
        for (int i = 0; i < count; ++i) {
            const double half = 0.05 + 0.004 * (i * 7 % 5), height = 0.03 + 0.004 * (i * 3 % 4);
            const int cells = 2 + i * 3 % 3;
            y += 1e-4;
            BodyDef body;
            body.shape = BodyTemplate::build(make_tet_box({.min_m = {-half, 0, -half}, .max_m = {half, height, half}, .cells = {cells + 1, cells, cells + 1}}));
            body.material = Corotational{.young_pa = young[i % 10], .poisson = 0.4};
            body.density_kg_m3 = 600 + 100.0 * (i * 2 % 5);
            body.translation_m = Vec3(0.002 * (i * 5 % 3), y, 0.0015 * (i * 2 % 3));
            body.friction = 0.5;
            bodies.push_back(world.add_body(body));
            weight += 9.81 * test::total_mass(world, bodies.back());
            y += height;
        }
        world.add_collider({.friction = 0.5});
    }
    void run(double seconds) {
        for (int n = 0; n < int(std::lround(60 * seconds)); ++n) EXPECT_EQ(world.step().flags & StepFlag::non_finite, StepFlag::none);
    }
    void remember() {
        for (const BodyId id : bodies) settled.push_back(test::copy(world.positions(id)));
    }
    double drift() const {
        double most = 0;
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            for (std::size_t i = 0; i < settled[b].size(); ++i) most = std::max(most, (world.positions(bodies[b])[i] - settled[b][i]).norm());
        }
        return most;
    }
    double rms_speed() const {
        double sum = 0;
        std::size_t count = 0;
        for (const BodyId id : bodies) {
            for (const Vec3& v : world.velocities(id)) sum += v.squaredNorm();
            count += world.velocities(id).size();
        }
        return std::sqrt(sum / double(count));
    }
};

TEST(ContactStack, ThreeBodiesRest) {
    Stack stack(3);
    stack.run(3);
    stack.remember();
    for (int second = 0; second < 5; ++second) {
        stack.run(1);
        EXPECT_LT(stack.rms_speed(), 1e-4) << second;
    }
    EXPECT_LT(stack.drift(), 1e-4);
    EXPECT_NEAR(stack.world.contact_force_n().y(), stack.weight, 1e-4 * stack.weight);
}

TEST(ContactStack, SlowTenBodiesRestForAMinute) {
    Stack stack(10);
    stack.run(5);
    stack.remember();
    for (int second = 0; second < 60; ++second) {
        stack.run(1);
        EXPECT_LT(stack.rms_speed(), 1e-4) << second;
        EXPECT_LT(stack.drift(), 1e-4) << second;
    }
    EXPECT_NEAR(stack.world.contact_force_n().y(), stack.weight, 1e-4 * stack.weight);
}

}  // namespace
}  // namespace supple
