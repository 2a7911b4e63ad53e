// A column of hexahedra, clamped at its foot, is twisted by its head through a turn and a half, and let go.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "demo.h"
#include "framing.h"
#include "supple/mesh/box_mesh.h"

namespace supple::demos {
namespace {

constexpr double kHeight_m = 0.4, kWidth_m = 0.1, kTiny_m = 1e-9;
constexpr double kBegin_s = 1, kTwisted_s = 6, kLetGo_s = 7.5;
constexpr double kTurns = 1.5;

/// Angle of the head [rad], smooth at both ends.
double angle_at(double time_s) {
    const double s = std::clamp((time_s - kBegin_s) / (kTwisted_s - kBegin_s), 0.0, 1.0);
    return 2 * M_PI * kTurns * s * s * (3 - 2 * s);
}

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.time_step_s = 1.0 / 120;
    def.solver.rayleigh_stiffness_s = 0.004;
    return def;
}

class TwistedColumn : public Show {
public:
    explicit TwistedColumn(const ShowOptions& options) : world_(world_def(options)) {
        BodyDef def;
        def.name = "column";
        def.shape = BodyTemplate::build(make_hex_box(
            {.min_m = Vec3(-kWidth_m / 2, 0, -kWidth_m / 2), .max_m = Vec3(kWidth_m / 2, kHeight_m, kWidth_m / 2), .cells = {8, 32, 8}}));
        def.material = StableNeoHookean{.mu_pa = 1e5, .lambda_pa = 9e5};
        body_ = world_.add_body(def);
        world_.fix(body_, InsideBox{Vec3(-1, -1, -1), Vec3(1, kTiny_m, 1)});
        world_.prescribe(body_, head_motion());
        SceneBounds bounds = bounds_of(world_);
        bounds.min_m -= Vec3(0.06, 0, 0.06);
        bounds.max_m += Vec3(0.06, 0.02, 0.06);
        camera_ = frame_camera(bounds, Vec3(0.5, 0.3, 1), 34);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 10; }

    void before_step() override {
        if (held_ && world_.time_s() >= kLetGo_s - 1e-9) {
            world_.release(body_, head());
            held_ = false;
        }
    }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        view.camera.eye_m += Vec3(0.03 * std::sin(0.4 * t), 0, 0);
        view.ground_height_m = 0;
        view.surfaces[0].look = Look::rubber;
        view.surfaces[0].rest_positions = world_.shape(body_).mesh().vertices;
        if (view.scale) view.scale->high = 3e5;
        if (held_) {
            char text[64];
            std::snprintf(text, sizeof text, "   head turned %.0f degrees", angle_at(t) * 180 / M_PI);
            view.hud += text;
        }
        if (t < kBegin_s)
            view.caption = "A rubber column of hexahedra, clamped at its foot";
        else if (held_)
            view.caption = "Its head is turned once and a half round";
        else
            view.caption = "It is let go";
    }

private:
    static InsideBox head() { return {Vec3(-1, kHeight_m - kTiny_m, -1), Vec3(1, 1, 1)}; }

    /// The head turns about the column's axis; a key every 2.5 degrees or so, and straight lines between.
    static Motion head_motion() {
        Motion motion;
        motion.where = head();
        constexpr int kKeys = 240;
        for (int k = 0; k <= kKeys; ++k) {
            const double t = kBegin_s + (kTwisted_s - kBegin_s) * k / kKeys;
            Mat34 A;
            A.leftCols<3>() = Eigen::AngleAxisd(angle_at(t), Vec3::UnitY()).toRotationMatrix();
            A.col(3).setZero();
            motion.affine.times_s.push_back(t);
            motion.affine.values.push_back(A);
        }
        return motion;
    }

    World world_;
    BodyId body_;
    bool held_ = true;
    Camera camera_;
};

const RegisterDemo demo({"twisted_column", "a rubber column of hexahedra is twisted once and a half round and let go",
                         [](const ShowOptions& options) { return std::make_unique<TwistedColumn>(options); }});

}  // namespace
}  // namespace supple::demos
