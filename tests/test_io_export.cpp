// Results for other programs, and other programs' readers of our files.
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>

#include "supple/io/binary_file.h"
#include "supple/io/mesh_file.h"
#include "supple/io/mesh_formats.h"
#include "supple/io/result_export.h"
#include "supple/io/surface_file.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/surface_check.h"
#include "supple/world/world.h"
#include "test_io_helpers.h"

namespace supple::io {
namespace {

using test::expect_error;

/// A soft plastic bar with a region, held at its left end, falling.
World falling_bar() {
    VolumeMesh mesh = make_tet_box({.max_m = {0.4, 0.1, 0.1}, .cells = {4, 1, 1}});
    mesh.regions = {{"soft part", 3}};
    mesh.element_region.assign(mesh.element_count(), -1);
    mesh.element_region[0] = 0;
    mesh.groups = {{"left end", {0, 5, 10, 15}}};
    World world({.time_step_s = 0.02, .threads = 1});
    BodyDef def;
    def.name = "bar/1 <soft>";
    def.shape = BodyTemplate::build(std::move(mesh));
    def.material = Corotational{.young_pa = 3e3, .poisson = 0.4, .plasticity = {.yield = 0.001, .creep_1_s = 20}};
    const BodyId bar = world.add_body(def);
    world.fix(bar, InGroup{"left end"});
    return world;
}

void run(World& world, ResultExport& out, int steps) {
    out.add_frame(world);
    for (int i = 0; i < steps; ++i) {
        world.step();
        out.add_frame(world);
    }
    out.finish();
}

TEST(IoExport, AFolderGetsAVtuPerFrameAndTheirList) {
    const test::TemporaryFolder folder;
    World world = falling_bar();
    const auto out = ResultExport::open(folder / "results", world, false);
    run(world, *out, 3);
    const std::string list = read_text_file(folder / "results/results.pvd");
    EXPECT_NE(list.find("timestep=\"0.06\" group=\"\" part=\"0\" name=\"bar/1 &lt;soft&gt;\" file=\"0_bar_1__soft__000003.vtu\""),
              std::string::npos)
        << list;
    const VolumeMesh back = read_mesh(folder / "results/0_bar_1__soft__000003.vtu");
    const BodyId bar = world.bodies()[0];
    ASSERT_EQ(back.vertices.size(), world.positions(bar).size());
    for (std::size_t v = 0; v < back.vertices.size(); ++v) EXPECT_EQ(back.vertices[v], world.positions(bar)[v]);
    EXPECT_EQ(back.regions[0].name, "soft part");
    EXPECT_EQ(back.groups[0].name, "left end");
    const std::string text = read_text_file(folder / "results/0_bar_1__soft__000003.vtu");
    for (const char* array : {"displacement_m", "velocity_m_s", "stress_pa", "von_mises_pa", "plastic_strain"})
        EXPECT_NE(text.find(std::string("Name=\"") + array + "\""), std::string::npos) << array;
    EXPECT_GT(world.plastic_strain(bar)[0][0] * world.plastic_strain(bar)[0][0], 0);
}

TEST(IoExport, TheLastStateAsVtuAndAsASurface) {
    const test::TemporaryFolder folder;
    World world = falling_bar();
    run(world, *ResultExport::open(folder / "last.vtu", world, false), 2);
    EXPECT_EQ(read_mesh(folder / "last.vtu").vertices.back(), world.positions(world.bodies()[0]).back());
    run(world, *ResultExport::open(folder / "skin.ply", world, false), 2);
    const mesh::TriangleMesh skin = read_surface(folder / "skin.ply");
    EXPECT_TRUE(mesh::check_surface(skin).is_closed());
    EXPECT_EQ(skin.vertices.back(), world.positions(world.bodies()[0]).back());
    run(world, *ResultExport::open(folder / "skin.obj", world, true), 1);
    EXPECT_TRUE(std::filesystem::exists(folder / "skin_000004.obj"));
    EXPECT_TRUE(std::filesystem::exists(folder / "skin_000005.obj"));
    expect_error(ErrorCode::unsupported, (folder / "a.xyz").string(), {".xyz", ".glb"},
                 [&] { ResultExport::open(folder / "a.xyz", world, false); });
    world.add_body({.shape = BodyTemplate::build(make_tet_box({}))});
    expect_error(ErrorCode::unsupported, (folder / "a.vtu").string(), {"one body", "2"},
                 [&] { ResultExport::open(folder / "a.vtu", world, false); });
}

/// The rules of glTF 2.0 that a viewer relies on.
void expect_valid_gltf(const nlohmann::json& g, const std::string& buffer) {
    EXPECT_EQ(g["asset"]["version"], "2.0");
    ASSERT_EQ(g["buffers"][0]["byteLength"].get<std::size_t>(), buffer.size());
    for (const auto& view : g["bufferViews"]) {
        EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
        EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), buffer.size());
        EXPECT_GT(view["byteLength"].get<std::size_t>(), 0u);
    }
    for (const auto& a : g["accessors"]) {
        const std::size_t width = a["type"] == "VEC3" ? 12 : 4;
        EXPECT_EQ(a["count"].get<std::size_t>() * width,
                  g["bufferViews"][a["bufferView"].get<std::size_t>()]["byteLength"].get<std::size_t>());
    }
    for (const auto& mesh : g["meshes"])
        for (const auto& p : mesh["primitives"]) {
            const auto& position = g["accessors"][p["attributes"]["POSITION"].get<std::size_t>()];
            EXPECT_TRUE(position.contains("min") && position.contains("max"));
            if (!p.contains("targets")) continue;
            EXPECT_EQ(mesh["weights"].size(), p["targets"].size());
            for (const auto& t : p["targets"]) EXPECT_EQ(g["accessors"][t["POSITION"].get<std::size_t>()]["count"], position["count"]);
        }
}

