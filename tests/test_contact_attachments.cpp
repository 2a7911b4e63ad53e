// Points of bodies tied to the world and to colliders.
#include <gtest/gtest.h>

#include <functional>

#include "support/bodies.h"

namespace supple {
namespace {

WorldDef quick(const Vec3& gravity = Vec3(0, -9.81, 0)) {
    WorldDef def;
    def.threads = 1;
    def.gravity_m_s2 = gravity;
    def.solver.rayleigh_mass_1_s = 2;
    return def;
}

/// The vertex of a body nearest to a point of its start.
std::int32_t vertex_at(const World& world, BodyId body, const Vec3& p) {
    const auto x = world.start_positions(body);
    std::size_t best = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if ((x[i] - p).squaredNorm() < (x[best] - p).squaredNorm()) best = i;
    }
    return std::int32_t(best);
}

BodyId add_cube(World& world) { return world.add_body({.shape = test::cube(3, 0.1), .material = Corotational{.young_pa = 1e5, .poisson = 0.3}}); }

TEST(ContactAttachment, ABodyHangsFromAPointAndThePointBearsItsWeight) {
    for (const double stiffness : {0.0, 2000.0}) {
        World world(quick());
        const BodyId body = add_cube(world);
        const double weight = test::total_mass(world, body) * 9.81;
        std::vector<AttachmentId> ties;
        for (const Vec3& p : {Vec3(0, 0.1, 0), Vec3(0.1, 0.1, 0), Vec3(0, 0.1, 0.1), Vec3(0.1, 0.1, 0.1)}) {
            ties.push_back(world.attach({.body = body, .vertices = {vertex_at(world, body, p), -1, -1, -1}, .stiffness_n_m = stiffness}));
        }
        ASSERT_TRUE(test::run_to_rest(world, 1e-6, 2000));
        Vec3 sum = Vec3::Zero();
        for (const AttachmentId tie : ties) {
            const AttachmentState state = world.attachment_state(tie);
            sum += state.force_n;
            const double stretch = (state.point_m - state.anchor_m).norm();
            if (stiffness > 0) {
                EXPECT_NEAR(state.force_n.norm(), stiffness * stretch, 1e-4 * weight);
            } else {
                EXPECT_LT(stretch, 2e-4) << "hard";
            }
        }
        EXPECT_LT((sum - Vec3(0, weight, 0)).norm(), 1e-4 * weight);
    }
}

TEST(ContactAttachment, APointOfAnElementIsTheMeanOfItsVertices) {
    World world(quick());
    const BodyId body = add_cube(world);
    const Tet t = world.shape(body).mesh().tets[5];
    const AttachmentId tie = world.attach({.body = body, .vertices = {t[0], t[1], t[2], t[3]}, .weights = {0.1, 0.2, 0.3, 0.4}});
    const Vec3 at = world.attachment_state(tie).anchor_m;
    EXPECT_EQ(at, world.attachment_state(tie).point_m) << "tied where it is";
    for (int n = 0; n < 600; ++n) EXPECT_EQ(world.step().flags, StepFlag::none);
    EXPECT_LT((world.attachment_state(tie).point_m - at).norm(), 1e-3);
    EXPECT_NEAR(world.attachment_state(tie).force_n.y(), test::total_mass(world, body) * 9.81, 0.05 * test::total_mass(world, body) * 9.81);
}

TEST(ContactAttachment, FollowsAMovingToolAndTurnsWithIt) {
    World world(quick(Vec3::Zero()));
    const BodyId body = add_cube(world);
    const ColliderId tool = world.add_collider({.shape = SphereShape{0.01}, .pose = {Vec3(0.05, 0.2, 0.05), {1, 0, 0, 0}}, .motion = ColliderMotion::kinematic});
    std::vector<AttachmentId> ties;
    for (const Vec3& p : {Vec3(0, 0.1, 0), Vec3(0.1, 0.1, 0), Vec3(0, 0.1, 0.1), Vec3(0.1, 0.1, 0.1)}) {
        ties.push_back(world.attach({.body = body, .vertices = {vertex_at(world, body, p), -1, -1, -1}, .collider = tool}));
    }
    for (int n = 1; n <= 240; ++n) {
        const double s = std::min(1.0, n / 180.0), angle = 0.5 * M_PI * s;
        world.move_collider(tool, {Vec3(0.05 + 0.3 * s, 0.2, 0.05), {std::cos(angle / 2), 0, std::sin(angle / 2), 0}});
        EXPECT_EQ(world.step().flags, StepFlag::none);
        for (const AttachmentId tie : ties) EXPECT_LT((world.attachment_state(tie).point_m - world.attachment_state(tie).anchor_m).norm(), 1e-3);
    }
    // (0, 0.1, 0) lay at (-0.05, -0.1, -0.05) from the tool; a quarter turn about y takes (x, z) to (z, -x).
    EXPECT_LT((world.attachment_state(ties[0]).anchor_m - Vec3(0.35 - 0.05, 0.1, 0.05 + 0.05)).norm(), 1e-9);
}

TEST(ContactAttachment, ADynamicWeightHangsOnABody) {
    World world(quick());
    const BodyId body = add_cube(world);
    world.fix(body, InsideBox{{-1, 0.1 - 1e-9, -1}, {1, 1, 1}});
    const ColliderId weight = world.add_collider({.shape = SphereShape{0.01}, .pose = {Vec3(0.05, -0.05, 0.05), {1, 0, 0, 0}}, .motion = ColliderMotion::dynamic, .mass_kg = 0.2});
    const AttachmentId tie = world.attach({.body = body, .vertices = {vertex_at(world, body, Vec3(0.033, 0, 0.033)), -1, -1, -1}, .collider = weight,
                                           .at_point = false, .anchor_m = Vec3(0.05, -0.05, 0.05), .stiffness_n_m = 100});
    for (int n = 0; n < 2400; ++n) world.step();
    EXPECT_NEAR(world.attachment_state(tie).force_n.y(), -0.2 * 9.81, 0.02 * 0.2 * 9.81);
    EXPECT_LT((world.attachment_state(tie).force_n + world.collider_state(weight).force_n).norm(), 1e-9);
    EXPECT_LT(world.collider_state(weight).velocity_m_s.norm(), 0.01);
    const Vec3 total = world.reaction_n();
    EXPECT_NEAR(total.y(), (test::total_mass(world, body) + 0.2) * 9.81, 0.02 * 0.2 * 9.81);
}

TEST(ContactAttachment, BreaksAboveItsForceAndSaysSo) {
    World world(quick());
    const BodyId body = add_cube(world);
    world.fix(body, InsideBox{{-1, -1, -1}, {1, 1e-9, 1}});
    const AttachmentId tie = world.attach({.body = body, .vertices = {vertex_at(world, body, Vec3(0, 0.1, 0)), -1, -1, -1}, .max_force_n = 3});
    const Vec3 start = world.attachment_state(tie).anchor_m;
    double strongest = 0;
    int broke = -1;
    for (int n = 0; n < 200; ++n) {
        world.move_attachment(tie, start + Vec3(0, 0.0005 * n, 0));
        world.step();
        const AttachmentState state = world.attachment_state(tie);
        if (!state.broken) strongest = std::max(strongest, state.force_n.norm());
        if (state.broken && broke < 0) {
            broke = n;
            EXPECT_GT(state.force_n.norm(), 3);
        }
    }
    EXPECT_GT(broke, 0);
    EXPECT_LE(strongest, 3);
    EXPECT_GT(strongest, 2);
    EXPECT_LT((world.attachment_state(tie).point_m - start).norm(), 5e-3) << "it went back";
}

TEST(ContactAttachment, AttachAndReleaseLeaveNoTrace) {
    World touched(quick()), untouched(quick());
    const BodyId body = add_cube(touched);
    const BodyId other = add_cube(untouched);
    touched.add_collider({});
    untouched.add_collider({});
    for (int round = 0; round < 50; ++round) {
        const AttachmentId tie = touched.attach({.body = body, .vertices = {round % 20, -1, -1, -1}});
        touched.detach(tie);
        EXPECT_THROW(touched.detach(tie), Error);
        touched.step();
        untouched.step();
    }
    EXPECT_EQ(touched.hash(), untouched.hash());
    // Held for a while: from then on as a world that was put into that state.
    const AttachmentId tie = touched.attach({.body = body, .vertices = {3, -1, -1, -1}});
    touched.move_attachment(tie, Vec3(0.02, 0.15, 0));
    for (int n = 0; n < 10; ++n) touched.step();
    const auto held = touched.save();
    for (int n = 0; n < 5; ++n) touched.step();
    const std::uint64_t hash = touched.hash();
    touched.restore(held);
    for (int n = 0; n < 5; ++n) touched.step();
    EXPECT_EQ(touched.hash(), hash) << "a snapshot holds its attachments";
    touched.detach(tie);
    untouched.set_state(other, touched.positions(body), touched.velocities(body));
    touched.set_state(body, test::copy(touched.positions(body)), test::copy(touched.velocities(body)));
    for (int n = 0; n < 5; ++n) {
        touched.step();
        untouched.step();
    }
    EXPECT_EQ(test::relative_difference(touched.positions(body), untouched.positions(other)), 0);
}

TEST(ContactAttachment, GoesWithItsBodyAndItsCollider) {
    World world(quick());
    const BodyId body = add_cube(world), second = add_cube(world);
    const ColliderId plane = world.add_collider({});
    const AttachmentId a = world.attach({.body = body, .vertices = {0, -1, -1, -1}}), b = world.attach({.body = second, .vertices = {0, -1, -1, -1}, .collider = plane});
    world.remove_body(body);
    EXPECT_THROW((void)world.attachment_state(a), Error);
    world.remove_collider(plane);
    EXPECT_THROW((void)world.attachment_state(b), Error);
    EXPECT_EQ(world.step().flags, StepFlag::none);
    const auto refused = [&](const AttachmentDef& def, const std::string& field) {
        try {
            world.attach(def);
            ADD_FAILURE() << field;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
        }
    };
    refused({.body = body, .vertices = {0, -1, -1, -1}}, "body");
    refused({.body = second}, "vertices");
    refused({.body = second, .vertices = {100000, -1, -1, -1}}, "vertices");
    refused({.body = second, .vertices = {1, 1, -1, -1}, .weights = {0.5, 0.5, 0, 0}}, "twice");
    refused({.body = second, .vertices = {1, 2, -1, -1}, .weights = {0.5, 0.4, 0, 0}}, "weights");
    refused({.body = second, .vertices = {1, -1, -1, -1}, .collider = plane}, "collider");
    refused({.body = second, .vertices = {1, -1, -1, -1}, .max_force_n = -1}, "max_force_n");
}

}  // namespace
}  // namespace supple
