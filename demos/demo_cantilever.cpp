// A bar clamped at one end bends under its own weight; a weight is hung on its free end and taken away again.
#include <cmath>
#include <cstdio>

#include "demo.h"
#include "framing.h"
#include "supple/mesh/box_mesh.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kLength_m = 0.4, kThickness_m = 0.1;
constexpr double kWeight_n = 6, kHung_s = 3.5, kTaken_s = 6.5;

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.rayleigh_stiffness_s = 0.004;
    return def;
}

class Cantilever : public Show {
public:
    explicit Cantilever(const ShowOptions& options) : world_(world_def(options)) {
        BodyDef def;
        def.name = "bar";
        def.shape = BodyTemplate::build(make_tet_box({.max_m = Vec3(kLength_m, kThickness_m, kThickness_m), .cells = {32, 8, 8}}));
        def.material = Corotational{.young_pa = 3e5, .poisson = 0.4};
        body_ = world_.add_body(def);
        const double tiny = 1e-9;
        world_.fix(body_, InsideBox{Vec3(-1, -1, -1), Vec3(tiny, 1, 1)});
        Load weight;
        weight.where = InsideBox{Vec3(kLength_m - tiny, -1, -1), Vec3(1, 1, 1)};
        weight.kind = LoadKind::total_force;
        weight.value.times_s = {kHung_s, kHung_s + 0.5, kTaken_s, kTaken_s + 0.02};
        weight.value.values = {Vec3(0, 0, 0), Vec3(0, -kWeight_n, 0), Vec3(0, -kWeight_n, 0), Vec3(0, 0, 0)};
        world_.add_load(body_, weight);
        load_ = weight.value;

        const auto& rest = world_.shape(body_).mesh().vertices;
        for (std::size_t v = 0; v < rest.size(); ++v)
            if (rest[v].x() > kLength_m - tiny) tip_.push_back(v);
        rest_tip_m_ = tip_m(rest);
        SceneBounds bounds = bounds_of(world_);
        bounds.min_m.y() -= 0.2;  // the tip comes down so far
        camera_ = frame_camera(bounds, Vec3(0.35, 0.22, 1), 34);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 9; }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        const Vec3 tip = tip_m(world_.positions(body_));
        const Vec3 force = load_.at(t);
        view.camera = camera_;
        view.camera.eye_m += Vec3(0.04 * std::sin(0.35 * t), 0, 0);
        view.ground_height_m = -0.3;
        view.surfaces[0].look = Look::rubber;
        view.surfaces[0].rest_positions = world_.shape(body_).mesh().vertices;
        if (view.scale) view.scale->high = 4e4;
        char text[64];
        std::snprintf(text, sizeof text, "   tip %.1f mm below rest", 1000 * (rest_tip_m_.y() - tip.y()));
        view.hud += text;
        if (force.norm() > 0.01) {
            view.arrows.push_back({tip, tip + 0.02 * force});
            show_force(view, force);
        }
        if (t < kHung_s - 0.2)
            view.caption = "A rubber bar, clamped on the left, bends under its own weight";
        else if (t < kTaken_s)
            view.caption = "A weight of 6 N is hung on its end";
        else
            view.caption = "The weight is taken away";
    }

private:
    template <class Positions>
    Vec3 tip_m(const Positions& positions) const {
        Vec3 sum = Vec3::Zero();
        for (const std::size_t v : tip_) sum += positions[v];
        return sum / static_cast<double>(tip_.size());
    }

    World world_;
    BodyId body_;
    Timeline<Vec3> load_;
    std::vector<std::size_t> tip_;
    Vec3 rest_tip_m_ = Vec3::Zero();
    Camera camera_;
};

const RegisterDemo demo({"cantilever", "a rubber bar bends under its own weight, then under a weight hung on its end",
                         [](const ShowOptions& options) { return std::make_unique<Cantilever>(options); }});

}  // namespace
}  // namespace supple::demos
