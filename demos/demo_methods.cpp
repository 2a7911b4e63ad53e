// Five ways to follow a rotation, one beam each, side by side: what small displacements do when they are not small, and what each frame costs.
#include <cstdio>

#include "demo.h"
#include "framing.h"
#include "supple/mesh/box_mesh.h"

namespace supple::demos {
namespace {

constexpr double kYoung_pa = 1e5, kPoisson = 0.35;
constexpr double kSide_m = 0.05, kLength_m = 0.4, kGap_m = 0.13;

struct Method {
    const char* name;
    Material material;
    bool hexes;
};

std::vector<Method> methods() {
    const auto turned = [](Rotation rotation) { return Corotational{.rotation = rotation, .young_pa = kYoung_pa, .poisson = kPoisson}; };
    return {{"linear", Linear{.young_pa = kYoung_pa, .poisson = kPoisson}, false},
            {"edge frame", turned(Rotation::large), false},
            {"polar", turned(Rotation::polar), false},
            {"SVD", turned(Rotation::svd), false},
            {"hexahedra, polar", turned(Rotation::polar), true}};
}

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.time_step_s = 1.0 / 120;
    def.gravity_m_s2 = Vec3::Zero();
    def.solver.rayleigh_mass_1_s = 2;
    return def;
}

class Methods : public Show {
public:
    explicit Methods(const ShowOptions& options) : world_(world_def(options)), methods_(methods()) {
        BoxDef box{.min_m = Vec3(0, -kSide_m / 2, -kSide_m / 2), .max_m = Vec3(kLength_m, kSide_m / 2, kSide_m / 2), .cells = {32, 4, 4}};
        const auto tets = BodyTemplate::build(make_tet_box(box)), hexes = BodyTemplate::build(make_hex_box(box));
        for (std::size_t i = 0; i < methods_.size(); ++i) {
            BodyDef def;
            def.name = methods_[i].name;
            def.shape = methods_[i].hexes ? hexes : tets;
            def.material = methods_[i].material;
            def.translation_m = Vec3(0, 0, offset(i));
            const BodyId body = world_.add_body(def);
            world_.fix(body, InsideBox{Vec3(-1, -1, -1), Vec3(1e-9, 1, 1)});
            Load load;
            load.where = InsideBox{Vec3(kLength_m - 1e-9, -1, -1), Vec3(1, 1, 1)};
            load.value.times_s = {0.5, 4, 6, 6.2};
            load.value.values = {Vec3::Zero(), Vec3(0, 1.3, 0), Vec3(0, 1.3, 0), Vec3::Zero()};
            world_.add_load(body, load);
            force_ = load.value;
            bodies_.push_back(body);
        }
        SceneBounds bounds;
        bounds.include(Vec3(-0.02, -0.05, offset(0)));
        bounds.include(Vec3(kLength_m + 0.08, 0.42, offset(methods_.size() - 1)));
        camera_ = frame_camera(bounds, Vec3(0.75, 0.5, 1), 32);
        camera_.eye_m = camera_.target_m + 0.8 * (camera_.eye_m - camera_.target_m);
    }

    World& world() override { return world_; }
    double duration_s() const override { return 9; }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        if (view.scale) view.scale->high = 1e4;
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            view.surfaces[i].look = Look::rubber;
            view.labels.push_back({Vec3(-0.03, -kSide_m, offset(i)), methods_[i].name});
        }
        char text[160];
        const double force = force_.at(t).y();
        if (t < 0.5 || force == 0)
            std::snprintf(text, sizeof text, "%s", t < 1 ? "The same beam by five methods, its end about to be lifted" : "Let go: every method comes back to rest");
        else
            std::snprintf(text, sizeof text, "Lifted with %.1f N: small displacements swell the beam, rotated frames bend it", force);
        view.caption = text;
    }

private:
    double offset(std::size_t i) const { return kGap_m * (double(i) - 2); }

    World world_;
    std::vector<Method> methods_;
    std::vector<BodyId> bodies_;
    Timeline<Vec3> force_;
    Camera camera_;
};

const RegisterDemo demo({"methods", "small displacements, three corotational frames and hexahedra side by side",
                         [](const ShowOptions& options) { return std::make_unique<Methods>(options); }});

}  // namespace
}  // namespace supple::demos