TEST(IoExport, AnAnimationAsGltf) {
    const test::TemporaryFolder folder;
    World world = falling_bar();
    run(world, *ResultExport::open(folder / "a.glb", world, false), 3);
    const std::string bytes = read_text_file(folder / "a.glb");
    ASSERT_EQ(bytes.substr(0, 4), "glTF");
    const auto number = [&](std::size_t at) {
        std::uint32_t n;
        std::memcpy(&n, bytes.data() + at, 4);
        return std::size_t(n);
    };
    EXPECT_EQ(number(8), bytes.size());
    const std::size_t json_size = number(12);
    EXPECT_EQ(json_size % 4, 0u);
    const nlohmann::json g = nlohmann::json::parse(bytes.substr(20, json_size));
    const std::string buffer = bytes.substr(20 + json_size + 8);
    EXPECT_EQ(number(20 + json_size), buffer.size());
    expect_valid_gltf(g, buffer);

    // First frame plus the last target is the last surface.
    const auto& primitive = g["meshes"][0]["primitives"][0];
    const auto vector_of = [&](std::size_t accessor, std::size_t i) {
        float x[3];
        const auto& view = g["bufferViews"][g["accessors"][accessor]["bufferView"].get<std::size_t>()];
        std::memcpy(x, buffer.data() + view["byteOffset"].get<std::size_t>() + 12 * i, 12);
        return Vec3(x[0], x[1], x[2]);
    };
    EXPECT_EQ(primitive["targets"].size(), 3u);
    const BodyId bar = world.bodies()[0];
    const std::size_t last = world.positions(bar).size() - 1;  // every vertex of this bar is on its surface
    const Vec3 moved = vector_of(primitive["attributes"]["POSITION"], last) + vector_of(primitive["targets"][2]["POSITION"], last);
    EXPECT_LT((moved - world.positions(bar)[last]).norm(), 1e-6);
    EXPECT_GT((world.positions(bar)[last] - world.start_positions(bar)[last]).norm(), 1e-3);
    const auto& animation = g["animations"][0];
    const auto& sampler = animation["samplers"][animation["channels"][0]["sampler"].get<std::size_t>()];
    EXPECT_EQ(g["accessors"][sampler["output"].get<std::size_t>()]["count"], 12);  // 4 times x 3 targets
    EXPECT_EQ(g["accessors"][sampler["input"].get<std::size_t>()]["count"], 4);

    run(world, *ResultExport::open(folder / "a.gltf", world, false), 1);
    const nlohmann::json text = nlohmann::json::parse(read_text_file(folder / "a.gltf"));
    EXPECT_EQ(text["buffers"][0]["uri"].get<std::string>().substr(0, 37), "data:application/octet-stream;base64,");
    for (const char* file : {"a.glb", "a.gltf"}) {
        try {
            EXPECT_EQ(read_surface(folder / file).triangles.size(),
                      g["accessors"][primitive["indices"].get<std::size_t>()]["count"].get<std::size_t>() / 3);
        } catch (const Error& error) {
            EXPECT_EQ(to_string(error.code()), "unsupported") << error.what();
            std::cout << "skipped: " << error.what() << std::endl;
        }
    }
}

