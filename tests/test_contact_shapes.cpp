// Shapes: distances, sweeps, grids of meshes, trees.
#include <gtest/gtest.h>

#include <numbers>

#include "supple/contact/closest.h"
#include "supple/contact/distance_grid.h"
#include "supple/contact/shape_surface.h"
#include "supple/contact/moving_triangles.h"
#include "supple/mesh/surface.h"
#include "support/bodies.h"

namespace supple {
namespace {

using contact::Distance;
using contact::DistanceGrid;

std::vector<Shape> convex_shapes() {
    return {PlaneShape{Vec3(1, 2, 2) / 3, 0.05}, SphereShape{0.2}, CapsuleShape{0.1, 0.15}, BoxShape{Vec3(0.1, 0.2, 0.15)}, CylinderShape{0.15, 0.1}};
}

std::shared_ptr<const DistanceGrid> grid_of(const Shape& shape, int cells = 48) {
    const contact::ShapeSurface s = contact::surface_of(shape, 1);
    return DistanceGrid::build(s.vertices, s.triangles, "test", cells);
}

TEST(ContactShapes, TheNormalIsTheGradientOfTheDistance) {
    test::Random random(1);
    for (const Shape& shape : convex_shapes()) {
        for (int i = 0; i < 500; ++i) {
            const Vec3 p = random.vector(0.4);
            const Distance at = contact::distance(shape, p);
            EXPECT_NEAR(at.normal.norm(), 1, 1e-12);
            constexpr double e = 1e-6;
            Vec3 gradient;
            for (int c = 0; c < 3; ++c) gradient[c] = (contact::distance(shape, p + e * Vec3::Unit(c)).d - contact::distance(shape, p - e * Vec3::Unit(c)).d) / (2 * e);
            if ((gradient - at.normal).norm() < 1e-4) continue;
            EXPECT_LT(gradient.norm(), 1 + 1e-9) << "shape " << shape.index() << ": only at creases may they differ";
            const Vec3 surface = p - at.d * at.normal;  // either face of a crease leads to the surface
            EXPECT_NEAR(contact::distance(shape, surface).d, 0, 1e-9) << "shape " << shape.index();
        }
    }
}

TEST(ContactShapes, DistancesAreExact) {
    EXPECT_NEAR(contact::distance(BoxShape{Vec3(1, 2, 3)}, Vec3(4, 6, 3)).d, 5, 1e-12);
    EXPECT_NEAR(contact::distance(BoxShape{Vec3(1, 2, 3)}, Vec3(0.5, -1.9, 0)).d, -0.1, 1e-12);
    EXPECT_NEAR(contact::distance(CylinderShape{1, 2}, Vec3(3, 3, 0)).d, std::sqrt(5), 1e-12);
    EXPECT_NEAR(contact::distance(CylinderShape{1, 2}, Vec3(0, 1.75, 0.1)).d, -0.25, 1e-12);
    EXPECT_NEAR(contact::distance(CapsuleShape{1, 2}, Vec3(0, 5, 0)).d, 2, 1e-12);
    EXPECT_NEAR(contact::distance(SphereShape{1}, Vec3::Zero()).d, -1, 1e-12) << "and a normal of some direction";
    EXPECT_NEAR(contact::distance(SphereShape{1}, Vec3::Zero()).normal.norm(), 1, 1e-12);
}

TEST(ContactShapes, MassAndInertiaAreThoseOfTheSolid) {
    test::Random random(2);
    std::vector<Shape> shapes = convex_shapes();
    shapes[0] = MeshShape{grid_of(BoxShape{Vec3(0.1, 0.2, 0.15)})};
    for (const Shape& shape : shapes) {
        const contact::MassProperties mass = contact::mass_properties(shape);
        double volume = 0;
        Vec3 inertia = Vec3::Zero();
        constexpr int kSamples = 400000;
        const double box = 0.5 * 0.5 * 0.5;
        for (int i = 0; i < kSamples; ++i) {
            const Vec3 p = random.vector(0.25);
            if (contact::distance(shape, p).d > 0) continue;
            volume += box / kSamples;
            const Vec3 s = p.cwiseAbs2();
            inertia += box / kSamples * Vec3(s.y() + s.z(), s.z() + s.x(), s.x() + s.y());
        }
        EXPECT_NEAR(mass.volume_m3 / volume, 1, 0.02) << "shape " << shape.index();
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(mass.inertia_m5(c, c) / inertia[c], 1, 0.03) << "shape " << shape.index() << " axis " << c;
    }
}

TEST(ContactShapes, TheDeepestPointOfATriangleIsDeepest) {
    test::Random random(3);
    for (const Shape& shape : convex_shapes()) {
        for (int i = 0; i < 200; ++i) {
            const Vec3 centre = random.vector(0.25), a = centre + random.vector(0.2), b = centre + random.vector(0.2), c = centre + random.vector(0.2);
            const contact::TrianglePoint found = contact::deepest_on_triangle(shape, a, b, c);
            EXPECT_NEAR(found.barycentric.sum(), 1, 1e-9);
            EXPECT_GE(found.barycentric.minCoeff(), -1e-12);
            double least = 1e9;
            for (int u = 0; u <= 40; ++u)
                for (int v = 0; v + u <= 40; ++v) least = std::min(least, contact::distance(shape, a + u / 40.0 * (b - a) + v / 40.0 * (c - a)).d);
            const double size = std::max((b - a).norm(), (c - a).norm());
            EXPECT_LT(found.at.d, least + (shape.index() == 1 ? 1e-3 : 0.06) * size) << "shape " << shape.index() << " triangle " << i;
        }
    }
}

TEST(ContactShapes, SweepsMissNothing) {
    test::Random random(4);
    int hits = 0;
    for (const Shape& shape : convex_shapes()) {
        for (int i = 0; i < 300; ++i) {
            const Vec3 p0 = random.vector(1), p1 = random.vector(1);
            const auto touch = contact::sweep_point(shape, p0, p1, 1e-4);
            if (contact::distance(shape, p0).d <= 1e-4) {
                EXPECT_FALSE(touch.has_value()) << "it begins inside";
                continue;
            }
            double first = 2;
            for (int k = 0; k <= 2000 && first > 1; ++k) {
                if (contact::distance(shape, p0 + k / 2000.0 * (p1 - p0)).d <= 0) first = k / 2000.0;
            }
            if (first <= 1) {
                ASSERT_TRUE(touch.has_value()) << "shape " << shape.index();
                EXPECT_LE(touch->time, first);
                EXPECT_LE(touch->point.at.d, 1e-4);
                ++hits;
            }
            const std::array<Vec3, 3> from = {p0, p0 + random.vector(0.1), p0 + random.vector(0.1)};
            const std::array<Vec3, 3> to = {p1, p1 + random.vector(0.1), p1 + random.vector(0.1)};
            if (contact::deepest_on_triangle(shape, from[0], from[1], from[2]).at.d <= 1e-3) continue;
            EXPECT_LE(contact::sweep_triangle(shape, from, to, 1e-3).has_value() ? 0 : 1, first <= 1 ? 0 : 1) << "a corner of it touched";
        }
    }
    EXPECT_GT(hits, 100);
}

TEST(ContactGrid, IsTheDistanceToItsSurface) {
    test::Random random(5);
    for (const Shape& shape : {Shape(SphereShape{0.2}), Shape(BoxShape{Vec3(0.1, 0.2, 0.15)}), Shape(CapsuleShape{0.1, 0.15}), Shape(CylinderShape{0.15, 0.1})}) {
        const auto grid = grid_of(shape);
        for (int i = 0; i < 2000; ++i) {
            const Vec3 p = random.vector(0.5);
            const double exact = contact::distance(shape, p).d;
            const double d = grid->distance(p).d;
            if (exact < 2 * grid->spacing_m()) {
                EXPECT_NEAR(d, exact, 0.6 * grid->spacing_m()) << "shape " << shape.index() << " at " << p.transpose();
            } else {
                EXPECT_LT(d, exact + 0.6 * grid->spacing_m()) << "beyond the grid: a lower bound";
                EXPECT_GT(d, 1.4 * grid->spacing_m());
            }
            if (std::abs(exact) > grid->spacing_m()) {
                EXPECT_EQ(d < 0, exact < 0);
            }
        }
    }
}

TEST(ContactGrid, OverlappingPartsAreOneInsideAndBadSurfacesAreRefused) {
    contact::ShapeSurface two = contact::surface_of(BoxShape{Vec3(0.1, 0.1, 0.1)}, 1);
    const std::size_t n = two.vertices.size(), m = two.triangles.size();
    for (std::size_t i = 0; i < n; ++i) two.vertices.push_back(two.vertices[i] + Vec3(0.1, 0.05, 0.02));
    for (std::size_t t = 0; t < m; ++t) {
        Triangle copy = two.triangles[t];
        for (std::int32_t& v : copy) v += std::int32_t(n);
        two.triangles.push_back(copy);
    }
    const auto grid = DistanceGrid::build(two.vertices, two.triangles);
    EXPECT_LT(grid->distance(Vec3(0.05, 0.02, 0.01)).d, 0) << "in both";
    EXPECT_LT(grid->distance(Vec3(-0.08, 0, 0)).d, 0);
    EXPECT_LT(grid->distance(Vec3(0.18, 0.05, 0)).d, 0);
    EXPECT_GT(grid->distance(Vec3(-0.08, 0.13, 0)).d, 0);

    // Inside out is turned; a soup of triangles is welded.
    contact::ShapeSurface soup;
    const contact::ShapeSurface box = contact::surface_of(BoxShape{Vec3(0.1, 0.1, 0.1)}, 1);
    for (const Triangle& t : box.triangles) {
        const auto first = std::int32_t(soup.vertices.size());
        for (const std::int32_t v : {t[0], t[2], t[1]}) soup.vertices.push_back(box.vertices[std::size_t(v)]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    EXPECT_NEAR(DistanceGrid::build(soup.vertices, soup.triangles)->mass_properties().volume_m3, 8e-3, 1e-12);
    const auto refused = [](const contact::ShapeSurface& s, const std::string& word) {
        try {
            DistanceGrid::build(s.vertices, s.triangles, "thing");
            ADD_FAILURE() << "not refused: " << word;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
        }
    };
    contact::ShapeSurface open = box;
    open.triangles.pop_back();
    refused(open, "not closed");
    contact::ShapeSurface wrong = box;
    std::swap(wrong.triangles[3][0], wrong.triangles[3][1]);
    refused(wrong, "not closed");
    wrong = box;
    wrong.triangles[0][0] = 99;
    refused(wrong, "uses vertex 99");
    wrong = box;
    wrong.vertices[0].x() = std::nan("");
    refused(wrong, "not finite");
}

TEST(ContactTree, FindsWhatTheScanFinds) {
    test::Random random(6);
    const auto shape = test::irregular_cube(5, 0.4, 7);
    std::vector<Vec3> x = shape->mesh().vertices;
    const auto& triangles = shape->boundary().triangles;
    contact::MovingTriangles tree(triangles, x);
    for (int round = 0; round < 3; ++round) {
        for (Vec3& p : x) p += random.vector(0.05);
        tree.refit(x);
        for (int i = 0; i < 100; ++i) {
            const Vec3 p = 0.5 * Vec3::Ones() + random.vector(1);
            contact::Bounds box{p, p};
            box.grow(0.2);
            std::vector<std::int32_t> found, scanned;
            tree.overlapping(box, [&](std::int32_t t) { found.push_back(t); });
            for (std::size_t t = 0; t < triangles.size(); ++t) {
                contact::Bounds own;
                for (const std::int32_t v : triangles[t]) own.include(x[std::size_t(v)]);
                if (own.overlaps(box)) scanned.push_back(std::int32_t(t));
            }
            std::sort(found.begin(), found.end());
            EXPECT_EQ(found, scanned);
        }
    }
}

}  // namespace
}  // namespace supple
