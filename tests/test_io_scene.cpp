#include <fstream>
#include <functional>

#include "supple/io/binary_file.h"
#include "supple/io/mesh_file.h"
#include "supple/io/scene.h"
#include "supple/mesh/box_mesh.h"
#include "test_io_helpers.h"

namespace supple::io {
namespace {

using test::expect_error;

Scene parse(const std::string& text) { return parse_scene(text, ".", "s.json"); }

/// A scene of one small box whose body has `extra` keys besides.
std::string one_body(const std::string& extra) {
    return R"({"supple_scene": 1, "bodies": [{"box": {"min_m": [0, 0, 0], "max_m": [2, 1, 1], "cells": [2, 1, 1]})" + (extra.empty() ? "" : ", " + extra) + "}]}";
}
std::string with_key(const std::string& key) {
    std::string text = one_body("");
    return text.insert(1, key + ", ");
}

const SceneBody& body_of(const Scene& scene) { return scene.bodies.at(0); }

/// Young's modulus of each element of the first body, as the world has it.
std::vector<double> young_of(const Scene& scene) {
    const World world = build_world(scene);
    const auto young = world.element_young_pa(world.bodies()[0]);
    return {young.begin(), young.end()};
}

TEST(IoScene, ABodyMayHaveColours) {
    const Scene scene = parse(one_body(R"("color": [0.1, 0.5, 1], "inner_color": [1, 0, 0.25])"));
    EXPECT_EQ(body_of(scene).color, (std::array<float, 3>{0.1f, 0.5f, 1.0f}));
    EXPECT_EQ(body_of(scene).inner_color, (std::array<float, 3>{1.0f, 0.0f, 0.25f}));
    EXPECT_FALSE(body_of(parse(one_body(""))).inner_color.has_value());
    expect_error(ErrorCode::parse, "s.json:/bodies/0/inner_color", {"three numbers from 0 to 1"}, [] { parse(one_body(R"("inner_color": [1, 0])")); });
    expect_error(ErrorCode::parse, "s.json:/bodies/0/color/2", {"1.5"}, [] { parse(one_body(R"("color": [1, 0, 1.5])")); });
}

TEST(IoScene, ReadsEveryKey) {
    const Scene scene = parse(R"({
      // a comment
      "supple_scene": 1, /* another */
      "time_step_s": 0.01, "gravity_m_s2": [0, 0, -9.81], "threads": 3,
      "solver": {"integrator": "implicit_euler", "newton_iterations": 4, "newton_tolerance": 1e-3, "cg_relative_tolerance": 1e-8, "cg_max_iterations": 77,
                 "preconditioner": "block_jacobi", "precision": "double", "linearise_at": "current", "tangent": "warped", "operator": "assembled",
                 "rayleigh_mass_1_s": 0.5, "rayleigh_stiffness_s": 0.01},
      "bodies": [{"name": "bar", "box": {"min_m": [0, 0, 0], "max_m": [2, 1, 1], "cells": [2, 1, 1], "elements": "tets"}, "scale": 0.5,
                  "translation_m": [1, 2, 3], "velocity_m_s": [0, 1, 0], "density_kg_m3": 900,
                  "material": {"law": "corotational", "rotation": "polar", "young_pa": 2e5, "poisson": 0.4},
                  "fixed": [{"box": {"min_m": [-1, -1, -1], "max_m": [0, 2, 2]}, "axes": "xz"}, "all"],
                  "prescribed": [{"vertices": [2], "displacement_m": [0, 0.1, 0]}],
                  "loads": [{"sphere": {"centre_m": [1, 0, 0], "radius_m": 0.1}, "force_n": [0, -1, 0]}]}],
      "colliders": [],
      "camera": {"eye_m": [0.2, 0.1, 0.8], "target_m": [0, 0, 0], "fov_deg": 35}
    })");
    EXPECT_EQ(scene.world.time_step_s, 0.01);
    EXPECT_EQ(scene.world.gravity_m_s2, Vec3(0, 0, -9.81));
    EXPECT_EQ(scene.world.threads, 3);
    const SolverDef& solver = scene.world.solver;
    EXPECT_EQ(solver.newton_iterations, 4);
    EXPECT_EQ(solver.newton_tolerance, 1e-3);
    EXPECT_EQ(solver.cg_relative_tolerance, 1e-8);
    EXPECT_EQ(solver.cg_max_iterations, 77);
    EXPECT_EQ(solver.preconditioner, PreconditionerKind::block_jacobi);
    EXPECT_EQ(solver.precision, Precision::double_);
    EXPECT_EQ(solver.linearise_at, LineariseAt::current);
    EXPECT_EQ(solver.rayleigh_mass_1_s, 0.5);
    EXPECT_EQ(solver.rayleigh_stiffness_s, 0.01);
    ASSERT_EQ(scene.bodies.size(), 1u);
    const SceneBody& body = body_of(scene);
    EXPECT_EQ(body.def.name, "bar");
    EXPECT_EQ(body.def.shape->mesh().tets.size(), 12u);
    EXPECT_EQ(body.def.shape->mesh().vertices[2], Vec3(1, 0, 0));  // scaled
    EXPECT_EQ(body.def.translation_m, Vec3(1, 2, 3));
    EXPECT_EQ(body.def.velocity_m_s, Vec3(0, 1, 0));
    EXPECT_EQ(body.def.density_kg_m3, 900);
    EXPECT_EQ(std::get<Corotational>(body.def.material).young_pa, 2e5);
    EXPECT_EQ(std::get<Corotational>(body.def.material).poisson, 0.4);
    EXPECT_TRUE(body.def.young_pa_per_element.empty());
    ASSERT_EQ(body.fixed.size(), 2u);
    EXPECT_EQ(std::get<InsideBox>(body.fixed[0].where).max_m, Vec3(0, 2, 2));
    EXPECT_TRUE(body.fixed[0].axes.x && !body.fixed[0].axes.y && body.fixed[0].axes.z);
    EXPECT_TRUE(std::holds_alternative<Everything>(body.fixed[1].where));
    ASSERT_EQ(body.prescribed.size(), 1u);
    EXPECT_EQ(body.prescribed[0].displacement_m.values.at(0), Vec3(0, 0.1, 0));
    EXPECT_TRUE(body.prescribed[0].displacement_m.times_s.empty());
    ASSERT_EQ(body.loads.size(), 1u);
    EXPECT_EQ(body.loads[0].kind, LoadKind::total_force);
    EXPECT_EQ(std::get<InsideSphere>(body.loads[0].where).radius_m, 0.1);
    ASSERT_TRUE(scene.camera.has_value());
    EXPECT_EQ(scene.camera->fov_deg, 35);
}

TEST(IoScene, DefaultsAreThoseOfTheDefinitions) {
    const Scene scene = parse(one_body(""));
    const WorldDef world;
    EXPECT_EQ(scene.world.time_step_s, world.time_step_s);
    EXPECT_EQ(scene.world.gravity_m_s2, world.gravity_m_s2);
    EXPECT_EQ(scene.world.solver.cg_max_iterations, world.solver.cg_max_iterations);
    EXPECT_EQ(scene.world.solver.precision, world.solver.precision);
    EXPECT_EQ(scene.world.solver.linearise_at, world.solver.linearise_at);
    EXPECT_EQ(body_of(scene).def.density_kg_m3, BodyDef().density_kg_m3);
    EXPECT_FALSE(scene.camera.has_value());
    EXPECT_EQ(parse(with_key(R"("solver": {"preconditioner": "auto", "operator": "auto", "precision": "single"})")).world.solver.preconditioner,
              PreconditionerKind::automatic);
}

TEST(IoScene, UnitsAndTheUpAxisOfAMeshFile) {
    const test::TemporaryFolder folder;
    write_mesh(folder / "a.vtu", make_tet_box({.max_m = {10, 20, 30}, .cells = {1, 1, 1}}));
    const auto scene_of = [&](const std::string& keys) {
        return parse_scene(R"({"supple_scene": 1, "bodies": [{"mesh": "a.vtu")" + keys + "}]}", folder.path(), "s.json");
    };
    const auto box_of = [&](const std::string& keys) { return scene_of(keys).bodies[0].def.shape->report(); };
    EXPECT_EQ(box_of("").max_m, Vec3(10, 20, 30));
    EXPECT_LT((box_of(R"(, "units": "cm", "scale": 2)").max_m - Vec3(0.2, 0.4, 0.6)).norm(), 1e-15);
    const MeshReport turned = box_of(R"(, "units": "mm", "up": "z")");
    EXPECT_LT((turned.min_m - Vec3(0, 0, -0.02)).norm(), 1e-15);
    EXPECT_LT((turned.max_m - Vec3(0.01, 0.03, 0)).norm(), 1e-15);
    EXPECT_NEAR(turned.volume_m3, 6e-6, 1e-15);
    expect_error(ErrorCode::parse, "s.json:/bodies/0/units", {"\"inch\"", "\"in\""}, [&] { scene_of(R"(, "units": "inch")"); });
    expect_error(ErrorCode::parse, "s.json:/bodies/0/up", {"\"w\""}, [&] { scene_of(R"(, "up": "w")"); });
    expect_error(ErrorCode::parse, "s.json:/bodies/0/units", {"box", "remove"}, [] {
        parse_scene(R"({"supple_scene": 1, "bodies": [{"units": "cm", "box": {"min_m": [0, 0, 0], "max_m": [1, 1, 1], "cells": [1, 1, 1]}}]})", ".", "s.json");
    });
}

TEST(IoScene, MeshPathsAreRelativeToTheSceneAndShared) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directories(folder / "meshes");
    VolumeMesh mesh = make_tet_box({});
    mesh.regions = {{"soft", 4}};
    mesh.element_region = {0, 0, -1, -1, -1, -1};
    mesh.groups = {{"ligament", {0, 1}}};
    write_mesh(folder / "meshes/a.msh", mesh);
    write_text_file(folder / "s.json", R"({"supple_scene": 1, "bodies": [
        {"mesh": "meshes/a.msh", "fixed": [{"group": "ligament"}], "regions": [{"group": "soft", "stiffness_factor": 0.5}]},
        {"mesh": "meshes/../meshes/a.msh", "fixed": [{"selection": {"group": "soft"}}]},
        {"mesh": "meshes/a.msh", "scale": 2}]})");
    const Scene scene = read_scene(folder / "s.json");
    ASSERT_EQ(scene.bodies.size(), 3u);
    EXPECT_EQ(scene.bodies[0].def.shape, scene.bodies[1].def.shape);
    EXPECT_NE(scene.bodies[0].def.shape, scene.bodies[2].def.shape);
    EXPECT_EQ(scene.bodies[2].def.shape->mesh().vertices[1], Vec3(2, 0, 0));
    EXPECT_EQ(young_of(scene), (std::vector<double>{5e4, 5e4, 1e5, 1e5, 1e5, 1e5}));
    expect_error(ErrorCode::parse, (folder / "s.json").string() + ":/bodies/0/fixed/0/group", {"\"ligamnt\"", "\"ligament\"", "\"soft\""}, [&] {
        parse_scene(R"({"supple_scene": 1, "bodies": [{"mesh": "meshes/a.msh", "fixed": [{"group": "ligamnt"}]}]})", folder.path(), (folder / "s.json").string());
    });
}