TEST(IoExport, AnEditedBodyHasAMeshPerMeshItHadInAGltfAnimation) {
    const test::TemporaryFolder folder;
    World world = falling_bar();
    const BodyId bar = world.bodies()[0];
    const std::size_t before = world.shape(bar).boundary().triangles.size();
    const auto out = ResultExport::open(folder / "a.gltf", world, true);
    std::vector<float> times;
    std::vector<std::size_t> triangles;
    for (int frame = 0; frame < 6; ++frame) {
        if (frame == 2) world.remove_elements(bar, std::vector<std::int32_t>{0});
        if (frame == 5) world.undo_edit(bar);
        out->add_frame(world);
        times.push_back(float(world.time_s()));
        triangles.push_back(world.shape(bar).boundary().triangles.size());
        world.step();
    }
    out->finish();
    const nlohmann::json g = nlohmann::json::parse(read_text_file(folder / "a.gltf"));
    ASSERT_EQ(g["meshes"].size(), 3u) << "frames 0 and 1, 2 to 4, 5";
    EXPECT_NE(triangles[2], before);
    EXPECT_EQ(triangles[5], before);
    const std::size_t first[] = {0, 2, 5}, frames[] = {2, 3, 1};
    for (std::size_t m = 0; m < 3; ++m) {
        const auto& primitive = g["meshes"][m]["primitives"][0];
        EXPECT_EQ(g["accessors"][primitive["indices"].get<std::size_t>()]["count"], 3 * triangles[first[m]]);
        EXPECT_EQ(primitive.contains("targets") ? primitive["targets"].size() : 0, frames[m] - 1);
        EXPECT_EQ(primitive["material"], 0) << "one body, one colour";
    }
    // When each is seen.
    const auto& animation = g["animations"][0];
    for (std::size_t m = 0; m < 3; ++m) {
        bool found = false;
        for (const auto& channel : animation["channels"]) {
            if (channel["target"]["node"] != m + 1 || channel["target"]["path"] != "scale") continue;
            found = true;
            const auto& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
            EXPECT_EQ(sampler["interpolation"], "STEP");
            const auto& input = g["accessors"][sampler["input"].get<std::size_t>()];
            EXPECT_EQ(input["count"], g["accessors"][sampler["output"].get<std::size_t>()]["count"]);
            if (m == 1) {
                EXPECT_EQ(input["count"], 3) << "gone, seen, gone";
                EXPECT_EQ(input["min"][0].get<float>(), times[0]);
                EXPECT_EQ(input["max"][0].get<float>(), times[5]);
            }
        }
        EXPECT_TRUE(found) << m;
    }
    for (const auto& channel : animation["channels"])
        if (channel["target"]["path"] == "weights") {
            const std::size_t m = channel["target"]["node"].get<std::size_t>() - 1;
            EXPECT_EQ(g["accessors"][animation["samplers"][channel["sampler"].get<std::size_t>()]["input"].get<std::size_t>()]["count"], frames[m]);
        }
}

TEST(IoExport, MeshioReadsWhatWeWrite) {
    std::string python;
    if (!test::python_with("meshio", python)) return;
    const test::TemporaryFolder folder;
    VolumeMesh mesh = make_tet_box({.max_m = {1, 2, 3}, .cells = {2, 1, 1}});
    mesh.vertices.push_back({5, 5, 5});
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back(
            {double(i == 1 || i == 2 || i == 5 || i == 6), double(i == 2 || i == 3 || i == 6 || i == 7), 4.0 + (i > 3)});
    const auto first = std::int32_t(mesh.vertices.size()) - 8;
    mesh.hexes = {{first, first + 1, first + 2, first + 3, first + 4, first + 5, first + 6, first + 7}};
    mesh.regions = {{"soft", 3}, {"hard", 8}};
    mesh.element_region.assign(mesh.element_count(), 0);
    mesh.element_region.back() = 1;
    std::string program = "import meshio, numpy as np, sys\n";
    program += "points = np.array([";
    for (const Vec3& x : mesh.vertices) program += "[" + to_text(x.x()) + "," + to_text(x.y()) + "," + to_text(x.z()) + "],";
    program += "])\ntets = np.array([";
    for (const Tet& t : mesh.tets)
        program += "[" + std::to_string(t[0]) + "," + std::to_string(t[1]) + "," + std::to_string(t[2]) + "," + std::to_string(t[3]) + "],";
    program += "])\nhexes = np.array([[";
    for (const std::int32_t v : mesh.hexes[0]) program += std::to_string(v) + ",";
    program +=
        "]])\nfailed = 0\n"
        "def check(name, form):\n"
        "    global failed\n"
        "    try:\n"
        "        m = meshio.read(name, file_format=form)\n"
        "        t = np.vstack([c.data for c in m.cells if c.type == 'tetra']); h = np.vstack([c.data for c in m.cells if c.type == "
        "'hexahedron'])\n"
        "        assert np.array_equal(m.points, points), 'points'\n"
        "        assert np.array_equal(t, tets), 'tets'\n"
        "        assert np.array_equal(h, hexes), 'hexes'\n"
        "    except BaseException as e:\n"
        "        print(name, 'FAILED', repr(e)); failed = 1\n";
    std::size_t checked = 0;
    for (const OutputFormat& format : output_formats()) {
        if (!format.write || format.key == "tetgen") continue;
        const std::string name = std::string(format.key) + std::string(format.endings);
        write_mesh(folder / name, mesh, format.key);
        const std::string ending(format.endings.substr(1));
        program += "check('" + (folder / name).string() + "', '" +
                   (ending == "msh"    ? "gmsh"
                    : ending == "mesh" ? "medit"
                                       : ending) +
                   "')\n";
        ++checked;
    }
    EXPECT_EQ(checked, 13u);
    World world = falling_bar();
    run(world, *ResultExport::open(folder / "r.vtu", world, false), 1);
    program += "m = meshio.read('" + (folder / "r.vtu").string() +
               "')\n"
               "for k, n in (('displacement_m', 3), ('velocity_m_s', 3), ('stress_pa', 6)): assert m.point_data[k].shape == "
               "(len(m.points), n), k\n"
               "assert float(m.point_data['von_mises_pa'].max()) > 0\nassert 'plastic_strain' in m.cell_data\nsys.exit(failed)\n";
    write_text_file(folder / "check.py", program);
    EXPECT_EQ(std::system((python + " " + (folder / "check.py").string()).c_str()), 0);
}

