// Edits on a timeline, and matter that tears by itself.
#include "support/bodies.h"
#include "support/edits.h"
#include "supple/world/edit_events.h"
#include "supple/world/tearing.h"

namespace supple {
namespace {

WorldDef still() { return {.gravity_m_s2 = Vec3::Zero(), .time_step_s = 0.01, .threads = 1}; }

CutEvent slow_cut(BodyId body) {
    return {.body = body, .from_m = {{0.2137, 0.12, -0.02}, {0.2137, 0.12, 0.12}}, .to_m = {{0.2137, -0.02, -0.02}, {0.2137, -0.02, 0.12}}, .begin_s = 0.02, .end_s = 0.42};
}

TEST(TopologyEvents, ABladeThatGoesStepByStepCutsThroughLikeOneStroke) {
    for (const bool hexes : {false, true}) {
        World world(still());
        const BodyId body = world.add_body({.shape = hexes ? test::hex_bar() : test::bar(), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}, .density_kg_m3 = 1000});
        const EditScript script({slow_cut(body)}, {});
        std::size_t edits = 0;
        for (int i = 0; i < 50; ++i) {
            edits += script.before_step(world);
            EXPECT_EQ(world.step().flags, StepFlag::none);
            test::expect_manifold(world.shape(body).mesh());
        }
        EXPECT_GT(edits, 1u);
        const auto pieces = world.pieces(body);
        ASSERT_EQ(pieces.size(), 2u) << (hexes ? "hexes" : "tets");
        EXPECT_NEAR(pieces[0].mass_kg, hexes ? 2.25 : 2.137, hexes ? 1e-12 : 0.02);  // where crossings were snapped the cut is not quite plane
        EXPECT_NEAR(pieces[0].mass_kg + pieces[1].mass_kg, 4, 1e-12);
    }
}

TEST(TopologyEvents, ARunThatASnapshotContinuesInTheMidstOfACutIsTheSame) {
    const auto run = [](World& world, const EditScript& script, int steps) {
        for (int i = 0; i < steps; ++i) {
            script.before_step(world);
            world.step();
        }
    };
    const auto make = [](World& world) {
        const BodyId body = world.add_body({.shape = test::bar(), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
        world.fix(body, test::at_x(0));
        return EditScript({slow_cut(body)}, {{.body = body, .from_m = {0.05, 0.1, 0.05}, .to_m = {0.35, 0.1, 0.05}, .radius_m = 0.02, .begin_s = 0.05, .end_s = 0.45}});
    };
    World whole(still());
    const EditScript script = make(whole);
    run(whole, script, 23);
    const auto bytes = whole.save();
    run(whole, script, 30);
    World fresh(still());
    const EditScript again = make(fresh);
    fresh.restore(bytes);
    run(fresh, again, 30);
    EXPECT_EQ(fresh.hash(), whole.hash());
    EXPECT_LT(test::total_mass(whole, whole.bodies()[0]), 0.99 * 4);
}

TEST(TopologyEvents, BadEventsAreRefused) {
    const auto refused = [](const std::string& text, CutEvent cut) { supple_test::expect_error(ErrorCode::invalid_argument, text, [&] { EditScript({cut}, {}); }); };
    CutEvent cut = slow_cut({});
    cut.end_s = 0;
    refused("CutEvent.end_s", cut);
    cut = slow_cut({});
    cut.to_m.pop_back();
    refused("CutEvent.from_m", cut);
    supple_test::expect_error(ErrorCode::invalid_argument, "EraseEvent.radius_m", [] { EditScript({}, {EraseEvent{.radius_m = 0}}); });
}

/// A thin slab with a notch, pulled.
struct Slab {
    World world{still()};
    BodyId body;
    explicit Slab(bool hexes) {
        const BoxDef box{.min_m = {-0.15, 0, 0}, .max_m = {0.15, 0.1, 0.01}, .cells = {24, 8, 1}};
        body = world.add_body({.shape = BodyTemplate::build(hexes ? make_hex_box(box) : make_tet_box(box)), .material = Corotational{.young_pa = 1e5, .poisson = 0.3}});
        world.cut(body, swept_blade(std::vector<Vec3>{{0.0011, -1, -1}, {0.0011, -1, 1}}, std::vector<Vec3>{{0.0011, 0.0257, -1}, {0.0011, 0.0257, 1}}));
        for (const double side : {-1.0, 1.0})
            world.prescribe(body, {.where = InsideBox{{side < 0 ? -1 : 0.15 - 1e-9, -1, -1}, {side < 0 ? -0.15 + 1e-9 : 1, 1, 1}},
                                   .displacement_m = {.times_s = {0, 1}, .values = {Vec3::Zero(), Vec3(side * 0.03, 0, 0)}}});
    }
};

TEST(TopologyEvents, ANotchedSlabTearsAcrossFromItsNotch) {
    for (const bool hexes : {false, true}) {
        SCOPED_TRACE(hexes ? "hexes" : "tets");
        Slab slab(hexes);
        const double mass = test::total_mass(slab.world, slab.body);
        const TearDef def{.where = InsideBox{{-0.1, -1, -1}, {0.1, 1, 1}}, .strength_pa = 2.5e4, .most_per_step = 2};
        Vec3 first = Vec3::Zero();
        bool torn = false;
        for (int i = 0; i < 130; ++i) {
            slab.world.step();
            const TopologyDelta delta = tear_overstressed(slab.world, slab.body, def);
            if (delta.is_identity()) continue;
            EXPECT_LE(delta.added_vertices().size(), 2u * 12);  // two vertices, and of their neighbours those whose faces reach the surface
            if (!torn) first = slab.world.shape(slab.body).mesh().vertices[std::size_t(delta.added_vertices()[0])];
            torn = true;
            test::expect_manifold(slab.world.shape(slab.body).mesh());
        }
        ASSERT_TRUE(torn);
        EXPECT_LT((first - Vec3(0, 0.025, 0.005)).norm(), 0.03) << "it begins at the notch: " << first.transpose();
        EXPECT_GE(slab.world.pieces(slab.body).size(), 2u);
        EXPECT_NEAR(test::total_mass(slab.world, slab.body), mass, 1e-12 * mass);
        double left = 0;
        for (const double s : slab.world.von_mises(slab.body)) left = std::max(left, s);
        EXPECT_LT(slab.world.energy().elastic_j, 0.05) << "what was stored is gone, " << left;
    }
}

TEST(TopologyEvents, ToughnessAndStretchDecideAsWell) {
    Slab tough(false), stretched(false), strong(false);
    const InsideBox middle{{-0.1, -1, -1}, {0.1, 1, 1}};
    std::size_t by_stretch = 0;
    for (int i = 0; i < 80; ++i) {
        for (Slab* s : {&tough, &stretched, &strong}) s->world.step();
        EXPECT_TRUE(tear_overstressed(tough.world, tough.body, {.where = middle, .strength_pa = 2.5e4, .toughness_j_m2 = 1e6}).is_identity());
        EXPECT_TRUE(tear_overstressed(strong.world, strong.body, {.where = middle, .strength_pa = 1e9}).is_identity());
        by_stretch += !tear_overstressed(stretched.world, stretched.body, {.where = middle, .strength_pa = 1e9, .max_stretch = 1.3}).is_identity();
    }
    EXPECT_GT(by_stretch, 0u);
    supple_test::expect_error(ErrorCode::invalid_argument, "TearDef.strength_pa", [&] { tear_overstressed(tough.world, tough.body, {}); });
    supple_test::expect_error(ErrorCode::invalid_argument, "TearDef.where", [&] { tear_overstressed(tough.world, tough.body, {.where = VertexList{{0}}, .strength_pa = 1}); });
}

}  // namespace
}  // namespace supple
