// Skins: surfaces of tens of thousands of triangles, each moved by a mesh of a few thousand elements that our own cook made of it. Organs with what lies inside of
// them, a block of gel with a ball in it, a creature; pressed, pushed and pulled by its tail. The meshes behind the skins are shown on the way.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "demo.h"
#include "framing.h"
#include "open_show.h"
#include "supple/io/mesh_file.h"
#include "supple/io/surface_file.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kSettled_s = 1.8, kMeshes_s = 6.2, kPan_s = 7.8, kArrived_s = 9.2, kStress_s = 11.0, kEnd_s = 16;
constexpr double kCreature_m = 0.64, kEye_m = 0.012;

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.contact_iterations = 30;  // two dozen vertices under a ball that moves
    def.solver.rayleigh_mass_1_s = 0.6;
    def.solver.rayleigh_stiffness_s = 0.003;
    return def;
}

/// Points or a surface that go with a body and are no skin: a vessel under the surface, an eye.
struct Passenger {
    BodyId body;
    mesh::TriangleMesh surface;
    Embedding embedding;
    std::vector<Vec3> positions;
    std::array<float, 3> color{};
    std::uint64_t edits = 0;

    Passenger(const World& world, BodyId id, mesh::TriangleMesh s, std::array<float, 3> c)
        : body(id), surface(std::move(s)), embedding(world.shape(id).mesh(), surface.vertices), positions(surface.vertices.size()), color(c) {}
    void move(const World& world) {
        if (edits != world.edit_count(body)) {  // a hand in the window has cut it: other vertices, the same rest shape
            embedding = Embedding(world.shape(body).mesh(), surface.vertices);
            edits = world.edit_count(body);
        }
        embedding.deform(world.positions(body), positions);
    }
};

struct Piece {
    const char* asset;
    double young_pa;
    double x_m, z_m, drop_m;  ///< where it falls from, above the table
    bool lies;                ///< on its back instead of upright: its z goes up
    Look look;
    std::array<float, 3> color;
};

class Skins : public Show {
public:
    explicit Skins(const ShowOptions& options) : world_(world_def(options)), script_(world_, {}, 0.05, 3.0) {
        world_.add_collider({.name = "table", .shape = PlaneShape{}, .friction = 0.5});
        liver_ = add({"liver_vessels", 1.2e4, -0.26, -0.02, 0.02, false, Look::tissue, {0.62f, 0.26f, 0.22f}},
                     {{.where = InGroup{"portal"}, .stiffness_factor = 8}, {.where = InGroup{"hepatic"}, .stiffness_factor = 8}});
        kidney_ = add({"kidney", 1.5e4, -0.06, -0.01, 0.03, true, Look::tissue, {0.56f, 0.24f, 0.20f}}, {});
        gallbladder_ = add({"gallbladder", 1.2e4, 0.075, 0.0, 0.03, true, Look::tissue, {0.47f, 0.53f, 0.27f}}, {});
        gel_ = add({"gel", 1.2e4, 0.35, 0.03, 0.03, false, Look::gel, {0.45f, 0.72f, 0.86f}}, {{.where = InGroup{"inclusion"}, .stiffness_factor = 10}});
        creature_ = add({"creature", 1.5e5, kCreature_m, 0.0, 0.02, false, Look::rubber, {0.42f, 0.62f, 0.52f}}, {});
        inside_.emplace_back(world_, liver_, surface("liver_vessels.portal.ply"), std::array<float, 3>{0.25f, 0.42f, 0.95f});
        inside_.emplace_back(world_, liver_, surface("liver_vessels.hepatic.ply"), std::array<float, 3>{0.50f, 0.20f, 0.70f});
        inside_.emplace_back(world_, gel_, surface("gel.inclusion.ply"), std::array<float, 3>{0.95f, 0.55f, 0.20f});
        eyes_.emplace(world_, creature_, mesh::TriangleMesh{{Vec3(0.149, 0.167, 0.040), Vec3(0.149, 0.167, -0.040)}, {}}, std::array<float, 3>{0.05f, 0.05f, 0.06f});
        add_tools();
        script_ = TouchScript(world_, touches(), 0.06, 3.0);
    }

