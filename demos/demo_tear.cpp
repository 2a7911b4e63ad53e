// A slab, thin as a membrane, with a notch is pulled at its ends until the stress at the notch passes its strength and a tear runs across.
#include "demo.h"
#include "framing.h"
#include "supple/mesh/box_mesh.h"
#include "supple/world/tearing.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kLength_m = 0.30, kWidth_m = 0.20, kThick_m = 0.006, kPull_m = 0.05;

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.gravity_m_s2 = Vec3::Zero();
    def.time_step_s = 1.0 / 120;
    def.solver.rayleigh_mass_1_s = 3;
    def.solver.rayleigh_stiffness_s = 0.01;
    def.solver.newton_iterations = 2;  // what snaps back is far from linear
    return def;
}

class Tear : public Show {
public:
    explicit Tear(const ShowOptions& options) : world_(world_def(options)), playing_(options.edits) {
        BodyDef def;
        def.name = "slab";
        def.shape = BodyTemplate::build(make_tet_box({.min_m = {-kLength_m / 2, 0, -kThick_m / 2}, .max_m = {kLength_m / 2, kWidth_m, kThick_m / 2}, .cells = {45, 30, 1}}));
        def.material = StableNeoHookean{.mu_pa = 4e4, .lambda_pa = 8e4};
        def.density_kg_m3 = 1100;
        body_ = world_.add_body(def);
        for (const double side : {-1.0, 1.0}) {
            Motion motion{.where = side < 0 ? InsideBox{{-1, -1, -1}, {-kLength_m / 2 + 1e-6, 1, 1}} : InsideBox{{kLength_m / 2 - 1e-6, -1, -1}, {1, 1, 1}}};
            motion.displacement_m = {.times_s = {0.5, 5.0}, .values = {Vec3::Zero(), Vec3(side * kPull_m, 0, 0)}};
            world_.prescribe(body_, motion);
        }
        // The notch: an eighth of the width, from below.
        const Vec3 low(0.002, -0.01, -0.1), high(0.002, -0.01, 0.1), up(0, 0.01 + kWidth_m / 8, 0);
        world_.cut(body_, swept_blade(std::vector<Vec3>{low, high}, std::vector<Vec3>{low + up, high + up}));
        tear_.where = InsideBox{{-0.4 * kLength_m, -1, -1}, {0.4 * kLength_m, 1, 1}};  // not where it is gripped
        tear_.strength_pa = 2.6e4;
        tear_.toughness_j_m2 = 5;
        tear_.most_per_step = 1;
        SceneBounds bounds = bounds_of(world_);
        bounds.min_m.x() -= kPull_m;
        bounds.max_m.x() += kPull_m;
        camera_ = frame_camera(bounds, Vec3(0.25, 0.2, 1), 32);
        camera_.eye_m = camera_.target_m + 0.85 * (camera_.eye_m - camera_.target_m);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 6; }
    void before_step() override {
        if (!playing_ || world_.step_count() % 4 != 0) return;  // the stress moves on before the next faces are looked at
        const TopologyDelta delta = tear_overstressed(world_, body_, tear_);
        if (delta.is_identity()) return;
        torn_ += delta.added_vertices().size();
    }
    void let_go() override { playing_ = false; }

    void decorate(FrameView& view) override {
        view.camera = camera_;
        view.surfaces[0].look = Look::gel;
        if (view.scale) view.scale->high = 3e4;
        if (torn_ == 0)
            view.caption = "A notched slab is pulled: the stress gathers at the notch";
        else if (world_.pieces(body_).size() == 1)
            view.caption = "Above its strength of 26 kPa it tears, element by element";
        else
            view.caption = "Torn in two";
    }

private:
    World world_;
    BodyId body_;
    TearDef tear_;
    std::size_t torn_ = 0;
    bool playing_;
    Camera camera_;
};

const RegisterDemo demo({"tear", "a notched slab, thin as a membrane, is pulled until a tear runs across it",
                         [](const ShowOptions& options) { return std::make_unique<Tear>(options); }});

}  // namespace
}  // namespace supple::demos
