// Three slabs are pressed by the same tool: one is elastic and comes back, the others, of tetrahedra and of hexahedra, flow and keep their dents.
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

struct Slab {
    const char* name;
    bool plastic, hexes;
    double centre_m() const { return (plastic ? hexes ? 1 : 0 : -1) * kGap_m; }
};

constexpr Slab kSlabs[] = {{"elastic", false, false}, {"plastic, tetrahedra", true, false}, {"plastic, hexahedra", true, true}};

BodyDef body_of(const Slab& slab) {
    const BoxDef box{.min_m = Vec3(-kWidth_m / 2, 0, -kWidth_m / 2), .max_m = Vec3(kWidth_m / 2, kHeight_m, kWidth_m / 2), .cells = {20, 6, 20}};
    Corotational clay{.young_pa = 4e4, .poisson = 0.4};
    if (slab.plastic) clay.plasticity = {.yield = 0.02, .max = 0.6, .creep_1_s = 30};
    BodyDef def;
    def.name = slab.name;
    def.shape = BodyTemplate::build(slab.hexes ? make_hex_box(box) : make_tet_box(box));
    def.material = clay;
    def.density_kg_m3 = 1200;
    def.translation_m = Vec3(slab.centre_m(), 0, 0);
    return def;
}

class Dent : public Show {
public:
    explicit Dent(const ShowOptions& options) : world_(world_def(options)) {
        for (const Slab& slab : kSlabs) world_.fix(world_.add_body(body_of(slab)), InsideBox{Vec3(-1, -1, -1), Vec3(1, 1e-9, 1)});
        script_ = std::make_unique<TouchScript>(world_, std::vector<Touch>{press(1.2, kSlabs[0].centre_m(), "Elastic: pressed, then let go"),
                                                                           press(4.2, kSlabs[1].centre_m(), "With a yield strain of 2 %: the same press"),
                                                                           press(7.2, kSlabs[2].centre_m(), "The same in hexahedra")}, 0.08, 20.0);
        SceneBounds bounds;
        bounds.include(Vec3(kSlabs[0].centre_m() - kWidth_m / 2, 0, -kWidth_m / 2));
        bounds.include(Vec3(kSlabs[2].centre_m() + kWidth_m / 2, kHeight_m + 0.08, kWidth_m / 2));
        camera_ = frame_camera(bounds, Vec3(0.1, 0.6, 1), 32);
        camera_.eye_m = camera_.target_m + 0.72 * (camera_.eye_m - camera_.target_m);  // a wide, flat scene
        camera_.target_m.y() -= 0.025;
    }

    World& world() override { return world_; }
    double duration_s() const override { return 11.5; }
    void before_step() override { script_->before_step(); }
    void let_go() override { script_->let_go(); }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        view.ground_height_m = 0.0;
        for (SurfaceView& surface : view.surfaces) surface.look = Look::rubber;
        for (const Slab& slab : kSlabs) view.labels.push_back({Vec3(slab.centre_m(), 0.0, kWidth_m / 2 + 0.02), slab.name});
        view.caption = t < 1.2 ? "Three slabs, equally stiff; two of them flow where they are strained beyond 2 %"
                               : "The elastic slab came back; the others keep their dents and the stress locked in around them";
        if (view.scale) view.scale->high = 1e4;
        script_->decorate(view);
    }

private:
    World world_;
    std::unique_ptr<TouchScript> script_;
    Camera camera_;
};

const RegisterDemo demo({"dent", "plastic flow: pressed slabs of tetrahedra and of hexahedra keep their dents beside one that comes back",
                         [](const ShowOptions& options) { return std::make_unique<Dent>(options); }});

}  // namespace
}  // namespace supple::demos
