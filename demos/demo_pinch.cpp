// Toothed forceps close on the lower edge of a liver, pull it down, turn it up, and open again. The jaws press by contact; once they are closed their teeth hold what they
// touch (attachments to the jaws, each of a limited force). What they squeeze with and what they pull is plotted.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "demo.h"
#include "drawn_shapes.h"
#include "framing.h"
#include "keyframes.h"
#include "open_show.h"
#include "supple/io/mesh_file.h"
#include "supple/io/surface_file.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kJaw_m = 0.005, kHalf_m = 0.011;  // radius and half length of a jaw
constexpr double kOpen_m = 0.016;                  // between a jaw and the surface while the forceps are open
constexpr double kClosed = 0.38;                   // of the thickness of the edge
constexpr double kCome_s = 0.6, kThere_s = 1.8, kClosed_s = 2.8, kPull_s = 3.1, kOpen_s = 8.2, kOpened_s = 8.8, kGone_s = 9.6;
constexpr double kTooth_n = 2.5;                   // what a tooth holds
constexpr double kMost_n = 10;                     // of the plot
const Vec3 kPlace(-0.066, -0.089, 0);              // where the edge is taken; its depth is found

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.contact_iterations = 40;
    def.solver.rayleigh_mass_1_s = 2;
    def.solver.rayleigh_stiffness_s = 0.003;
    return def;
}

class Pinch : public Show {
public:
    explicit Pinch(const ShowOptions& options) : world_(world_def(options)) {
        BodyDef def;
        def.name = "liver";
        def.shape = BodyTemplate::build(io::read_mesh(find_asset("liver_vessels.msh")));
        def.skin = Skin::build(def.shape->mesh(), io::read_surface(find_asset("liver_vessels.ply")));
        def.material = StableNeoHookean{.mu_pa = 2.4e3, .lambda_pa = 2e4};
        def.density_kg_m3 = 1060;
        body_ = world_.add_body(def);
        world_.fix(body_, InGroup{"ligament"});
        for (std::size_t jaw = 0; jaw < 2; ++jaw) {
            ColliderDef tool;
            tool.name = jaw == 0 ? "front jaw" : "back jaw";
            tool.shape = CapsuleShape{kJaw_m, kHalf_m};
            tool.friction = 0;  // wet: it is the teeth that hold
            tool.motion = ColliderMotion::kinematic;
            tool.pose = {place(jaw, 0), rotation()};
            jaws_[jaw] = world_.add_collider(tool);
        }
        SceneBounds bounds = bounds_of(world_);
        bounds.min_m.y() -= 0.03;
        camera_ = frame_camera(bounds, Vec3(-0.55, 0.10, 1), 32);
        camera_.eye_m = camera_.target_m + 0.78 * (camera_.eye_m - camera_.target_m);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 10.4; }

    void before_step() override {
        const double t = world_.time_s() + world_.def().time_step_s;
        if (t >= kThere_s && surface_z_[0] == 0) measure();
        if (t >= kPull_s && t < kOpen_s && teeth_.empty()) bite();
        if (t >= kOpen_s) open();
        for (std::size_t jaw = 0; jaw < 2; ++jaw) world_.move_collider(jaws_[jaw], {place(jaw, t), rotation()});
        if (world_.step_count() == 0) return;
        squeezed_.push_back({world_.time_s(), squeeze_n()});
        pulled_.push_back({world_.time_s(), pull_n().norm()});
    }
    void let_go() override {
        open();
        for (ColliderId& jaw : jaws_) world_.remove_collider(jaw), jaw = {};
        gone_ = true;
    }

    std::vector<Reading> readings() override {
        if (gone_) return {};
        return {{"teeth", double(teeth_.size()), ""}, {"squeeze", squeeze_n(), "N"}, {"pull", pull_n().norm(), "N"}};
    }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        view.ground_height_m = -0.17;
        view.surfaces[0].look = Look::tissue;
        if (view.scale) view.scale->high = 3000;
        if (gone_) return;
        drawn_.clear();
        for (std::size_t jaw = 0; jaw < 2; ++jaw) {
            // An arm: from the jaw's lower end to a handle towards the surgeon.
            const Vec3 at = world_.collider_state(jaws_[jaw]).pose.position_m, end = at - kHalf_m * along();
            const Vec3 middle = 0.5 * (world_.collider_state(jaws_[0]).pose.position_m + world_.collider_state(jaws_[1]).pose.position_m) - kHalf_m * along();
            const Vec3 side = end - middle, back = -along();
            drawn_.tube(std::array{end, Vec3(middle + 0.05 * back + 1.15 * side), Vec3(middle + 0.11 * back + 0.9 * side), Vec3(middle + 0.20 * back + 0.25 * side)},
                        std::array{0.0040, 0.0036, 0.0036, 0.0040}, {0.62f, 0.66f, 0.71f}, Look::metal);
        }
        drawn_.add_to(view);
        const Vec3 force = pull_n(), between = 0.5 * (world_.collider_state(jaws_[0]).pose.position_m + world_.collider_state(jaws_[1]).pose.position_m);
        if (force.norm() > 0.05) view.arrows.push_back({between, between + 0.09 * (1 - std::exp(-force.norm() / 2)) * force.normalized()});
        view.caption = t < kThere_s    ? "Forceps come to the lower edge of a liver"
                       : t < kPull_s   ? "They close, and their teeth take hold"
                       : t < kOpen_s   ? t < 7.1 ? "Pulled down, then turned up" : "Brought back"
                                       : "Opened";
        PlotView plot;
        plot.title = "Force of the jaws [N]";
        plot.end = duration_s();
        plot.high = kMost_n;
        plot.curves.push_back({squeezed_, {0.45f, 0.78f, 1.0f}, "squeeze"});
        plot.curves.push_back({pulled_, {1.0f, 0.85f, 0.2f}, "pull"});
        view.plot = std::move(plot);
    }

