// Skins under edits: split where the tets are, closed where they were closed, and back again.
#include <Eigen/Geometry>

#include "support/bodies.h"
#include "support/edits.h"
#include "supple/base/disjoint_sets.h"
#include "supple/base/parallel.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/cook.h"
#include "supple/mesh/mesh_grow.h"
#include "supple/mesh/skin.h"
#include "supple/mesh/surface.h"
#include "supple/mesh/surface_check.h"
#include "supple/mesh/triangle_tree.h"

namespace supple {
namespace {

const Vec3 kSize(0.4, 0.1, 0.1);

/// The faces of a box in n x m x m squares of two triangles.
mesh::TriangleMesh box_surface(int n, int m, double grow) {
    const VolumeMesh fine = make_tet_box({.max_m = kSize, .cells = {n, m, m}});
    mesh::TriangleMesh surface{fine.vertices, extract_boundary(fine).triangles};
    for (Vec3& x : surface.vertices) x = 0.5 * kSize + ((x - 0.5 * kSize).array() * (1 + 2 * grow / kSize.array())).matrix();
    return weld(surface);
}

struct Case {
    const char* name;
    mesh::TriangleMesh surface;
    bool on_boundary;
};

std::vector<Case> cases(const VolumeMesh& mesh) {
    return {{"the boundary", {mesh.vertices, extract_boundary(mesh).triangles}, true},
            {"finer", box_surface(33, 9, 0), true},
            {"coarser", box_surface(5, 2, 0), true},
            {"outside", box_surface(21, 7, 0.004), false},
            {"inside", box_surface(21, 7, -0.004), false}};
}

/// A plane, a little oblique, down to a height.
mesh::TriangleMesh oblique_blade(double deep) { return swept_blade(std::vector<Vec3>{{0.19, 1, -1}, {0.23, 1, 1}}, std::vector<Vec3>{{0.19, deep, -1}, {0.23, deep, 1}}); }

/// Parts of a surface that share no vertex: a number per vertex.
std::vector<std::size_t> parts_of(const mesh::TriangleMesh& surface, std::size_t& count) {
    DisjointSets sets(surface.vertices.size());
    for (const Triangle& t : surface.triangles)
        for (const std::int32_t v : t) sets.join(std::size_t(t[0]), std::size_t(v));
    std::vector<std::size_t> root(surface.vertices.size());
    std::set<std::size_t> all;
    for (std::size_t v = 0; v < root.size(); ++v) all.insert(root[v] = sets.root(v));
    count = all.size();
    return root;
}

/// Area of the skin that edits did not make.
double outer_area(const Skin& skin) {
    mesh::TriangleMesh outer{skin.surface().vertices, {}};
    for (std::size_t t = 0; t < skin.surface().triangles.size(); ++t)
        if (!skin.is_inner(t)) outer.triangles.push_back(skin.surface().triangles[t]);
    return area_of(outer);
}

std::vector<Vec3> bent(const VolumeMesh& mesh) {
    std::vector<Vec3> x = mesh.vertices;
    for (Vec3& p : x) p += Vec3(0.02 * std::sin(20 * p.y()) + 0.1 * p.z() * p.z(), 0.3 * p.x() * p.x(), 0.02 * std::cos(9 * p.x() + 5 * p.y()));
    return x;
}

std::vector<Vec3> deformed(const Skin& skin, const std::vector<Vec3>& x) {
    std::vector<Vec3> out(skin.surface().vertices.size());
    skin.embedding().deform(x, out);
    return out;
}

TEST(TopologySkin, AClosedSkinStaysClosedAndKeepsItsArea) {
    const VolumeMesh mesh = make_tet_box({.max_m = kSize, .cells = {16, 4, 4}});
    for (const Case& c : cases(mesh))
        for (const double deep : {-1.0, 0.043}) {
            SCOPED_TRACE(std::string(c.name) + (deep < 0 ? ", cut through" : ", cut into"));
            const auto skin = Skin::build(mesh, c.surface);
            const MeshEdit edit = cut(mesh, mesh.vertices, oblique_blade(deep));
            const auto now = skin->follow(mesh, edit);
            const double area = area_of(c.surface);
            EXPECT_NEAR(outer_area(*now), area, 1e-9 * area);
            EXPECT_GT(now->inner_triangles(), 10u);
            const mesh::SurfaceReport check = mesh::check_surface(now->surface());
            EXPECT_TRUE(check.is_closed()) << check.open_edges << " open, " << check.turned_edges << " turned, " << check.crowded_edges << " crowded edges, " << check.pinched_vertices << " pinched";
            std::size_t parts = 0;
            parts_of(now->surface(), parts);
            EXPECT_EQ(parts, deep < 0 ? 2u : 1u);
            // The lips are those of the tets, however it bends: every inner vertex stays on the boundary of the mesh.
            const std::vector<Vec3> x = bent(edit.mesh), y = deformed(*now, x);
            const BoundarySurface boundary = extract_boundary(edit.mesh);
            const TriangleTree tree({x, boundary.triangles});
            double farthest = 0;
            for (std::size_t t = 0; t < now->surface().triangles.size(); ++t) {
                if (!c.on_boundary && !now->is_inner(t)) continue;
                for (const std::int32_t v : now->surface().triangles[t]) farthest = std::max(farthest, tree.nearest(y[std::size_t(v)]).distance);
            }
            EXPECT_LT(farthest, c.on_boundary && std::string(c.name) != "coarser" ? 1e-6 * 0.4 : 0.01);
        }
}

TEST(TopologySkin, NoTriangleStraddlesAndLipsLieOnTheCut) {
    const VolumeMesh mesh = make_tet_box({.max_m = kSize, .cells = {16, 4, 4}});
    for (const Case& c : cases(mesh)) {
        SCOPED_TRACE(c.name);
        const auto skin = Skin::build(mesh, c.surface);
        const MeshEdit edit = cut(mesh, mesh.vertices, oblique_blade(-1));
        const auto now = skin->follow(mesh, edit);
        // Pulled apart, the halves' elements go with their own: no edge is longer than it was.
        const Pieces pieces = find_pieces(edit.mesh);
        ASSERT_EQ(pieces.volume_m3.size(), 2u);
        std::vector<Vec3> apart = edit.mesh.vertices;
        std::set<std::int32_t> moved;
        for (std::size_t e = 0; e < pieces.of_element.size(); ++e)
            if (pieces.of_element[e] == 1)
                for (const std::int32_t v : element_vertices(edit.mesh, e)) moved.insert(v);
        for (const std::int32_t v : moved) apart[std::size_t(v)] += Vec3(1, 0, 0);
        const std::vector<Vec3> y = deformed(*now, apart);
        const mesh::TriangleMesh& surface = now->surface();
        for (const Triangle& t : surface.triangles)
            for (std::size_t k = 0; k < 3; ++k) {
                const auto a = std::size_t(t[k]), b = std::size_t(t[(k + 1) % 3]);
                EXPECT_NEAR((y[a] - y[b]).norm(), (surface.vertices[a] - surface.vertices[b]).norm(), 1e-9);
            }
        // Every vertex that the two halves have in common at rest lies on opened faces, or straight above or below their rim.
        std::vector<std::int32_t> parents = boundary_parents(mesh, edit);
        const BoundarySurface boundary = extract_boundary(edit.mesh);
        mesh::TriangleMesh opened{edit.mesh.vertices, {}};
        for (std::size_t t = 0; t < parents.size(); ++t)
            if (parents[t] < 0) opened.triangles.push_back(boundary.triangles[t]);
        const TriangleTree tree(opened);
        std::size_t inner = 0;
        double farthest = 0;
        for (std::size_t t = 0; t < surface.triangles.size(); ++t)
            if (now->is_inner(t))
                for (const std::int32_t v : surface.triangles[t]) {
                    ++inner;
                    farthest = std::max(farthest, tree.nearest(surface.vertices[std::size_t(v)]).distance);
                }
        EXPECT_GT(inner, 30u);
        EXPECT_LT(farthest, std::string(c.name) == "outside" ? 0.0045 * 1.8 : 1e-6 * 0.4);
    }
}

TEST(TopologySkin, TextureIsInterpolatedAndInnerFacesHaveTheirOwn) {
    const VolumeMesh mesh = make_tet_box({.max_m = kSize, .cells = {16, 4, 4}});
    const mesh::TriangleMesh surface = box_surface(13, 5, 0);
    // An affine map: interpolation must give it back.
    const auto map = [](const Vec3& x) { return std::array<double, 2>{3 * x.x() - x.y() + 1, 2 * x.z() + x.y()}; };
    std::vector<TextureCorners> texture;
    for (const Triangle& t : surface.triangles) texture.push_back({map(surface.vertices[std::size_t(t[0])]), map(surface.vertices[std::size_t(t[1])]), map(surface.vertices[std::size_t(t[2])])});
    const auto now = Skin::build(mesh, surface, texture)->follow(mesh, cut(mesh, mesh.vertices, oblique_blade(0.043)));
    ASSERT_EQ(now->texture().size(), now->surface().triangles.size());
    std::size_t split = 0;
    for (std::size_t t = 0; t < now->texture().size(); ++t) {
        const auto X = [&](std::size_t k) -> const Vec3& { return now->surface().vertices[std::size_t(now->surface().triangles[t][k])]; };
        const auto& uv = now->texture()[t];
        if (now->is_inner(t)) {  // lengths: no stretch across the plane of the cut
            for (std::size_t k = 0; k < 3; ++k) {
                const double on_map = std::hypot(uv[k][0] - uv[(k + 1) % 3][0], uv[k][1] - uv[(k + 1) % 3][1]), length = (X(k) - X((k + 1) % 3)).norm();
                EXPECT_LE(on_map, length * (1 + 1e-9));
                EXPECT_GE(on_map, 0.3 * length);
            }
            continue;
        }
        ++split;
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t c = 0; c < 2; ++c) EXPECT_NEAR(uv[k][c], map(X(k))[c], 1e-6);
    }
    EXPECT_GT(split, surface.triangles.size());
    supple_test::expect_error(ErrorCode::invalid_argument, "3 triangles for a surface of", [&] { Skin::build(mesh, surface, std::span(texture).first(3)); });
}

TEST(TopologySkin, CutsOneAfterTheOtherAndErasuresKeepItClosed) {
    for (const bool hexes : {false, true}) {
        SCOPED_TRACE(hexes);
        VolumeMesh mesh = hexes ? make_hex_box({.max_m = kSize, .cells = {16, 4, 4}}) : make_tet_box({.max_m = kSize, .cells = {16, 4, 4}});
        auto skin = Skin::build(mesh, {mesh.vertices, extract_boundary(mesh).triangles});
        const auto look = [&](MeshEdit edit) {
            ASSERT_FALSE(edit.delta.is_identity());
            skin = skin->follow(mesh, edit);
            mesh = std::move(edit.mesh);
            const mesh::SurfaceReport check = mesh::check_surface(skin->surface());
            EXPECT_EQ(check.open_edges, 0u);
            EXPECT_EQ(check.turned_edges, 0u);
            EXPECT_LE(check.crowded_edges, edit.delta.removed_elements().empty() ? 0u : 2u);  // a crater may touch the end of a slit
            // On the boundary of the mesh it is as large, and stays there.
            const BoundarySurface boundary = extract_boundary(mesh);
            const double area = area_of({mesh.vertices, boundary.triangles});
            EXPECT_NEAR(area_of(skin->surface()), area, 1e-7 * area);
        };
        look(cut(mesh, mesh.vertices, oblique_blade(0.043)));
        look(cut(mesh, mesh.vertices, swept_blade(std::vector<Vec3>{{-1, 0.062, -1}, {1, 0.062, -1}}, std::vector<Vec3>{{-1, 0.062, 0.055}, {1, 0.062, 0.055}})));
        std::vector<std::int32_t> some;
        for (std::size_t e = 0; e < mesh.element_count(); ++e)
            if ((mesh.vertices[std::size_t(element_vertices(mesh, e)[0])] - Vec3(0.2, 0.1, 0.05)).norm() < 0.04) some.push_back(std::int32_t(e));
        look(remove_elements(mesh, some));
    }
}

/// A round, wavy surface much finer than the tets that are cooked of it: it lies outside of them in places, and inside in others.
mesh::TriangleMesh wavy_surface() {
    const VolumeMesh cube = make_tet_box({.min_m = {-1, -1, -1}, .max_m = {1, 1, 1}, .cells = {26, 26, 26}});
    mesh::TriangleMesh surface{cube.vertices, extract_boundary(cube).triangles};
    for (Vec3& x : surface.vertices) {
        x = x.cwiseAbs().maxCoeff() * x.normalized();
        x = 0.1 * (1 + 0.13 * std::sin(7 * x.x() + 1) * std::cos(6 * x.y()) * std::sin(5 * x.z() + 0.5)) * Vec3(1.1 * x.x(), 0.8 * x.y(), 0.7 * x.z());
    }
    return weld(surface);
}

/// Triangles of a skin whose vertices belong to different pieces of the mesh.
std::size_t straddling(const Skin& skin, const VolumeMesh& mesh) {
    const Pieces pieces = find_pieces(mesh);
    const auto elements = skin.embedding().elements();
    std::size_t count = 0;
    for (const Triangle& t : skin.surface().triangles) {
        const auto piece = [&](std::size_t k) { return pieces.of_element[std::size_t(elements[std::size_t(t[k])])]; };
        count += piece(0) != piece(1) || piece(1) != piece(2);
    }
    return count;
}

double least_weight(const Skin& skin) {
    const auto w = skin.embedding().weights();
    return *std::min_element(w.begin(), w.end());
}

TEST(TopologySkin, AFineSkinOfACookedMeshIsPartedCleanly) {
    Team team(2);
    const mesh::TriangleMesh surface = wavy_surface();
    for (const std::size_t elements : {2000u, 5000u}) {
        SCOPED_TRACE(elements);
        const VolumeMesh cooked = cook(surface, {.elements = elements}, team);
        const auto skin = Skin::build(cooked, surface);
        ASSERT_LT(least_weight(*skin), -0.2) << "nothing of it lies outside";
        const auto blade = [](double from, double to) {
            const auto pose = [](double s) { return std::vector<Vec3>{{0.004 + 0.008 * s, 0.11 - 0.22 * s, -1}, {0.009 - 0.01 * s, 0.11 - 0.22 * s, 1}}; };
            return swept_blade(pose(from), pose(to));
        };
        for (const int strides : {1, 6, 9}) {
            SCOPED_TRACE(strides);
            VolumeMesh mesh = cooked;
            auto now = skin;
            for (int k = 0; k < strides; ++k) {
                MeshEdit edit = cut(mesh, mesh.vertices, blade(std::max(0.0, (k - 1.0) / strides), (k + 1.0) / strides));
                now = now->follow(mesh, edit);
                mesh = std::move(edit.mesh);
                const mesh::SurfaceReport check = mesh::check_surface(now->surface());
                // Where a stride begins, lines may have gaps: cracks are left along the cut, no webs across it.
                EXPECT_LE(double(check.open_edges), strides == 1 ? 0 : 0.03 * 1.5 * double(now->surface().triangles.size())) << k;
                EXPECT_EQ(straddling(*now, mesh), 0u) << k;
                EXPECT_GT(least_weight(*now), -4) << k;
            }
            EXPECT_GE(find_pieces(mesh).volume_m3.size(), 2u);
        }
        // A ball goes along below the surface: what stays is bound to what is left.
        VolumeMesh mesh = cooked;
        auto now = skin;
        for (int k = 0; k <= 6; ++k) {
            const Vec3 at(0.01 + 0.005 * k, 0.075 - 0.004 * k, 0.01);
            std::vector<std::int32_t> near;
            for (std::size_t e = 0; e < mesh.element_count(); ++e) {
                Vec3 centre = Vec3::Zero();
                for (const std::int32_t v : element_vertices(mesh, e)) centre += 0.25 * mesh.vertices[std::size_t(v)];
                if ((centre - at).norm() < 0.022) near.push_back(std::int32_t(e));
            }
            if (near.empty()) continue;
            MeshEdit edit = remove_elements(mesh, near);
            now = now->follow(mesh, edit);
            mesh = std::move(edit.mesh);
            for (const std::int32_t e : now->embedding().elements()) ASSERT_TRUE(e >= 0 && std::size_t(e) < mesh.element_count());
            EXPECT_GT(least_weight(*now), -4) << k;
            EXPECT_GT(now->inner_triangles(), 10u);
        }
    }
}

TEST(TopologySkin, HealingGivesTheOldSkinBack) {
    const VolumeMesh mesh = make_tet_box({.max_m = kSize, .cells = {16, 4, 4}});
    for (const Case& c : cases(mesh)) {
        SCOPED_TRACE(c.name);
        const auto skin = Skin::build(mesh, c.surface);
        const MeshEdit first = cut(mesh, mesh.vertices, oblique_blade(-1));
        const MeshEdit second = cut(first.mesh, first.mesh.vertices, swept_blade(std::vector<Vec3>{{0.3, 1, -1}, {0.3, 1, 1}}, std::vector<Vec3>{{0.301, 0.05, -1}, {0.301, 0.05, 1}}));
        const auto twice = skin->follow(mesh, first)->follow(first.mesh, second);
        const std::vector<double> weight(second.mesh.vertices.size(), 1);
        const MeshEdit half = heal(second.mesh, second.mesh.vertices, weight, {.gap_m = 1e-6, .centre_m = {0.3, 0.1, 0.05}, .radius_m = 0.08});
        const auto healed = twice->follow(second.mesh, half);
        EXPECT_LT(healed->inner_triangles(), twice->inner_triangles());
        EXPECT_GT(healed->inner_triangles(), 0u);
        const std::vector<double> weights(half.mesh.vertices.size(), 1);
        const MeshEdit whole = heal(half.mesh, half.mesh.vertices, weights, {.gap_m = 1e-6});
        const auto again = healed->follow(half.mesh, whole);
        EXPECT_EQ(again->inner_triangles(), 0u);
        EXPECT_EQ(again->surface().triangles, skin->surface().triangles);
        EXPECT_EQ(again->surface().vertices, skin->surface().vertices);
    }
}

}  // namespace
}  // namespace supple
