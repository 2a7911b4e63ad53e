// Ten different bodies fall into a tray and on one another: contact of soft bodies, friction, a heap that comes to rest.
#include <cmath>

#include "demo.h"
#include "framing.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/isosurface_stuffing.h"

namespace supple::demos {
namespace {

constexpr double kEdge_m = 0.016;
constexpr double kTray_m = 0.14, kWall_m = 0.006;  // half its inner width, half the thickness of its walls
constexpr double kReach_m = 0.07;  // every shape lies within it around its middle

double ball(const Vec3& p, double radius) { return p.norm() - radius; }
double capsule(const Vec3& p, double half, double radius) { return (p - Vec3(std::clamp(p.x(), -half, half), 0, 0)).norm() - radius; }
double ring(const Vec3& p, double radius, double thickness) { return std::hypot(std::hypot(p.x(), p.z()) - radius, p.y()) - thickness; }
double rounded_box(const Vec3& p, const Vec3& half, double radius) {
    const Vec3 d = p.cwiseAbs() - (half - Vec3::Constant(radius));
    return d.cwiseMax(0.0).norm() + std::min(d.maxCoeff(), 0.0) - radius;
}
double both(double a, double b, double round_m) {  // smooth union (polynomial)
    const double h = std::max(round_m - std::abs(a - b), 0.0) / round_m;
    return std::min(a, b) - h * h * round_m / 4;
}

VolumeMesh fill(ImplicitShape shape) {
    return stuff_isosurface(shape, {.min_m = Vec3::Constant(-kReach_m), .max_m = Vec3::Constant(kReach_m), .edge_m = kEdge_m});
}

struct Piece {
    const char* name;
    VolumeMesh mesh;
    double young_pa, density_kg_m3;
    std::array<float, 3> color;
    Look look;
};

std::vector<Piece> pieces() {
    std::vector<Piece> list;
    list.push_back({"blob", fill([](const Vec3& p) {
                        return both(both(ball(p - Vec3(0.02, 0.01, 0), 0.032), ball(p + Vec3(0.022, 0, 0.01), 0.028), 0.02), ball(p - Vec3(0, -0.012, 0.026), 0.024), 0.02);
                    }),
                    2e4, 1000, {0.85f, 0.55f, 0.62f}, Look::gel});
    list.push_back({"ball", fill([](const Vec3& p) { return ball(p, 0.045); }), 6e4, 900, {0.86f, 0.28f, 0.24f}, Look::rubber});
    list.push_back({"cushion", fill([](const Vec3& p) { return rounded_box(p, Vec3(0.06, 0.022, 0.05), 0.018); }), 3e4, 600, {0.95f, 0.76f, 0.35f}, Look::rubber});
    list.push_back({"ring", fill([](const Vec3& p) { return ring(p, 0.042, 0.018); }), 8e4, 800, {0.24f, 0.55f, 0.80f}, Look::rubber});
    list.push_back({"sausage", fill([](const Vec3& p) { return capsule(p, 0.04, 0.02); }), 5e4, 950, {0.78f, 0.42f, 0.34f}, Look::tissue});
    list.push_back({"egg", fill([](const Vec3& p) { return (p.cwiseQuotient(Vec3(0.055, 0.036, 0.036)).norm() - 1) * 0.036; }), 4e4, 1000, {0.93f, 0.90f, 0.82f}, Look::gel});
    list.push_back({"dumbbell", fill([](const Vec3& p) {
                        const double ends = std::min(ball(p - Vec3(0.036, 0, 0), 0.027), ball(p + Vec3(0.036, 0, 0), 0.027));
                        return both(ends, capsule(p, 0.036, 0.014), 0.01);
                    }),
                    7e4, 900, {0.45f, 0.66f, 0.35f}, Look::rubber});
    list.push_back({"star", fill([](const Vec3& p) {
                        double d = ball(p, 0.02);
                        for (int i = 0; i < 5; ++i) {
                            const double a = 2 * 3.14159265358979 * i / 5;
                            const Vec3 along(std::cos(a), 0, std::sin(a));
                            d = both(d, (p - std::clamp(p.dot(along), 0.0, 0.046) * along).norm() - 0.015, 0.012);
                        }
                        return d;
                    }),
                    6e4, 900, {0.70f, 0.45f, 0.75f}, Look::rubber});
    list.push_back({"die", make_tet_box({.min_m = Vec3::Constant(-0.032), .max_m = Vec3::Constant(0.032), .cells = {5, 5, 5}}), 1e5, 900, {0.25f, 0.62f, 0.62f}, Look::rubber});
    list.push_back({"brick", make_hex_box({.min_m = Vec3(-0.055, -0.02, -0.03), .max_m = Vec3(0.055, 0.02, 0.03), .cells = {8, 3, 4}}), 1e5, 1000, {0.80f, 0.52f, 0.30f}, Look::rubber});
    return list;
}

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.cg_relative_tolerance = 1e-3;
    def.solver.rayleigh_mass_1_s = 0.5;
    def.solver.rayleigh_stiffness_s = 0.002;
    return def;
}

class Heap : public Show {
public:
    explicit Heap(const ShowOptions& options) : world_(world_def(options)) {
        world_.add_collider({.name = "table", .shape = PlaneShape{}, .friction = 0.4});
        for (const double side : {-1.0, 1.0}) {
            const double at = side * (kTray_m + kWall_m);
            world_.add_collider({.name = "wall", .shape = BoxShape{Vec3(kWall_m, 0.035, kTray_m + 2 * kWall_m)}, .pose = {{at, 0.035, 0}, {1, 0, 0, 0}}, .friction = 0.3});
            world_.add_collider({.name = "wall", .shape = BoxShape{Vec3(kTray_m, 0.035, kWall_m)}, .pose = {{0, 0.035, at}, {1, 0, 0, 0}}, .friction = 0.3});
        }
        double height = 0.08;
        int i = 0;
        for (Piece& piece : pieces()) {
            BodyDef def;
            def.name = piece.name;
            def.shape = BodyTemplate::build(std::move(piece.mesh));
            def.material = Corotational{.young_pa = piece.young_pa, .poisson = 0.42};
            def.density_kg_m3 = piece.density_kg_m3;
            def.friction = 0.4;
            const double turn = 2.4 * i;  // the golden angle: no two above one another
            def.translation_m = Vec3(0.025 * std::cos(turn), height, 0.025 * std::sin(turn));
            def.velocity_m_s = Vec3(0, -0.5, 0);
            world_.add_body(def);
            colors_.push_back(piece.color);
            looks_.push_back(piece.look);
            height += 0.105;
            ++i;
        }
        SceneBounds bounds;
        bounds.include(Vec3(-0.15, 0, -0.15));
        bounds.include(Vec3(0.15, 0.2, 0.15));
        camera_ = frame_camera(bounds, Vec3(0.35, 0.6, 1), 34);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 7; }
    ColorBy color_by() const override { return world_.time_s() > 4.5 ? ColorBy::stress : ColorBy::nothing; }

    void decorate(FrameView& view) override {
        view.camera = camera_;
        if (color_by() == ColorBy::nothing) {
            for (std::size_t i = 0; i < std::min(view.surfaces.size(), colors_.size()); ++i) {
                view.surfaces[i].look = looks_[i];
                view.surfaces[i].color = colors_[i];
            }
        }
        if (view.scale) view.scale->high = 3000;
        view.caption = color_by() == ColorBy::stress ? "Where they press one another: von Mises stress"
                       : world_.time_s() < 2.5       ? "Ten soft bodies fall on one another"
                                                     : "The heap comes to rest: contact and friction in one implicit system";
    }

private:
    World world_;
    std::vector<std::array<float, 3>> colors_;
    std::vector<Look> looks_;
    Camera camera_;
};

const RegisterDemo demo({"heap", "ten different soft bodies fall on one another and come to rest in a heap",
                         [](const ShowOptions& options) { return std::make_unique<Heap>(options); }});

}  // namespace
}  // namespace supple::demos
