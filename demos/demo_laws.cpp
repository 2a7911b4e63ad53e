// Eight hyperelastic laws, one strip each, side by side. All have the same stiffness at small strain; pulled hard they part.
#include <cmath>
#include <cstdio>

#include "demo.h"
#include "framing.h"
#include "supple/mesh/box_mesh.h"

namespace supple::demos {
namespace {

constexpr double kMu_pa = 1e4, kBulk_pa = 1e5, kLambda_pa = kBulk_pa - 2 * kMu_pa / 3;
constexpr double kSide_m = 0.03, kLength_m = 0.16, kGap_m = 0.1;
constexpr double kGently_n = 0.5, kHard_n = 14;

struct NamedLaw {
    const char* name;
    Material material;
};

/// Alphabetical, all with the shear modulus kMu_pa and the bulk modulus kBulk_pa at small strain.
std::vector<NamedLaw> laws() {
    return {{"Arruda-Boyce", ArrudaBoyce{kMu_pa / 1.0851367078791743, kBulk_pa}},
            {"Costa", Costa{kMu_pa, kLambda_pa}},
            {"Mooney-Rivlin", MooneyRivlin{0.3 * kMu_pa, 0.2 * kMu_pa, kBulk_pa}},
            {"Neo-Hookean", NeoHookean{kMu_pa, kLambda_pa}},
            {"Ogden", Ogden{{{2 * kMu_pa, 3}}, kBulk_pa}},
            {"St. Venant-K.", StVenantKirchhoff{kMu_pa, kLambda_pa}},
            {"Stable Neo-H.", StableNeoHookean{kMu_pa, kLambda_pa}},
            {"Veronda-W.", VerondaWestman{kMu_pa / 2, 2, kBulk_pa}}};
}

WorldDef world_def(const ShowOptions& options) {
    WorldDef def;
    def.threads = options.threads;
    def.time_step_s = 1.0 / 120;
    def.gravity_m_s2 = Vec3(0, -9.81, 0);
    def.solver.rayleigh_mass_1_s = 8;
    def.solver.rayleigh_stiffness_s = 0.003;
    return def;
}

class Laws : public Show {
public:
    explicit Laws(const ShowOptions& options) : world_(world_def(options)), laws_(laws()) {
        const auto shape = BodyTemplate::build(make_tet_box({.min_m = Vec3(-kSide_m / 2, -kLength_m, -kSide_m / 2),
                                                             .max_m = Vec3(kSide_m / 2, 0, kSide_m / 2), .cells = {4, 20, 4}}));
        for (std::size_t i = 0; i < laws_.size(); ++i) {
            BodyDef def;
            def.name = laws_[i].name;
            def.shape = shape;
            def.material = laws_[i].material;
            def.translation_m = Vec3(kGap_m * (double(i) - 3.5), 0, 0);
            const BodyId body = world_.add_body(def);
            world_.fix(body, InsideBox{Vec3(-1, -1e-9, -1), Vec3(1, 1, 1)});
            Load pull;
            pull.where = InsideBox{Vec3(-1, -1, -1), Vec3(1, -kLength_m + 1e-9, 1)};
            pull.value.times_s = {0.5, 2, 4, 7};
            pull.value.values = {Vec3::Zero(), Vec3(0, -kGently_n, 0), Vec3(0, -kGently_n, 0), Vec3(0, -kHard_n, 0)};
            world_.add_load(body, pull);
            force_ = pull.value;
            bodies_.push_back(body);
        }
        SceneBounds bounds;
        bounds.include(Vec3(-3.9 * kGap_m, 0.03, 0));
        bounds.include(Vec3(3.9 * kGap_m, -0.36, 0));
        camera_ = frame_camera(bounds, Vec3(0.0, 0.12, 1), 30);
        camera_.eye_m = camera_.target_m + 0.64 * (camera_.eye_m - camera_.target_m);  // a wide, flat scene
        camera_.eye_m.x() = camera_.target_m.x() += 0.04;  // room for the legend
        camera_.target_m.y() -= 0.025;
    }

    World& world() override { return world_; }
    double duration_s() const override { return 10; }

    void decorate(FrameView& view) override {
        const double t = world_.time_s();
        view.camera = camera_;
        view.ground_height_m = -0.42;
        if (view.scale) view.scale->high = 5e4;
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            view.surfaces[i].look = Look::rubber;
            const double x = kGap_m * (double(i) - 3.5);
            view.labels.push_back({Vec3(x, 0.017, kSide_m / 2), laws_[i].name});
            double lowest = 0;
            for (const Vec3& p : view.surfaces[i].positions) lowest = std::min(lowest, p.y());
            char text[32];
            std::snprintf(text, sizeof text, "%.0f %%", 100 * (-lowest / kLength_m - 1));
            view.labels.push_back({Vec3(x, lowest - 0.012, kSide_m / 2), text});
        }
        char text[160];
        if (t < 4)
            std::snprintf(text, sizeof text, "Eight laws with the same stiffness at small strain, pulled with %.1f N: alike", -force_.at(t).y());
        else
            std::snprintf(text, sizeof text, "Pulled harder they part: %.0f N", -force_.at(t).y());
        view.caption = text;
    }

private:
    World world_;
    std::vector<NamedLaw> laws_;
    std::vector<BodyId> bodies_;
    Timeline<Vec3> force_;
    Camera camera_;
};

const RegisterDemo demo({"laws", "eight hyperelastic laws side by side: equal at small strain, apart at large strain",
                         [](const ShowOptions& options) { return std::make_unique<Laws>(options); }});

}  // namespace
}  // namespace supple::demos
