#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bench/haptic_scorecard.h"
#include "json_text.h"
#include "supple/base/clock.h"
#include "supple/haptics/plain_devices.h"
#include "supple/haptics/servo.h"
#include "supple/haptics/tool_link.h"
#include "supple/io/report.h"
#include "supple/mesh/box_mesh.h"

namespace supple::demos {

using namespace haptics;

HapticRealTime haptic_real_time(int threads, double seconds) {
    WorldDef def;
    def.threads = threads;
    def.time_step_s = 1.0 / 60;
    World world(def);
    const BodyId body = world.add_body({.shape = BodyTemplate::build(make_tet_box({.min_m = Vec3(-0.1, 0, -0.1), .max_m = Vec3(0.1, 0.08, 0.1), .cells = {20, 8, 20}})),
                                        .material = Corotational{.young_pa = 1e4, .poisson = 0.4}});
    world.fix(body, InsideBox{Vec3(-1, -1, -1), Vec3(1, 1e-9, 1)});
    // Round and round on the block, a second a turn.
    Trajectory path;
    for (int i = 0; i <= 64 * int(std::ceil(seconds) + 1); ++i) {
        const double a = 2 * M_PI * i / 64;
        path.times_s.push_back(i / 64.0);
        path.positions_m.emplace_back(0.02 * std::cos(a), 0.08 + 0.012 - 0.005 + 0.002 * std::sin(3 * a), 0.02 * std::sin(a));
    }
    PlayedDevice device(device_preset("omega_x"), path);
    HapticLoop loop(device, {});
    ToolLink link(world, loop, {.shape = SphereShape{0.012}});
    HapticRealTime r;
    r.threads = threads;
    std::vector<double> step_ms, model_us;
    {
        Servo servo(loop, device);
        r.priority = servo.priority();
        const Stopwatch watch;
        while (watch.ms() < seconds * 1e3) {
            link.before_step();
            step_ms.push_back(world.step().step_ms);
            model_us.push_back(link.after_step().total_us);
            link.publish();
        }
        const TickTimes& t = servo.times();
        r.ticks = t.ticks();
        r.missed = t.missed();
        r.p50_us = t.percentile_us(0.5);
        r.p99_us = t.percentile_us(0.99);
        r.p999_us = t.percentile_us(0.999);
        r.longest_us = t.longest_us();
        r.tick_us = t.mean_work_us();
        r.seconds = watch.ms() * 1e-3;
    }
    r.steps = step_ms.size();
    r.step_ms = io::median(step_ms);
    r.model_us = io::median(model_us);
    return r;
}

std::string HapticRealTime::text() const {
    char line[512];
    std::snprintf(line, sizeof line,
                  "%2d thread%s: tick interval p50 %.0f us, p99 %.0f us, p99.9 %.0f us, longest %.0f us; %llu of %llu ticks missed; a tick works %.0f us\n"
                  "            %llu steps of %.1f ms beside it, a model %.0f us; %s\n",
                  threads, threads == 1 ? " " : "s", p50_us, p99_us, p999_us, longest_us, static_cast<unsigned long long>(missed), static_cast<unsigned long long>(ticks + missed), tick_us,
                  static_cast<unsigned long long>(steps), step_ms, model_us, priority.c_str());
    return line;
}

std::string HapticRealTime::json() const {
    using demos::json;
    return JsonObject()
        .add("threads", json(threads))
        .add("priority", json(std::string_view(priority)))
        .add("seconds", json(seconds))
        .add("ticks", json(std::size_t(ticks)))
        .add("missed", json(std::size_t(missed)))
        .add("interval_us", JsonObject().add("p50", json(p50_us)).add("p99", json(p99_us)).add("p999", json(p999_us)).add("max", json(longest_us)).line())
        .add("tick_us", json(tick_us))
        .add("step_ms", json(step_ms))
        .add("model_us", json(model_us))
        .line();
}

}  // namespace supple::demos
