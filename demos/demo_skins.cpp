// Three cooked assets under their fine skins: the simulation moves a few thousand tets each, what is drawn, touched and pulled is the skin.
#include <cmath>

#include "demo.h"
#include "framing.h"
#include "open_show.h"
#include "supple/io/mesh_file.h"
#include "supple/io/skin_file.h"
#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kCreatureScale = 0.42;
const Vec3 kLiver_m(-0.27, 0.20, 0), kCreature_m(0, 0, 0), kKidney_m(0.22, 0.20, 0);

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.isa = options.isa;
    def.time_step_s = 1.0 / 120;
    def.solver.rayleigh_mass_1_s = 0.4;
    def.solver.rayleigh_stiffness_s = 0.002;
    return def;
}

/// A tool that goes to `path` over a second and stays there until it lets go.
Touch pull(double begin_s, const Ray& ray, double radius_m, const Vec3& path, std::string caption) {
    Touch touch;
    touch.begin_s = begin_s;
    touch.end_s = begin_s + 1.9;
    touch.ray = ray;
    touch.radius_m = radius_m;
    touch.tool_radius_m = 0.008;
    touch.pushes = false;
    touch.caption = std::move(caption);
    for (int i = 0; i <= 8; ++i) {
        touch.displacement_m.times_s.push_back(1.2 * i / 8.0);
        touch.displacement_m.values.push_back(smooth_step(0, 1, i / 8.0) * path);
    }
    return touch;
}

std::vector<Touch> touches() {
    const Vec3 back(0, 0, -1);
    return {pull(2.2, {kLiver_m + Vec3(-0.055, -0.030, 0.5), back}, 0.020, Vec3(-0.010, -0.035, 0.050), "A liver of 9,000 tets with stiffer vessels, pulled at its skin"),
            pull(5.0, {kCreature_m + Vec3(0, 0.115, 0.5), back}, 0.025, Vec3(0.050, 0.020, 0.030), "A creature of 5,000 tets, pulled by its snout"),
            pull(7.8, {kKidney_m + Vec3(0, -0.030, 0.5), back}, 0.015, Vec3(0.030, -0.030, 0.020), "A kidney of 4,000 tets")};
}

class Skins : public Show {
public:
    explicit Skins(const ShowOptions& options) : world_(world_def(options)), script_(world_, touches(), 0.06, 2.0) {
        BodyDef liver = asset("liver_vessels", 1, Corotational{.young_pa = 5e3, .poisson = 0.45}, kLiver_m);
        liver.regions = {{.where = InGroup{"vessels"}, .stiffness_factor = 12}};
        world_.fix(world_.add_body(liver), InsideBox{Vec3(-0.08, 0.030, -0.2), Vec3(0.056, 0.2, -0.010)});
        const BodyDef creature = asset("creature", kCreatureScale, StableNeoHookean{.mu_pa = 4e3, .lambda_pa = 3e4}, kCreature_m);
        world_.fix(world_.add_body(creature), InsideBox{Vec3(-1, -1, -1), Vec3(1, 0.012, 1)});
        const BodyDef kidney = asset("kidney", 1, Corotational{.young_pa = 8e3, .poisson = 0.45}, kKidney_m);
        world_.fix(world_.add_body(kidney), InsideBox{Vec3(-1, 0.046, -1), Vec3(1, 1, 1)});
        camera_ = frame_camera(bounds_of(world_), Vec3(0.10, 0.16, 1), 30);
        camera_.eye_m = camera_.target_m + 0.80 * (camera_.eye_m - camera_.target_m);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 11; }
    ColorBy color_by() const override { return ColorBy::nothing; }
    void before_step() override { script_.before_step(); }

    void decorate(FrameView& view) override {
        view.camera = camera_;
        view.camera.eye_m += Vec3(0.05 * std::sin(0.5 * world_.time_s()), 0, 0);
        view.ground_height_m = 0;
        view.surfaces[0].look = Look::tissue;
        view.surfaces[1].look = Look::rubber;
        view.surfaces[1].color = {0.93f, 0.60f, 0.36f};
        view.surfaces[2].look = Look::tissue;
        view.surfaces[2].color = {0.56f, 0.22f, 0.18f};
        if (world_.time_s() < 2.2) view.caption = "Cooked from fine surfaces: a few thousand tets move skins of tens of thousands of triangles";
        script_.decorate(view);
    }

private:
    static BodyDef asset(const std::string& name, double scale, const Material& material, const Vec3& place_m) {
        BodyDef def;
        def.name = name;
        def.shape = BodyTemplate::build(io::read_mesh(find_asset(name + ".msh")), scale);
        mesh::TriangleMesh surface = io::read_skin_surface(find_asset(name + "_skin.ply"));
        for (Vec3& x : surface.vertices) x *= scale;
        def.skin = Skin::build(def.shape->mesh(), surface);
        def.material = material;
        def.density_kg_m3 = 1050;
        def.translation_m = place_m;
        return def;
    }

    World world_;
    TouchScript script_;
    Camera camera_;
};

const RegisterDemo demo({"skins", "a liver, a creature and a kidney, cooked from fine surfaces and moved under them as skins",
                         [](const ShowOptions& options) { return std::make_unique<Skins>(options); }});

}  // namespace
}  // namespace supple::demos