TEST(IoScene, MaterialsPerElementAndPerRegion) {
    std::string twelve = "[";
    for (int e = 1; e <= 12; ++e) twelve += std::to_string(e) + (e < 12 ? "," : "]");
    const Scene arrays = parse(one_body(R"("material": {"young_pa": )" + twelve + R"(, "poisson": [0,0.1,0.2,0.3,0.4,0.45,0,0,0,0,0,-0.5]})"));
    EXPECT_EQ(body_of(arrays).def.young_pa_per_element[11], 12);
    EXPECT_EQ(body_of(arrays).def.poisson_per_element[11], -0.5);

    const Scene regions = parse(one_body(R"("material": {"young_pa": 100, "poisson": 0.2}, "regions": [
        {"box": {"min_m": [1, 0, 0], "max_m": [2, 1, 1]}, "material": {"young_pa": 1000, "poisson": 0.3}},
        {"all": true, "stiffness_factor": 2}])"));
    const BodyDef& def = body_of(regions).def;
    const std::vector<std::int32_t> right = select_elements(def.shape->mesh(), InsideBox{Vec3(1, 0, 0), Vec3(2, 1, 1)});
    ASSERT_EQ(right.size(), 6u);
    const auto young = young_of(regions);
    for (std::size_t e = 0; e < 12; ++e) {
        EXPECT_NEAR(young[e], std::find(right.begin(), right.end(), std::int32_t(e)) != right.end() ? 2000 : 200, 1e-9);
    }
    EXPECT_EQ(std::get<Corotational>(*def.regions[0].material).poisson, 0.3);
    const Scene scaled = parse(one_body(R"("regions": [{"all": true, "stiffness_factor": 3, "density_kg_m3": 7}])"));
    EXPECT_NEAR(young_of(scaled).at(0), 3 * Corotational().young_pa, 1e-6);
    EXPECT_EQ(body_of(scaled).def.regions[0].density_kg_m3, 7);
    EXPECT_FALSE(body_of(scaled).def.regions[0].material);
}

