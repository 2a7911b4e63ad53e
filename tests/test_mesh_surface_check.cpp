#include <gtest/gtest.h>

#include "supple/base/error.h"
#include "supple/mesh/surface_check.h"

namespace supple::mesh {
namespace {

/// A tetrahedron's surface, outwards.
TriangleMesh tetrahedron() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}}; }

TEST(MeshSurfaceCheck, AClosedSurfaceHasNothingToReport) {
    const SurfaceReport report = check_surface(tetrahedron());
    EXPECT_TRUE(report.is_closed());
    EXPECT_TRUE(report.sentences().empty());
    EXPECT_EQ(report.components, 1u);
    EXPECT_NEAR(report.volume_m3, 1.0 / 6, 1e-15);
    EXPECT_EQ(report.max_m, Vec3(1, 1, 1));
}

TEST(MeshSurfaceCheck, FindsEachFault) {
    TriangleMesh open = tetrahedron();
    open.triangles.pop_back();
    EXPECT_EQ(check_surface(open).open_edges, 3u);
    EXPECT_FALSE(check_surface(open).is_closed());

    TriangleMesh turned = tetrahedron();
    std::swap(turned.triangles[0][0], turned.triangles[0][1]);
    EXPECT_EQ(check_surface(turned).turned_edges, 3u);
    EXPECT_FALSE(check_surface(turned).is_closed());

    TriangleMesh inwards = tetrahedron();
    for (Triangle& t : inwards.triangles) std::swap(t[0], t[1]);
    ASSERT_EQ(check_surface(inwards).sentences().size(), 1u);
    EXPECT_NE(check_surface(inwards).sentences()[0].find("inwards"), std::string::npos);

    TriangleMesh twice = tetrahedron();
    twice.triangles.push_back({2, 3, 1});
    EXPECT_EQ(check_surface(twice).duplicate_triangles, 1u);
    EXPECT_EQ(check_surface(twice).crowded_edges, 3u);

    TriangleMesh flat = tetrahedron();
    flat.vertices.push_back({0.5, 0, 0});
    flat.triangles.push_back({0, 1, 4});
    flat.triangles.push_back({2, 2, 3});
    EXPECT_EQ(check_surface(flat).degenerate_triangles, 2u);

    TriangleMesh loose = tetrahedron();
    loose.vertices.push_back({0, 0, 1});
    EXPECT_EQ(check_surface(loose).unreferenced_vertices, 1u);
    EXPECT_EQ(check_surface(loose).duplicate_vertices, 1u);

    // Two tetrahedra that share a vertex: two parts, pinched there.
    TriangleMesh touching = tetrahedron();
    for (const Vec3& x : {Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)}) touching.vertices.push_back(x);
    for (const Triangle& t : {Triangle{5, 4, 6}, Triangle{6, 0, 5}, Triangle{4, 0, 6}, Triangle{5, 0, 4}}) touching.triangles.push_back(t);
    const SurfaceReport report = check_surface(touching);
    EXPECT_EQ(report.components, 2u);
    EXPECT_EQ(report.pinched_vertices, 1u);

    TriangleMesh bad = tetrahedron();
    bad.triangles[0][0] = 9;
    EXPECT_THROW(check_surface(bad), Error);
}

}  // namespace
}  // namespace supple::mesh
