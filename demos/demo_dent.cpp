// Two slabs are pressed by the same tool: one is elastic and comes back, the other flows and keeps its dent.
#include "demo.h"
#include "framing.h"
#include "supple/mesh/box_mesh.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kWidth_m = 0.2, kHeight_m = 0.06, kGap_m = 0.28;

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.time_step_s = 1.0 / 120;
    def.solver.rayleigh_mass_1_s = 2;
    def.solver.rayleigh_stiffness_s = 0.002;
    return def;
}

Touch press(double begin_s, double x_m, const char* caption) {
    Touch touch;
    touch.begin_s = begin_s;
    touch.end_s = begin_s + 2.2;
    touch.ray = {Vec3(x_m, 0.5, 0.01), Vec3(0, -1, 0)};
    touch.radius_m = 0.035;
    touch.tool_radius_m = 0.03;
    touch.displacement_m.times_s = {0, 1.2, 1.7, 2.2};
    touch.displacement_m.values = {Vec3::Zero(), Vec3(0, -0.036, 0), Vec3(0, -0.036, 0), Vec3(0, -0.036, 0)};
    touch.caption = caption;
    return touch;
}

class Dent : public Show {
public:
    explicit Dent(const ShowOptions& options) : world_(world_def(options)) {
        const auto slab = BodyTemplate::build(make_tet_box({.min_m = Vec3(-kWidth_m / 2, 0, -kWidth_m / 2),
                                                            .max_m = Vec3(kWidth_m / 2, kHeight_m, kWidth_m / 2), .cells = {20, 6, 20}}));
        for (const bool plastic : {false, true}) {
            BodyDef def;
            def.name = plastic ? "plastic" : "elastic";
            def.shape = slab;
            Corotational clay{.young_pa = 4e4, .poisson = 0.4};
            if (plastic) clay.plasticity = {.yield = 0.02, .max = 0.6, .creep_1_s = 30};
            def.material = clay;
            def.density_kg_m3 = 1200;
            def.translation_m = Vec3(centre(plastic), 0, 0);
            const BodyId body = world_.add_body(def);
            world_.fix(body, InsideBox{Vec3(-1, -1, -1), Vec3(1, 1e-9, 1)});
        }
        script_ = std::make_unique<TouchScript>(world_, std::vector<Touch>{press(1.2, centre(false), "Elastic: pressed, then let go"),
                                                                           press(4.6, centre(true), "With a yield strain of 2 %: the same press")}, 0.08, 20.0);
        SceneBounds bounds;
        bounds.include(Vec3(-kGap_m / 2 - kWidth_m / 2, 0, -kWidth_m / 2));
        bounds.include(Vec3(kGap_m / 2 + kWidth_m / 2, kHeight_m + 0.08, kWidth_m / 2));
        camera_ = frame_camera(bounds, Vec3(0.1, 0.6, 1), 32);
        camera_.eye_m = camera_.target_m + 0.72 * (camera_.eye_m - camera_.target_m);  // a wide, flat scene
        camera_.target_m.y() -= 0.025;
    }

    World& world() override { return world_; }
    double duration_s() const override { return 9; }
    void before_step() override { script_->before_step(); }
    void let_go() override { script_->let_go(); }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        view.ground_height_m = 0.0;
        for (SurfaceView& surface : view.surfaces) surface.look = Look::rubber;
        view.labels.push_back({Vec3(centre(false), 0.0, kWidth_m / 2 + 0.02), "elastic"});
        view.labels.push_back({Vec3(centre(true), 0.0, kWidth_m / 2 + 0.02), "plastic"});
        view.caption = t < 1.2 ? "Two slabs, equally stiff; the right one flows where it is strained beyond 2 %"
                               : "The elastic slab came back; the other keeps its dent and the stress locked in around it";
        if (view.scale) view.scale->high = 1e4;
        script_->decorate(view);
    }

private:
    static double centre(bool plastic) { return plastic ? kGap_m / 2 : -kGap_m / 2; }

    World world_;
    std::unique_ptr<TouchScript> script_;
    Camera camera_;
};

const RegisterDemo demo({"dent", "plastic flow: a pressed slab keeps its dent beside one that comes back",
                         [](const ShowOptions& options) { return std::make_unique<Dent>(options); }});

}  // namespace
}  // namespace supple::demos