TEST(IoScene, HyperelasticParametersPerElementAndPerRegion) {
    const Scene lists = parse(one_body(R"("material": {"law": "MooneyRivlin", "c1_pa": [1,2,3,4,5,6,7,8,9,10,11,12], "c2_pa": 1, "bulk_pa": 50,
        "fibre": [[1,0,0],[0,1,0],[0,0,1],[1,1,0],[1,0,0],[1,0,0],[1,0,0],[1,0,0],[1,0,0],[1,0,0],[1,0,0],[1,0,2]], "fibre_stiffness_pa": 3})"));
    const auto& of = body_of(lists).def.material_per_element;
    ASSERT_EQ(of.size(), 12u);
    EXPECT_EQ(std::get<MooneyRivlin>(of[4]).c1_pa, 5);
    EXPECT_EQ(std::get<MooneyRivlin>(of[4]).c2_pa, 1);
    EXPECT_EQ(std::get<MooneyRivlin>(of[11]).fibres.fibre, std::vector<Vec3>{Vec3(1, 0, 2)});
    build_world(lists).step();

    const Scene regions = parse(one_body(R"("material": {"law": "NeoHookean", "young_pa": 100, "poisson": 0.25, "fibre": [0, 1, 0], "fibre_stiffness_pa": 5},
        "regions": [{"box": {"min_m": [1, 0, 0], "max_m": [2, 1, 1]}, "material": {"young_pa": 300, "fibre_stiffness_pa": 7}}])"));
    const auto& inside = std::get<NeoHookean>(*body_of(regions).def.regions[0].material);
    EXPECT_NEAR(inside.mu_pa, 120, 1e-12) << "the body's poisson, which the region does not name";
    EXPECT_EQ(inside.fibres.fibre, std::vector<Vec3>{Vec3(0, 1, 0)});
    EXPECT_EQ(inside.fibres.fibre_stiffness_pa, 7);
    build_world(regions).step();
}

TEST(IoScene, RegionsMayHaveAnotherLaw) {
    const Scene scene = parse(one_body(R"("material": {"law": "NeoHookean", "mu_pa": 10, "lambda_pa": 20}, "regions": [
        {"box": {"min_m": [1, 0, 0], "max_m": [2, 1, 1]}, "material": {"law": "Ogden", "bulk_pa": 70}},
        {"box": {"min_m": [0, 0, 0], "max_m": [1, 1, 1]}, "material": {"law": "corotational", "young_pa": 30, "rotation": "svd", "plastic_yield": 0.1, "volumetric": "nodal"}}])"));
    const auto& regions = body_of(scene).def.regions;
    EXPECT_EQ(std::get<Ogden>(*regions[0].material).bulk_pa, 70);
    EXPECT_EQ(std::get<Ogden>(*regions[0].material).terms.size(), Ogden{}.terms.size()) << "what it does not name is the law's default";
    const auto& turned = std::get<Corotational>(*regions[1].material);
    EXPECT_EQ(turned.young_pa, 30);
    EXPECT_EQ(turned.poisson, Corotational{}.poisson);
    EXPECT_EQ(turned.rotation, Rotation::svd);
    EXPECT_EQ(turned.volumetric, Volumetric::nodal);
    EXPECT_EQ(turned.plasticity.yield, 0.1);
    World world = build_world(scene);
    EXPECT_EQ(world.step().flags, StepFlag::none);
}

TEST(IoScene, CostaAndFibresAreReadWithAllTheirKeys) {
    const Scene scene = parse(one_body(R"("material": {"law": "Costa", "a_pa": 10, "bulk_pa": 20, "b": [1, 2, 3, 4, 5, 6], "fibre": [1, 1, 0], "sheet": [0, 0, 1],
        "fibre_stiffness_pa": 7, "fibre_exponent": 8, "sheet_stiffness_pa": 9, "sheet_exponent": 10, "matrix_regularization": false})"));
    const auto& costa = std::get<Costa>(body_of(scene).def.material);
    EXPECT_EQ(costa.a_pa, 10);
    EXPECT_EQ(costa.bulk_pa, 20);
    EXPECT_EQ(costa.b, (std::array<double, 6>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(costa.fibres.fibre, std::vector<Vec3>{Vec3(1, 1, 0)});
    EXPECT_EQ(costa.fibres.sheet, std::vector<Vec3>{Vec3(0, 0, 1)});
    EXPECT_EQ(costa.fibres.fibre_stiffness_pa, 7);
    EXPECT_EQ(costa.fibres.fibre_exponent, 8);
    EXPECT_EQ(costa.fibres.sheet_stiffness_pa, 9);
    EXPECT_EQ(costa.fibres.sheet_exponent, 10);
    EXPECT_FALSE(costa.matrix_regularization);
    build_world(scene).step();
    const Scene ogden = parse(one_body(R"("material": {"law": "Ogden", "bulk_pa": 9e4, "terms": [{"mu_pa": 5e3, "alpha": 3}, {"mu_pa": 100, "alpha": -2}, {"mu_pa": 50, "alpha": 7}]})"));
    ASSERT_EQ(std::get<Ogden>(body_of(ogden).def.material).terms.size(), 3u);
    EXPECT_EQ(std::get<Ogden>(body_of(ogden).def.material).terms[1].alpha, -2);
    build_world(ogden).step();
}

TEST(IoScene, TimelinesRampOrFollowTheirTable) {
    const Scene scene = parse(one_body(R"(
        "prescribed": [{"all": true, "displacement_m": [1, 2, 3], "times_s": [0.5, 1]},
                       {"all": true, "velocity_m_s": [[0, 0, 0], [1, 0, 0], [0, 0, 0]], "times_s": [0, 1, 4]},
                       {"all": true, "affine": [[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7]], "times_s": [0, 2], "axes": "y"},
                       {"all": true, "affine": [[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0]]], "times_s": [0, 2]},
                       {"all": true, "affine": [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0]]}],
        "loads": [{"vertices": [0, 1], "force_per_vertex_n": [0, 0, 8], "times_s": [0, 2]},
                  {"all": true, "traction_pa": [1, 0, 0]},
                  {"all": true, "body_force_n_m3": [[0, 1, 0]], "times_s": [3]},
                  {"all": true, "pressure_pa": 5, "times_s": [1, 2]},
                  {"triangles": [1, 2], "pressure_pa": [1, 4, 9], "times_s": [0, 1, 2], "follower": false},
                  {"all": true, "moment_nm": 2, "axis": [0, 0, 3]}])"));
    const auto& motions = body_of(scene).prescribed;
    EXPECT_EQ(motions[0].displacement_m.at(0), Vec3(0, 0, 0));
    EXPECT_EQ(motions[0].displacement_m.at(0.75), Vec3(0.5, 1, 1.5));
    EXPECT_EQ(motions[0].displacement_m.at(9), Vec3(1, 2, 3));
    EXPECT_EQ(motions[1].velocity_m_s.at(2.5), Vec3(0.5, 0, 0));
    EXPECT_TRUE(motions[1].displacement_m.values.empty());
    EXPECT_EQ(motions[2].affine.at(0)(0, 0), 1);
    EXPECT_EQ(motions[2].affine.at(1)(0, 0), 0.5);
    EXPECT_EQ(motions[2].affine.at(2)(2, 3), 7);
    EXPECT_FALSE(motions[2].axes.x);
    EXPECT_EQ(motions[3].affine.at(1)(1, 1), 1.5);
    EXPECT_EQ(motions[4].affine.values.size(), 1u);
    const auto& loads = body_of(scene).loads;
    EXPECT_EQ(loads[0].kind, LoadKind::force_per_vertex);
    EXPECT_EQ(std::get<VertexList>(loads[0].where).vertices, (std::vector<std::int32_t>{0, 1}));
    EXPECT_EQ(loads[0].value.at(1), Vec3(0, 0, 4));
    EXPECT_EQ(loads[1].kind, LoadKind::traction);
    EXPECT_EQ(loads[2].kind, LoadKind::body_force);
    EXPECT_EQ(loads[2].value.at(0), Vec3(0, 1, 0));
    EXPECT_EQ(loads[3].kind, LoadKind::pressure);
    EXPECT_TRUE(loads[3].follower);
    EXPECT_EQ(loads[3].amount.at(1.5), 2.5);
    EXPECT_EQ(loads[4].triangles, (std::vector<std::int32_t>{1, 2}));
    EXPECT_FALSE(loads[4].follower);
    EXPECT_EQ(loads[4].amount.at(1.5), 6.5);
    EXPECT_EQ(loads[5].kind, LoadKind::moment);
    EXPECT_EQ(loads[5].axis, Vec3(0, 0, 3));
    EXPECT_EQ(loads[5].amount.at(7), 2);
}

TEST(IoScene, SyntaxErrorsNameTheLine) {
    const auto refuse = [](const std::string& text, const std::string& where, const std::vector<std::string>& words) {
        SCOPED_TRACE(text);
        expect_error(ErrorCode::parse, where, words, [&] { parse(text); });
    };
    refuse("{\n\"supple_scene\": 1,\n\"bodies\": [}\n", "s.json:3", {"column"});
    refuse("{\n\n\"supple_scene\" 1}", "s.json:3", {});
    refuse("", "s.json:1", {});
    refuse("{\"supple_scene\": 1, \"bodies\": [", "s.json:1", {});
    refuse("{\n\"supple_scene\": 1} trailing", "s.json:2", {});
    refuse("{\"supple_scene\": 1,\n \"time_step_s\": 1e999}", "s.json:2", {});
    refuse("{\"supple_scene\": 1,\n \"bodies\": [{\n \"name\": 1}],\n \"supple_scene\": 1,\n \"bodies\": 1}", "s.json:4", {"\"supple_scene\"", "twice"});
    refuse("{\"supple_scene\": \"\xff\"}", "s.json:1", {});
    refuse(std::string(100000, '['), "s.json:1", {});
    refuse(std::string(100000, '[') + std::string(100000, ']'), "s.json:/", {"must be an object"});
}

TEST(IoScene, MistakesNameThePointerAndTheFix) {
    const auto refuse = [](const std::string& text, const std::string& pointer, const std::vector<std::string>& words, ErrorCode code = ErrorCode::parse) {
        SCOPED_TRACE(text);
        expect_error(code, "s.json:" + pointer, words, [&] { parse(text); });
    };
    const std::string b = "/bodies/0/";
    // unknown and missing keys
    refuse(with_key(R"("gravity": [0, 0, 0])"), "/gravity", {"unknown key", "\"gravity_m_s2\""});
    refuse(with_key(R"("time_stepp_s": 1)"), "/time_stepp_s", {"did you mean \"time_step_s\""});
    refuse(with_key(R"("a/b~c": 1)"), "/a~1b~0c", {"unknown key"});
    refuse(one_body(R"("materail": {})"), b + "materail", {"did you mean \"material\""});
    refuse(one_body(R"("material": {"young": 1})"), b + "material/young", {"did you mean \"young_pa\""});
    refuse(one_body(R"("fixed": [{"boxx": 1}])"), b + "fixed/0/boxx", {"did you mean \"box\""});
    refuse(one_body(R"("fixed": [{"axis": "x", "all": true}])"), b + "fixed/0/axis", {"did you mean \"axes\""});
    refuse(R"({"bodies": []})", "/", {"\"supple_scene\" is missing"});
    refuse(R"({"supple_scene": 1})", "/", {"\"bodies\" is missing"});
    refuse(R"({"supple_scene": 1, "bodies": []})", "/bodies", {"empty"});
    refuse(R"({"supple_scene": 1, "bodies": [{}]})", "/bodies/0", {"\"mesh\"", "\"box\""});
    refuse(R"({"supple_scene": 2, "bodies": []})", "/supple_scene", {"version 2", "version 1"}, ErrorCode::unsupported);
    // types and ranges
    refuse(with_key(R"("time_step_s": 0)"), "/time_step_s", {"0 is outside (0, 1]"});
    refuse(with_key(R"("time_step_s": 1.5)"), "/time_step_s", {"1.5", "(0, 1]"});
    refuse(with_key(R"("time_step_s": "fast")"), "/time_step_s", {"must be a number", "\"fast\""});
    refuse(with_key(R"("gravity_m_s2": -9.81)"), "/gravity_m_s2", {"three numbers", "-9.81"});
    refuse(with_key(R"("gravity_m_s2": [0, null, 0])"), "/gravity_m_s2/1", {"null"});
    refuse(with_key(R"("threads": 257)"), "/threads", {"257", "[0, 256]"});
    refuse(with_key(R"("threads": 1.5)"), "/threads", {"whole number"});
    refuse(with_key(R"("solver": {"newton_iterations": 0})"), "/solver/newton_iterations", {"[1, 1000]"});
    refuse(with_key(R"("solver": {"newton_tolerance": 1})"), "/solver/newton_tolerance", {"[0, 1)"});
    refuse(with_key(R"("solver": {"cg_relative_tolerance": 0})"), "/solver/cg_relative_tolerance", {"(0, 1)"});
    refuse(with_key(R"("solver": {"cg_max_iterations": 1e7})"), "/solver/cg_max_iterations", {"[1, 1000000]"});
    refuse(with_key(R"("solver": {"precision": "dubble"})"), "/solver/precision", {"did you mean \"double\"", "\"single\""});
    refuse(with_key(R"("solver": [])"), "/solver", {"must be an object"});
    refuse(with_key(R"("camera": {"eye_m": [0, 0, 0]})"), "/camera", {"\"target_m\" is missing"});
    refuse(with_key(R"("camera": {"eye_m": [0, 0, 0], "target_m": [0, 0, 0]})"), "/camera/target_m", {"eye_m"});
    refuse(with_key(R"("camera": {"eye_m": [0, 0, 0], "target_m": [0, 0, 1], "fov_deg": 180})"), "/camera/fov_deg", {"[1, 170]"});
    refuse(one_body(R"("material": {"poisson": 0.5})"), b + "material/poisson", {"0.5 is outside (-1, 0.5)"});
    refuse(one_body(R"("material": {"young_pa": -1})"), b + "material/young_pa", {"-1 is outside (0, "});
    refuse(one_body(R"("material": {"young_pa": [1, 2]})"), b + "material/young_pa", {"2 numbers", "12 elements"});
    refuse(one_body(R"("material": {"poisson": [0,0,0,0,0,0,0,0,0,0,0,0.7]})"), b + "material/poisson/11", {"0.7"});
    refuse(one_body(R"("density_kg_m3": 0)"), b + "density_kg_m3", {"outside (0"});
    refuse(one_body(R"("scale": 0)"), b + "scale", {"outside (0"});
    refuse(one_body(R"("name": 7)"), b + "name", {"text"});
    refuse(one_body(R"("mesh": "a.msh")"), b + "box", {"not both"});
    refuse(R"({"supple_scene": 1, "bodies": [{"mesh": "none.msh"}]})", b + "mesh", {"none.msh", "cannot open"}, ErrorCode::file_unreadable);
    refuse(R"({"supple_scene": 1, "bodies": [{"box": {"min_m": [0, 0, 0], "max_m": [1, 0, 1], "cells": [1, 1, 1]}}]})", b + "box/max_m/1", {"not above"});
    refuse(R"({"supple_scene": 1, "bodies": [{"box": {"min_m": [0, 0, 0], "max_m": [1, 1, 1], "cells": [1, 0, 1]}}]})", b + "box/cells/1", {"[1, "});
    refuse(R"({"supple_scene": 1, "bodies": [{"box": {"min_m": [0, 0, 0], "max_m": [1, 1, 1], "cells": [1000, 1000, 1000]}}]})", b + "box/cells", {"1e+09"});
    // selections
    refuse(one_body(R"("fixed": [{"axes": "x"}])"), b + "fixed/0", {"selection is missing"});
    refuse(one_body(R"("fixed": ["left"])"), b + "fixed/0", {"\"all\"", "group"});
    refuse(one_body(R"("fixed": [7])"), b + "fixed/0", {"object"});
    refuse(one_body(R"("fixed": [{"all": false}])"), b + "fixed/0/all", {"true"});
    refuse(one_body(R"("fixed": [{"all": true, "group": "a"}])"), b + "fixed/0/all", {"exclude each other"});
    refuse(one_body(R"("fixed": [{"group": "a"}])"), b + "fixed/0/group", {"no group"});
    refuse(one_body(R"("fixed": [{"vertices": [12]}])"), b + "fixed/0/vertices/0", {"12", "[0, 11]"});
    refuse(one_body(R"("fixed": [{"vertices": []}])"), b + "fixed/0/vertices", {"no vertex"});
    refuse(one_body(R"("fixed": [{"box": {"min_m": [5, 5, 5], "max_m": [6, 6, 6]}}])"), b + "fixed/0/box", {"no vertex", "[2, 1, 1]"});
    refuse(one_body(R"("fixed": [{"box": {"min_m": [5, 5, 5], "max_m": [4, 6, 6]}}])"), b + "fixed/0/box/max_m/0", {"not above"});
    refuse(one_body(R"("fixed": [{"sphere": {"centre_m": [0, 0, 0], "radius_m": -1}}])"), b + "fixed/0/sphere/radius_m", {"[0, "});
    refuse(one_body(R"("fixed": [{"all": true, "axes": "xx"}])"), b + "fixed/0/axes", {"each once"});
    refuse(one_body(R"("fixed": [{"all": true, "axes": ""}])"), b + "fixed/0/axes", {"empty"});
    refuse(one_body(R"("fixed": {"all": true})"), b + "fixed", {"list"});
    refuse(one_body(R"("fixed": [{"selection": {"selection": "all"}}])"), b + "fixed/0/selection/selection", {"directly"});
    refuse(one_body(R"("fixed": [{"selection": {"all": true, "axes": "x"}}])"), b + "fixed/0/selection/axes", {"unknown key"});
    // motions, loads, times
    refuse(one_body(R"("prescribed": [{"all": true}])"), b + "prescribed/0", {"displacement_m", "affine"});
    refuse(one_body(R"("prescribed": [{"all": true, "displacement_m": [0,0,0], "velocity_m_s": [0,0,0]}])"), b + "prescribed/0/velocity_m_s", {"exclude"});
    refuse(one_body(R"("prescribed": [{"all": true, "displacement_m": [[0,0,0],[0,0,1]]}])"), b + "prescribed/0/displacement_m", {"times_s"});
    refuse(one_body(R"("prescribed": [{"all": true, "displacement_m": [[0,0,0],[0,0,1]], "times_s": [0, 1, 2]}])"), b + "prescribed/0/displacement_m",
           {"2 values for 3 times"});
    refuse(one_body(R"("prescribed": [{"all": true, "displacement_m": [0,0,1], "times_s": [0, 1, 2]}])"), b + "prescribed/0/displacement_m", {"ramp"});
    refuse(one_body(R"("prescribed": [{"all": true, "displacement_m": [0,0,1], "times_s": [1, 1]}])"), b + "prescribed/0/times_s/1", {"ascend"});
    refuse(one_body(R"("prescribed": [{"all": true, "displacement_m": [0,0,1], "times_s": []}])"), b + "prescribed/0/times_s", {"empty"});
    refuse(one_body(R"("prescribed": [{"all": true, "affine": [[1,0,0],[0,1,0],[0,0,1]]}])"), b + "prescribed/0/affine/0", {"four numbers"});
    refuse(one_body(R"("loads": [{"all": true}])"), b + "loads/0", {"force_n", "traction_pa"});
    refuse(one_body(R"("loads": [{"all": true, "force_n": [0,0,0], "traction_pa": [0,0,0]}])"), b + "loads/0/traction_pa", {"exclude"});
    refuse(one_body(R"("loads": [{"vertices": [0], "traction_pa": [0,0,0]}])"), b + "loads/0/traction_pa", {"boundary triangle"});
    refuse(one_body(R"("loads": [{"vertices": [0], "pressure_pa": 1}])"), b + "loads/0/pressure_pa", {"boundary triangle"});
    refuse(one_body(R"("loads": [{"all": true, "pressure_pa": [0,1,0]}])"), b + "loads/0/pressure_pa", {"times_s"});
    refuse(one_body(R"("loads": [{"all": true, "moment_nm": 1}])"), b + "loads/0", {"axis", "[x, y, z]"});
    refuse(one_body(R"("loads": [{"all": true, "moment_nm": 1, "axis": [0,0,0]}])"), b + "loads/0/axis", {"direction"});
    refuse(one_body(R"("loads": [{"all": true, "force_n": [0,1,0], "axis": [0,0,1]}])"), b + "loads/0/axis", {"moment_nm"});
    refuse(one_body(R"("loads": [{"all": true, "traction_pa": [0,1,0], "follower": true}])"), b + "loads/0/follower", {"pressure_pa", "direction"});
    refuse(one_body(R"("loads": [{"triangles": [0], "force_n": [0,1,0]}])"), b + "loads/0/triangles", {"pressure_pa"});
    refuse(one_body(R"("loads": [{"triangles": [999], "pressure_pa": 1}])"), b + "loads/0/triangles/0", {"999"});
    refuse(one_body(R"("loads": [{"triangles": [0], "all": true, "pressure_pa": 1}])"), b + "loads/0/all", {"exclude"});
    refuse(one_body(R"("loads": [{"vertices": [0], "body_force_n_m3": [0,0,0]}])"), b + "loads/0/body_force_n_m3", {"no element"});
    refuse(one_body(R"("regions": [{"all": true}])"), b + "regions/0", {"changes nothing"});
    refuse(one_body(R"("regions": [{"vertices": [0], "stiffness_factor": 2}])"), b + "regions/0", {"no element"});
    refuse(one_body(R"("regions": [{"all": true, "stiffness_factor": 0}])"), b + "regions/0/stiffness_factor", {"outside (0"});
    refuse(one_body(R"("regions": [{"all": true, "stiffness_factor": 1e14}])"), b + "regions/0/stiffness_factor", {"1e+12"});
    refuse(one_body(R"("material": {"young_pa": [1,2,3,4,5,6,7,8,9,10,11,12]}, "regions": [{"all": true, "material": {"poisson": 0.1}}])"), b + "regions/0/material", {"element by element", "law"});
    refuse(one_body(R"("material": {"law": "NeoHookean"}, "regions": [{"all": true, "material": {"mu_pa": [1, 2]}}])"), b + "regions/0/material", {"one value"});
    refuse(one_body(R"("material": {"law": "NeoHookean", "mu_pa": [1, 2]})"), b + "material/mu_pa", {"12 elements"});
    refuse(one_body(R"("material": {"law": "NeoHookean", "young_pa": 1})"), b + "material", {"poisson"});
    refuse(one_body(R"("material": {"law": "Costa", "b": [1, 2, 3]})"), b + "material/b", {"six"});
    refuse(one_body(R"("material": {"law": "Costa", "c1_pa": 1})"), b + "material/c1_pa", {"unknown key"});
}

TEST(IoScene, SolverSettingsReachTheWorld) {
    for (const auto& [word, integrator] : {std::pair{"bdf2", Integrator::bdf2}, std::pair{"newmark", Integrator::newmark}, std::pair{"static", Integrator::quasi_static}}) {
        EXPECT_EQ(parse(with_key(std::string(R"("solver": {"integrator": ")") + word + "\"}")).world.solver.integrator, integrator);
    }
    EXPECT_EQ(parse(with_key(R"("solver": {"tangent": "exact"})")).world.solver.tangent, Tangent::exact);
    EXPECT_EQ(parse(with_key(R"("solver": {"preconditioner": "direct"})")).world.solver.preconditioner, PreconditionerKind::direct);
    EXPECT_EQ(parse(with_key(R"("solver": {"step_budget_us": 8000})")).world.solver.step_budget_us, 8000);
    EXPECT_EQ(parse(with_key(R"("solver": {"preconditioner": "lattice_multigrid"})")).world.solver.preconditioner, PreconditionerKind::lattice_multigrid);
    EXPECT_EQ(parse(with_key(R"("solver": {"preconditioner": "scalar_laplacian"})")).world.solver.preconditioner, PreconditionerKind::scalar_laplacian);
    EXPECT_EQ(parse(with_key(R"("solver": {"preconditioner": "auto_timed"})")).world.solver.preconditioner, PreconditionerKind::automatic_timed);
    EXPECT_EQ(parse(with_key(R"("solver": {})")).world.solver.operator_kind, OperatorKind::automatic);
    EXPECT_EQ(parse(with_key(R"("solver": {"operator": "auto"})")).world.solver.operator_kind, OperatorKind::automatic);
    EXPECT_EQ(parse(with_key(R"("solver": {"operator": "assembled"})")).world.solver.operator_kind, OperatorKind::assembled);
    EXPECT_EQ(parse(with_key(R"("solver": {"operator": "matrix_free"})")).world.solver.operator_kind, OperatorKind::matrix_free);
}

TEST(IoScene, WhatThisBuildCannotDoIsRefusedByItsKey) {
    const auto refuse = [](const std::string& text, const std::string& pointer, const std::vector<std::string>& words) {
        SCOPED_TRACE(text);
        expect_error(ErrorCode::unsupported, "s.json:" + pointer, words, [&] { parse(text); });
    };
    refuse(one_body(R"("material": {"fibre": [1, 0, 0]})"), "/bodies/0/material/fibre", {"fibre", "hyperelastic"});
    refuse(one_body(R"("material": {"law": "linear", "matrix_regularization": true})"), "/bodies/0/material/matrix_regularization", {"hyperelastic"});
    refuse(one_body(R"("regions": [{"all": true, "material": {"fibre_stiffness_pa": 1}}])"), "/bodies/0/regions/0/material/fibre_stiffness_pa", {"hyperelastic"});
}

TEST(IoScene, CollidersOfEveryShapeAndMotion) {
    const Scene scene = parse(with_key(R"("colliders": [
        {"plane": {"normal": [0, 2, 0], "offset_m": -0.5}, "friction": 0.4, "name": "floor"},
        {"sphere": {"centre_m": [1, 2, 3], "radius_m": 0.1}, "motion": {"times_s": [0, 1], "positions_m": [[0, 0, 0], [1, 0, 0]], "rotations_wxyz": [[1, 0, 0, 0], [0, 1, 0, 0]]}},
        {"capsule": {"radius_m": 0.1, "half_length_m": 0.2}, "position_m": [1, 1, 1], "mass_kg": 2, "velocity_m_s": [0, -1, 0], "spin_rad_s": [1, 0, 0]},
        {"box": {"min_m": [0, 0, 0], "max_m": [1, 2, 3]}, "friction": 0},
        {"box": {"half_extents_m": [1, 2, 3]}, "rotation_wxyz": [0, 0, 2, 0]},
        {"cylinder": {"radius_m": 0.1, "half_length_m": 0.2}, "mass_kg": 0.1, "motion": {"times_s": [0], "positions_m": [[0, 1, 0]]},
         "tool": {"stiffness_n_m": 300, "damping_n_s_m": 3, "max_force_n": 3.3, "torsion_nm_rad": 0.1, "max_torque_nm": 0.2}}])"));
    ASSERT_EQ(scene.colliders.size(), 6u);
    EXPECT_EQ(std::get<PlaneShape>(scene.colliders[0].shape).offset_m, -0.5);
    EXPECT_EQ(scene.colliders[0].friction, 0.4);
    EXPECT_EQ(scene.colliders[0].name, "floor");
    EXPECT_EQ(scene.colliders[0].motion, ColliderMotion::fixed);
    EXPECT_EQ(scene.colliders[1].motion, ColliderMotion::kinematic);
    EXPECT_EQ(scene.colliders[1].pose.position_m, Vec3(1, 2, 3));
    EXPECT_EQ(scene.colliders[1].keys.positions_m[1], Vec3(1, 0, 0));
    EXPECT_EQ(scene.colliders[1].keys.rotations_wxyz[1][1], 1);
    EXPECT_EQ(scene.colliders[2].motion, ColliderMotion::dynamic);
    EXPECT_EQ(scene.colliders[2].mass_kg, 2);
    EXPECT_EQ(scene.colliders[2].velocity_m_s, Vec3(0, -1, 0));
    EXPECT_EQ(scene.colliders[3].pose.position_m, Vec3(0.5, 1, 1.5));
    EXPECT_EQ(std::get<BoxShape>(scene.colliders[3].shape).half_extents_m, Vec3(0.5, 1, 1.5));
    EXPECT_EQ(scene.colliders[4].pose.rotation_wxyz[2], 2);
    EXPECT_EQ(scene.colliders[5].motion, ColliderMotion::tool);
    EXPECT_EQ(scene.colliders[5].coupling.max_force_n, 3.3);
    EXPECT_EQ(build_world(scene).colliders().size(), 6u);

    const auto wrong = [](const std::string& collider, const std::string& pointer, const std::vector<std::string>& words) {
        SCOPED_TRACE(collider);
        expect_error(ErrorCode::parse, "s.json:/colliders/0" + pointer, words, [&] { parse(with_key("\"colliders\": [" + collider + "]")); });
    };
    wrong(R"({"friction": 0.3})", "", {"no shape", "sphere"});
    wrong(R"({"sphere": {"radius_m": 1}, "box": {"half_extents_m": [1, 1, 1]}})", "/box", {"sphere"});
    wrong(R"({"spere": {"radius_m": 1}})", "/spere", {"sphere"});
    wrong(R"({"sphere": {"radius_m": 0}})", "/sphere/radius_m", {"0"});
    wrong(R"({"sphere": {"radius_m": 1, "centre_m": [0, 0, 0]}, "position_m": [0, 0, 0]})", "/position_m", {"keep one"});
    wrong(R"({"plane": {"normal": [0, 0, 0]}})", "/plane/normal", {"length"});
    wrong(R"({"plane": {}, "mass_kg": 1})", "/mass_kg", {"plane"});
    wrong(R"({"sphere": {"radius_m": 1}, "tool": {}})", "/tool", {"mass_kg"});
    wrong(R"({"sphere": {"radius_m": 1}, "mass_kg": 1, "motion": {"times_s": [0], "positions_m": [[0, 0, 0]]}})", "/mass_kg", {"tool"});
    wrong(R"({"sphere": {"radius_m": 1}, "velocity_m_s": [0, 0, 0]})", "/velocity_m_s", {"mass_kg"});
    wrong(R"({"sphere": {"radius_m": 1}, "motion": {"times_s": [0, 0], "positions_m": [[0, 0, 0], [0, 0, 0]]}})", "/motion/times_s/1", {"ascend"});
    wrong(R"({"sphere": {"radius_m": 1}, "motion": {"times_s": [0, 1], "positions_m": [[0, 0, 0]]}})", "/motion/positions_m", {"times_s"});
    wrong(R"({"sphere": {"radius_m": 1}, "friction": 11})", "/friction", {"11"});
}

TEST(IoScene, EveryLawReadsItsParameters) {
    const auto material = [](const std::string& json) { return body_of(parse(one_body("\"material\": " + json))).def.material; };
    EXPECT_EQ(std::get<Linear>(material(R"({"law": "linear", "young_pa": 5, "poisson": 0.1})")).young_pa, 5);
    EXPECT_EQ(std::get<Corotational>(material(R"({"rotation": "large"})")).rotation, Rotation::large);
    EXPECT_EQ(std::get<Corotational>(material(R"({"rotation": "svd"})")).rotation, Rotation::svd);
    EXPECT_EQ(std::get<NeoHookean>(material(R"({"law": "NeoHookean", "mu_pa": 3, "lambda_pa": 4})")).lambda_pa, 4);
    EXPECT_NEAR(std::get<StableNeoHookean>(material(R"({"law": "StableNeoHookean", "young_pa": 2e5, "poisson": 0.4})")).mu_pa, 71428.571428571, 1e-6);
    EXPECT_EQ(std::get<StVenantKirchhoff>(material(R"({"law": "StVenantKirchhoff", "mu_pa": 3})")).mu_pa, 3);
    EXPECT_EQ(std::get<MooneyRivlin>(material(R"({"law": "MooneyRivlin", "c1_pa": 3, "c2_pa": -1, "bulk_pa": 9})")).c2_pa, -1);
    EXPECT_EQ(std::get<ArrudaBoyce>(material(R"({"law": "ArrudaBoyce", "mu_pa": 3})")).mu_pa, 3);
    EXPECT_EQ(std::get<VerondaWestman>(material(R"({"law": "VerondaWestman", "c2": 3})")).c2, 3);
    const Ogden ogden = std::get<Ogden>(material(R"({"law": "Ogden", "terms": [{"mu_pa": 3, "alpha": 2}, {"mu_pa": -1, "alpha": -2}], "bulk_pa": 8})"));
    ASSERT_EQ(ogden.terms.size(), 2u);
    EXPECT_EQ(ogden.terms[1].alpha, -2);
    EXPECT_EQ(ogden.bulk_pa, 8);

    const auto refuse = [](const std::string& text, const std::string& where, const std::vector<std::string>& words) {
        SCOPED_TRACE(text);
        try {
            parse(text);
            ADD_FAILURE() << "accepted";
        } catch (const Error& e) {
            EXPECT_NE(e.where().find(where), std::string::npos) << e.what();
            for (const std::string& word : words) EXPECT_NE(e.message().find(word), std::string::npos) << e.what();
        }
    };
    const std::string b = "/bodies/0/material";
    refuse(one_body(R"("material": {"law": "NeoHookean", "c1_pa": 3})"), b + "/c1_pa", {"unknown"});
    refuse(one_body(R"("material": {"law": "NeoHookean", "mu_pa": 3, "poisson": 0.3})"), b, {"both"});
    refuse(one_body(R"("material": {"law": "NeoHookean", "mu_pa": -3})"), b + ".mu_pa", {"-3", "above 0"});
    refuse(one_body(R"("material": {"law": "Ogden", "terms": []})"), b + ".terms", {"at least one"});
    refuse(one_body(R"("material": {"law": "linear", "rotation": "polar"})"), b + "/rotation", {"corotational"});
}

TEST(IoScene, MistakesInMeshesNameBothPlaces) {
    const test::TemporaryFolder folder;
    write_text_file(folder / "surface.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_text_file(folder / "broken.msh", "$NOD\n1\n1 0 0 zero\n$ENDNOD\n$ELM\n0\n$ENDELM\n");
    write_mesh(folder / "hexes.msh", make_hex_box({}));
    const auto scene_of = [&](const char* mesh) { return std::string(R"({"supple_scene": 1, "bodies": [{"mesh": ")") + mesh + "\"}]}"; };
    const auto refuse = [&](ErrorCode code, const char* mesh, const std::vector<std::string>& words) {
        expect_error(code, "s.json:/bodies/0/mesh", words, [&] { parse_scene(scene_of(mesh), folder.path(), "s.json"); });
    };
    refuse(ErrorCode::surface_mesh, "surface.obj", {"surface.obj", "surface mesh"});
    refuse(ErrorCode::parse, "broken.msh", {"broken.msh:3", "zero"});
    VolumeMesh folded = make_hex_box({});
    std::swap(folded.vertices[6], folded.vertices[7]);
    write_mesh(folder / "folded.msh", folded);
    refuse(ErrorCode::invalid_argument, "folded.msh", {"folded.msh", "hex 0", "Jacobian"});
    EXPECT_EQ(parse_scene(scene_of("hexes.msh"), folder.path(), "s.json").bodies.at(0).def.shape->mesh().hexes.size(), 1u);
}

TEST(IoScene, HexBoxesAndTheIntegrationOfTheirElements) {
    const auto parsed = [](const std::string& material) {
        return body_of(parse(R"({"supple_scene": 1, "bodies": [{"box": {"min_m": [0, 0, 0], "max_m": [1, 1, 1], "cells": [2, 1, 1], "elements": "hexes"},
                                 "material": )" + material + "}]}")).def;
    };
    EXPECT_EQ(parsed("{}").shape->mesh().hexes.size(), 2u);
    EXPECT_EQ(parsed("{}").shape->mesh().tets.size(), 0u);
    EXPECT_EQ(std::get<Corotational>(parsed("{}").material).integration, Integration::incompatible);
    EXPECT_EQ(std::get<Corotational>(parsed(R"({"integration": "full"})").material).integration, Integration::full);
    EXPECT_EQ(std::get<Linear>(parsed(R"({"law": "linear", "integration": "full"})").material).integration, Integration::full);
    EXPECT_EQ(std::get<Linear>(parsed(R"({"law": "linear", "integration": "incompatible"})").material).integration, Integration::incompatible);
}

TEST(IoScene, PlasticHexesAndHexesOfCostasLawRun) {
    for (const std::string material : {R"({"young_pa": 1e4, "plastic_yield": 0.02, "plastic_max": 0.3, "plastic_creep_1_s": 4})",
                                       R"({"law": "linear", "integration": "full", "young_pa": 1e4, "plastic_yield": 0.02})",
                                       R"({"law": "Costa", "a_pa": 1000, "bulk_pa": 9000, "b": [4, 2, 2, 2, 2, 2], "fibre": [1, 1, 0]})"}) {
        const Scene scene = parse(R"({"supple_scene": 1, "bodies": [{"box": {"min_m": [0, 0, 0], "max_m": [1, 1, 1], "cells": [2, 1, 1], "elements": "hexes"},
                                      "fixed": [{"box": {"min_m": [0, 0, 0], "max_m": [0, 1, 1]}}], "material": )" + material + "}]}");
        World world = build_world(scene);
        EXPECT_EQ(world.step().flags, StepFlag::none) << material;
    }
}

