// Stress drawn flat, as points and through a translucent body.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>

#include "supple/base/error.h"
#include "supple/render/camera.h"
#include "supple/render/context.h"
#include "supple/render/renderer.h"
#include "support/skip.h"

namespace supple {
namespace {

#if defined(__SANITIZE_THREAD__)
constexpr bool kCanDraw = false;
#else
constexpr bool kCanDraw = true;
#endif

HeadlessContext* context() {
    static const std::unique_ptr<HeadlessContext> made = [] {
        try {
            if (kCanDraw) return std::make_unique<HeadlessContext>();
        } catch (const Error& e) {
            std::cout << "skipped: " << e.what() << "\n";
        }
        return std::unique_ptr<HeadlessContext>();
    }();
    return made.get();
}

#define NEEDS_CONTEXT()                                                        \
    do {                                                                       \
        if (!context()) SUPPLE_SKIP("no OpenGL context without a display");    \
        context()->make_current();                                             \
    } while (false)

/// The unit cube's surface, a few triangles a side.
struct Cube {
    std::vector<Vec3> x;
    std::vector<Triangle> triangles;
    std::vector<double> smooth, flat;

    Cube() {
        constexpr int n = 4;
        for (int face = 0; face < 6; ++face) {
            const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
            const auto base = std::int32_t(x.size());
            for (int i = 0; i <= n; ++i)
                for (int j = 0; j <= n; ++j) {
                    Vec3 p = Vec3::Zero();
                    p[axis] = face % 2;
                    p[u] = double(i) / n;
                    p[v] = double(j) / n;
                    x.push_back(0.1 * p);
                    smooth.push_back(500);
                }
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const std::int32_t a = base + i * (n + 1) + j, b = a + n + 1, c = b + 1, d = a + 1;
                    const bool out = face % 2 == 1;
                    triangles.push_back(out ? Triangle{a, b, c} : Triangle{a, c, b});
                    triangles.push_back(out ? Triangle{a, c, d} : Triangle{a, d, c});
                }
        }
        flat.assign(triangles.size(), 500);
    }

    FrameView view() const {
        FrameView view;
        SurfaceView s;
        s.positions = x;
        s.triangles = triangles;
        view.surfaces = {s};
        view.scale = ColorScale{.map = "viridis", .low = 0, .high = 1000};
        view.camera = frame_camera(bounds_of(x), Vec3(0.4, 0.5, 1), 35, 16.0 / 9);
        return view;
    }
};

Image draw(const FrameView& view) {
    Renderer renderer({.width = 256, .height = 144});
    renderer.draw(view);
    return renderer.read_pixels();
}

TEST(RenderStress, OneValuePerTriangleIsDrawnFlat) {
    NEEDS_CONTEXT();
    Cube cube;
    FrameView smooth = cube.view(), flat = cube.view();
    smooth.surfaces[0].scalar = cube.smooth;
    flat.surfaces[0].triangle_scalar = cube.flat;
    EXPECT_LE(compare(draw(smooth), draw(flat)).max, 1) << "one value everywhere: no difference";
    for (std::size_t t = 0; t < cube.flat.size(); ++t) cube.flat[t] = t % 2 == 0 ? 0 : 1000;
    const Image checkered = draw(flat);
    EXPECT_GT(compare(draw(smooth), checkered).fraction_above_16, 0.05);
    // Flat: hardly a pixel between the two ends of the map (violet and yellow), which a gradient would be full of.
    std::size_t body = 0, between = 0;
    for (std::size_t i = 0; i < checkered.rgb.size(); i += 3) {
        const int r = checkered.rgb[i], g = checkered.rgb[i + 1], b = checkered.rgb[i + 2];
        const bool yellow = g > b + 60 && r > b + 40, violet = b > g + 25 && r > g + 5, teal = g > r + 40 && b > r + 25;
        body += yellow || violet || teal;
        between += teal;
    }
    EXPECT_GT(body, 1000u);
    EXPECT_LT(double(between), 0.05 * double(body));
    cube.flat[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NO_THROW(draw(flat));
}

TEST(RenderStress, OpacityShowsWhatIsInside) {
    NEEDS_CONTEXT();
    const Cube cube;
    for (const double opacity : {1.0, 0.4}) {
        FrameView empty = cube.view();
        empty.surfaces[0].scalar = cube.smooth;
        empty.surfaces[0].opacity = opacity;
        FrameView full = empty;
        full.markers.push_back({Vec3::Constant(0.05), 0.03});
        FrameView dotted = empty;
        const std::vector<Vec3> points = {Vec3::Constant(0.05), Vec3(0.03, 0.05, 0.06)};
        const std::vector<double> values = {1000, 0};
        dotted.points.push_back({points, values, 20});
        const Image plain = draw(empty);
        const ImageDifference marker = compare(plain, draw(full)), dots = compare(plain, draw(dotted));
        if (opacity == 1) {
            EXPECT_LT(marker.fraction_above_16, 0.001);
            EXPECT_EQ(dots.max, 0);
        } else {
            EXPECT_GT(marker.fraction_above_16, 0.01);
            EXPECT_GT(dots.fraction_above_16, 0.002);
        }
    }
}

TEST(RenderStress, PointsAreRoundAndColouredByTheTable) {
    NEEDS_CONTEXT();
    const Cube cube;
    FrameView view = cube.view();
    view.surfaces.clear();
    const std::vector<Vec3> points = {Vec3::Constant(0.05)};
    const std::vector<double> high = {1000}, low = {0};
    view.points.push_back({points, low, 40});
    const Image violet = draw(view);
    view.points[0].scalar = high;
    const Image yellow = draw(view);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < violet.rgb.size(); i += 3) changed += yellow.rgb[i + 1] > violet.rgb[i + 1] + 20;
    EXPECT_NEAR(double(changed), 3.14159 * 20 * 20, 150);
}

TEST(RenderStress, RefusesWhatDoesNotFit) {
    NEEDS_CONTEXT();
    const Cube cube;
    FrameView view = cube.view();
    view.surfaces[0].triangle_scalar = std::span(cube.flat).first(3);
    EXPECT_THROW(draw(view), Error);
    view.surfaces[0].triangle_scalar = cube.flat;
    view.surfaces[0].scalar = cube.smooth;
    EXPECT_THROW(draw(view), Error) << "both";
    view.surfaces[0].scalar = {};
    for (const double bad : {0.0, -1.0, 1.5, std::nan("")}) {
        view.surfaces[0].opacity = bad;
        EXPECT_THROW(draw(view), Error) << bad;
    }
    view.surfaces[0].opacity = 1;
    view.scale.reset();
    EXPECT_THROW(draw(view), Error) << "no scale";
    view.scale = ColorScale{};
    const std::vector<Vec3> points = {Vec3::Zero()};
    view.points.push_back({points, {}, 5});
    EXPECT_THROW(draw(view), Error);
    const std::vector<double> values = {1};
    view.points[0] = {points, values, 0};
    EXPECT_THROW(draw(view), Error);
}

}  // namespace
}  // namespace supple
