// A kidney hangs on five elastic bands. It is pulled down at one end; each band holds up to its strength, and they break one after the other.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "demo.h"
#include "drawn_shapes.h"
#include "open_show.h"
#include "supple/io/mesh_file.h"
#include "supple/io/surface_file.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kBar_m = 0.062;          // height of the bar that the bands hang from
constexpr double kHook_m = 0.004;         // the ends of the bands are so far above the kidney at first
constexpr double kStiffness_n_m = 70, kMost_n = 2;
constexpr double kRecoil_s = 0.12;        // what is left of a band that broke draws back so fast
constexpr double kPullBegin_s = 1.5, kPullEnd_s = 60, kGround_m = -0.21;
constexpr std::array<double, 5> kStrength_n{1.2, 1.5, 1.3, 1.6, 1.4};
constexpr std::array<std::array<float, 3>, 5> kColors{{{0.95f, 0.45f, 0.40f}, {0.98f, 0.75f, 0.30f}, {0.50f, 0.82f, 0.45f}, {0.40f, 0.72f, 0.98f}, {0.78f, 0.58f, 0.98f}}};

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.rayleigh_mass_1_s = 2;
    def.solver.rayleigh_stiffness_s = 0.002;
    return def;
}

struct Band {
    AttachmentId id;
    Vec3 hook_m;
    double strength_n = 0, force_n = 0;
    double broke_s = -1, broke_n = 0;
    bool gone = false;
    Vec3 point_m = Vec3::Zero();
    Vec3 end_m = Vec3::Zero();  ///< where its lower end was when it broke
    std::vector<std::array<double, 2>> curve;
};

class Breakable : public Show {
public:
    explicit Breakable(const ShowOptions& options) : world_(world_def(options)), script_(world_, {}, 0.05, 2.0) {
        BodyDef def;
        def.name = "kidney";
        VolumeMesh mesh = io::read_mesh(find_asset("kidney.msh"));
        mesh::TriangleMesh skin = io::read_surface(find_asset("kidney.ply"));
        for (auto* points : {&mesh.vertices, &skin.vertices})
            for (Vec3& x : *points) x = Vec3(x.y(), -x.x(), x.z());  // on its side, the hilum below
        def.shape = BodyTemplate::build(std::move(mesh));
        def.skin = Skin::build(def.shape->mesh(), skin);
        def.material = Corotational{.young_pa = 2.5e4, .poisson = 0.45};
        def.density_kg_m3 = 1050;
        body_ = world_.add_body(def);
        for (std::size_t i = 0; i < kStrength_n.size(); ++i) hang(Vec3(0.021 * (2.0 - double(i)), 1, 0), kStrength_n[i]);
        script_ = TouchScript(world_, {pull()}, 0.05, 2.0);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 8.5; }
    void let_go() override { script_.let_go(); }

    void before_step() override {
        read();
        script_.before_step();
    }

    std::vector<Reading> readings() override {
        read();
        std::vector<Reading> list{{"bands", double(bands_.size() - broken()), ""}};
        if (last_broken_) list.insert(list.end(), {{"broke at", last_broken_->broke_n, "N"}, {"of", last_broken_->strength_n, "N"}});
        return list;
    }

    void decorate(FrameView& view) override {
        read();
        const double back = smooth_step(5, 6.5, world_.time_s());  // as far as the kidney hangs lower, with the labels of the bands still below the line of figures
        view.camera.target_m = Vec3(0.016, -0.036 - 0.020 * back, 0);
        view.camera.eye_m = view.camera.target_m + Vec3(0.10 * std::sin(0.25 * world_.time_s()) - 0.04, 0.040, 0.47 + 0.09 * back);
        view.camera.fov_deg = 32;
        view.key_light = Vec3(-0.6, 1, 0.9);
        view.ground_height_m = kGround_m;
        view.surfaces[0].look = Look::tissue;
        if (view.scale) view.scale->high = 5000;
        draw_bands(view);
        PlotView plot;
        plot.title = "Force of each band [N]";
        plot.end = duration_s();
        plot.high = kMost_n;
        for (std::size_t i = 0; i < bands_.size(); ++i) plot.curves.push_back({bands_[i].curve, kColors[i], ""});
        view.plot = std::move(plot);
        script_.decorate(view);
        if (broken() == 0)
            view.caption = world_.time_s() < kPullBegin_s ? "A kidney hangs on five bands, each with a strength of its own" : "Pulled: the load goes to the nearest bands";
        else if (broken() < bands_.size())
            view.caption = "Broken: " + std::to_string(broken()) + " of 5, each at its own force; the others take over";
        else
            view.caption = "All broken: it hangs from what pulled it";
    }

private:
    /// Ties the top of the kidney below a place to a hook: four vertices share the force.
    void hang(const Vec3& above, double strength_n) {
        const auto hit = world_.pick({above, Vec3(0, -1, 0)});
        const auto x = world_.positions(body_);
        std::vector<std::int32_t> near;
        for (const Triangle& t : world_.shape(body_).boundary().triangles) near.insert(near.end(), t.begin(), t.end());
        std::sort(near.begin(), near.end());
        near.erase(std::unique(near.begin(), near.end()), near.end());
        std::partial_sort(near.begin(), near.begin() + 4, near.end(), [&](std::int32_t a, std::int32_t b) {
            return (x[std::size_t(a)] - hit->position_m).squaredNorm() < (x[std::size_t(b)] - hit->position_m).squaredNorm();
        });
        Band band;
        band.strength_n = strength_n;
        band.hook_m = hit->position_m + Vec3(0, kHook_m, 0);
        AttachmentDef def;
        def.body = body_;
        std::copy_n(near.begin(), 4, def.vertices.begin());
        def.weights = {0.25, 0.25, 0.25, 0.25};
        def.at_point = false;
        def.anchor_m = band.hook_m;
        def.stiffness_n_m = kStiffness_n_m;
        def.max_force_n = strength_n;
        band.id = world_.attach(def);
        bands_.push_back(band);
    }