TEST(IoScene, OnlyErrorsEscapeFromMutatedScenes) {
    const std::string whole = R"({"supple_scene": 1, "time_step_s": 0.01, "solver": {"newton_iterations": 2}, "bodies": [{"name": "a",
        "box": {"min_m": [0, 0, 0], "max_m": [1, 1, 1], "cells": [1, 1, 1]}, "scale": 0.5, "material": {"young_pa": 1e5, "poisson": [0, 0, 0, 0, 0, 0.1]},
        "regions": [{"all": true, "stiffness_factor": 2}], "fixed": [{"vertices": [0, 1]}, "all"],
        "prescribed": [{"box": {"min_m": [0, 0, 0], "max_m": [1, 1, 1]}, "displacement_m": [0, 0, 1], "times_s": [0, 1]}],
        "loads": [{"sphere": {"centre_m": [0, 0, 0], "radius_m": 1}, "force_n": [1, 0, 0]}]}], "camera": {"eye_m": [0, 0, 1], "target_m": [0, 0, 0]}})";
    std::mt19937 random(17);
    std::size_t accepted = 0, refused = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        const std::string text = test::mutated(whole, random);
        try {
            parse(text);
            ++accepted;
        } catch (const Error& error) {
            EXPECT_EQ(error.where().compare(0, 6, "s.json"), 0) << error.what();
            ++refused;
        } catch (const std::exception& other) {
            FAIL() << other.what() << "\n" << text;
        }
    }
    EXPECT_GT(accepted, 50u);
    EXPECT_GT(refused, 500u);
}

