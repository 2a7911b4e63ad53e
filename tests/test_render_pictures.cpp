// Contexts and pictures. Without EGL the pictures are skipped, loudly; what the errors say is tested everywhere.
// SUPPLE_UPDATE_GOLDEN=1 writes the golden pictures anew: look at them before they are kept.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <numbers>

#include "supple/base/error.h"
#include "supple/render/camera.h"
#include "supple/render/color_map.h"
#include "supple/render/context.h"
#include "supple/render/renderer.h"
#include "support/skip.h"

namespace supple {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 256, kHeight = 144;

// Mesa is not built for ThreadSanitizer, which takes the hand-over between its threads for races: let it draw on ours alone.
#if defined(__SANITIZE_THREAD__)
#define SUPPLE_UNDER_TSAN
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define SUPPLE_UNDER_TSAN
#endif
#endif

/// One context for all tests of a process: making one takes longer than drawing.
HeadlessContext* context() {
    static std::string reason;
    static const std::unique_ptr<HeadlessContext> made = [] {
#ifdef SUPPLE_UNDER_TSAN
        ::setenv("LP_NUM_THREADS", "0", 1);
#endif
        try {
            return std::make_unique<HeadlessContext>();
        } catch (const Error& e) {
            reason = e.what();
            return std::unique_ptr<HeadlessContext>();
        }
    }();
    if (!made) std::cout << "skipped: " << reason << "\n";
    return made.get();
}

#define NEEDS_CONTEXT()                                                        \
    do {                                                                       \
        if (!context()) SUPPLE_SKIP("no OpenGL context without a display");    \
        context()->make_current();                                             \
    } while (false)

struct Body {
    std::vector<Vec3> rest, x;
    std::vector<Triangle> triangles;
    std::vector<double> stress;
    std::vector<std::array<std::int32_t, 2>> edges;
    SurfaceView view() const {
        SurfaceView v;
        v.positions = x;
        v.triangles = triangles;
        v.reference_positions = rest;
        return v;
    }
};

/// A thick ring, squeezed; the stress is made up.
Body torus() {
    constexpr int kRound = 48, kTube = 20;
    Body b;
    for (int i = 0; i < kRound; ++i)
        for (int j = 0; j < kTube; ++j) {
            const double u = 2 * std::numbers::pi * i / kRound, v = 2 * std::numbers::pi * j / kTube;
            const double r = 0.08 + 0.035 * std::cos(v);
            b.rest.push_back(Vec3(r * std::cos(u), 0.035 + 0.035 * std::sin(v), r * std::sin(u)));
            const Vec3& p = b.rest.back();
            b.x.push_back(
                Vec3(p.x() * (1 + 0.2 * std::cos(2 * u)), p.y() * (1 + 0.5 * std::exp(-60 * (p.x() - 0.08) * (p.x() - 0.08))), p.z()));
            b.stress.push_back(3000 * (1 + std::cos(2 * u)) + 1500 * (1 + std::sin(v)));
            const int in = (i + 1) % kRound, jn = (j + 1) % kTube;
            b.triangles.push_back({i * kTube + j, i * kTube + jn, in * kTube + j});
            b.triangles.push_back({in * kTube + j, i * kTube + jn, in * kTube + jn});
        }
    return b;
}

/// A block of n x 1 x 1 boxes, bent down; its surface edges without diagonals.
Body block() {
    constexpr int n = 10;
    Body b;
    for (int i = 0; i <= n; ++i)
        for (int k = 0; k < 4; ++k) {
            const double s = double(i) / n, y = 0.03 * (k == 1 || k == 2), z = 0.03 * (k >= 2);
            b.rest.push_back(Vec3(0.24 * s, 0.1 + y, z));
            b.x.push_back(Vec3(0.24 * s - 0.3 * s * y, 0.1 + y - 0.07 * s * s, z));
            b.stress.push_back(9000 * (1 - s) * (k == 1 || k == 2 ? 1 : 0.4));
        }
    const auto quad = [&](int p, int q, int r, int s) {
        b.triangles.push_back({p, q, r});
        b.triangles.push_back({p, r, s});
        const int ring[4] = {p, q, r, s};
        for (int k = 0; k < 4; ++k)
            if (ring[k] < ring[(k + 1) % 4]) b.edges.push_back({ring[k], ring[(k + 1) % 4]});
    };
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < 4; ++k) quad(4 * i + k, 4 * i + (k + 1) % 4, 4 * i + 4 + (k + 1) % 4, 4 * i + 4 + k);
    quad(0, 3, 2, 1);
    quad(4 * n, 4 * n + 1, 4 * n + 2, 4 * n + 3);
    return b;
}