TEST(IoExport, WeReadWhatMeshioWrites) {
    std::string python;
    if (!test::python_with("meshio", python)) return;
    const test::TemporaryFolder folder;
    struct Row {
        const char *file, *options;
        bool hexes;
    };
    const Row rows[] = {{"gmsh22_ascii.msh", "file_format='gmsh22', binary=False", true},
                        {"gmsh22.msh", "file_format='gmsh22', binary=True", true},
                        {"gmsh41_ascii.msh", "file_format='gmsh', binary=False", false},
                        {"gmsh41.msh", "file_format='gmsh', binary=True", false},
                        {"ascii.vtk", "binary=False", true},
                        {"binary.vtk", "binary=True", true},
                        {"ascii.vtu", "binary=False", true},
                        {"zlib.vtu", "compression='zlib'", true},
                        {"plain.vtu", "compression=None", true},
                        {"a.mesh", "", true},
                        {"a.inp", "", true},
                        {"a.node", "", false}};
    std::string program =
        "import meshio, numpy as np\n"
        "p = np.array([[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,1],[0.1,0.2,3]])\n"
        "t = ('tetra', np.array([[4,5,6,8],[4,6,7,8]]))\nh = ('hexahedron', np.array([[0,1,2,3,4,5,6,7]]))\n";
    for (const Row& row : rows) {
        const std::string cells = row.hexes ? "[t, h]" : "[t]";
        const std::string data = row.hexes ? "[np.array([7, 8]), np.array([9])]" : "[np.array([7, 8])]";
        const std::string tags = row.hexes && std::string(row.file).find("msh") != std::string::npos
                                     ? ", cell_data={'gmsh:physical': " + data + ", 'gmsh:geometrical': " + data + "}"
                                 : std::string(row.file) == "a.mesh" || std::string(row.file).find(".vt") != std::string::npos
                                     ? ", cell_data={'medit:ref': " + data + "}"
                                     : "";
        program += "meshio.write('" + (folder / row.file).string() + "', meshio.Mesh(p, " + cells + tags + ")" +
                   (*row.options ? std::string(", ") + row.options : "") + ")\n";
    }
    write_text_file(folder / "write.py", program);
    ASSERT_EQ(std::system((python + " " + (folder / "write.py").string() + " 2>/dev/null").c_str()), 0);
    for (const Row& row : rows) {
        SCOPED_TRACE(row.file);
        const VolumeMesh mesh = read_mesh(folder / row.file);
        EXPECT_EQ(mesh.vertices.size(), 9u);
        EXPECT_EQ(mesh.vertices[8], Vec3(0.1, 0.2, 3));
        EXPECT_EQ(mesh.tets, (std::vector<Tet>{{4, 5, 6, 8}, {4, 6, 7, 8}}));
        if (row.hexes) {
            EXPECT_EQ(mesh.hexes, (std::vector<Hex>{{0, 1, 2, 3, 4, 5, 6, 7}}));
        }
        const std::string name(row.file);
        if (!row.hexes || name == "a.inp") continue;  // meshio gives those no tags
        ASSERT_EQ(mesh.element_region.size(), 3u);
        EXPECT_EQ(mesh.regions[std::size_t(mesh.element_region[1])].tag, 8);
        EXPECT_EQ(mesh.regions[std::size_t(mesh.element_region[2])].tag, 9);
    }
}

}  // namespace
}  // namespace supple::io
