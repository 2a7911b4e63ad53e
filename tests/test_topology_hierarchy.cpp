// Large bodies under the knife keep their multigrid.
#include <gtest/gtest.h>

#include "support/bodies.h"
#include "support/edits.h"

namespace supple {
namespace {

using test::blade_at_x;

TEST(TopologyHierarchy, ALargeBodyTakesItsHierarchyThroughEditsAndGetsANewOne) {
    World world({.time_step_s = 0.01, .threads = 1});
    const BodyId body = world.add_body({.shape = test::bar({40, 8, 8}), .material = Corotational{.young_pa = 5e6, .poisson = 0.4}});
    world.fix(body, test::at_x(0));
    const auto most = [&](int steps) {
        int iterations = 0;
        for (int i = 0; i < steps; ++i) {
            const StepReport report = world.step();
            EXPECT_EQ(report.flags, StepFlag::none);
            iterations = std::max(iterations, report.cg_iterations);
        }
        return iterations;
    };
    const int before = most(10);
    world.cut(body, blade_at_x(0.2337, 0.05));
    const int between = most(8);
    most(12);
    const int after = most(10);  // a bar cut half through needs more than a whole one
    EXPECT_LT(between, 8 * after / 5) << "the levels of before stand in; block-Jacobi takes ten times as many";
    EXPECT_LT(after, 5 * before / 2);
    world.undo_edit(body);
    EXPECT_LT(most(5), 3 * before / 2);
    for (int i = 0; i < 6; ++i) {  // edit upon edit: no time for a new one
        std::vector<std::int32_t> near;
        const VolumeMesh& m = world.shape(body).mesh();
        for (std::size_t e = 0; e < m.tets.size(); ++e)
            if ((m.vertices[std::size_t(m.tets[e][0])] - Vec3(0.1 + 0.03 * i, 0.1, 0.05)).norm() < 0.018) near.push_back(std::int32_t(e));
        ASSERT_FALSE(near.empty());
        world.remove_elements(body, near);
        EXPECT_LT(most(4), 3 * before);
    }
}

TEST(TopologyHierarchy, ASnapshotHoldsTheHierarchyThatAnEditHandedOn) {
    const auto make = [](int threads) {
        World world({.time_step_s = 0.01, .threads = threads});
        const BodyId body = world.add_body({.shape = test::bar({24, 8, 8}), .material = Corotational{.young_pa = 5e6, .poisson = 0.4}});
        world.fix(body, test::at_x(0));
        return std::pair(std::move(world), body);
    };
    const auto run = [](World& world, int steps) {
        for (int i = 0; i < steps; ++i) EXPECT_EQ(world.step().flags, StepFlag::none);
    };
    auto [world, body] = make(1);
    run(world, 6);
    const auto uncut = world.save();
    std::vector<std::vector<std::byte>> saved;
    std::vector<int> at;
    const auto save = [&](int step) {
        saved.push_back(world.save());
        at.push_back(step);
    };
    world.cut(body, blade_at_x(0.2337, 0.05));
    save(0);  // no step yet with what was handed on
    run(world, 3);
    save(3);
    world.cut(body, blade_at_x(0.13, 0.06));  // handed on twice
    run(world, 2);
    save(5);
    run(world, 12);  // a new one is under way
    save(17);
    run(world, 20);  // and at work
    save(37);
    run(world, 5);
    const std::uint64_t end = world.hash();
    for (std::size_t i = 0; i < saved.size(); ++i) {
        SCOPED_TRACE("saved after " + std::to_string(at[i]) + " steps");
        auto [fresh, same] = make(i % 2 == 0 ? 3 : 1);
        fresh.restore(saved[i]);
        for (int step = at[i]; step < 42; ++step) {
            if (step == 3 && at[i] <= 3) fresh.cut(same, blade_at_x(0.13, 0.06));
            run(fresh, 1);
        }
        EXPECT_EQ(fresh.hash(), end);
    }
    world.restore(uncut);  // what the edits will hand on is built anew
    world.cut(body, blade_at_x(0.2337, 0.05));
    run(world, 3);
    world.cut(body, blade_at_x(0.13, 0.06));
    run(world, 39);
    EXPECT_EQ(world.hash(), end);
    auto spoilt = saved[1];
    spoilt[spoilt.size() - 5000] ^= std::byte{1};
    EXPECT_THROW(world.restore(spoilt), Error);
}

}  // namespace
}  // namespace supple
