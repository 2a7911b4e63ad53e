// The main demo: a liver hangs from its ligament, is pressed, pulled and let go; colours show the stress inside.
#include <Eigen/Geometry>
#include <cmath>

#include "demo.h"
#include "framing.h"
#include "open_show.h"
#include "supple/io/mesh_file.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.rayleigh_mass_1_s = 0.3;        // the air and the tissue around it calm the swinging
    def.solver.rayleigh_stiffness_s = 0.002;
    return def;
}

/// A tool that goes to `path` and comes back: there over `in_s`, held until `hold_s`, back over `out_s`.
Timeline<Vec3> there_and_back(const Vec3& path, double in_s, double hold_s, double out_s) {
    Timeline<Vec3> line;
    for (int i = 0; i <= 8; ++i) {
        const double s = i / 8.0;
        line.times_s.push_back(in_s * s);
        line.values.push_back(smooth_step(0, 1, s) * path);
    }
    for (int i = 0; i <= 8; ++i) {
        const double s = i / 8.0;
        line.times_s.push_back(hold_s + out_s * s);
        line.values.push_back((1 - smooth_step(0, 1, s)) * path);
    }
    return line;
}

/// A tool that goes to `path` and stays there.
Timeline<Vec3> there(const Vec3& path, double in_s) {
    Timeline<Vec3> line;
    for (int i = 0; i <= 8; ++i) {
        line.times_s.push_back(in_s * i / 8.0);
        line.values.push_back(smooth_step(0, 1, i / 8.0) * path);
    }
    return line;
}

/// x to the patient's left, y up, z to the front: the right lobe is on the left of the picture.
std::vector<Touch> touches() {
    Touch press;
    press.begin_s = 2.2;
    press.end_s = 5.0;
    const Vec3 inwards = Vec3(0.80, -0.25, -0.55).normalized();  // from the front and the side, so that the arrow is seen in full
    press.ray = {Vec3(-0.040, -0.005, 0.045) - 0.4 * inwards, inwards};
    press.radius_m = 0.024;
    press.tool_radius_m = 0.012;
    press.displacement_m = there_and_back(0.038 * inwards, 1.0, 1.9, 0.8);
    press.caption = "Pressed: the stress spreads from the tool to the ligament";

    Touch pull;
    pull.begin_s = 6.0;
    pull.end_s = 8.0;
    pull.ray = {Vec3(-0.03, -0.5, 0.02), Vec3(0, 1, 0)};
    pull.radius_m = 0.03;
    pull.displacement_m = there(Vec3(0.022, -0.034, 0.028), 1.4);
    pull.tool_radius_m = 0.008;
    pull.pushes = false;
    pull.caption = "Pulled at the lower edge";
    return {press, pull};
}

class Liver : public Show {
public:
    explicit Liver(const ShowOptions& options) : world_(world_def(options)), script_(world_, touches(), 0.055, 4.0) {
        BodyDef def;
        def.name = "liver";
        def.shape = BodyTemplate::build(io::read_mesh(find_asset("liver.msh")));
        def.material = Corotational{.young_pa = 6e3, .poisson = 0.45};
        def.density_kg_m3 = 1060;
        body_ = world_.add_body(def);
        world_.fix(body_, InGroup{"ligament"});
        SceneBounds bounds = bounds_of(world_);
        bounds.min_m.y() -= 0.06;  // it sags, and is pulled down
        camera_ = frame_camera(bounds, Vec3(0, 0.12, 1), 32);
        camera_.eye_m = camera_.target_m + 0.82 * (camera_.eye_m - camera_.target_m);  // it fills less than the sphere around its box
    }

    World& world() override { return world_; }
    double duration_s() const override { return 10; }
    void before_step() override { script_.before_step(); }
    void let_go() override { script_.let_go(); }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        const double turn = -0.30 + 0.5 * smooth_step(0, 10, t);  // a slow walk around it [rad]
        view.camera.eye_m = camera_.target_m + Eigen::AngleAxisd(turn, Vec3(0, 1, 0)) * (camera_.eye_m - camera_.target_m);
        view.ground_height_m = -0.17;
        view.surfaces[0].look = Look::tissue;
        if (view.scale) view.scale->high = 3000;
        if (t < 2.0)
            view.caption = "A liver hangs from its ligament; colours show the stress";
        else if (t > 8.0)
            view.caption = "Let go: it swings back";
        script_.decorate(view);
    }

private:
    World world_;
    TouchScript script_;
    BodyId body_;
    Camera camera_;
};

const RegisterDemo demo({"liver", "a liver hangs from its ligament, is pressed, pulled and let go (the main demo)",
                         [](const ShowOptions& options) { return std::make_unique<Liver>(options); }});

}  // namespace
}  // namespace supple::demos
