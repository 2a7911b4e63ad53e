// A game-like scene: a soft creature is steered over planks, bumps and a ramp, pushes a ball aside, and leaps from a ledge onto a cushion. 60 steps a second.
#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "creature_walk.h"
#include "demo.h"
#include "open_show.h"
#include "supple/io/mesh_file.h"
#include "supple/io/surface_file.h"
#include "supple/mesh/isosurface_stuffing.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kEye_m = 0.012;
constexpr double kLedge_m = 0.09;
const Vec3 kCushion(1.62, 0, 0.34);
constexpr double kClear_m = 0.0015;  // of tied soles above the ground: what they are tied to and what they stand on must not quarrel
constexpr double kGoal_m = 0.20;  // it has arrived where its middle is so near to that of the cushion

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 60;
    def.solver.cg_relative_tolerance = 1e-3;  // of a game
    def.solver.contact_iterations = 30;
    def.solver.rayleigh_mass_1_s = 0.5;
    def.solver.rayleigh_stiffness_s = 0.004;
    return def;
}

double rounded_box(const Vec3& p, const Vec3& half, double radius) {
    const Vec3 d = p.cwiseAbs() - (half - Vec3::Constant(radius));
    return d.cwiseMax(0.0).norm() + std::min(d.maxCoeff(), 0.0) - radius;
}

Route route() { return {{Vec3(-0.55, 0, -0.06), Vec3(-0.1, 0, -0.06), Vec3(0.25, 0, 0.10), Vec3(0.60, 0, 0.34), Vec3(1.20, 0, 0.34)}}; }

class Creature : public Show {
public:
    explicit Creature(const ShowOptions& options) : world_(world_def(options)) {
        world_.add_collider({.name = "ground", .shape = PlaneShape{}, .friction = 0.6});
        build_course();
        creature_ = add_creature();
        ball_ = add_ball(Vec3(-0.02, 0.045, -0.09), 0.045);
        cushion_ = add_cushion();
        walk_.emplace(world_, creature_, route(), CreatureWalk::Def{});
        eyes_.emplace(world_.shape(creature_).mesh(), std::vector<Vec3>{Vec3(0.149, 0.167, 0.040), Vec3(0.149, 0.167, -0.040)});
        eye_positions_.resize(2);
        target_ = middle(creature_);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 12.5; }
    ColorBy color_by() const override { return ColorBy::nothing; }

    void before_step() override {
        target_ += 0.05 * (middle(creature_) + Vec3(0.06, 0.02, 0) - target_);  // the camera comes after it
        if (!walk_->walks()) return;
        if (walk_->arrived() && !walk_->leaps()) {
            if (arrived_s_ == 0) arrived_s_ = world_.time_s();
            if (world_.time_s() > arrived_s_ + 0.7) walk_->leap(Vec3(1.25, 1.45, 0), 0.10);
        }
        walk_->before_step();
    }
    void let_go() override { walk_->let_go(); }

    std::vector<Reading> readings() override {
        const double left = (middle(creature_) - middle(cushion_)).cwiseProduct(Vec3(1, 0, 1)).norm();
        return {{"to the goal", left, "m"}, {"budget", 1000 * world_.def().time_step_s, "ms"}};
    }

    void decorate(FrameView& view) override {
        const Vec3 now = middle(creature_);
        view.camera.target_m = target_;
        const double turn = 0.35 - 0.5 * smooth_step(2, 9, world_.time_s());
        view.camera.eye_m = target_ + Vec3(0.85 * std::sin(turn), 0.38, 0.85 * std::cos(turn));
        view.camera.fov_deg = 34;
        view.key_light = Vec3(-0.5, 1.0, 0.6);
        dress(view);
        if (walk_->walks() && !walk_->arrived())
            view.caption = walk_->way_m() < 0.62 ? "A soft creature trots over planks and pushes a ball aside" : "Over bumps and up a ramp";
        else if (walk_->walks())
            view.caption = "It takes aim ...";
        else
            view.caption = (now - kCushion).cwiseProduct(Vec3(1, 0, 1)).norm() < kGoal_m ? "... and lands on the cushion" : "... leaps ...";
    }

private:
    Vec3 middle(BodyId body) const {
        Vec3 sum = Vec3::Zero();
        for (const Vec3& x : world_.positions(body)) sum += x;
        return sum / double(world_.positions(body).size());
    }

    void add_fixed(const char* name, const Shape& shape, const Vec3& at, double turn_rad, const Vec3& axis, const std::array<float, 3>& color) {
        const Eigen::Quaterniond q(Eigen::AngleAxisd(turn_rad, axis));
        world_.add_collider({.name = name, .shape = shape, .pose = {at, {q.w(), q.x(), q.y(), q.z()}}, .friction = 0.8});
        colors_.push_back(color);
    }