    World& world() override { return world_; }
    double duration_s() const override { return kEnd_s; }
    void before_step() override { script_.before_step(); }
    void let_go() override { script_.let_go(); }
    ColorBy color_by() const override { return world_.time_s() < kStress_s ? ColorBy::nothing : ColorBy::stress; }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        const double s = smooth_step(kPan_s, kArrived_s, t);
        view.camera.fov_deg = 30;
        view.camera.target_m = (1 - s) * Vec3(-0.11, 0.035, 0.01) + s * Vec3(0.58, 0.09, 0);
        view.camera.eye_m = view.camera.target_m + (1 - s) * Vec3(0.02 * std::sin(0.3 * t), 0.35, 0.44) + s * Vec3(0.40 + 0.02 * std::sin(0.3 * t), 0.26, 0.66);
        view.key_light = Vec3(-0.45, 1, 0.7);
        const bool meshes = t >= kMeshes_s && t < kPan_s;
        const std::vector<BodyId> bodies = world_.bodies();
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            SurfaceView& surface = view.surfaces[b];
            surface.look = pieces_[b].look;
            if (view.scale == std::nullopt) surface.color = pieces_[b].color;
            if (meshes) {  // what is computed instead of what is drawn
                const BoundarySurface& boundary = world_.shape(bodies[b]).boundary();
                surface.positions = world_.positions(bodies[b]);
                surface.reference_positions = world_.shape(bodies[b]).mesh().vertices;
                surface.triangles = boundary.triangles;
                surface.edges = boundary.edges;
            }
        }
        if (view.scale) view.scale->high = 5000;
        if (!meshes && !view.scale) {
            for (const auto& [body, opacity] : {std::pair{liver_, 0.5}, std::pair{gel_, 0.4}})
                for (std::size_t b = 0; b < bodies.size(); ++b)
                    if (bodies[b] == body) view.surfaces[b].opacity = opacity;
            for (Passenger& p : inside_) {
                p.move(world_);
                SurfaceView inner;
                inner.positions = p.positions;
                inner.triangles = p.surface.triangles;
                inner.look = Look::rubber;
                inner.color = p.color;
                view.surfaces.push_back(inner);
            }
        }
        eyes_->move(world_);
        for (const Vec3& x : eyes_->positions) view.markers.push_back({x, kEye_m, eyes_->color});
        script_.decorate(view);
        if (t < kSettled_s) view.caption = "Fine skins, each moved by a coarse mesh cooked from it";
        else if (t < kMeshes_s) view.caption = "Pressed and pushed; vessels stiffen the liver where they run";
        else if (t < kPan_s) view.caption = counts_;
        else if (t < kStress_s) view.caption = "Gel with a hard ball in it, and a creature in a cage of tetrahedra";
        else if (t < 14.2) view.caption = "Pulled by its tail, pressed on its head: stress on the skin";
        else view.caption = "Let go";
    }