TEST(IoScene, BuildsAWorldThatHoldsAndLoadsItsBodies) {
    const Scene scene = parse(with_key(R"("time_step_s": 0.01, "threads": 1)").replace(
        with_key(R"("time_step_s": 0.01, "threads": 1)").find("\"cells\": [2, 1, 1]}"), 19,
        R"("cells": [2, 1, 1]}, "translation_m": [0, 5, 0], "fixed": [{"box": {"min_m": [0, 0, 0], "max_m": [0, 1, 1]}}],
           "prescribed": [{"vertices": [2], "displacement_m": [0, 0, 0.25], "times_s": [0, 0.02]}], "loads": [{"vertices": [5], "force_n": [3, 0, 0]}])"));
    std::vector<std::string> messages;
    World world = build_world(scene, [&](LogLevel, std::string_view message) { messages.emplace_back(message); });
    ASSERT_EQ(world.bodies().size(), 1u);
    const BodyId body = world.bodies()[0];
    const Vec3 held = world.positions(body)[0];
    EXPECT_EQ(held, Vec3(0, 5, 0));
    const double hanging = world.positions(body)[1][1];
    for (int i = 0; i < 3; ++i) {
        const StepReport report = world.step();
        EXPECT_EQ(report.flags, StepFlag::none);
    }
    EXPECT_EQ(world.positions(body)[0], held);
    EXPECT_NEAR(world.positions(body)[2][2], 0.25, 1e-12);
    EXPECT_LT(world.positions(body)[1][1], hanging);
}

}  // namespace
}  // namespace supple::io