FrameView studio(const Body& body) {
    FrameView view;
    view.surfaces = {body.view()};
    view.ground_height_m = 0;
    SceneBounds bounds = bounds_of(body.rest);
    bounds.include(Vec3(bounds.min_m.x(), 0, bounds.min_m.z()));
    view.camera = frame_camera(bounds, Vec3(0.35, 0.5, 1), 35, double(kWidth) / kHeight);
    return view;
}

Image draw(const FrameView& view, const RendererDef& def = {.width = kWidth, .height = kHeight}) {
    Renderer renderer(def);
    renderer.draw(view);
    return renderer.read_pixels();
}

/// Within what another driver may round, and far from what a lost light or shadow changes.
void expect_golden(const Image& image, const std::string& name) {
    const fs::path golden = fs::path(SUPPLE_SOURCE_DIR) / "tests" / "golden" / (name + ".png");
    if (std::getenv("SUPPLE_UPDATE_GOLDEN")) write_png(golden.string(), image);
    const ImageDifference d = compare(image, read_png(golden.string()));
    const bool good = d.mean < 1.0 && d.fraction_above_16 < 0.01;
    EXPECT_TRUE(good) << name << ": mean difference " << d.mean << " (below 1), share of pixels off by more than 16 levels "
                      << d.fraction_above_16 << " (below 0.01)";
    if (!good) {
        const std::string seen = (fs::temp_directory_path() / (name + ".seen.png")).string();
        write_png(seen, image);
        std::cout << "what was drawn is in " << seen << "\n";
    }
}

TEST(RenderContext, SaysWhichPlatformItGot) {
    NEEDS_CONTEXT();
    std::cout << context()->description() << "\n";
    for (const std::string& failure : context()->failures()) std::cout << "  before it: " << failure << "\n";
    EXPECT_NE(context()->description().find("OpenGL"), std::string::npos);
}

TEST(RenderContext, EveryPlatformWorksOrSaysWhyNot) {
    for (const ContextPlatform platform : {ContextPlatform::surfaceless, ContextPlatform::device, ContextPlatform::pbuffer}) {
        HeadlessContextDef def;
        def.platforms = {platform};
        try {
            HeadlessContext c(def);
            EXPECT_EQ(c.platform(), platform);
            Body b = block();
            const Image image = draw(studio(b), {.width = 64, .height = 36});
            EXPECT_EQ(image.rgb.size(), 64u * 36 * 3);
            std::cout << c.description() << "\n";
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ErrorCode::no_display);
            std::cout << "this machine has not: " << e.what() << "\n";
        }
    }
}

TEST(RenderContext, AFailureListsEveryReasonAndThePackages) {
    HeadlessContextDef def;
    def.gl_major = 9;  // no driver has it
    try {
        HeadlessContext c(def);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::no_display);
        const std::string text = e.what();
        const bool no_library = text.find("cannot be loaded") != std::string::npos || text.find("can be loaded") != std::string::npos;
        for (const char* word : {"EGL surfaceless: ", "EGL device: ", "EGL pbuffer: "})
            EXPECT_TRUE(no_library || text.find(word) != std::string::npos) << word << " is not in: " << text;
        for (const char* package : {"libegl1", "libegl-mesa0", "libgl1-mesa-dri"}) EXPECT_NE(text.find(package), std::string::npos) << text;
    }
}

TEST(RenderContext, ARendererWithoutOneIsAnError) {
    if (context()) context()->release();
    try {
        Renderer renderer;
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::no_display);
    }
}

TEST(RenderPicture, GoldenTissue) {
    NEEDS_CONTEXT();
    const Body b = torus();
    FrameView view = studio(b);
    view.markers.push_back({Vec3(0.09, 0.115, 0.02), 0.016});
    view.arrows.push_back({Vec3(-0.07, 0.07, 0.05), Vec3(-0.11, 0.12, 0.07)});
    view.caption = "Ring";
    expect_golden(draw(view), "tissue");
}

