// The fast loop: what the hand feels of a local model, and everything that keeps it safe. Virtual time.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "supple/base/error.h"
#include "supple/haptics/plain_devices.h"
#include "support/bodies.h"
#include "support/haptics.h"

namespace supple::haptics {
namespace {

using test::bare;
using test::FedLoop;
using test::wall;

constexpr double kTick = 1e-3;

DeviceLimits strong() { return {"strong", 50, 1000, 10}; }

TEST(HapticsProxy, PressesAsTwoSpringsInSeries) {
    for (const double W : {0.0, 1.0 / 300, 1.0}) {
        FedDevice device(strong(), 0);
        device.put({Vec3(-0.002, 0, 0)});
        FedLoop fed(device, bare(500), wall(W));
        TickReport r;
        for (int i = 0; i < 3; ++i) r = fed.tick(kTick);
        EXPECT_NEAR(r.force_n.x(), 0.002 / (1.0 / 500 + W), 1e-9);
        EXPECT_NEAR(r.proxy_m.x(), -W * r.force_n.x(), 1e-12) << "the surface gives way, the proxy stays on it";
        EXPECT_EQ(r.force_n.y(), 0);
    }
}

TEST(HapticsProxy, SticksThenSlidesAtCoulombsCone) {
    FedDevice device(strong(), 0);
    FedLoop fed(device, bare(500), wall(0, 0.4, 10));  // one model throughout
    device.put({Vec3(-0.002, 0, 0)});
    fed.tick(kTick);
    device.put({Vec3(-0.002, 0.0005, 0)});
    TickReport r = fed.tick(kTick);
    EXPECT_NEAR(r.force_n.y(), -0.25, 1e-9) << "sticks: 500 N/m times 0.5 mm, below 0.4 times 1 N";
    EXPECT_NEAR(r.proxy_m.y(), 0, 1e-12);
    device.put({Vec3(-0.002, 0.005, 0)});
    r = fed.tick(kTick);
    EXPECT_NEAR(r.force_n.y(), -0.4, 1e-9);
    EXPECT_NEAR(r.force_n.x(), 1.0, 1e-9);
    // Back by 0.8 mm: from one side of the cone to the inside, without a creep.
    device.put({Vec3(-0.002, 0.0042, 0)});
    r = fed.tick(kTick);
    EXPECT_NEAR(r.force_n.y(), 0, 1e-9);
    for (int i = 0; i < 100; ++i) r = fed.tick(kTick);
    EXPECT_NEAR(r.force_n.y(), 0, 1e-9) << "what sticks has no creep";
}

TEST(HapticsProxy, StaysOutsideOfAWedge) {
    LocalModel m = wall();
    m.contacts = 3;
    m.contact[0].normal = Vec3(1, 1, 0).normalized();
    m.contact[1].normal = Vec3(1, -1, 0).normalized();
    m.contact[2].normal = Vec3(1, 0, 0);
    m.contact[2].gap_m = 0.001;  // 1 mm deeper: never reached
    m.compliance.fill(0);
    FedDevice device(strong(), 0);
    device.put({Vec3(-0.001, 0.0005, 0)});
    FedLoop fed(device, bare(500), m);
    TickReport r;
    for (int i = 0; i < 5; ++i) r = fed.tick(kTick);
    EXPECT_NEAR(r.proxy_m.norm(), 0, 1e-6) << "the bottom of the wedge";
    EXPECT_NEAR((r.force_n - Vec3(0.5, -0.25, 0)).norm(), 0, 1e-3);
    EXPECT_EQ(r.touching, 2u);
    EXPECT_LT(r.penetration_m, 1e-6);
}

/// Amplitude of a handle that a steady 1 N presses on a rigid wall, a little out of its balance: at the start and at the end of `seconds`.
std::pair<double, double> amplitude(double K, double b, double tick, bool passivity, double seconds, double& lowest_j) {
    SimulatedDeviceDef def;
    def.limits = strong();
    def.limits.stiffness_n_m = 2 * b / 1e-3;  // own_damping_n_s_m() is b
    def.mass_kg = 0.1;
    def.damping_n_s_m = b;
    def.coulomb_n = def.encoder_step_m = 0;
    def.start_m = Vec3(-1 / K - 2e-5, 0, 0);
    SimulatedDevice device(def, {.push_n = Vec3(-1, 0, 0)});
    LoopDef loop = bare(K);
    loop.tick_s = tick;
    loop.passivity = passivity;
    FedLoop fed(device, loop, wall());
    double first = 0, last = 0;
    const int n = int(seconds / tick), window = int(0.25 / tick);
    for (int i = 0; i < n; ++i) {
        fed.tick(tick);
        const double away = std::abs(device.position_m().x() + 1 / K);
        if (i < window) first = std::max(first, away);
        if (i >= n - window) last = std::max(last, away);
    }
    lowest_j = fed.loop.lowest_energy_j();
    return {first, last};
}

TEST(HapticsPassivity, AWallIsStableUpToColgatesBound) {
    double lowest;
    for (const double b : {0.25, 0.5}) {
        for (const double tick : {1e-3, 2.5e-4}) {
            const double bound = 2 * b / tick;
            const auto [below0, below1] = amplitude(0.9 * bound, b, tick, false, 2, lowest);
            EXPECT_LT(below1, 0.8 * below0) << "b " << b << ", tick " << tick;
            const auto [above0, above1] = amplitude(1.1 * bound, b, tick, false, 2, lowest);
            EXPECT_GT(above1, 1.1 * above0) << "b " << b << ", tick " << tick;
        }
    }
}

TEST(HapticsPassivity, TheControllerMakesAnUnstableWallStable) {
    for (const double times : {1.5, 3.0}) {
        const double b = 0.5, K = times * 2 * b / kTick;
        double without, with;
        const auto [off0, off1] = amplitude(K, b, kTick, false, 3, without);
        const auto [on0, on1] = amplitude(K, b, kTick, true, 3, with);
        EXPECT_GT(off1, 3 * off0) << times;
        EXPECT_LT(on1, 0.3 * on0) << times;
        EXPECT_LT(on1, 0.1 * off1) << times;
        EXPECT_GT(with, -1e-4) << "what the device's own damping is good for [J]";
        EXPECT_LT(without, 10 * with);
    }
}

TEST(HapticsPassivity, LeavesAPassiveWallAlone) {
    SimulatedDeviceDef def;
    def.limits = strong();
    def.mass_kg = 0.1;
    def.damping_n_s_m = 0.5;
    def.coulomb_n = def.encoder_step_m = 0;
    def.start_m = Vec3(0.002, 0, 0);
    SimulatedDevice device(def, {.push_n = Vec3(-1, 0, 0)});
    LoopDef loop = bare(600);
    loop.passivity = true;
    FedLoop fed(device, loop, wall());
    for (int i = 0; i < 1000; ++i) EXPECT_EQ(fed.tick(kTick).flags & kDamped, 0u) << i;
}

TEST(HapticsSafety, FadesInAfterTheStart) {
    FedDevice device(strong(), 0);
    device.put({Vec3(-0.002, 0, 0)});
    LoopDef def = bare(500);
    def.fade_in_s = 0.5;
    FedLoop fed(device, def, wall());
    double before = 0;
    for (int i = 0; i < 600; ++i) {
        const double F = fed.tick(kTick).force_n.x();
        EXPECT_GE(F, before - 1e-12);
        EXPECT_LE(F, (i + 1) * kTick / 0.5 + 1e-9);
        before = F;
    }
    EXPECT_NEAR(before, 1, 1e-9);
}

TEST(HapticsSafety, AStallFadesToZeroWithinATenthOfASecond) {
    FedDevice device(strong(), 0);
    device.put({Vec3(-0.002, 0, 0)});
    LoopDef def = bare(500);
    def.fade_in_s = 0.3;
    FedLoop fed(device, def, wall());
    TickReport r;
    for (int i = 0; i < 600; ++i) r = fed.tick(kTick);
    ASSERT_NEAR(r.force_n.x(), 1, 1e-9);
    while (fed.since_s > kTick / 2) r = fed.tick(kTick);  // up to a model that arrives
    fed.silent = true;
    double before = r.force_n.x();
    for (int i = 1; i <= 200; ++i) {
        r = fed.tick(kTick);
        EXPECT_LE(r.force_n.x(), before + 1e-12);
        before = r.force_n.x();
        if (i <= 45) {
            EXPECT_NEAR(before, 1, 1e-9) << "a late step is no stall";
        }
        if (i >= 100) {
            EXPECT_EQ(before, 0.0) << i << " ms";
            EXPECT_NE(r.flags & kStalled, 0u);
        }
    }
    fed.silent = false;
    int rising = 0;
    for (int i = 0; i < 400; ++i) {
        r = fed.tick(kTick);
        EXPECT_LE(r.force_n.x() - before, kTick / 0.3 + 1e-9) << "fades in, no jump";
        rising += r.force_n.x() > before;
        before = r.force_n.x();
    }
    EXPECT_GT(rising, 250);
    EXPECT_NEAR(before, 1, 1e-9);
}

TEST(HapticsSafety, NotANumberAndAPulledPlugAreContained) {
    SimulatedDeviceDef def;
    def.limits = strong();
    def.damping_n_s_m = 0.5;
    def.start_m = Vec3(-0.002, 0, 0);
    SimulatedDevice device(def, {.stiffness_n_m = 2000, .damping_n_s_m = 20});
    LoopDef loop = bare(500);
    loop.fade_in_s = 0.2;
    FedLoop fed(device, loop, wall());
    TickReport r;
    for (int i = 0; i < 400; ++i) r = fed.tick(kTick);
    const double steady = r.force_n.x();
    ASSERT_GT(steady, 0.5);
    device.spoil(true);
    r = fed.tick(kTick);
    EXPECT_NE(r.flags & kBadReading, 0u);
    EXPECT_LT(std::abs(r.force_n.x() - steady), 0.05) << "one bad reading is hardly felt";
    for (int i = 0; i < 60; ++i) {
        r = fed.tick(kTick);
        ASSERT_TRUE(r.force_n.allFinite());
    }
    EXPECT_EQ(r.force_n.norm(), 0);
    EXPECT_TRUE(fed.loop.samples().update());
    EXPECT_TRUE(fed.loop.samples().front().handle_m.allFinite()) << "nor does the simulation see it";
    device.spoil(false);
    for (int i = 0; i < 400; ++i) r = fed.tick(kTick);
    EXPECT_NEAR(r.force_n.x(), steady, 0.05);
    device.plug(false);
    r = fed.tick(kTick);
    EXPECT_NE(r.flags & kUnplugged, 0u);
    EXPECT_EQ(r.force_n.norm(), 0);
    for (int i = 0; i < 50; ++i) fed.tick(kTick);
    device.plug(true);
    double before = 0;
    for (int i = 0; i < 300; ++i) {
        r = fed.tick(kTick);
        EXPECT_LT(std::abs(r.force_n.x() - before), 0.05);
        before = r.force_n.x();
    }
    EXPECT_NEAR(before, steady, 0.1);
}

TEST(HapticsSafety, WhateverComesTheForceKeepsItsLimits) {
    test::Random random(5);
    const double bad[] = {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300, -1e18};
    for (int run = 0; run < 20; ++run) {
        const DeviceLimits& limits = device_presets()[std::size_t(run) % 10];
        FedDevice device(limits, 0);
        LoopDef def;
        def.fade_in_s = 0.01;
        HapticLoop loop(device, def);
        const double slew = loop.def().max_slew_n_s;
        Vec3 last = Vec3::Zero();
        std::uint32_t seen = 0;
        for (int i = 0; i < 1500; ++i) {
            DeviceReading reading;
            reading.position_m = random.vector(i % 100 < 50 ? 0.003 : 0.3);
            if (i % 37 == 0) reading.position_m[i % 3] = bad[std::size_t(i) % 5];
            device.put(reading);
            if (i % 13 == 0) {
                LocalModel m = wall(random.uniform(0, 0.01), 0.5);
                m.contact[0].normal = random.vector(1).normalized();
                m.contact[0].velocity_m_s = random.vector(5);
                if (i % 91 == 0) m.compliance[std::size_t(i) % 9] = bad[std::size_t(i) % 3];
                if (i % 143 == 0) m.contact[0].normal[0] = std::nan("");
                loop.models().back().copy_from(m);
                loop.models().publish();
            }
            const double dt = random.uniform(0.5e-3, 2e-3);
            const TickReport r = loop.tick(i % 211 == 0 ? std::nan("") : dt);
            seen |= r.flags;
            ASSERT_TRUE(r.force_n.allFinite()) << i;
            ASSERT_LE(r.force_n.norm(), limits.force_n * (1 + 1e-12)) << i;
            if (r.gain > 0 && i % 211 != 0) {
                ASSERT_LE((r.force_n - last).norm(), slew * dt * (1 + 1e-9) + 1e-12) << i;
            }
            last = r.force_n;
        }
        for (const std::uint32_t flag : {kBadReading, kBadModel, kForceLimit, kSlewLimit}) EXPECT_NE(seen & flag, 0u) << flag;
    }
}

TEST(HapticsLoop, ANewModelTakesOverWithoutAJump) {
    for (const bool blend : {false, true}) {
        FedDevice device(strong(), 0);
        device.put({Vec3(-0.002, 0, 0)});
        LoopDef def = bare(500);
        def.blend = blend;
        FedLoop fed(device, def, wall());
        TickReport r;
        for (int i = 0; i < 100; ++i) r = fed.tick(kTick);
        const double before = r.force_n.x();
        fed.model.tool_m.x() = 0.001;  // the surface has come 1 mm nearer: 0.5 N more
        double steepest = 0, last = before, jump = 0;
        for (int i = 0; i < 60; ++i) {
            r = fed.tick(kTick);
            steepest = std::max(steepest, std::abs(r.force_n.x() - last));
            jump = std::max(jump, r.jump_n);
            last = r.force_n.x();
        }
        EXPECT_NEAR(jump, 0.5, 1e-9);
        EXPECT_NEAR(last, before + 0.5, 1e-9);
        if (blend) {
            EXPECT_LT(steepest, 0.5 / 15);
        } else {
            EXPECT_GT(steepest, 0.49);
        }
    }
}

TEST(HapticsLoop, ScalesAndAxesTurnTheHandleIntoTheScene) {
    LoopDef def = bare(100);
    def.workspace_scale = 5;
    def.force_scale = 0.5;
    def.origin_m = Vec3(1, 2, 3);
    def.axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // device x is scene y
    FedDevice device(strong(), 0);
    device.put({Vec3(-0.002, 0, 0)});  // scene (1, 2 - 0.01, 3)
    LocalModel m = wall();
    m.tool_m = Vec3(1, 2, 3);
    m.contact[0].normal = Vec3(0, 1, 0);
    FedLoop fed(device, def, m);
    TickReport r;
    for (int i = 0; i < 3; ++i) r = fed.tick(kTick);
    EXPECT_NEAR((r.handle_m - Vec3(1, 1.99, 3)).norm(), 0, 1e-12);
    EXPECT_NEAR((r.force_n - Vec3(0.5 * 100 * 0.01, 0, 0)).norm(), 0, 1e-9);
}

TEST(HapticsLoop, RefusesSettingsThatMakeNoSense) {
    FedDevice device(strong());
    const auto refuses = [&](auto change, const char* field) {
        LoopDef def;
        change(def);
        try {
            HapticLoop loop(device, def);
            ADD_FAILURE() << field;
        } catch (const Error& e) {
            EXPECT_NE(e.where().find(field), std::string::npos) << e.what();
        }
    };
    refuses([](LoopDef& d) { d.tick_s = 0; }, "tick_s");
    refuses([](LoopDef& d) { d.max_force_n = 51; }, "max_force_n");
    refuses([](LoopDef& d) { d.patience_s = 0.07; }, "patience_s");
    refuses([](LoopDef& d) { d.axes(0, 0) = 2; }, "axes");
    refuses([](LoopDef& d) { d.workspace_scale = 0; }, "workspace_scale");
    refuses([](LoopDef& d) { d.origin_m.x() = std::nan(""); }, "origin_m");
}

}  // namespace
}  // namespace supple::haptics
