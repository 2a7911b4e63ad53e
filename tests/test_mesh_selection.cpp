#include <limits>

#include "mesh_helpers.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/selection.h"

namespace supple {
namespace {

using Ids = std::vector<std::int32_t>;
using supple_test::expect_error;

VolumeMesh labelled_bar() {
    VolumeMesh mesh = make_tet_box({Vec3(0, 0, 0), Vec3(4, 1, 1), {4, 1, 1}});  // vertex (i,j,k) = i + 5 (j + 2 k)
    mesh.regions = {{"left", 1}, {"right", 2}};
    for (int e = 0; e < 24; ++e) mesh.element_region.push_back(e < 12 ? 0 : 1);
    mesh.groups = {{"tip", {4, 9, 14, 19}}};
    return mesh;
}

TEST(MeshSelection, Vertices) {
    const VolumeMesh mesh = labelled_bar();
    EXPECT_EQ(select_vertices(mesh, Everything{}).size(), 20u);
    EXPECT_EQ(select_vertices(mesh, InsideBox{Vec3(-1, -1, -1), Vec3(0, 1, 1)}), (Ids{0, 5, 10, 15})) << "closed box";
    EXPECT_EQ(select_vertices(mesh, InsideSphere{Vec3(4, 0, 0), 1.0}), (Ids{3, 4, 9, 14})) << "closed sphere";
    EXPECT_EQ(select_vertices(mesh, InsideSphere{Vec3(4, 0, 0), 0.0}), (Ids{4}));
    EXPECT_EQ(select_vertices(mesh, VertexList{{7, 2, 7, 0}}), (Ids{0, 2, 7}));
    EXPECT_EQ(select_vertices(mesh, InGroup{"tip"}), (Ids{4, 9, 14, 19}));
    EXPECT_EQ(select_vertices(mesh, InGroup{"left"}), select_vertices(mesh, InsideBox{Vec3(0, 0, 0), Vec3(2, 1, 1)}));
    EXPECT_TRUE(select_vertices(mesh, InsideBox{Vec3(9, 9, 9), Vec3(10, 10, 10)}).empty());
}

TEST(MeshSelection, Elements) {
    const VolumeMesh mesh = labelled_bar();
    EXPECT_EQ(select_elements(mesh, Everything{}).size(), 24u);
    EXPECT_EQ(select_elements(mesh, InsideBox{Vec3(0, 0, 0), Vec3(1.5, 1, 1)}), (Ids{0, 1, 2, 3, 4, 5})) << "all vertices inside";
    EXPECT_EQ(select_elements(mesh, InGroup{"right"}), (Ids{12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23}));
    EXPECT_TRUE(select_elements(mesh, InGroup{"tip"}).empty()) << "a face holds no element";
    const VolumeMesh hexes = make_hex_box({Vec3(0, 0, 0), Vec3(4, 1, 1), {4, 1, 1}});
    EXPECT_EQ(select_elements(hexes, InsideBox{Vec3(1, 0, 0), Vec3(3, 1, 1)}), (Ids{1, 2}));
}

TEST(MeshSelection, MistakesNameTheLegalValues) {
    const VolumeMesh mesh = labelled_bar();
    expect_error(ErrorCode::invalid_argument, "it has \"left\", \"right\", \"tip\"", [&] { select_vertices(mesh, InGroup{"tipp"}); });
    expect_error(ErrorCode::invalid_argument, "no group \"x\"", [&] { select_elements(mesh, InGroup{"x"}); });
    expect_error(ErrorCode::invalid_argument, "no groups", [] { select_vertices(make_hex_box({}), InGroup{"x"}); });
    expect_error(ErrorCode::invalid_argument, "vertex 20", [&] { select_vertices(mesh, VertexList{{20}}); });
    expect_error(ErrorCode::invalid_argument, "vertex -1", [&] { select_elements(mesh, VertexList{{-1}}); });
    expect_error(ErrorCode::invalid_argument, "in y from 1 to 0", [&] { select_vertices(mesh, InsideBox{Vec3(0, 1, 0), Vec3(1, 0, 1)}); });
    expect_error(ErrorCode::invalid_argument, "radius", [&] { select_vertices(mesh, InsideSphere{Vec3(0, 0, 0), -1}); });
    const double nan = std::numeric_limits<double>::quiet_NaN();
    expect_error(ErrorCode::invalid_argument, "radius", [&] { select_vertices(mesh, InsideSphere{Vec3(0, 0, 0), nan}); });
    expect_error(ErrorCode::invalid_argument, "InsideBox", [&] { select_vertices(mesh, InsideBox{Vec3(nan, 0, 0), Vec3(1, 1, 1)}); });
}

}  // namespace
}  // namespace supple