TEST(RenderPicture, GoldenStress) {
    NEEDS_CONTEXT();
    const Body b = block();
    FrameView view = studio(b);
    view.surfaces[0].scalar = b.stress;
    view.surfaces[0].edges = b.edges;
    view.surfaces[0].rest_positions = b.rest;
    view.scale = ColorScale{.map = "viridis", .low = 0, .high = 9000};
    view.hud = "step 3.1 ms";
    expect_golden(draw(view), "stress");
}

TEST(RenderPicture, TheSameViewGivesTheSamePicture) {
    NEEDS_CONTEXT();
    const Body ring = torus(), bar = block();
    const FrameView a = studio(ring), b = studio(bar);
    Renderer renderer({.width = kWidth, .height = kHeight});
    renderer.draw(a);
    const Image first = renderer.read_pixels();
    renderer.draw(b);  // another topology in the same place
    renderer.draw(a);
    EXPECT_EQ(compare(first, renderer.read_pixels()).max, 0);
    renderer.resize(64, 64);
    renderer.draw(b);
    renderer.resize(kWidth, kHeight);
    renderer.draw(a);
    EXPECT_EQ(compare(first, renderer.read_pixels()).max, 0);
}

TEST(RenderPicture, ThePictureDoesNotDependOnTheSizeOfTheScene) {
    NEEDS_CONTEXT();
    Body b = torus();
    FrameView view = studio(b);
    const Image reference = draw(view);
    // A thousand times larger and a kilometre away; the grid on the ground keeps its look, since 1000 is a power of ten.
    const Vec3 away(1000, 0, -500);
    for (std::vector<Vec3>* points : {&b.rest, &b.x})
        for (Vec3& p : *points) p = 1000 * p + 1000 * away;
    view.surfaces = {b.view()};
    view.camera.eye_m = 1000 * view.camera.eye_m + 1000 * away;
    view.camera.target_m = 1000 * view.camera.target_m + 1000 * away;
    EXPECT_LT(compare(reference, draw(view)).fraction_above_16, 0.02);
}

TEST(RenderPicture, MappedColoursAreThoseOfTheTable) {
    NEEDS_CONTEXT();
    Body b = torus();
    for (double& s : b.stress) s = 500;
    FrameView view = studio(b);
    view.surfaces[0].scalar = b.stress;
    view.scale = ColorScale{.map = "viridis", .low = 0, .high = 1000};
    const Image image = draw(view, {.width = kWidth, .height = kHeight, .samples = 0});
    // Hue of viridis in the middle: green and blue near each other, red far below. The pixels of the body are the most saturated ones.
    int teal = 0;
    for (std::size_t p = 0; p < image.rgb.size(); p += 3) {
        const int r = image.rgb[p], g = image.rgb[p + 1], bl = image.rgb[p + 2];
        teal += g - r > 60 && std::abs(g - bl) < 30;
    }
    EXPECT_GT(teal, kWidth * kHeight / 20);
}

/// Mean of a channel sum over a rectangle given in shares of the picture.
double brightness(const Image& image, double x0, double y0, double x1, double y1) {
    double sum = 0;
    int count = 0;
    for (int y = int(y0 * image.height); y < int(y1 * image.height); ++y)
        for (int x = int(x0 * image.width); x < int(x1 * image.width); ++x, ++count)
            for (int c = 0; c < 3; ++c) sum += image.rgb[std::size_t((y * image.width + x) * 3 + c)];
    return sum / (3.0 * count);
}

TEST(RenderPicture, TheGroundCatchesAShadow) {
    NEEDS_CONTEXT();
    Body b = torus();
    for (Vec3& p : b.x) p.y() += 0.25;  // out of the picture, above
    FrameView view = studio(b);
    view.camera.target_m = Vec3(0, 0, 0);
    view.camera.eye_m = Vec3(0, 0.3, 0.35);
    view.key_light = Vec3(0, 1, 0);
    const Image with = draw(view, {.width = kWidth, .height = kHeight, .samples = 0, .ambient_occlusion = false});
    view.surfaces.clear();
    const Image without = draw(view, {.width = kWidth, .height = kHeight, .samples = 0, .ambient_occlusion = false});
    EXPECT_LT(brightness(with, 0.3, 0.4, 0.7, 0.7), 0.9 * brightness(without, 0.3, 0.4, 0.7, 0.7));
    EXPECT_NEAR(brightness(with, 0.0, 0.9, 0.1, 1.0), brightness(without, 0.0, 0.9, 0.1, 1.0), 3);
}

