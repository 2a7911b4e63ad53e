// Devices, trajectories, and the mechanics of the simulated one.
#include <gtest/gtest.h>

#include <cmath>

#include "supple/base/error.h"
#include "supple/haptics/coupling.h"
#include "supple/haptics/plain_devices.h"
#include "supple/haptics/simulated_device.h"

namespace supple::haptics {
namespace {

constexpr double kTick = 1e-3;

SimulatedDeviceDef frictionless() {
    SimulatedDeviceDef def;
    def.limits = device_preset("lambda_7");
    def.mass_kg = 0.1;
    def.damping_n_s_m = 0;
    def.coulomb_n = 0;
    def.encoder_step_m = 0;
    return def;
}

TEST(HapticsDevices, PresetsAreKnownByName) {
    EXPECT_EQ(device_presets().size(), 10u);
    EXPECT_EQ(device_preset("falcon").stiffness_n_m, 3000);
    EXPECT_EQ(device_preset("touch").force_n, 3.3);
    try {
        device_preset("glove");
        ADD_FAILURE();
    } catch (const Error& e) {
        EXPECT_NE(e.message().find("omega_x"), std::string::npos) << e.what();
    }
}

TEST(HapticsDevices, TheCouplingKeepsToTheDevice) {
    for (const DeviceLimits& d : device_presets()) {
        for (const double tick : {1e-3, 2.5e-4, 4e-3}) {
            const VirtualCoupling c = size_coupling(d, tick, 2.0, 0.5);
            const double K = c.stiffness_n_m * 2.0 * 0.5, B = c.damping_n_s_m * 2.0 * 0.5;
            EXPECT_LE(K, 0.8 * d.stiffness_n_m * (1 + 1e-12)) << d.name;
            EXPECT_LT(K * tick / 2 + B, d.own_damping_n_s_m()) << d.name << ": Colgate and Schenkel's bound";
            EXPECT_GT(K, 0);
        }
    }
}

TEST(HapticsDevices, TrajectoriesReadBackAndSayWhatIsWrong) {
    const Trajectory t = parse_trajectory("t_s, x, y, z, buttons\n0, 1, 2, 3, 0\n# a pause\n0.5; 2; 2; 3; 1\n", "a.csv");
    ASSERT_EQ(t.times_s.size(), 2u);
    EXPECT_DOUBLE_EQ(t.at(0.25).position_m.x(), 1.5);
    EXPECT_EQ(t.at(0.49).buttons, 0u);
    EXPECT_EQ(t.at(9).buttons, 1u);
    EXPECT_DOUBLE_EQ(t.at(-1).position_m.x(), 1);
    const Trajectory again = parse_trajectory(to_csv(t), "b.csv");
    EXPECT_EQ(again.times_s, t.times_s);
    EXPECT_EQ(again.positions_m[1], t.positions_m[1]);
    EXPECT_EQ(again.buttons, t.buttons);
    const auto message = [](const char* text) {
        try {
            parse_trajectory(text, "bad.csv");
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string("accepted");
    };
    EXPECT_NE(message("0 1 2 3\n0.1 1 x 3\n").find("bad.csv:2"), std::string::npos) << message("0 1 2 3\n0.1 1 x 3\n");
    EXPECT_NE(message("0 1 2 3\n0.1 1 2\n").find("bad.csv:2"), std::string::npos);
    EXPECT_NE(message("0 1 2 3\n0.1 1 2 3 1\n").find("another count"), std::string::npos);
    EXPECT_NE(message("1 1 2 3\n1 1 2 3\n").find("does not follow"), std::string::npos);
    EXPECT_NE(message("").find("no entries"), std::string::npos);
    EXPECT_NE(message("0 nan 2 3\n").find("not finite"), std::string::npos);
    EXPECT_THROW(read_trajectory("no-such-file.csv"), Error);
}

TEST(HapticsDevices, AFedHandleGoesToItsPlaceSmoothly) {
    FedDevice device(device_preset("touch"), 0.02);
    device.put({Vec3(0.1, 0, 0)});
    EXPECT_DOUBLE_EQ(device.read(kTick).position_m.x(), 0.1) << "the first place is no jump";
    device.put({Vec3(0.2, 0, 0)});
    Vec3 x;
    for (int i = 0; i < 20; ++i) x = device.read(kTick).position_m;
    EXPECT_NEAR(x.x(), 0.2 - 0.1 * std::exp(-1.0), 1e-9);
    device.write(Vec3(0, 1, 0));
    EXPECT_EQ(device.force_n(), Vec3(0, 1, 0));
}

TEST(SimulatedDevice, FallsLikeAMassOnASpring) {
    // Hand 90 N/m on 0.1 kg: w = 30 rad/s. From 10 mm away: x = 10 mm cos(w t).
    SimulatedDeviceDef def = frictionless();
    def.substeps = 200;
    def.start_m = Vec3(0.01, 0, 0);
    SimulatedDevice device(def, {.stiffness_n_m = 90, .wanted = {.times_s = {0}, .positions_m = {Vec3::Zero()}}});
    DeviceReading r;
    for (int i = 0; i < 100; ++i) r = device.read(kTick);
    EXPECT_NEAR(r.position_m.x(), 0.01 * std::cos(30 * 0.1), 5e-5);
    EXPECT_EQ(r.position_m.y(), 0);
}

TEST(SimulatedDevice, DampingDryFrictionAndForceDoWhatTheyShould) {
    SimulatedDeviceDef def = frictionless();
    def.damping_n_s_m = 2;
    SimulatedDevice damped(def);
    damped.write(Vec3(1, 0, 0));
    for (int i = 0; i < 1000; ++i) damped.read(kTick);
    EXPECT_NEAR(damped.velocity_m_s().x(), 0.5, 1e-6) << "F / b";

    def = frictionless();
    def.coulomb_n = 0.3;
    SimulatedDevice rubbing(def);
    rubbing.write(Vec3(0.29, 0, 0));
    for (int i = 0; i < 100; ++i) rubbing.read(kTick);
    EXPECT_EQ(rubbing.position_m().x(), 0) << "below its dry friction it does not move at all";
    rubbing.write(Vec3(0.5, 0, 0));
    for (int i = 0; i < 100; ++i) rubbing.read(kTick);
    EXPECT_NEAR(rubbing.velocity_m_s().x(), 0.1 * (0.5 - 0.3) / 0.1, 1e-3);
    EXPECT_NEAR(rubbing.work_j(), 0.5 * rubbing.position_m().x(), 1e-9);
}

TEST(SimulatedDevice, EncoderDelayAndSaturation) {
    SimulatedDeviceDef def = frictionless();
    def.limits.force_n = 2;
    def.encoder_step_m = 50e-6;
    def.delay_ticks = 3;
    SimulatedDevice device(def);
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(device.force_n(), Vec3(0, 0, 0)) << i;
        device.read(kTick);
        device.write(Vec3(3, 0, 4));
    }
    EXPECT_NEAR(device.force_n().norm(), 2, 1e-12);
    EXPECT_NEAR(device.force_n().z(), 1.6, 1e-12);
    for (int i = 0; i < 50; ++i) {
        const Vec3 x = device.read(kTick).position_m;
        const double steps = x.x() / 50e-6;
        EXPECT_NEAR(steps, std::round(steps), 1e-9);
        EXPECT_LE(std::abs(x.x() - device.position_m().x()), 25e-6 + 1e-12);
    }
    EXPECT_THROW(SimulatedDevice({.mass_kg = 0}), Error);
    EXPECT_THROW(SimulatedDevice({.delay_ticks = 65}), Error);
    EXPECT_THROW(SimulatedDevice({}, {.stiffness_n_m = -1}), Error);
}

}  // namespace
}  // namespace supple::haptics
