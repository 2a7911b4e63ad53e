// What must be true of the demos while they play: flags, forces, places.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "demo.h"

namespace {

using namespace supple;
using demos::Show;

std::unique_ptr<Show> open(const std::string& name) {
    for (const demos::Demo& demo : demos::all_demos())
        if (demo.name == name) return demo.make({});
    ADD_FAILURE() << "no demo \"" << name << "\"";
    return nullptr;
}

double reading(Show& show, const std::string& name) {
    for (const demos::Reading& r : show.readings())
        if (r.name == name) return r.value;
    return std::nan("");
}

ColliderId collider(const World& world, const std::string& name) {
    for (const ColliderId id : world.colliders())
        if (world.collider(id).name == name) return id;
    ADD_FAILURE() << "no collider \"" << name << "\"";
    return {};
}

BodyId body(const World& world, const std::string& name) {
    for (const BodyId id : world.bodies())
        if (world.name(id) == name) return id;
    ADD_FAILURE() << "no body \"" << name << "\"";
    return {};
}

std::pair<Vec3, Vec3> box(const World& world, BodyId id) {
    Vec3 low = Vec3::Constant(1e9), high = Vec3::Constant(-1e9);
    for (const Vec3& x : world.positions(id)) low = low.cwiseMin(x), high = high.cwiseMax(x);
    return {low, high};
}

/// Plays until a time, looking after every step; no flag may be raised.
template <class Look>
void play(Show& show, double until_s, Look&& look) {
    while (show.world().time_s() < until_s - 1e-9) {
        show.before_step();
        const StepReport report = show.world().step();
        ASSERT_EQ(report.flags, StepFlag::none) << "at " << show.world().time_s() << " s: " << cure(report.flags);
        look();
    }
}
void play(Show& show, double until_s) {
    play(show, until_s, [] {});
}

TEST(Demo, SqueezeKeepsTheBallBetweenThePlatesAndLetsItSpringBack) {
    const auto show = open("squeeze");
    const World& world = show->world();
    const BodyId ball = body(world, "ball");
    const ColliderId lower = collider(world, "lower plate"), upper = collider(world, "upper plate");
    const double thick = std::get<BoxShape>(world.collider(upper).shape).half_extents_m.y();
    const auto [low0, high0] = box(world, ball);
    double least = 1, most_n = 0;
    play(*show, 3.3, [&] {
        const auto [low, high] = box(world, ball);
        const double gap = world.collider_state(upper).pose.position_m.y() - thick;
        EXPECT_GT(low.y(), -1e-3) << "through the lower plate";
        EXPECT_LT(high.y(), std::max(gap, high0.y()) + 1e-3) << "through the upper plate";
        least = std::min(least, gap / (high0.y() - low0.y()));
        most_n = std::max(most_n, world.collider_state(upper).force_n.norm());
    });
    EXPECT_LT(least, 0.52) << "squeezed to half its height";
    EXPECT_GT(most_n, 20);
    // What the one plate gives the other takes, but for the ball's weight.
    const double difference = -world.collider_state(lower).force_n.y() - world.collider_state(upper).force_n.y();
    double weight = 0;
    for (const double m : world.masses(ball)) weight += 9.81 * m;
    EXPECT_NEAR(difference, weight, 0.05 * most_n);
    const auto [low, high] = box(world, ball);
    EXPECT_GT(high.x() - low.x(), 1.2 * (high0.x() - low0.x())) << "it bulges";
}

TEST(Demo, BreakableBandsBreakOneAfterTheOtherAtTheirForce) {
    const auto show = open("breakable");
    const World& world = show->world();
    double bands = reading(*show, "bands");
    EXPECT_EQ(bands, 5);
    std::vector<double> times;
    play(*show, 8.5, [&] {
        const double now = reading(*show, "bands");
        EXPECT_LE(now, bands);
        EXPECT_GE(now, bands - 1) << "one after the other";
        if (now < bands) {
            times.push_back(world.time_s());
            const double broke = reading(*show, "broke at"), strength = reading(*show, "of");
            EXPECT_GE(broke, strength);
            EXPECT_LE(broke, 1.15 * strength) << "it broke late";
        }
        bands = now;
    });
    EXPECT_EQ(bands, 0);
    ASSERT_EQ(times.size(), 5u);
    EXPECT_GT(times.front(), 1.5) << "its weight alone breaks none";
    EXPECT_GT(times.back() - times.front(), 0.5);
    EXPECT_LT(box(world, body(world, "kidney")).second.y(), -0.02) << "free";
}

TEST(Demo, PinchHoldsTheTissue) {
    const auto show = open("pinch");
    const World& world = show->world();
    const BodyId liver = body(world, "liver");
    const auto lowest = [&] {
        const auto x = world.positions(liver);
        return *std::min_element(x.begin(), x.end(), [](const Vec3& a, const Vec3& b) { return a.y() < b.y(); });
    };
    play(*show, 1.0);
    EXPECT_EQ(reading(*show, "pull"), 0) << "they come from afar";
    const Vec3 before = lowest();
    play(*show, 3.05);
    EXPECT_GT(reading(*show, "squeeze"), 0.15);
    play(*show, 4.7);
    EXPECT_GT(reading(*show, "teeth"), 2);
    EXPECT_GT(reading(*show, "pull"), 0.5);
    EXPECT_LT(lowest().y(), before.y() - 0.010) << "what is held comes along";
}

TEST(Demo, SlowPinchOpensAndLetsGo) {
    const auto show = open("pinch");
    play(*show, 9.7);
    EXPECT_EQ(reading(*show, "teeth"), 0);
    EXPECT_LT(reading(*show, "pull"), 0.2) << "opened";
}

TEST(Demo, TheCreatureGoesItsWay) {
    const auto show = open("creature");
    const World& world = show->world();
    const BodyId creature = body(world, "creature"), post = world.bodies().back();
    const double begin = reading(*show, "to the goal");
    const std::vector<Vec3> stood(world.positions(post).begin(), world.positions(post).end());
    double bent = 0;
    play(*show, 4.0, [&] {
        const auto [low, high] = box(world, creature);
        EXPECT_GT(low.y(), -0.030) << "in the ground: its cage stands off its skin by 15 mm";
        const auto x = world.positions(post);
        for (std::size_t v = 0; v < x.size(); ++v) bent = std::max(bent, (x[v] - stood[v]).norm());
        EXPECT_LT((high - low).norm(), 0.62) << "pulled apart";
    });
    EXPECT_LT(reading(*show, "to the goal"), begin - 0.55);
    EXPECT_GT(bent, 0.005) << "it pushed the post aside";
}

TEST(Demo, SlowTheCreatureLandsOnTheCushion) {
    const auto show = open("creature");
    const World& world = show->world();
    play(*show, show->duration_s());
    EXPECT_LT(reading(*show, "to the goal"), 0.20);
    const auto [low, high] = box(world, body(world, "creature"));
    EXPECT_GT(low.y(), 0.0);
    EXPECT_GT(high.y(), 0.15) << "flat as a flounder";
    double fastest = 0;
    for (const Vec3& v : world.velocities(body(world, "creature"))) fastest = std::max(fastest, v.norm());
    EXPECT_LT(fastest, 1.0);
}

TEST(Demo, CarveTakesAwayWhatTheHandPressesAndFeelsIt) {
    const auto show = open("carve");
    const World& world = show->world();
    const std::size_t all = world.shape(world.bodies()[0]).mesh().element_count();
    double most_n = 0, at_first_bite_n = 0, highest_before_n = 0;
    play(*show, 3.2, [&] {
        const double force = reading(*show, "force");
        most_n = std::max(most_n, force);
        if (reading(*show, "removed") == 0) highest_before_n = std::max(highest_before_n, force);
        else if (at_first_bite_n == 0) at_first_bite_n = force;
    });
    const double removed = reading(*show, "removed");
    EXPECT_GT(removed, 10);
    EXPECT_EQ(double(world.shape(world.bodies()[0]).mesh().element_count()), double(all) - removed);
    EXPECT_GT(highest_before_n, 0.3) << "it pressed before it bit";
    EXPECT_GT(most_n, 0.5);
    EXPECT_LT(most_n, 8.4) << "the falcon gives no more than 8.3 N";
}

}  // namespace