private:
    static mesh::TriangleMesh surface(const std::string& name) { return io::read_surface(find_asset(name)); }

    BodyId add(const Piece& piece, std::vector<MaterialRegion> regions) {
        const std::string name = piece.asset;
        BodyDef def;
        def.name = name;
        VolumeMesh mesh = io::read_mesh(find_asset(name + ".msh"));
        mesh::TriangleMesh skin = surface(name + ".ply");
        if (piece.lies)
            for (auto* points : {&mesh.vertices, &skin.vertices})
                for (Vec3& x : *points) x = Vec3(x.x(), x.z(), -x.y());
        def.shape = BodyTemplate::build(std::move(mesh));
        def.skin = Skin::build(def.shape->mesh(), skin);
        def.material = Corotational{.young_pa = piece.young_pa, .poisson = 0.43};
        def.density_kg_m3 = 1050;
        def.regions = std::move(regions);
        double low = 1e9;
        for (const Vec3& x : def.shape->mesh().vertices) low = std::min(low, x.y());
        def.translation_m = Vec3(piece.x_m, piece.drop_m - low, piece.z_m);
        pieces_.push_back(piece);
        triangles_ += def.skin->surface().triangles.size();
        elements_ += def.shape->mesh().element_count();
        char text[120];
        std::snprintf(text, sizeof text, "What is computed: %zu elements under %zu triangles", elements_, triangles_);
        counts_ = text;
        return world_.add_body(def);
    }

    /// A ball that goes over the organs, one that presses the gel, one that pats the creature's head.
    void add_tools() {
        const auto ball = [&](const char* name, double radius_m, std::initializer_list<std::pair<double, Vec3>> stops) {
            ColliderDef tool;
            tool.name = name;
            tool.shape = SphereShape{radius_m};
            tool.friction = 0.2;
            tool.motion = ColliderMotion::kinematic;
            const std::pair<double, Vec3>* last = nullptr;
            for (const auto& stop : stops) {
                for (int i = 1; last != nullptr && i < 8; ++i) {
                    tool.keys.times_s.push_back(last->first + (stop.first - last->first) * i / 8);
                    tool.keys.positions_m.push_back(last->second + smooth_step(0, 1, i / 8.0) * (stop.second - last->second));
                }
                tool.keys.times_s.push_back(stop.first);
                tool.keys.positions_m.push_back(stop.second);
                last = &stop;
            }
            world_.add_collider(tool);
        };
        ball("finger", 0.013, {{0, {-0.28, 0.26, -0.03}}, {1.6, {-0.285, 0.18, -0.03}}, {2.3, {-0.285, 0.065, -0.03}}, {2.9, {-0.285, 0.065, -0.03}}, {3.3, {-0.20, 0.15, 0.0}},
                               {3.7, {-0.07, 0.10, -0.01}}, {4.2, {-0.065, 0.037, -0.01}}, {4.6, {-0.065, 0.037, -0.01}}, {4.9, {-0.03, 0.08, 0.02}}, {5.2, {0.025, 0.018, 0.02}},
                               {6.0, {0.075, 0.018, 0.02}}, {6.5, {-0.02, 0.14, 0.06}}, {7.4, {-0.06, 0.26, 0.06}}});
        ball("press", 0.020, {{0, {0.35, 0.26, 0.03}}, {9.0, {0.35, 0.20, 0.03}}, {10.0, {0.34, 0.078, 0.03}}, {10.6, {0.34, 0.078, 0.03}}, {11.3, {0.34, 0.24, 0.0}}});
        ball("hand", 0.020, {{0, {0.75, 0.42, 0}}, {12.6, {0.75, 0.36, 0}}, {13.3, {0.74, 0.21, 0}}, {13.8, {0.74, 0.21, 0}}, {14.3, {0.76, 0.40, 0}}});
    }

    std::vector<Touch> touches() const {
        Touch pull;
        pull.begin_s = 11.0;
        pull.end_s = 12.8;
        pull.ray = {Vec3(kCreature_m - 0.174, 0.5, 0), Vec3(0, -1, 0)};
        pull.radius_m = 0.02;
        pull.tool_radius_m = 0.009;
        pull.pushes = false;
        for (int i = 0; i <= 8; ++i) {
            pull.displacement_m.times_s.push_back(1.4 * i / 8.0);
            pull.displacement_m.values.push_back(smooth_step(0, 1, i / 8.0) * Vec3(-0.045, 0.04, 0.03));
        }
        return {pull};
    }

    World world_;
    TouchScript script_;
    BodyId liver_, kidney_, gallbladder_, gel_, creature_;
    std::vector<Piece> pieces_;
    std::vector<Passenger> inside_;
    std::optional<Passenger> eyes_;
    std::size_t triangles_ = 0, elements_ = 0;
    std::string counts_;
};

const RegisterDemo demo({"skins", "organs, a gel and a creature: fine skins over coarse meshes that our own cook made, under contact and drag",
                         [](const ShowOptions& options) { return std::make_unique<Skins>(options); }});

}  // namespace
}  // namespace supple::demos
