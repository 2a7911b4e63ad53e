// A spherical burr carves a groove into a block of hexahedra and feels it.
#include <cmath>
#include <cstdio>

#include "demo.h"
#include "framing.h"
#include "supple/mesh/box_mesh.h"
#include "supple/world/edit_events.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kSize_m = 0.12, kBurr_m = 0.014;
constexpr int kCells = 16;

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.rayleigh_mass_1_s = 1;
    def.solver.rayleigh_stiffness_s = 0.002;
    return def;
}

/// The burr's way: down at the front left, along an S over the top, up again.
Vec3 path(double t) {
    const Vec3 wait(-0.5 * kSize_m, kSize_m + 0.06, 0.3 * kSize_m), down(-0.38 * kSize_m, kSize_m + 0.002, 0.3 * kSize_m);
    if (t < 2) return wait + smooth_step(0.6, 2, t) * (down - wait);
    const double s = std::min((t - 2) / 5.5, 1.0);
    const Vec3 on(-0.38 * kSize_m + 0.76 * kSize_m * s, kSize_m + 0.002 - 0.012 * smooth_step(0, 1, s), 0.3 * kSize_m * std::cos(2.2 * M_PI * s));
    return on + smooth_step(7.5, 8.5, t) * Vec3(0.02, 0.06, 0);
}

class Carve : public Show {
public:
    explicit Carve(const ShowOptions& options) : world_(world_def(options)) {
        BodyDef def;
        def.name = "block";
        def.shape = BodyTemplate::build(make_hex_box({.min_m = {-kSize_m / 2, 0, -kSize_m / 2}, .max_m = {kSize_m / 2, kSize_m, kSize_m / 2}, .cells = {kCells, kCells, kCells}}));
        def.material = Corotational{.young_pa = 4e4, .poisson = 0.4};
        def.density_kg_m3 = 1100;
        body_ = world_.add_body(def);
        world_.fix(body_, InsideBox{{-1, -1, -1}, {1, 1e-9, 1}});
        ColliderDef tool;
        tool.name = "burr";
        tool.shape = SphereShape{kBurr_m};
        tool.friction = 0.2;
        tool.motion = ColliderMotion::kinematic;
        for (int i = 0; i <= 600; ++i) {
            tool.keys.times_s.push_back(i / 60.0);
            tool.keys.positions_m.push_back(path(i / 60.0));
        }
        tool_ = world_.add_collider(tool);
        SceneBounds bounds = bounds_of(world_);
        bounds.max_m.y() += 0.03;
        camera_ = frame_camera(bounds, Vec3(-0.35, 0.75, 1), 32);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 9; }
    /// What its surface reaches goes, three quarters of a cell deep: between two removals it presses on what is left.
    void before_step() override {
        if (!playing_ || world_.step_count() % 4 != 0) return;
        const Vec3 at = world_.collider_state(tool_).pose.position_m;
        const auto gone = elements_near(world_, body_, at, at, kBurr_m + 0.75 * kSize_m / kCells);
        if (!gone.empty()) removed_ += world_.remove_elements(body_, gone).removed_elements().size();
        removed_ += world_.remove_pieces(body_, 1e-2 * kSize_m * kSize_m * kSize_m).removed_elements().size();
    }
    void let_go() override { playing_ = false; }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        view.surfaces[0].look = Look::rubber;
        view.ground_height_m = 0.0;
        if (view.scale) view.scale->high = 4000;
        const ColliderState tool = world_.collider_state(tool_);
        felt_n_ += 0.2 * (tool.force_n - felt_n_);
        if (felt_n_.norm() > 0.02) {
            view.arrows.push_back({tool.pose.position_m, tool.pose.position_m + 0.03 * felt_n_, {1.0f, 0.55f, 0.15f}});
            char text[32];
            std::snprintf(text, sizeof text, "%.1f N", felt_n_.norm());
            view.labels.push_back({tool.pose.position_m + Vec3(0, kBurr_m + 0.02, 0), text});
        }
        view.caption = t < 1.8 ? "A burr comes to a soft block of " + std::to_string(kCells * kCells * kCells) + " hexahedra"
                               : "Carved: " + std::to_string(removed_) + " elements removed, the force is what the hand feels";
    }

private:
    World world_;
    BodyId body_;
    ColliderId tool_;
    std::size_t removed_ = 0;
    Vec3 felt_n_ = Vec3::Zero();
    bool playing_ = true;
    Camera camera_;
};

const RegisterDemo demo({"carve", "a spherical burr carves a groove into a block of hexahedra and feels its force",
                         [](const ShowOptions& options) { return std::make_unique<Carve>(options); }});

}  // namespace
}  // namespace supple::demos