    void build_course() {
        const std::array<float, 3> wood{0.72f, 0.52f, 0.32f}, stone{0.55f, 0.60f, 0.66f}, grass{0.45f, 0.62f, 0.36f};
        add_fixed("low plank", BoxShape{Vec3(0.03, 0.009, 0.16)}, Vec3(-0.28, 0.009, -0.06), 0.15, Vec3(0, 1, 0), wood);
        add_fixed("high plank", BoxShape{Vec3(0.03, 0.014, 0.16)}, Vec3(-0.12, 0.014, -0.06), -0.1, Vec3(0, 1, 0), wood);
        for (const auto& [x, z, r] : {std::array{0.24, 0.06, 0.08}, std::array{0.35, 0.20, 0.09}, std::array{0.36, 0.10, 0.06}, std::array{0.47, 0.22, 0.07}, std::array{0.45, 0.33, 0.08}})
            add_fixed("bump", SphereShape{r}, Vec3(x, 0.028 - r, z), 0, Vec3(0, 1, 0), stone);
        // A ramp whose upper side goes from the ground to the ledge.
        const double begin = 0.68, end = 1.05, slope = std::atan2(kLedge_m, end - begin), half = 0.5 * std::hypot(end - begin, kLedge_m);
        const Vec3 top(0.5 * (begin + end), 0.5 * kLedge_m, 0.34);
        add_fixed("ramp", BoxShape{Vec3(half, 0.02, 0.14)}, top - 0.02 * Vec3(-std::sin(slope), std::cos(slope), 0), slope, Vec3(0, 0, 1), wood);
        add_fixed("ledge", BoxShape{Vec3(0.15, 0.5 * kLedge_m, 0.14)}, Vec3(end + 0.145, 0.5 * kLedge_m, 0.34), 0, Vec3(0, 1, 0), grass);
    }

    BodyId add_creature() {
        BodyDef def;
        def.name = "creature";
        def.shape = BodyTemplate::build(io::read_mesh(find_asset("creature.msh")));
        def.skin = Skin::build(def.shape->mesh(), io::read_surface(find_asset("creature.ply")));
        def.material = Corotational{.young_pa = 1.2e5, .poisson = 0.43};
        def.density_kg_m3 = 1000;
        def.friction = 0.8;
        double low = 1e9;
        for (const Vec3& x : def.shape->mesh().vertices) low = std::min(low, x.y());
        const Vec3 start = route().points_m[0];
        def.translation_m = Vec3(start.x(), kClear_m - low, start.z());
        return world_.add_body(def);
    }

    BodyId add_ball(const Vec3& at, double radius_m) {
        BodyDef def;
        def.name = "ball";
        def.shape = BodyTemplate::build(stuff_isosurface([&](const Vec3& p) { return p.norm() - radius_m; },
                                                         {.min_m = Vec3::Constant(-1.4 * radius_m), .max_m = Vec3::Constant(1.4 * radius_m), .edge_m = 0.022}));
        def.material = Corotational{.young_pa = 5e4, .poisson = 0.4};
        def.density_kg_m3 = 120;
        def.friction = 0.5;
        def.translation_m = at;
        return world_.add_body(def);
    }

    BodyId add_cushion() {
        const Vec3 half(0.20, 0.045, 0.17);
        BodyDef def;
        def.name = "cushion";
        def.shape = BodyTemplate::build(stuff_isosurface([&](const Vec3& p) { return rounded_box(p, half, 0.035); }, {.min_m = -1.2 * half, .max_m = 1.2 * half, .edge_m = 0.05}));
        def.material = Corotational{.young_pa = 1.2e4, .poisson = 0.3};
        def.density_kg_m3 = 300;
        def.friction = 1;
        def.translation_m = kCushion + Vec3(0, half.y(), 0);
        return world_.add_body(def);
    }

    void dress(FrameView& view) {
        const std::size_t bodies = world_.bodies().size();
        const bool plain = !view.scale;
        const std::array<std::array<float, 3>, 3> own{{{0.42f, 0.66f, 0.52f}, {0.92f, 0.34f, 0.26f}, {0.86f, 0.66f, 0.86f}}};
        for (std::size_t b = 0; b < bodies; ++b) {
            view.surfaces[b].look = b == 2 ? Look::gel : Look::rubber;
            if (plain) view.surfaces[b].color = own[b];
        }
        for (std::size_t c = 0; c < colors_.size() && bodies + c < view.surfaces.size(); ++c) {
            view.surfaces[bodies + c].look = Look::rubber;
            view.surfaces[bodies + c].color = colors_[c];
        }
        eyes_->deform(world_.positions(creature_), eye_positions_);
        for (const Vec3& x : eye_positions_) view.markers.push_back({x, kEye_m, {0.05f, 0.05f, 0.06f}});
    }

    World world_;
    BodyId creature_, ball_, cushion_;
    std::optional<CreatureWalk> walk_;
    std::optional<Embedding> eyes_;
    std::vector<Vec3> eye_positions_;
    std::vector<std::array<float, 3>> colors_;  ///< of the course, in the order of its colliders
    double arrived_s_ = 0;
    Vec3 target_;
};

const RegisterDemo demo({"creature", "a soft creature is steered over planks, bumps and a ramp and leaps onto a cushion, at 60 steps a second (a game)",
                         [](const ShowOptions& options) { return std::make_unique<Creature>(options); }});

}  // namespace
}  // namespace supple::demos
