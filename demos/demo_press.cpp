// A hand presses the liver with a ball on a haptic device: the recorded hand goes through the 1 kHz loop, whose force is plotted.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "demo.h"
#include "framing.h"
#include "open_show.h"
#include "press_scene.h"
#include "supple/haptics/plain_devices.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kHighest_n = 3;  // of the plot

struct Part {
    double from_s;
    const char* caption;
};
constexpr Part kParts[] = {{0, "A recorded hand on a haptic device comes near"},
                           {2.1, "It presses: the force at 1 kHz, from a local model of the touched place"},
                           {3.4, "Deeper, between two steps of the simulation the hand feels the tissue's own compliance"},
                           {4.9, "Dragged along, with friction"},
                           {6.5, "Lifted, and a quick tap"},
                           {8.1, "Let go"}};

class Press : public Show {
public:
    explicit Press(const ShowOptions& options)
        : scene_(find_asset("liver.msh").string(), options.threads),
          device_(haptics::device_preset("touch"), haptics::read_trajectory(find_asset("press_hand.csv").string())),
          loop_(device_, scene_.loop()),
          link_(std::in_place, scene_.world, loop_, scene_.link()) {
        SceneBounds bounds = bounds_of(scene_.world);
        bounds.min_m.y() -= 0.03;
        camera_ = frame_camera(bounds, Vec3(-0.25, 0.15, 1), 32);
        camera_.eye_m = camera_.target_m + 0.80 * (camera_.eye_m - camera_.target_m);
    }

    World& world() override { return scene_.world; }
    double duration_s() const override { return 9.2; }

    void let_go() override { link_.reset(); }  // the tool leaves the world

    void before_step() override {
        if (!link_) return;
        run_beside_step(loop_, *link_, scene_.world, [&](double time, const haptics::TickReport& tick) {
            tick_ = tick;
            if (++ticks_ % 4 == 0) curve_.push_back({time, tick.force_n.norm()});
        });
        if (link_->collider()) simulated_.push_back({scene_.world.time_s(), scene_.world.collider_state(link_->collider()).force_n.norm()});
    }

    void decorate(FrameView& view) override {
        const double t = scene_.world.time_s();
        view.camera = camera_;
        view.ground_height_m = -0.17;
        view.surfaces[0].look = Look::tissue;
        if (view.scale) view.scale->high = 3000;
        for (const Part& part : kParts)
            if (t >= part.from_s) view.caption = part.caption;
        if (!link_) return;
        const Vec3 force = tick_.force_n;
        if (force.norm() > 0.02) {  // on the hand, from the tool's back outwards
            const Vec3 tail = tick_.proxy_m - (PressScene::kTool_m + 0.002) * scene_.inwards;
            view.arrows.push_back({tail, tail + 0.05 * (1 - std::exp(-force.norm() / 1.0)) * force.normalized()});
        }
        view.markers.push_back({tick_.handle_m - 0.022 * scene_.inwards, 0.0035, {0.35f, 0.75f, 1.0f}});  // the handle: a coupling's length from the tool
        PlotView plot;
        plot.title = "Force on the hand [N]";
        plot.end = duration_s();
        plot.high = kHighest_n;
        plot.curves.push_back({curve_, {1.0f, 0.85f, 0.2f}, "1 kHz loop"});
        plot.curves.push_back({simulated_, {0.45f, 0.78f, 1.0f}, "simulation"});
        std::swap(plot.curves[0], plot.curves[1]);  // the loop's on top
        view.plot = std::move(plot);
        show_force(view, force);
    }

private:
    PressScene scene_;
    haptics::PlayedDevice device_;
    haptics::HapticLoop loop_;
    std::optional<haptics::ToolLink> link_;
    haptics::TickReport tick_;
    std::vector<std::array<double, 2>> curve_, simulated_;
    std::uint64_t ticks_ = 0;
    Camera camera_;
};

const RegisterDemo demo({"press", "a recorded hand presses the liver through the 1 kHz haptic loop; its force is plotted in the picture",
                         [](const ShowOptions& options) { return std::make_unique<Press>(options); }});

}  // namespace
}  // namespace supple::demos
