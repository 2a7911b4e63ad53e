// A soft ball is squeezed between two plates to half its height, rolled between them, and let go.
#include <cmath>

#include "demo.h"
#include "keyframes.h"
#include "supple/mesh/isosurface_stuffing.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kRadius_m = 0.05, kEdge_m = 0.0095;
constexpr double kPlate_m = 0.085, kThick_m = 0.006;  // half its side, half its thickness
constexpr double kMost_n = 100;                       // of the plot

/// Of the lower face of the upper plate: it comes down, holds, goes from side to side, which rolls the ball, comes back and lifts off.
const std::vector<Stop>& way() {
    static const std::vector<Stop> stops{{0, {0, 0.125, 0}},      {0.5, {0, 0.125, 0}},     {3.0, {0, 0.050, 0}},  {3.5, {0, 0.050, 0}}, {4.5, {0.026, 0.050, 0}},
                                         {5.9, {-0.026, 0.050, 0}}, {6.6, {0, 0.050, 0}}, {6.9, {0, 0.050, 0}}, {8.1, {0, 0.15, 0}}};
    return stops;
}

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.contact_iterations = 80;  // a hundred vertices that come to rest on a plate that moves
    def.solver.rayleigh_mass_1_s = 0.5;
    def.solver.rayleigh_stiffness_s = 0.002;
    return def;
}

class Squeeze : public Show {
public:
    explicit Squeeze(const ShowOptions& options) : world_(world_def(options)) {
        BodyDef def;
        def.name = "ball";
        def.shape = BodyTemplate::build(stuff_isosurface([](const Vec3& p) { return p.norm() - kRadius_m; },
                                                         {.min_m = Vec3::Constant(-1.3 * kRadius_m), .max_m = Vec3::Constant(1.3 * kRadius_m), .edge_m = kEdge_m}));
        def.material = StableNeoHookean{.mu_pa = 8e3, .lambda_pa = 1.6e5};  // nu = 0.476: it bulges instead of vanishing
        def.density_kg_m3 = 1050;
        def.translation_m = Vec3(0, kRadius_m, 0);
        world_.add_body(def);
        ColliderDef plate;
        plate.shape = BoxShape{Vec3(kPlate_m, kThick_m, kPlate_m)};
        plate.friction = 0.8;
        plate.motion = ColliderMotion::kinematic;
        plate.name = "lower plate";
        plate.pose.position_m = Vec3(0, -kThick_m, 0);
        lower_ = world_.add_collider(plate);
        plate.name = "upper plate";
        plate.keys = eased(way());
        for (Vec3& x : plate.keys.positions_m) x.y() += kThick_m;
        plate.pose.position_m = plate.keys.positions_m[0];
        upper_ = world_.add_collider(plate);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 9.6; }

    void before_step() override {
        if (world_.step_count() == 0) return;
        const double t = world_.time_s();
        press_.push_back({t, -world_.collider_state(lower_).force_n.y()});
    }

    std::vector<Reading> readings() override {
        const double gap = world_.collider_state(upper_).pose.position_m.y() - kThick_m;
        return {{"squeezed to", 100 * std::min(1.0, gap / (2 * kRadius_m)), "%"}, {"force", world_.collider_state(upper_).force_n.norm(), "N"}};
    }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera.target_m = Vec3(0, 0.047, 0);
        const double turn = -0.35 + 0.25 * smooth_step(0, 8, t);
        view.camera.eye_m = view.camera.target_m + Vec3(0.40 * std::sin(turn), 0.055, 0.40 * std::cos(turn));
        view.camera.fov_deg = 30;
        view.key_light = Vec3(-0.5, 0.9, 1.0);
        view.ground_height_m = -2 * kThick_m;
        view.surfaces[0].look = Look::gel;
        if (view.scale) view.scale->high = 1e4;
        view.caption = t < 0.9   ? "A soft, nearly incompressible ball between two plates"
                       : t < 3.3 ? "Squeezed to half its height: it bulges"
                       : t < 6.8 ? "Rolled under load: what is squeezed changes, the force hardly does"
                                 : "Let go: it springs back";
        PlotView plot;
        plot.title = "Force on the plates [N]";
        plot.end = duration_s();
        plot.high = kMost_n;
        plot.curves.push_back({press_, {1.0f, 0.85f, 0.2f}, ""});
        view.plot = std::move(plot);
    }

private:
    World world_;
    ColliderId lower_, upper_;
    std::vector<std::array<double, 2>> press_;
};

const RegisterDemo demo({"squeeze", "a soft ball is squeezed between two plates, rolled and let go; the force is plotted",
                         [](const ShowOptions& options) { return std::make_unique<Squeeze>(options); }});

}  // namespace
}  // namespace supple::demos
