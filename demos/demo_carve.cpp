// A spherical burr on a haptic device carves a groove into a block of hexahedra: force-limited, its force rendered at 1 kHz and plotted.
#include <cmath>
#include <optional>

#include "demo.h"
#include "drawn_shapes.h"
#include "framing.h"
#include "press_scene.h"
#include "supple/haptics/plain_devices.h"
#include "supple/mesh/box_mesh.h"
#include "supple/world/edit_events.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kSize_m = 0.12, kBurr_m = 0.014;
constexpr int kCells = 16;
constexpr double kHighest_n = 4;  // of the plot
constexpr double kBite_n = 0.8;   // it takes away what it presses with more

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.cg_relative_tolerance = 1e-4;
    def.solver.contact_iterations = 150;
    def.solver.rayleigh_mass_1_s = 1;
    def.solver.rayleigh_stiffness_s = 0.002;
    return def;
}

/// The hand's way: down at the front left, along an S over the top, up again. The burr follows as far as the device's force takes it.
Vec3 path(double t) {
    const Vec3 wait(-0.5 * kSize_m, kSize_m + 0.06, 0.3 * kSize_m), down(-0.38 * kSize_m, kSize_m + 0.003, 0.3 * kSize_m);
    if (t < 2) return wait + smooth_step(0.6, 2, t) * (down - wait);
    const double s = std::min((t - 2) / 5.5, 1.0);
    const Vec3 on(-0.38 * kSize_m + 0.76 * kSize_m * s, kSize_m + 0.003 - 0.016 * smooth_step(0, 1, s), 0.3 * kSize_m * std::cos(2.2 * M_PI * s));
    return on + smooth_step(7.5, 8.5, t) * Vec3(0.02, 0.06, 0);
}

class Carve : public Show {
public:
    explicit Carve(const ShowOptions& options)
        : world_(world_def(options)), edits_(options.edits), device_(haptics::device_preset("falcon"), hand()), loop_(device_, {}),
          link_(std::in_place, world_, loop_, haptics::ToolLinkDef{.shape = SphereShape{kBurr_m}, .friction = 0, .mass_kg = 0.02}) {
        BodyDef def;
        def.name = "block";
        def.shape = BodyTemplate::build(make_hex_box({.min_m = {-kSize_m / 2, 0, -kSize_m / 2}, .max_m = {kSize_m / 2, kSize_m, kSize_m / 2}, .cells = {kCells, kCells, kCells}}));
        def.material = Corotational{.young_pa = 8e4, .poisson = 0.4};
        def.density_kg_m3 = 1100;
        body_ = world_.add_body(def);
        world_.fix(body_, InsideBox{{-1, -1, -1}, {1, 1e-9, 1}});
        SceneBounds bounds = bounds_of(world_);
        bounds.max_m.y() += 0.02;
        camera_ = frame_camera(bounds, Vec3(-0.35, 0.75, 1), 32);
        camera_.target_m.y() -= 0.006;
        camera_.eye_m += 0.05 * (camera_.eye_m - camera_.target_m);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 9; }
    void before_step() override {
        if (!link_) return;
        run_beside_step(loop_, *link_, world_, [&](double time, const haptics::TickReport& tick) {
            tick_ = tick;
            if (++ticks_ % 4 == 0) curve_.push_back({time, tick.force_n.norm()});
        });
        if (!link_->collider()) return;
        if (world_.step_count() > 0) simulated_.push_back({world_.time_s(), world_.collider_state(link_->collider()).force_n.norm()});
        if (edits_ && world_.step_count() % 4 == 0) grind();
    }
    void let_go() override { link_.reset(); }

    std::vector<Reading> readings() override { return {{"removed", double(removed_), ""}, {"force", tick_.force_n.norm(), "N"}}; }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        view.surfaces[0].look = Look::rubber;
        view.ground_height_m = 0.0;
        if (view.scale) view.scale->high = 3000;
        if (!link_) return;
        drawn_.clear();
        const Vec3 burr = link_->collider() ? world_.collider_state(link_->collider()).pose.position_m : path(t), shaft = Vec3(-0.35, 1, 0.25).normalized();
        drawn_.tube(std::array{Vec3(burr + 0.7 * kBurr_m * shaft), Vec3(burr + 0.035 * shaft), Vec3(burr + 0.037 * shaft), Vec3(burr + 0.30 * shaft)}, std::array{0.0032, 0.0032, 0.0075, 0.0085},
                    {0.80f, 0.82f, 0.86f}, Look::rubber);
        drawn_.add_to(view);
        if (tick_.force_n.norm() > 0.05) view.arrows.push_back({burr, burr + 0.07 * (1 - std::exp(-tick_.force_n.norm() / 2)) * tick_.force_n.normalized(), {1.0f, 0.55f, 0.15f}});
        PlotView plot;
        plot.title = "Force on the hand [N]";
        plot.end = duration_s();
        plot.high = kHighest_n;
        plot.curves.push_back({simulated_, {0.45f, 0.78f, 1.0f}, "simulation"});
        plot.curves.push_back({curve_, {1.0f, 0.85f, 0.2f}, "1 kHz loop"});
        view.plot = std::move(plot);
        view.caption = t < 1.8 ? "A burr comes to a soft block of " + std::to_string(kCells * kCells * kCells) + " hexahedra"
                       : t < 7.5 ? "Carved: the hand feels every part that gives way, at 1 kHz"
                                 : "Lifted: " + std::to_string(removed_) + " hexahedra are gone";
    }

private:
    static haptics::Trajectory hand() {
        haptics::Trajectory way;
        for (int i = 0; i <= 900; ++i) {
            way.times_s.push_back(i / 100.0);
            way.positions_m.push_back(path(i / 100.0));
        }
        return way;
    }
    /// Where it presses, what its surface reaches goes, a little more than a cell deep: between two removals it presses on what is left.
    void grind() {
        const ColliderState burr = world_.collider_state(link_->collider());
        if (burr.force_n.norm() < kBite_n) return;
        const auto gone = elements_near(world_, body_, burr.pose.position_m, burr.pose.position_m, kBurr_m + 0.6 * kSize_m / kCells);
        if (!gone.empty()) removed_ += world_.remove_elements(body_, gone).removed_elements().size();
        removed_ += world_.remove_pieces(body_, 1e-2 * kSize_m * kSize_m * kSize_m).removed_elements().size();
    }

    World world_;
    bool edits_;
    BodyId body_;
    haptics::PlayedDevice device_;
    haptics::HapticLoop loop_;
    std::optional<haptics::ToolLink> link_;
    haptics::TickReport tick_;
    std::vector<std::array<double, 2>> curve_, simulated_;
    std::uint64_t ticks_ = 0;
    std::size_t removed_ = 0;
    DrawnShapes drawn_;
    Camera camera_;
};

const RegisterDemo demo({"carve", "a spherical burr on a haptic device carves a groove into a block of hexahedra; the force at 1 kHz is plotted",
                         [](const ShowOptions& options) { return std::make_unique<Carve>(options); }});

}  // namespace
}  // namespace supple::demos