TEST(RenderPicture, SmoothingAddsShadesAndNothingElse) {
    NEEDS_CONTEXT();
    const Body b = block();
    const FrameView view = studio(b);
    const Image rough = draw(view, {.width = kWidth, .height = kHeight, .samples = 0}), smooth = draw(view);
    const ImageDifference d = compare(rough, smooth);
    EXPECT_GT(d.max, 20);
    EXPECT_LT(d.mean, 1.0);
}

TEST(RenderPicture, EveryLookAndTheEmptySceneAreDrawn) {
    NEEDS_CONTEXT();
    const Body b = torus();
    Renderer renderer({.width = 160, .height = 90});
    FrameView view = studio(b);
    std::vector<Image> images;
    for (const Look look : {Look::tissue, Look::rubber, Look::gel, Look::metal}) {
        view.surfaces[0].look = look;
        renderer.draw(view);
        images.push_back(renderer.read_pixels());
        for (std::size_t i = 0; i + 1 < images.size(); ++i) EXPECT_GT(compare(images[i], images.back()).mean, 2.0);
    }
    view.surfaces[0].color = std::array<float, 3>{0.9f, 0.8f, 0.1f};
    renderer.draw(view);
    EXPECT_GT(compare(images.back(), renderer.read_pixels()).mean, 1.0);
    view = {};
    EXPECT_EQ(renderer.draw(view).triangles, 0u);
    view.ground_height_m = 1.0;  // the eye is below it
    EXPECT_NO_THROW(renderer.draw(view));
}

TEST(RenderPicture, WhatACutLaidOpenHasAColourOfItsOwn) {
    NEEDS_CONTEXT();
    // A board that faces the eye, its right half laid open.
    Body board;
    for (const double x : {-1.0, 0.0, 1.0})
        for (const double y : {-0.6, 0.6}) board.x.push_back(Vec3(x, y, 0));
    board.triangles = {{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}};
    board.rest = board.x;
    const std::vector<char> inner{0, 0, 1, 1};
    FrameView view;
    view.surfaces.push_back(board.view());
    view.camera.eye_m = Vec3(0, 0, 3);
    view.camera.target_m = Vec3::Zero();
    Renderer renderer({.width = 160, .height = 90});
    const auto halves = [&] {
        renderer.draw(view);
        const Image image = renderer.read_pixels();
        std::array<std::array<double, 3>, 2> mean{};
        for (int y = 35; y < 55; ++y)
            for (int half = 0; half < 2; ++half)
                for (int x = 0; x < 20; ++x)
                    for (std::size_t c = 0; c < 3; ++c) mean[std::size_t(half)][c] += image.rgb[3 * std::size_t(y * 160 + (half == 0 ? 50 : 90) + x) + c] / 400.0;
        return mean;
    };
    const auto whole = halves();
    view.surfaces[0].inner = inner;
    for (const Look look : {Look::tissue, Look::rubber}) {
        view.surfaces[0].look = look;
        const auto cut = halves();
        const double left = cut[0][0] + cut[0][1] + cut[0][2], right = cut[1][0] + cut[1][1] + cut[1][2];
        EXPECT_GT(right, 1.15 * left) << "brighter than outside, look " << int(look);
        if (look != Look::tissue) continue;
        EXPECT_GT(cut[1][0], cut[1][1] + 30) << "flesh is red";
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(cut[0][c], whole[0][c], 3) << "the outside stays as it was";
    }
    view.surfaces[0].look = Look::tissue;
    view.surfaces[0].inner_color = std::array<float, 3>{0.1f, 0.2f, 0.9f};
    const auto blue = halves();
    EXPECT_GT(blue[1][2], 2 * blue[1][0]);
    EXPECT_GT(blue[0][0], blue[0][2]);
}

