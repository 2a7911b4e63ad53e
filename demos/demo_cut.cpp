// A liver is held at both lobes and pulled while a blade goes down through it: the lips gape, the stress that ran across the cut is gone from them.
#include "demo.h"
#include "drawn_shapes.h"
#include "framing.h"
#include "open_show.h"
#include "supple/io/mesh_file.h"
#include "supple/world/edit_events.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kCutBegin_s = 2.2, kCutEnd_s = 6.8, kBlade_m = 0.05;

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.rayleigh_mass_1_s = 2;
    def.solver.rayleigh_stiffness_s = 0.004;
    return def;
}

class Cut : public Show {
public:
    explicit Cut(const ShowOptions& options) : world_(world_def(options)) {
        BodyDef def;
        def.name = "liver";
        def.shape = BodyTemplate::build(io::read_mesh(find_asset("liver.msh")));
        def.material = StableNeoHookean{.mu_pa = 3e3, .lambda_pa = 2e4};
        def.density_kg_m3 = 1060;
        body_ = world_.add_body(def);
        bounds_ = bounds_of(world_);
        const Vec3 size = bounds_.max_m - bounds_.min_m;
        for (const double side : {-1.0, 1.0}) {
            InsideBox lobe{bounds_.min_m - Vec3::Constant(1), bounds_.max_m + Vec3::Constant(1)};
            (side < 0 ? lobe.max_m.x() : lobe.min_m.x()) = side < 0 ? bounds_.min_m.x() + 0.14 * size.x() : bounds_.max_m.x() - 0.18 * size.x();
            Motion motion{.where = lobe};
            for (int i = 0; i <= 20; ++i) {
                motion.displacement_m.times_s.push_back(0.6 + 0.3 * i);
                motion.displacement_m.values.push_back(Vec3(side * 0.15 * size.x() * smooth_step(0, 20, i), 0, 0));
            }
            world_.prescribe(body_, motion);
        }
        // The blade's edge runs from front to back and is longer than the organ.
        blade_.body = body_;
        const double x = bounds_.min_m.x() + 0.52 * size.x();
        for (const double z : {bounds_.max_m.z() + 0.03, bounds_.min_m.z() - 0.03}) {
            blade_.from_m.push_back(Vec3(x, bounds_.max_m.y() - 0.002, z));
            blade_.to_m.push_back(Vec3(x + 0.012, bounds_.min_m.y() + 0.53 * size.y(), z));
        }
        blade_.begin_s = kCutBegin_s;
        blade_.end_s = kCutEnd_s;
        if (options.edits) script_ = EditScript({blade_}, {});
        camera_ = frame_camera(bounds_, Vec3(-0.25, 0.62, 1), 32);
        camera_.eye_m = camera_.target_m + 0.86 * (camera_.eye_m - camera_.target_m);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 9; }
    void before_step() override {
        if (playing_) script_.before_step(world_);
    }
    void let_go() override { playing_ = false; }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        view.surfaces[0].look = Look::tissue;
        if (view.scale) view.scale->high = 5000;
        if (t < kCutBegin_s)
            view.caption = "A liver is held at both lobes and pulled";
        else if (t < kCutEnd_s)
            view.caption = "A blade goes through: elements are split along it, the lips gape";
        else
            view.caption = "Open: little stress is left along the lips, much at the end of the cut";
        if (playing_ && t > kCutBegin_s - 0.8 && t < kCutEnd_s + 0.2) {
            const double s = std::clamp((t - kCutBegin_s) / (kCutEnd_s - kCutBegin_s), 0.0, 1.0);
            const Vec3 a = (1 - s) * blade_.from_m[0] + s * blade_.to_m[0], b = (1 - s) * blade_.from_m[1] + s * blade_.to_m[1];
            const Vec3 up(0, kBlade_m, 0), away(0, 0.14 * (1 - smooth_step(kCutBegin_s - 0.8, kCutBegin_s, t)), 0);  // it is seen coming
            drawn_.clear();
            drawn_.surface(thick_strip(std::array{Vec3(a + away), Vec3(b + away)}, std::array{Vec3(a + away + up), Vec3(b + away + up)}, 0.0016), {0.86f, 0.89f, 0.92f}, Look::rubber, 0.7);
            drawn_.add_to(view);
        }
    }

private:
    World world_;
    BodyId body_;
    SceneBounds bounds_;
    CutEvent blade_;
    EditScript script_;
    bool playing_ = true;
    DrawnShapes drawn_;
    Camera camera_;
};

const RegisterDemo demo({"cut", "a liver is pulled open while a blade goes through it; the stress relaxes along the lips",
                         [](const ShowOptions& options) { return std::make_unique<Cut>(options); }});

}  // namespace
}  // namespace supple::demos
