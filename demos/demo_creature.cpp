// A game-like scene: a soft creature is steered over planks and bumps, between rubber posts, up a ramp, and leaps from a ledge onto a cushion. 60 steps a second.
// Its mesh is a cage that stands off its skin by a finger's breadth, and contact is the cage's. So everything that it may touch is computed that much lower or
// thinner than it is drawn: skin meets skin.
#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "creature_walk.h"
#include "demo.h"
#include "drawn_shapes.h"
#include "open_show.h"
#include "supple/contact/shape_surface.h"
#include "supple/io/mesh_file.h"
#include "supple/io/surface_file.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/isosurface_stuffing.h"
#include "supple/mesh/surface.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kEye_m = 0.012;
constexpr double kLedge_m = 0.09;
const std::vector<Vec3> kEyes{Vec3(0.149, 0.167, 0.040), Vec3(0.149, 0.167, -0.040)};
const Vec3 kCushion(1.66, 0, 0.34);
constexpr double kStandOff_m = 0.0165;  // of the cage's soles from those of its skin, and a little more: tied soles must not quarrel with what they stand on
constexpr double kGoal_m = 0.25;  // it has arrived where its middle is so near to that of the cushion

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 60;
    def.solver.cg_relative_tolerance = 1e-3;  // of a game
    def.solver.contact_iterations = 30;
    def.solver.rayleigh_mass_1_s = 1;
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
        build_course();
        creature_ = add_creature();
        cushion_ = add_cushion();
        for (const auto& [x, z] : {std::array{0.0120, 0.0935}, std::array{0.0880, -0.0735}}) add_post(Vec3(x, 0, z));
        walk_.emplace(world_, creature_, route(), ground_, CreatureWalk::Def{});
        eyes_.emplace(world_.shape(creature_).mesh(), kEyes);
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
            if (world_.time_s() > arrived_s_ + 0.7) walk_->leap(Vec3(1.50, 1.75, 0), 0.12);
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
            view.caption = walk_->way_m() < 0.62 ? "A soft creature trots over planks and squeezes through a gate" : "Over bumps and up a ramp";
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
        const Pose pose{at, {q.w(), q.x(), q.y(), q.z()}};
        world_.add_collider({.name = name, .shape = shape, .pose = {at - Vec3(0, kStandOff_m, 0), pose.rotation_wxyz}, .friction = 0});  // feet are tied; a belly slides
        ground_.push_back({shape, pose});
        if (std::holds_alternative<PlaneShape>(shape)) return;
        const contact::ShapeSurface drawn = contact::surface_of(shape, 1);
        mesh::TriangleMesh surface{drawn.vertices, drawn.triangles};
        for (Vec3& x : surface.vertices) x = at + q * x;
        course_.surface(std::move(surface), color, Look::rubber);
    }

    void build_course() {
        const std::array<float, 3> wood{0.72f, 0.52f, 0.32f}, stone{0.55f, 0.60f, 0.66f}, grass{0.45f, 0.62f, 0.36f};
        add_fixed("ground", PlaneShape{}, Vec3::Zero(), 0, Vec3(0, 1, 0), stone);
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
        for (const Vec3& x : def.skin->surface().vertices) low = std::min(low, x.y());
        const Vec3 start = route().points_m[0];
        def.translation_m = Vec3(start.x(), -low, start.z());
        return world_.add_body(def);
    }

    /// A body on a foot that is fixed, with a skin that stands off its mesh as the creature's cage does off its skin.
    BodyId add_soft(const char* name, VolumeMesh mesh, ImplicitShape drawn, const Vec3& reach, double skin_edge_m, const Vec3& at, double young_pa, double friction) {
        const VolumeMesh solid = stuff_isosurface(drawn, {.min_m = -reach, .max_m = reach, .edge_m = skin_edge_m});
        BodyDef def;
        def.name = name;
        def.shape = BodyTemplate::build(std::move(mesh));
        def.skin = Skin::build(def.shape->mesh(), {solid.vertices, extract_boundary(solid).triangles});
        def.material = Corotational{.young_pa = young_pa, .poisson = 0.35};
        def.density_kg_m3 = 400;
        def.friction = friction;
        def.translation_m = at;
        const BodyId id = world_.add_body(def);
        double low = 1e9;
        for (const Vec3& x : world_.positions(id)) low = std::min(low, x.y());
        world_.fix(id, InsideBox{{-9, -9, -9}, {9, low + 0.004, 9}});
        return id;
    }

    BodyId add_cushion() {
        const Vec3 drawn(0.25, 0.05, 0.20), inner = drawn - Vec3::Constant(kStandOff_m);
        return add_soft("cushion", stuff_isosurface([&](const Vec3& p) { return rounded_box(p, inner, 0.02); }, {.min_m = -1.2 * drawn, .max_m = 1.2 * drawn, .edge_m = 0.05}),
                        [&](const Vec3& p) { return rounded_box(p, drawn, 0.035); }, 1.2 * drawn, 0.012, kCushion + Vec3(0, drawn.y(), 0), 1e4, 0.8);
    }

    void add_post(const Vec3& at) {
        const double height = 0.13, radius = 0.030;
        const Vec3 half(radius - kStandOff_m + 0.001, 0.5 * height - kStandOff_m, radius - kStandOff_m + 0.001);
        add_soft("post", make_tet_box({.min_m = -half, .max_m = half, .cells = {2, 6, 2}}),
                 [&](const Vec3& p) { return (p - Vec3(0, std::clamp(p.y(), -0.5 * height + 0.008, 0.5 * height - radius), 0)).norm() - radius; },
                 Vec3(1.3 * radius, 0.6 * height, 1.3 * radius), 0.007, at + Vec3(0, 0.5 * height, 0), 8e4, 0);
    }

    void dress(FrameView& view) {
        const std::size_t bodies = world_.bodies().size();
        const bool plain = !view.scale;
        const std::array<std::array<float, 3>, 3> own{{{0.42f, 0.66f, 0.52f}, {0.86f, 0.62f, 0.84f}, {0.95f, 0.55f, 0.25f}}};
        for (std::size_t b = 0; b < bodies; ++b) {
            view.surfaces[b].look = Look::rubber;
            if (plain) view.surfaces[b].color = own[std::min<std::size_t>(b, 2)];
        }
        view.surfaces.resize(bodies);  // the colliders lie lower than what they stand for
        course_.add_to(view);
        view.ground_height_m = 0;
        if (edits_ != world_.edit_count(creature_)) {  // a hand in the window has cut it: other vertices, the same rest shape
            eyes_.emplace(world_.shape(creature_).mesh(), kEyes);
            edits_ = world_.edit_count(creature_);
        }
        eyes_->deform(world_.positions(creature_), eye_positions_);
        for (const Vec3& x : eye_positions_) view.markers.push_back({x, kEye_m, {0.05f, 0.05f, 0.06f}});
    }

    World world_;
    BodyId creature_, cushion_;
    std::optional<CreatureWalk> walk_;
    std::optional<Embedding> eyes_;
    std::vector<Vec3> eye_positions_;
    std::uint64_t edits_ = 0;  ///< of the creature
    std::vector<Foothold> ground_;
    DrawnShapes course_;
    double arrived_s_ = 0;
    Vec3 target_;
};

const RegisterDemo demo({"creature", "a soft creature is steered over planks, bumps and a ramp, between rubber posts, and leaps onto a cushion, at 60 steps a second (a game)",
                         [](const ShowOptions& options) { return std::make_unique<Creature>(options); }});

}  // namespace
}  // namespace supple::demos
