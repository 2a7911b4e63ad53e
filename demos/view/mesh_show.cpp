#include "view/mesh_show.h"

#include <cmath>

#include "framing.h"
#include "supple/io/mesh_file.h"

namespace supple::demos::view {
namespace {

constexpr double kDensity_kg_m3 = 1000, kFoot = 0.05;
constexpr double kWeightsOfFirmness = 50;

class MeshShow : public Show {
public:
    MeshShow(const std::filesystem::path& file, const ShowOptions& options) : world_(world_def(options)) {
        BodyDef def;
        def.name = file.stem().string();
        def.shape = BodyTemplate::build(io::read_mesh(file));
        const SceneBounds bounds = supple::bounds_of(def.shape->mesh().vertices);
        const double height = bounds.max_m.y() - bounds.min_m.y();
        const double pressure_pa = kDensity_kg_m3 * world_.def().gravity_m_s2.norm() * height;
        Corotational matter;
        matter.poisson = 0.4;
        // Two digits: a number that a person can read.
        const double wanted = kWeightsOfFirmness * pressure_pa, unit = std::pow(10.0, std::floor(std::log10(wanted)) - 1);
        matter.young_pa = std::round(wanted / unit) * unit;
        def.material = matter;
        def.density_kg_m3 = kDensity_kg_m3;
        const BodyId body = world_.add_body(def);
        const Vec3 top(bounds.max_m.x(), bounds.min_m.y() + kFoot * height, bounds.max_m.z());
        world_.fix(body, InsideBox{bounds.min_m, top});
        ground_m_ = bounds.min_m.y();
        camera_ = frame_bodies(world_);
    }

    World& world() override { return world_; }
    void decorate(FrameView& view) override {
        view.camera = camera_;
        view.ground_height_m = ground_m_;
    }

private:
    static WorldDef world_def(const ShowOptions& options) {
        WorldDef def;
        def.threads = options.threads;
        def.isa = options.isa;
        def.solver.rayleigh_mass_1_s = 0.5;
        def.solver.rayleigh_stiffness_s = 0.002;
        return def;
    }

    World world_;
    double ground_m_ = 0;
    Camera camera_;
};

}  // namespace

std::unique_ptr<Show> open_mesh(const std::filesystem::path& file, const ShowOptions& options) {
    return std::make_unique<MeshShow>(file, options);
}

}  // namespace supple::demos::view