    std::size_t broken() const {
        return std::size_t(std::count_if(bands_.begin(), bands_.end(), [](const Band& b) { return b.broke_s >= 0; }));
    }

    static Touch pull() {
        Touch touch;
        touch.begin_s = kPullBegin_s;
        touch.end_s = kPullEnd_s;
        touch.ray = {Vec3(0.040, -0.5, 0.002), Vec3(0, 1, 0)};
        touch.radius_m = 0.014;
        touch.tool_radius_m = 0.006;
        touch.pushes = false;
        touch.displacement_m = {.times_s = {0, 1.0, 6.5}, .values = {Vec3::Zero(), Vec3(0.001, -0.006, 0.002), Vec3(0.002, -0.052, 0.010)}};
        return touch;
    }

    /// Forces of the last step; once for each.
    void read() {
        if (world_.step_count() == read_step_) return;
        read_step_ = world_.step_count();
        for (Band& band : bands_) {
            if (band.gone) continue;
            AttachmentState state;
            try {
                state = world_.attachment_state(band.id);
            } catch (const Error&) {  // a hand in the window took away what it held
                band.gone = true;
                state = {.point_m = band.point_m, .anchor_m = band.hook_m, .force_n = Vec3::Zero(), .broken = true};
            }
            band.point_m = state.point_m;
            band.force_n = state.broken ? 0 : state.force_n.norm();
            if (state.broken && band.broke_s < 0) {
                band.broke_s = world_.time_s();
                band.broke_n = state.force_n.norm();
                band.end_m = state.point_m;
                band.curve.push_back({world_.time_s(), band.broke_n});
                last_broken_ = &band;
            }
            band.curve.push_back({world_.time_s(), band.force_n});
        }
    }

    void draw_bands(FrameView& view) {
        drawn_.clear();
        const double bar_radius = 0.0035;
        drawn_.tube(std::array{Vec3(-0.075, kBar_m, 0), Vec3(0.075, kBar_m, 0)}, std::array{bar_radius}, {0.62f, 0.66f, 0.71f}, Look::metal);
        for (std::size_t i = 0; i < bands_.size(); ++i) {
            const Band& band = bands_[i];
            const Vec3 top(band.hook_m.x(), kBar_m, 0);
            drawn_.tube(std::array{top, Vec3(band.hook_m.x(), kBar_m - 0.2 * (kBar_m - band.hook_m.y()), 0.3 * band.hook_m.z()), band.hook_m}, std::array{0.0012}, {0.62f, 0.66f, 0.71f}, Look::metal);
            const Vec3 point = band.point_m;
            char text[32];
            if (band.broke_s < 0) {
                elastic(band.hook_m, point, kColors[i]);
                std::snprintf(text, sizeof text, "%.2f N", band.force_n);
            } else {
                const double left = 1 - smooth_step(band.broke_s, band.broke_s + kRecoil_s, world_.time_s());
                const Vec3 half = 0.5 * (band.end_m - band.hook_m) * left;
                elastic(band.hook_m, band.hook_m + half - Vec3(0, 0.006, 0), kColors[i]);
                elastic(point, point - half + Vec3(0, 0.005, 0), kColors[i]);
                std::snprintf(text, sizeof text, "× %.2f N", band.broke_n);
            }
            view.labels.push_back({top + Vec3(0, i % 2 == 0 ? 0.010 : -0.010, 0), text});
        }
        drawn_.add_to(view);
    }

    /// A band of constant volume: the longer, the thinner.
    void elastic(const Vec3& a, const Vec3& b, const std::array<float, 3>& color) {
        if ((b - a).norm() < 1e-4) return;
        const double middle = std::clamp(0.0032 * std::sqrt(0.008 / (b - a).norm()), 0.0012, 0.0032);
        std::vector<Vec3> way;
        std::vector<double> radius;
        for (int k = 0; k <= 10; ++k) {
            const double s = k / 10.0, end = std::pow(2 * s - 1, 4);
            way.push_back(a + s * (b - a));
            radius.push_back((1 - end) * middle + end * 0.0034);
        }
        drawn_.tube(way, radius, color, Look::gel);
    }

    World world_;
    TouchScript script_;
    BodyId body_;
    std::vector<Band> bands_;
    const Band* last_broken_ = nullptr;  ///< into bands_, which no longer grows
    std::uint64_t read_step_ = ~std::uint64_t{0};
    DrawnShapes drawn_;
};

const RegisterDemo demo({"breakable", "a kidney on five bands is pulled until they break, one after the other, each at its own force",
                         [](const ShowOptions& options) { return std::make_unique<Breakable>(options); }});

}  // namespace
}  // namespace supple::demos
