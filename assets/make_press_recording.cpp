// Records press_hand.csv: a simulated hand holds a simulated device and presses the liver of the demo `press`, feels it, drags the ball along and lets go.
// Usage: make_press_recording liver.msh press_hand.csv
#include <cmath>
#include <cstdio>

#include "press_scene.h"
#include "supple/haptics/simulated_device.h"
#include "supple/io/binary_file.h"

namespace {

using namespace supple;

/// From one place to another with the least jerk, as hands go.
double least_jerk(double s) { return s <= 0 ? 0 : s >= 1 ? 1 : s * s * s * (10 + s * (6 * s - 15)); }

/// What the hand wants, in the device's frame: depth along `inwards` and a way aside [m], with a tremor of 0.2 mm at 9 Hz.
haptics::Trajectory wanted(const demos::PressScene& scene) {
    struct Goal {
        double begin_s, end_s, depth_m, aside_m;
    };
    const Goal goals[] = {{0.8, 1.8, -0.008, 0}, {2.2, 2.9, 0.022, 0}, {3.4, 3.7, 0.008, 0}, {3.8, 4.5, 0.032, 0}, {4.9, 6.3, 0.028, 0.030}, {6.6, 7.2, 0.012, 0.022}, {7.3, 7.7, 0.026, 0.024}, {8.0, 8.7, -0.060, 0.02}};
    haptics::Trajectory t;
    for (int i = 0; i <= 950; ++i) {
        const double time = i * 0.01;
        double depth = -0.060, aside = 0;
        for (const Goal& g : goals) {
            const double s = least_jerk((time - g.begin_s) / (g.end_s - g.begin_s));
            depth += s * (g.depth_m - depth);
            aside += s * (g.aside_m - aside);
        }
        const double tremor = 0.2e-3 * std::sin(2 * M_PI * 9 * time);
        t.times_s.push_back(time);
        t.positions_m.push_back((depth + tremor) * scene.inwards + (aside + 0.6 * tremor) * scene.aside);
    }
    return t;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: make_press_recording liver.msh press_hand.csv\n");
        return 2;
    }
    try {
        demos::PressScene scene(argv[1], 1);
        haptics::SimulatedDeviceDef device_def;
        device_def.limits = haptics::device_preset("touch");
        const haptics::Trajectory goal = wanted(scene);
        device_def.start_m = goal.positions_m[0];
        haptics::SimulatedDevice device(device_def, {.mass_kg = 0.15, .stiffness_n_m = 300, .damping_n_s_m = 6, .wanted = goal});
        haptics::HapticLoop loop(device, scene.loop());
        haptics::ToolLink link(scene.world, loop, scene.link());
        haptics::Trajectory recorded;
        int ticks = 0;
        double most = 0;
        while (scene.world.time_s() < 9.2) {
            demos::run_beside_step(loop, link, scene.world, [&](double time, const haptics::TickReport& tick) {
                most = std::max(most, tick.force_n.norm());
                if (ticks++ % 8 != 0) return;
                recorded.times_s.push_back(std::round(time * 1e3) / 1e3);
                const Vec3 x = device.position_m() * 1e6;
                recorded.positions_m.push_back(Vec3(std::round(x.x()), std::round(x.y()), std::round(x.z())) / 1e6);
            });
            scene.world.step();
        }
        io::write_text_file(argv[2], haptics::to_csv(recorded));
        std::printf("%zu places, at most %.2f N, least energy %.3f mJ\n", recorded.times_s.size(), most, loop.lowest_energy_j() * 1e3);
    } catch (const Error& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
    return 0;
}
