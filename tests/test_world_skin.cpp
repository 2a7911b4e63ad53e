// Skins: drawn and picked in place of the boundary.
#include <gtest/gtest.h>

#include <cmath>

#include "mesh_helpers.h"
#include "supple/mesh/box_mesh.h"
#include "supple/world/world.h"

namespace supple {
namespace {

using supple_test::expect_error;

/// A block of 2 x 1 x 1 whose skin is a square a little above its top, of 2 x 8 x 8 triangles.
struct Skinned {
    World world{WorldDef{.gravity_m_s2 = Vec3::Zero(), .time_step_s = 0.01, .threads = 1}};
    BodyId body;

    explicit Skinned(bool hexes) {
        const BoxDef box{Vec3::Zero(), Vec3(2, 1, 1), {4, 2, 2}};
        BodyDef def;
        def.shape = BodyTemplate::build(hexes ? make_hex_box(box) : make_tet_box(box));
        mesh::TriangleMesh square;
        constexpr int n = 8;
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i) square.vertices.push_back(Vec3(0.5 + double(i) / n, double(j) / n, 1.05));
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const int a = i + (n + 1) * j, b = a + 1, c = a + n + 1, d = c + 1;
                square.triangles.push_back({a, b, d});
                square.triangles.push_back({a, d, c});
            }
        def.skin = Skin::build(def.shape->mesh(), square);
        def.translation_m = Vec3(0, 0, 3);
        def.material = Corotational{.young_pa = 1e4, .poisson = 0.3};
        body = world.add_body(def);
    }
};

const Ray kDown{Vec3(0.9, 0.4, 10), Vec3(0, 0, -1)};

TEST(WorldSkin, PickingMeetsTheSkinAndSaysWhichElementMovesIt) {
    for (const bool hexes : {false, true}) {
        Skinned s(hexes);
        const auto hit = s.world.pick(kDown);
        ASSERT_TRUE(hit);
        EXPECT_GE(hit->skin_triangle, 0);
        EXPECT_EQ(hit->triangle, -1);
        EXPECT_NEAR(hit->position_m.z(), 4.05, 1e-12);
        Vec3 sum = Vec3::Zero();
        const auto corners = element_vertices(s.world.shape(s.body).mesh(), hit->element);
        for (std::size_t a = 0; a < corners.size(); ++a) sum += hit->element_weights[a] * s.world.positions(s.body)[std::size_t(corners[a])];
        EXPECT_LT((sum - hit->position_m).norm(), 1e-10) << "the element's weights give the point";
        EXPECT_FALSE(s.world.pick({Vec3(0.2, 0.4, 10), Vec3(0, 0, -1)})) << "the boundary beside the skin is not there";
        EXPECT_EQ(s.world.skin_positions(s.body).size(), s.world.skin(s.body)->surface().vertices.size());
    }
}

TEST(WorldSkin, DragsPullWhereTheSkinIsHeld) {
    for (const bool hexes : {false, true})
        for (const double radius : {0.0, 0.7}) {
            Skinned s(hexes);
            s.world.fix(s.body, InsideBox{Vec3(-1, -1, -1), Vec3(3, 3, 0.01)});
            const auto hit = s.world.pick(kDown);
            ASSERT_TRUE(hit);
            const DragId drag = s.world.begin_drag(*hit, {.radius_m = radius});
            EXPECT_LT((s.world.drag_state(drag).anchor_m - hit->position_m).norm(), 1e-12) << "no jump at the start";
            s.world.move_drag(drag, hit->position_m + Vec3(0, 0, 0.2));
            const double before = s.world.skin_positions(s.body)[40].z();
            for (int i = 0; i < 60; ++i) ASSERT_TRUE(s.world.step().flags == StepFlag::none);
            EXPECT_GT(s.world.skin_positions(s.body)[40].z(), before + 0.02);
        }
}

TEST(WorldSkin, BoundaryHitsCarryElementWeightsToo) {
    Skinned s(false);
    BodyDef plain;
    plain.shape = BodyTemplate::build(make_tet_box({Vec3::Zero(), Vec3::Ones(), {2, 2, 2}}));
    plain.translation_m = Vec3(0.5, 0, 8);
    const BodyId body = s.world.add_body(plain);
    const auto hit = s.world.pick(kDown);
    ASSERT_TRUE(hit);
    ASSERT_EQ(hit->body, body);
    EXPECT_EQ(hit->skin_triangle, -1);
    EXPECT_GE(hit->triangle, 0);
    Vec3 sum = Vec3::Zero();
    const auto corners = element_vertices(s.world.shape(body).mesh(), hit->element);
    for (std::size_t a = 0; a < corners.size(); ++a) sum += hit->element_weights[a] * s.world.positions(body)[std::size_t(corners[a])];
    EXPECT_LT((sum - hit->position_m).norm(), 1e-12);
    EXPECT_EQ(s.world.skin(body), nullptr);
    EXPECT_TRUE(s.world.skin_positions(body).empty());
}

TEST(WorldSkin, RefusesASkinOfAnotherMeshAndHitsOfNoSkin) {
    Skinned s(false);
    BodyDef def;
    def.shape = BodyTemplate::build(make_tet_box({Vec3::Zero(), Vec3::Ones(), {1, 1, 1}}));
    def.skin = s.world.skin(s.body);
    expect_error(ErrorCode::invalid_argument, "was made for a mesh of", [&] { s.world.add_body(def); });
    PickHit hit = *s.world.pick(kDown);
    hit.skin_triangle = 100000;
    expect_error(ErrorCode::invalid_argument, "PickHit.skin_triangle", [&] { s.world.begin_drag(hit); });
    hit = *s.world.pick(kDown);
    hit.element = -5;
    expect_error(ErrorCode::invalid_argument, "PickHit.element", [&] { s.world.begin_drag(hit); });
}

TEST(WorldFill, PartlyFilledElementsAreAsMuchLighterAndSofter) {
    VolumeMesh half = make_tet_box({Vec3::Zero(), Vec3(2, 1, 1), {4, 2, 2}}), full = half;
    half.fill.assign(half.element_count(), 0.5);
    World world(WorldDef{.time_step_s = 0.01, .threads = 1});
    std::array<BodyId, 2> bodies;
    std::array<double, 2> mass{}, drop{};
    for (std::size_t i = 0; i < 2; ++i) {
        BodyDef def;
        def.shape = BodyTemplate::build(i == 0 ? full : half);
        def.material = Corotational{.young_pa = 1e5, .poisson = 0.3};
        bodies[i] = world.add_body(def);
        world.fix(bodies[i], InsideBox{Vec3(-1, -1, -1), Vec3(0.01, 2, 2)});
    }
    for (int i = 0; i < 20; ++i) world.step();
    for (std::size_t i = 0; i < 2; ++i) {
        for (const double m : world.masses(bodies[i])) mass[i] += m;
        drop[i] = world.positions(bodies[i]).back().y();
    }
    EXPECT_NEAR(mass[1], 0.5 * mass[0], 1e-9 * mass[0]);
    EXPECT_NEAR(drop[1], drop[0], 1e-4 * std::abs(drop[0] - 1)) << "lighter and softer by the same factor: the same motion";
    half.fill[3] = 0;
    BodyDef bad;
    bad.shape = BodyTemplate::build(half);
    expect_error(ErrorCode::invalid_argument, "element 3 is filled by 0", [&] { world.add_body(bad); });
}

}  // namespace
}  // namespace supple