private:
    static Vec3 along() { return Vec3(0.42, 0.82, -0.38).normalized(); }  ///< of the jaws, from the handle
    static std::array<double, 4> rotation() {
        const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(Vec3(0, 1, 0), along());
        return {q.w(), q.x(), q.y(), q.z()};
    }
    /// Across the jaws: they close along it.
    static Vec3 across() { return (Vec3(0, 0, 1) - along().z() * along()).normalized(); }

    /// The triangles that each jaw touches are tied to it.
    void bite() {
        std::vector<std::pair<ColliderId, std::int32_t>> held;
        for (const ContactPoint& c : world_.contacts()) {
            if (c.body != body_) continue;
            const Triangle& corners = world_.shape(body_).boundary().triangles[std::size_t(c.triangle)];
            for (const std::int32_t vertex : corners) held.emplace_back(c.collider, vertex);
        }
        std::sort(held.begin(), held.end(), [](const auto& a, const auto& b) { return std::pair(a.first.index, a.second) < std::pair(b.first.index, b.second); });
        held.erase(std::unique(held.begin(), held.end()), held.end());
        for (const auto& [jaw, vertex] : held) {
            AttachmentDef tooth;
            tooth.body = body_;
            tooth.vertices[0] = vertex;
            tooth.collider = jaw;
            tooth.stiffness_n_m = 1500;
            tooth.max_force_n = kTooth_n;
            teeth_.push_back(world_.attach(tooth));
        }
    }
    void open() {
        for (const AttachmentId tooth : teeth_) world_.detach(tooth);
        teeth_.clear();
    }

    /// Where the surface is that the jaws close on, front and back.
    void measure() {
        for (std::size_t jaw = 0; jaw < 2; ++jaw) {
            const double side = jaw == 0 ? 1 : -1;
            const auto hit = world_.pick({kPlace + 0.3 * side * across(), -side * across()});
            surface_z_[jaw] = hit ? (hit->position_m - kPlace).dot(across()) : side * 0.02;
        }
    }

    Vec3 place(std::size_t jaw, double t) const {
        const double side = jaw == 0 ? 1 : -1;
        const bool measured = surface_z_[0] != 0;
        const double front = measured ? surface_z_[0] : 0.040, back = measured ? surface_z_[1] : -0.012;
        const double middle = 0.5 * (front + back), half = 0.5 * (front - back);
        const double open = half + kJaw_m + kOpen_m, closed = kClosed * half + kJaw_m;
        double gap = open + smooth_step(kThere_s, kClosed_s, t) * (closed - open);
        gap += smooth_step(kOpen_s, kOpened_s, t) * (open + 0.01 - closed);
        static const std::vector<Stop> stops{{kPull_s, Vec3::Zero()}, {4.6, {0.010, -0.042, 0.010}}, {5.0, {0.010, -0.042, 0.010}}, {6.7, {0.050, 0.015, 0.065}}, {7.1, {0.050, 0.015, 0.065}}, {8.1, {0.008, -0.002, 0.012}}};
        Vec3 way = t <= kPull_s ? Vec3::Zero() : eased_at(stops, t);
        way -= 0.16 * (1 - smooth_step(kCome_s, kThere_s, t) + smooth_step(kOpened_s, kGone_s, t)) * along();
        return kPlace + (middle + side * gap) * across() + way;
    }

    double squeeze_n() const {
        const Vec3 a = world_.collider_state(jaws_[0]).force_n, b = world_.collider_state(jaws_[1]).force_n;
        return std::max(0.0, std::min(a.dot(across()), -b.dot(across())));
    }
    /// Of the jaws on the tissue.
    Vec3 pull_n() const { return -(world_.collider_state(jaws_[0]).force_n + world_.collider_state(jaws_[1]).force_n); }

    World world_;
    BodyId body_;
    std::array<ColliderId, 2> jaws_;
    std::vector<AttachmentId> teeth_;
    std::array<double, 2> surface_z_{0, 0};
    bool gone_ = false;
    std::vector<std::array<double, 2>> squeezed_, pulled_;
    DrawnShapes drawn_;
    Camera camera_;
};

const RegisterDemo demo({"pinch", "toothed forceps close on a liver, pull it and let go; squeeze and pull are plotted",
                         [](const ShowOptions& options) { return std::make_unique<Pinch>(options); }});

}  // namespace
}  // namespace supple::demos
