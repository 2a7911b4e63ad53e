// Every real mesh beside the repository as a body that falls and is held: volumes as they are, surfaces cooked.
#include "supple/base/parallel.h"
#include "supple/io/mesh_file.h"
#include "supple/io/surface_file.h"
#include "supple/mesh/cook.h"
#include "supple/mesh/skin.h"
#include "supple/world/world.h"
#include "test_io_helpers.h"

namespace supple::test {
namespace {

/// Their units are anybody's guess: made 0.2 m long.
template <class Mesh>
void scale_to_twenty_centimetres(Mesh& mesh) {
    Box box;
    for (const Vec3& x : mesh.vertices) box.include(x);
    for (Vec3& x : mesh.vertices) x = 0.2 / box.size().maxCoeff() * (x - box.centre());
}

/// Held by its left tenth, it sags and swings.
void expect_runs(const VolumeMesh& mesh, const std::shared_ptr<const Skin>& skin, int steps) {
    World world({.time_step_s = 0.01, .threads = hardware_threads()});
    BodyDef def;
    def.name = "body";
    def.shape = BodyTemplate::build(mesh);
    def.skin = skin;
    def.material = Corotational{.young_pa = 5e4, .poisson = 0.4};
    const BodyId body = world.add_body(def);
    const MeshReport& report = world.shape(body).report();
    world.fix(body, InsideBox{report.min_m - Vec3::Ones(), Vec3(report.min_m.x() + 0.1 * (report.max_m.x() - report.min_m.x()), 1e3, 1e3)});
    for (int i = 0; i < steps; ++i) {
        const StepReport step = world.step();
        ASSERT_EQ(int(step.flags), 0) << "step " << i;
    }
    const auto now = world.positions(body);
    const std::vector<Vec3> start = world.start_positions(body);
    double farthest = 0;
    for (std::size_t v = 0; v < now.size(); ++v) farthest = std::max(farthest, (now[v] - start[v]).norm());
    EXPECT_GT(farthest, 1e-6) << "it moved";
    EXPECT_LT(farthest, 0.4) << "it did not fly away";
}

void expect_all_run(int steps, std::size_t elements) {
    const std::filesystem::path folder = shared_data("meshes");
    if (folder.empty()) return;
    Team team(hardware_threads());
    std::vector<std::filesystem::path> files(std::filesystem::directory_iterator(folder), {});
    std::sort(files.begin(), files.end());
    std::size_t volumes = 0, surfaces = 0;
    for (const std::filesystem::path& file : files) {
        if (file.extension() == ".md") continue;
        SCOPED_TRACE(file.filename().string());
        try {
            VolumeMesh mesh = io::read_mesh(file);
            scale_to_twenty_centimetres(mesh);
            expect_runs(mesh, nullptr, steps);
            ++volumes;
        } catch (const Error& error) {
            ASSERT_EQ(to_string(error.code()), to_string(ErrorCode::surface_mesh)) << error.what();
            mesh::TriangleMesh surface = weld(io::read_surface(file));
            scale_to_twenty_centimetres(surface);
            const VolumeMesh mesh = cook(surface, {.elements = elements}, team);
            expect_runs(mesh, Skin::build(mesh, surface), steps);
            const CookKind kind = surfaces % 2 == 0 ? CookKind::hexes : CookKind::cage;
            const VolumeMesh coarse = cook(surface, {.kind = kind, .elements = elements / 4}, team);
            expect_runs(coarse, Skin::build(coarse, surface), steps);
            ++surfaces;
        }
    }
    EXPECT_GE(volumes, 9u);
    EXPECT_GE(surfaces, 7u);
}

TEST(IoRealMeshes, RunForSomeSteps) { expect_all_run(8, 1500); }
TEST(SlowIoRealMeshes, RunForThreeHundredSteps) { expect_all_run(300, 8000); }

}  // namespace
}  // namespace supple::test