TEST(RenderPicture, ManyTrianglesAreDrawn) {
    NEEDS_CONTEXT();
    constexpr int n = 224;
    Body b;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) b.x.push_back(Vec3(double(i) / n, 0.05 * std::sin(0.2 * i) * std::cos(0.17 * j), double(j) / n));
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const int a = i * (n + 1) + j, c = a + n + 1;
            b.triangles.push_back({a, a + 1, c});
            b.triangles.push_back({c, a + 1, c + 1});
        }
    b.rest = b.x;
    Renderer renderer({.width = kWidth, .height = kHeight, .samples = 0});
    EXPECT_EQ(renderer.draw(studio(b)).triangles, std::size_t(2 * n * n));
}

TEST(RenderPicture, BadViewsAreErrorsThatNameTheField) {
    NEEDS_CONTEXT();
    const Body good = block();
    Renderer renderer({.width = 64, .height = 36, .samples = 0});
    const auto where = [&](const auto& spoil) {
        Body body = good;
        FrameView view = studio(body);
        spoil(view, body);
        try {
            renderer.draw(view);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
            return e.where();
        }
        return std::string("no error");
    };
    EXPECT_EQ(where([](FrameView&, Body& b) { b.x[3].y() = NAN; }), "FrameView.surfaces[0].positions");
    EXPECT_EQ(where([](FrameView&, Body& b) { b.triangles[2][1] = 999; }), "FrameView.surfaces[0].triangles");
    EXPECT_EQ(where([](FrameView& v, Body& b) { v.surfaces[0].scalar = std::span(b.stress).first(3); }), "FrameView.surfaces[0].scalar");
    EXPECT_EQ(where([](FrameView& v, Body& b) { v.surfaces[0].scalar = b.stress; }), "FrameView.scale");
    EXPECT_EQ(where([](FrameView& v, Body&) { v.surfaces[0].inner = std::span("ab", 2); }), "FrameView.surfaces[0].inner");
    EXPECT_EQ(where([](FrameView& v, Body& b) { v.surfaces[0].edges = (b.edges[0][1] = -1, b.edges); }), "FrameView.surfaces[0].edges");
    EXPECT_EQ(where([](FrameView& v, Body&) { v.scale = ColorScale{.map = "jet"}; }), "ColorScale.map");
    EXPECT_EQ(where([](FrameView& v, Body&) { v.camera.eye_m = v.camera.target_m; }), "Camera.eye_m");
    EXPECT_EQ(where([](FrameView& v, Body&) { v.camera.up = v.camera.eye_m - v.camera.target_m; }), "Camera.up");
    EXPECT_EQ(where([](FrameView& v, Body&) { v.camera.fov_deg = 0; }), "Camera.fov_deg");
    EXPECT_EQ(where([](FrameView& v, Body&) { v.markers.push_back({Vec3::Zero(), -1}); }), "FrameView.markers[0].radius_m");
    EXPECT_EQ(where([](FrameView& v, Body&) { v.arrows.push_back({Vec3::Zero(), Vec3(INFINITY, 0, 0)}); }), "FrameView.arrows[0].to_m");
    EXPECT_EQ(where([](FrameView&, Body&) {}), "no error");  // and the renderer still works
    EXPECT_THROW(Renderer({.width = 0}), Error);
    EXPECT_THROW(Renderer({.samples = 4096}), Error);
    EXPECT_THROW(Renderer({.shadow_map_size = 1000}), Error);
}

TEST(RenderPicture, TextOfAnyAlphabetAndLengthIsDrawn) {
    NEEDS_CONTEXT();
    FrameView view;
    view.caption =
        "\xCF\x83 = 12 \xC2\xB5N/mm\xC2\xB2, \xE2\x89\xA4 \xD0\x9F\xD1\x80\xD0\xB8\xD0\xB2\xD0\xB5\xD1\x82 \xFF\xC3 broken bytes\nsecond "
        "line "
        "averylongwordthatnobodycanbreakanywhereatallbecauseithasnoblanks and more words to wrap over a line or two";
    view.hud = std::string(500, 'W');
    const Image image = draw(view);
    int white = 0;
    for (std::size_t p = 0; p < image.rgb.size(); p += 3) white += image.rgb[p] > 180;
    EXPECT_GT(white, 300);
    Renderer renderer({.width = 1920, .height = 1080, .samples = 0});
    for (int size = 200; size < 1080; size += 40) {  // many sizes: the font atlas fills up and starts anew
        renderer.resize(640, size);
        renderer.draw(view);
        renderer.draw(view);
    }
}

}  // namespace
}  // namespace supple
