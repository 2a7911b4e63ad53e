// A soft block with a stiff sphere inside, cut open through the middle and pressed from above: first the stiffness is coloured, then the stress. Then the
// sphere is made as soft as the block while the world runs.
#include <cmath>

#include "demo.h"
#include "framing.h"
#include "supple/mesh/box_mesh.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kYoung_pa = 2e4, kContrast = 100, kPressure_pa = 3000;
constexpr double kPressed_s = 2.5, kSoftened_s = 7, kEnd_s = 11;
const Vec3 kCentre_m(0, 0.06, 0);
constexpr double kRadius_m = 0.032;

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.time_step_s = 1.0 / 120;
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.rayleigh_mass_1_s = 6;
    def.solver.rayleigh_stiffness_s = 0.002;
    return def;
}

class Inclusion : public Show {
public:
    explicit Inclusion(const ShowOptions& options) : world_(world_def(options)) {
        BodyDef def;
        def.name = "block";
        // The half behind the plane of symmetry z = 0; what faces us is the cut.
        def.shape = BodyTemplate::build(make_tet_box({.min_m = Vec3(-0.1, 0, -0.08), .max_m = Vec3(0.1, 0.12, 0), .cells = {24, 14, 10}}));
        def.material = NeoHookean{lame_parameters(kYoung_pa, 0.4, "block").mu_pa, lame_parameters(kYoung_pa, 0.4, "block").lambda_pa};
        def.regions = {{.where = InsideSphere{kCentre_m, kRadius_m}, .stiffness_factor = kContrast}};
        body_ = world_.add_body(def);
        world_.fix(body_, InsideBox{Vec3(-1, -1, -1), Vec3(1, 1e-9, 1)});
        world_.fix(body_, InsideBox{Vec3(-1, 1e-6, -1e-9), Vec3(1, 1, 1)}, {.x = false, .y = false});
        Load press;
        press.where = InsideBox{Vec3(-1, 0.12 - 1e-9, -1), Vec3(1, 1, 1)};
        press.kind = LoadKind::traction;
        press.value.times_s = {kPressed_s, kPressed_s + 2};
        press.value.values = {Vec3::Zero(), Vec3(0, -kPressure_pa, 0)};
        world_.add_load(body_, press);
        camera_ = frame_camera(bounds_of(world_), Vec3(0.28, 0.3, 1), 30);
    }

    World& world() override { return world_; }
    double duration_s() const override { return kEnd_s; }
    ColorBy color_by() const override { return world_.time_s() < kPressed_s ? ColorBy::stiffness : ColorBy::stress; }

    void before_step() override {
        if (softened_ || world_.time_s() < kSoftened_s) return;
        world_.set_regions(body_, {});
        softened_ = true;
    }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        view.camera.eye_m += Vec3(0.03 * std::sin(0.4 * t), 0, 0);
        view.ground_height_m = 0;
        view.surfaces[0].look = Look::gel;
        if (t >= kPressed_s) {
            view.surfaces[0].rest_positions = world_.shape(body_).mesh().vertices;
            if (view.scale) view.scale->high = 8000;
        }
        if (t < kPressed_s)
            view.caption = "A soft block with a stiff ball inside, 100 to 1, cut open. Colours: Young's modulus";
        else if (t < kSoftened_s)
            view.caption = "Pressed from above with 3 kPa: the ball does not yield, the stress gathers in it";
        else
            view.caption = "The ball is made as soft as the block while the simulation runs: the stress evens out";
    }

private:
    World world_;
    BodyId body_;
    Camera camera_;
    bool softened_ = false;
};

const RegisterDemo demo({"inclusion", "a stiff ball inside a soft block: its stiffness, the stress under load, and the ball softened on the way",
                         [](const ShowOptions& options) { return std::make_unique<Inclusion>(options); }});

}  // namespace
}  // namespace supple::demos
