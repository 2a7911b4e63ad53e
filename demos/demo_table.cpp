// A liver is dropped on a table; a ball on a stick presses it, then pushes it aside. Contact, friction, the force that the tool feels.
#include <cmath>
#include <cstdio>

#include "demo.h"
#include "framing.h"
#include "open_show.h"
#include "supple/io/mesh_file.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kToolRadius_m = 0.014;

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.rayleigh_mass_1_s = 0.5;
    def.solver.rayleigh_stiffness_s = 0.003;
    return def;
}

class Table : public Show {
public:
    explicit Table(const ShowOptions& options) : world_(world_def(options)) {
        BodyDef def;
        def.name = "liver";
        def.shape = BodyTemplate::build(io::read_mesh(find_asset("liver.msh")));
        def.material = Corotational{.young_pa = 1.2e4, .poisson = 0.45};
        def.density_kg_m3 = 1060;
        double low = 1e9;
        for (const Vec3& x : def.shape->mesh().vertices) low = std::min(low, x.y());
        def.translation_m = Vec3(0, 0.04 - low, 0);
        world_.add_body(def);
        world_.add_collider({.name = "table", .shape = PlaneShape{}, .friction = 0.35});

        ColliderDef tool;
        tool.name = "tool";
        tool.shape = SphereShape{kToolRadius_m};
        tool.friction = 0.1;
        tool.motion = ColliderMotion::kinematic;
        const Vec3 wait(-0.045, 0.26, 0.02), above(-0.045, 0.13, 0.02), down(-0.045, 0.028, 0.02), beside(-0.19, 0.03, 0.02), pushed(-0.045, 0.03, 0.02), away(-0.16, 0.20, 0.02);
        const auto add = [&](double t, const Vec3& p) {
            tool.keys.times_s.push_back(t);
            tool.keys.positions_m.push_back(p);
        };
        const auto glide = [&](double from_s, double to_s, const Vec3& from, const Vec3& to) {
            for (int i = 1; i <= 10; ++i) add(from_s + (to_s - from_s) * i / 10, from + smooth_step(0, 1, i / 10.0) * (to - from));
        };
        add(0, wait);
        glide(1.2, 1.8, wait, above);
        glide(1.8, 2.9, above, down);
        add(3.6, down);
        glide(3.6, 4.3, down, above);
        glide(4.3, 4.9, above, Vec3(-0.19, 0.13, 0.02));
        glide(4.9, 5.4, Vec3(-0.19, 0.13, 0.02), beside);
        glide(5.4, 7.4, beside, pushed);
        add(7.5, pushed);
        glide(7.5, 8.4, pushed, away);
        tool_ = world_.add_collider(tool);

        SceneBounds bounds = bounds_of(world_);
        bounds.min_m.y() = 0;
        bounds.max_m.x() += 0.05;
        camera_ = frame_camera(bounds, Vec3(0.25, 0.35, 1), 32);
        camera_.target_m.y() -= 0.015;
    }

    World& world() override { return world_; }
    double duration_s() const override { return 9; }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        view.surfaces[0].look = Look::tissue;
        if (view.scale) view.scale->high = 4000;
        const ColliderState tool = world_.collider_state(tool_);
        const double force_n = tool.force_n.norm();
        if (force_n > 0.02) {
            view.arrows.push_back({tool.pose.position_m, tool.pose.position_m + 0.02 * tool.force_n, {1.0f, 0.55f, 0.15f}});
            char text[32];
            std::snprintf(text, sizeof text, "%.1f N", force_n);
            view.labels.push_back({tool.pose.position_m + Vec3(0, kToolRadius_m + 0.02, 0), text});
        }
        if (t < 1.4)
            view.caption = "A liver falls on a table";
        else if (t < 4.3)
            view.caption = "Pressed by a ball: stress inside, force on the tool";
        else if (t < 7.6)
            view.caption = "Pushed aside against the friction of the table";
        else
            view.caption = "Let go: it lies where it was pushed";
    }

private:
    World world_;
    ColliderId tool_;
    Camera camera_;
};

const RegisterDemo demo({"table", "a liver falls on a table, is pressed and pushed aside by a tool that feels its force",
                         [](const ShowOptions& options) { return std::make_unique<Table>(options); }});

}  // namespace
}  // namespace supple::demos
