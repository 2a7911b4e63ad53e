// The parts of the renderer that need no graphics card: normals, colour maps, legend, camera, occlusion, images, video.
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <numbers>

#include "supple/base/error.h"
#include "supple/render/camera.h"
#include "supple/render/color_map.h"
#include "supple/render/image.h"
#include "supple/render/legend.h"
#include "supple/render/normals.h"
#include "supple/render/occlusion.h"
#include "supple/render/video.h"
#include "support/skip.h"

namespace supple {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3f;

struct Mesh {
    std::vector<Vec3> x;
    std::vector<Triangle> t;
};

Mesh cube() {
    Mesh m;
    for (int v = 0; v < 8; ++v) m.x.push_back(Vec3(v & 1, v >> 1 & 1, v >> 2 & 1));
    const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& q : quads) {
        m.t.push_back({q[0], q[1], q[2]});
        m.t.push_back({q[0], q[2], q[3]});
    }
    return m;
}

Mesh sphere(int rings, int sides) {
    Mesh m;
    m.x.push_back(Vec3::UnitY());
    for (int r = 1; r < rings; ++r)
        for (int s = 0; s < sides; ++s) {
            const double a = std::numbers::pi * r / rings, b = 2 * std::numbers::pi * s / sides;
            m.x.push_back(Vec3(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)));
        }
    m.x.push_back(-Vec3::UnitY());
    const auto at = [&](int r, int s) { return r == 0 ? 0 : r == rings ? int(m.x.size()) - 1 : 1 + (r - 1) * sides + s % sides; };
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < sides; ++s) {
            if (r > 0) m.t.push_back({at(r, s), at(r, s + 1), at(r + 1, s)});
            if (r < rings - 1) m.t.push_back({at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)});
        }
    return m;
}

std::vector<Vector3f> normals_of(const Mesh& m, const render::SmoothTopology& topology) {
    std::vector<Vector3f> x, n;
    for (const int v : topology.vertex_of) x.push_back(m.x[std::size_t(v)].cast<float>());
    render::compute_normals(topology, x, n);
    return n;
}

TEST(RenderNormals, ACubeIsCrisp) {
    const Mesh m = cube();
    const auto topology = render::split_at_creases(m.x, m.t, 40);
    EXPECT_EQ(topology.vertex_of.size(), 24u);  // three sides meet at each of eight vertices
    const auto n = normals_of(m, topology);
    for (std::size_t t = 0; t < m.t.size(); ++t) {
        const Vec3 face =
            (m.x[std::size_t(m.t[t][1])] - m.x[std::size_t(m.t[t][0])]).cross(m.x[std::size_t(m.t[t][2])] - m.x[std::size_t(m.t[t][0])]);
        for (const auto c : topology.triangles[t]) EXPECT_NEAR(n[c].dot(face.normalized().cast<float>()), 1.0f, 1e-6f);
    }
    std::size_t crisp = 0;
    for (const auto& e : topology.edges) crisp += e.crisp;
    EXPECT_EQ(crisp, 12u);
    EXPECT_EQ(topology.edges.size(), 18u);
}

TEST(RenderNormals, ACubeIsSmoothWhereTheAngleAllowsIt) {
    const Mesh m = cube();
    const auto topology = render::split_at_creases(m.x, m.t, 95);
    EXPECT_EQ(topology.vertex_of.size(), 8u);
    // Max's weights make a cube's corner normals exact: they do not depend on how its squares are cut into triangles.
    for (std::size_t c = 0; const Vector3f& n : normals_of(m, topology)) {
        const Vec3 out = (m.x[std::size_t(topology.vertex_of[c++])] - Vec3::Constant(0.5)).normalized();
        EXPECT_NEAR(n.dot(out.cast<float>()), 1.0f, 1e-6f);
    }
}

TEST(RenderNormals, WhatACutLaidOpenIsPartedFromTheRest) {
    const Mesh m = cube();
    std::vector<char> inner(m.t.size(), 0);
    inner[0] = inner[1] = 1;  // one side
    const auto topology = render::split_at_creases(m.x, m.t, 180, inner);
    EXPECT_EQ(topology.vertex_of.size(), 12u);
    std::size_t crisp = 0;
    for (const auto& e : topology.edges) crisp += e.crisp;
    EXPECT_EQ(crisp, 4u);
    EXPECT_TRUE(topology.closed);
}

TEST(RenderNormals, ASphereIsSmoothAndExact) {
    const Mesh m = sphere(17, 29);
    const auto topology = render::split_at_creases(m.x, m.t, 40);
    ASSERT_EQ(topology.vertex_of.size(), m.x.size());
    for (std::size_t c = 0; const Vector3f& n : normals_of(m, topology))
        EXPECT_NEAR((n - m.x[std::size_t(topology.vertex_of[c++])].cast<float>()).norm(), 0.0f, 2e-5f);
}

TEST(RenderNormals, AClosedSurfaceIsTurnedOutwards) {
    Mesh m = sphere(9, 12);
    for (Triangle& t : m.t) std::swap(t[0], t[1]);
    const auto topology = render::split_at_creases(m.x, m.t, 40);
    EXPECT_TRUE(topology.closed);
    for (std::size_t c = 0; const Vector3f& n : normals_of(m, topology))
        EXPECT_GT(n.dot(m.x[std::size_t(topology.vertex_of[c++])].cast<float>()), 0.99f);
    m.t.pop_back();
    EXPECT_FALSE(render::split_at_creases(m.x, m.t, 40).closed);
}

TEST(RenderNormals, FlatAndTinyTrianglesDoNoHarm) {
    Mesh m = cube();
    for (Vec3& x : m.x) x *= 1e-7;
    m.t.push_back({0, 0, 1});
    m.t.push_back({2, 2, 2});
    const auto topology = render::split_at_creases(m.x, m.t, 40);
    for (const Vector3f& n : normals_of(m, topology)) EXPECT_NEAR(n.norm(), 1.0f, 1e-5f);
}

TEST(RenderColorMap, SequentialMapsGetLighterAllTheWay) {
    for (const std::string_view name : color_map_names()) {
        if (name == "coolwarm") continue;
        const ColorTable& table = color_map(name);
        double previous = lightness(table[0]), steepest = 0, flattest = 100;
        for (std::size_t i = 8; i < table.size(); i += 8) {
            const double l = lightness(table[i]);
            EXPECT_GT(l, previous) << name << " at " << i;
            steepest = std::max(steepest, l - previous);
            flattest = std::min(flattest, l - previous);
            previous = l;
        }
        EXPECT_GT(lightness(table[255]) - lightness(table[0]), 70) << name;
        EXPECT_LT(steepest, 5.5) << name << ": equal steps of the value must be equal steps of lightness";
        EXPECT_GT(flattest, 0.8) << name;
    }
}

TEST(RenderColorMap, TheDivergingMapIsEvenSidedAndLightInTheMiddle) {
    const ColorTable& table = color_map("coolwarm");
    for (std::size_t i = 0; i < 120; i += 8) {
        EXPECT_LT(lightness(table[i]), lightness(table[i + 8])) << i;
        EXPECT_NEAR(lightness(table[i]), lightness(table[255 - i]), 4) << i;
    }
    EXPECT_GT(table[0][2], table[0][0]);      // blue below
    EXPECT_GT(table[255][0], table[255][2]);  // red above
}

TEST(RenderColorMap, PublishedValues) {
    // A quarter, a half and three quarters of the way, as matplotlib and R's viridisLite print them.
    const struct {
        const char* name;
        std::uint32_t hex[3];
    } published[] = {{"viridis", {0x3b528b, 0x21908c, 0x5dc863}},
                     {"magma", {0x51127c, 0xb63679, 0xfb8861}},
                     {"inferno", {0x56106e, 0xbb3754, 0xf98c0a}},
                     {"cividis", {0x414d6b, 0x7c7b78, 0xbcaf6f}}};
    for (const auto& p : published)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto& seen = color_map(p.name)[64 * (k + 1) - 1];
            const int hex[3] = {int(p.hex[k] >> 16), int(p.hex[k] >> 8 & 255), int(p.hex[k] & 255)};
            for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], hex[c], 5) << p.name << " " << k << " " << c;
        }
}

TEST(RenderColorMap, AnUnknownNameListsTheKnownOnes) {
    try {
        color_map("jet");
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
        for (const std::string_view name : color_map_names()) EXPECT_NE(e.message().find(name), std::string::npos) << name;
    }
}

std::string joined(const LegendTicks& t) {
    std::string out;
    for (const LegendTick& tick : t.ticks) out += tick.text + " ";
    return out + t.unit;
}

TEST(RenderLegend, TicksAreRoundAndCarryThePrefix) {
    EXPECT_EQ(joined(legend_ticks(0, 8000, "Pa")), "0 2 4 6 8 kPa");
    EXPECT_EQ(joined(legend_ticks(0, 12345, "Pa")), "0.0 2.5 5.0 7.5 10.0 kPa");
    EXPECT_EQ(joined(legend_ticks(0, 437, "Pa")), "0 100 200 300 400 Pa");
    EXPECT_EQ(joined(legend_ticks(1.1e6, 2.3e6, "Pa")), "1.25 1.50 1.75 2.00 2.25 MPa");
    EXPECT_EQ(joined(legend_ticks(0, 2.5e11, "Pa")), "0 50 100 150 200 250 GPa");
    EXPECT_EQ(joined(legend_ticks(0, 0.004, "m")), "0 1 2 3 4 mm");
    EXPECT_EQ(joined(legend_ticks(-1, 1, "")), "-1.0 -0.5 0.0 0.5 1.0 ");
    EXPECT_EQ(joined(legend_ticks(0, 250, "%")), "0 50 100 150 200 250 %");
    EXPECT_EQ(joined(legend_ticks(-3e5, 3e5, "Pa", 4)), "-200 0 200 kPa");
}

TEST(RenderLegend, AnyRangeGivesTicksInsideIt) {
    for (int k = -12; k < 14; ++k)
        for (const double width : {1.0, 1.37, 2.2, 3.33, 4.99, 7.1, 9.9}) {
            const double low = 0.7 * std::pow(10.0, k), high = low + width * std::pow(10.0, k);
            const LegendTicks t = legend_ticks(low, high, "Pa");
            ASSERT_GE(t.ticks.size(), 2u) << low << " " << high;
            ASSERT_LE(t.ticks.size(), 8u) << low << " " << high;
            for (const LegendTick& tick : t.ticks) {
                EXPECT_GE(tick.value, low * (1 - 1e-9));
                EXPECT_LE(tick.value, high * (1 + 1e-9));
                EXPECT_LE(tick.text.size(), 10u) << tick.text;
            }
        }
    EXPECT_THROW(legend_ticks(1, 1, "Pa"), Error);
    EXPECT_THROW(legend_ticks(0, NAN, "Pa"), Error);
    EXPECT_THROW(legend_ticks(-INFINITY, 0, "Pa"), Error);
}

TEST(RenderCamera, FramesTheSphereAroundTheBounds) {
    SceneBounds bounds;
    bounds.include({1, 2, 3});
    bounds.include({1.4, 2.1, 3.2});
    const Camera camera = frame_camera(bounds, {1, 0.5, 2}, 30, 0.5);
    const double distance = (camera.eye_m - camera.target_m).norm(), radius = 0.5 * (bounds.max_m - bounds.min_m).norm();
    const double narrow = std::atan(0.5 * std::tan(15 * std::numbers::pi / 180));
    EXPECT_GT(std::sin(narrow) * distance, radius);
    EXPECT_LT(std::sin(narrow) * distance, 1.2 * radius);
    EXPECT_THROW(frame_camera({}, {1, 0, 0}), Error);
    EXPECT_THROW(frame_camera(bounds, {0, 0, 0}), Error);
    EXPECT_THROW(frame_camera(bounds, {0, 1, 0}), Error);  // along up
    EXPECT_THROW(frame_camera(bounds, {1, 0, 0}, 180), Error);
}

TEST(RenderCamera, RaysGoWhereThePictureSays) {
    Camera camera;
    camera.eye_m = Vec3(0, 0, 2);
    camera.fov_deg = 90;
    EXPECT_TRUE(camera_ray(camera, 0.5, 0.5, 2).direction.isApprox(Vec3(0, 0, -1)));
    EXPECT_TRUE(camera_ray(camera, 1, 0.5, 2).direction.isApprox(Vec3(2, 0, -1).normalized()));
    EXPECT_TRUE(camera_ray(camera, 0.5, 0, 2).direction.isApprox(Vec3(0, 1, -1).normalized()));
}

TEST(RenderOcclusion, OpenOutsideDarkInside) {
    const Mesh ball = sphere(24, 48);
    render::OcclusionGrid grid;
    const auto fill = [&](double wall_at) {  // a ball, and a wall beside it
        const std::vector<Vector3f> wall{
            {float(wall_at), -1, -1}, {float(wall_at), 1, -1}, {float(wall_at), 1, 1}, {float(wall_at), -1, 1}};
        grid.reset({-1, -1, -1}, {2, 1, 1});
        for (const Triangle& t : ball.t)
            grid.add(ball.x[std::size_t(t[0])].cast<float>(), ball.x[std::size_t(t[1])].cast<float>(),
                     ball.x[std::size_t(t[2])].cast<float>());
        grid.add(wall[0], wall[1], wall[2]);
        grid.add(wall[0], wall[2], wall[3]);
        grid.finish();
    };
    fill(1.15);
    EXPECT_GT(grid.openness({-1, 0, 0}, {-1, 0, 0}), 0.93f);  // a lone convex surface does not darken itself
    const float near_wall = grid.openness({1, 0, 0}, {1, 0, 0});
    EXPECT_LT(near_wall, 0.75f);
    fill(1.9);
    EXPECT_GT(grid.openness({1, 0, 0}, {1, 0, 0}), near_wall + 0.1f);

    std::vector<std::uint8_t> ground;
    grid.ground(-1, ground);
    constexpr int n = render::OcclusionGrid::kGroundSize;
    const auto at = [&](float x, float z) {
        const Eigen::Vector2f uv = (Eigen::Vector2f(x, z) - grid.ground_low()).cwiseQuotient(grid.ground_high() - grid.ground_low()) * n;
        return int(ground[std::size_t(int(uv.y()) * n + int(uv.x()))]);
    };
    EXPECT_LT(at(0, 0), 150);
    EXPECT_GT(at(0, -2.2f), 245);
}

class RenderFiles : public ::testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("supple_render_" + std::to_string(::getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const char* name) const { return (folder_ / name).string(); }
    static Image gradient(int width, int height, int shift = 0) {
        Image image{width, height, {}};
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                image.rgb.insert(image.rgb.end(), {std::uint8_t(x + shift), std::uint8_t(2 * y), std::uint8_t(x ^ y)});
        return image;
    }
    fs::path folder_;
};

TEST_F(RenderFiles, PngComesBackAsItWent) {
    const Image image = gradient(61, 47);
    write_png(path("a.png"), image);
    const Image back = read_png(path("a.png"));
    EXPECT_EQ(back.width, 61);
    EXPECT_EQ(back.height, 47);
    EXPECT_EQ(back.rgb, image.rgb);
    const ImageDifference d = compare(image, gradient(61, 47, 3));
    EXPECT_NEAR(d.mean, 1.0, 1e-9);  // three levels in one channel of three
    EXPECT_EQ(d.max, 3);
}

TEST_F(RenderFiles, FilesThatCannotBeAreErrors) {
    const Image image = gradient(8, 8);
    EXPECT_THROW(write_png(path("no/such/folder/a.png"), image), Error);
    EXPECT_THROW(read_png(path("absent.png")), Error);
    std::FILE* f = std::fopen(path("junk.png").c_str(), "wb");
    std::fputs("this is not a picture", f);
    std::fclose(f);
    try {
        read_png(path("junk.png"));
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::parse);
    }
    EXPECT_THROW(write_png(path("b.png"), Image{8, 8, {1, 2, 3}}), Error);
    EXPECT_THROW(compare(image, gradient(8, 9)), Error);
}

bool have_ffmpeg() { return std::system("ffmpeg -version >/dev/null 2>&1") == 0; }

TEST_F(RenderFiles, VideoIsWritten) {
    if (!have_ffmpeg()) SUPPLE_SKIP("ffmpeg is not installed (apt-get install ffmpeg)");
    VideoDef def{.path = path("a.mp4"), .width = 64, .height = 48, .frames_per_s = 25};
    VideoWriter video(def);
    for (int i = 0; i < 10; ++i) video.write(gradient(64, 48, 5 * i));
    EXPECT_THROW(video.write(gradient(64, 50)), Error);
    video.finish();
    video.finish();
    EXPECT_THROW(video.write(gradient(64, 48)), Error);
    ASSERT_GT(fs::file_size(def.path), 500u);
    std::FILE* f = std::fopen(def.path.c_str(), "rb");
    char head[12] = {};
    ASSERT_EQ(std::fread(head, 1, sizeof head, f), sizeof head);
    std::fclose(f);
    EXPECT_EQ(std::string(head + 4, 4), "ftyp");

    // What comes out has the colours that went in, within what yuv420p and compression leave of them.
    const std::string png = path("frame.png"), command = "ffmpeg -v error -i '" + def.path + "' -frames:v 1 '" + png + "'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    EXPECT_LT(compare(read_png(png), gradient(64, 48)).mean, 12.0);
}

TEST_F(RenderFiles, AMissingProgramNamesThePackageAndTheOtherWay) {
    try {
        VideoWriter video({.path = path("a.mp4"), .program = "ffmpeg-that-is-not-there"});
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::external_tool);
        EXPECT_NE(e.message().find("apt-get install ffmpeg"), std::string::npos) << e.what();
        EXPECT_NE(e.message().find("--out DIR"), std::string::npos) << e.what();
    }
}

TEST_F(RenderFiles, AProgramThatDiesIsAnErrorAndNoSignal) {
    ASSERT_NE(std::signal(SIGPIPE, SIG_DFL), SIG_ERR);  // a SIGPIPE would end this test here
    VideoWriter video({.path = path("a.mp4"), .width = 1280, .height = 720, .program = "false"});
    const Image frame = gradient(1280, 720);
    EXPECT_THROW(
        {
            for (int i = 0; i < 50; ++i) video.write(frame);
            video.finish();
        },
        Error);
}

TEST_F(RenderFiles, AFailureIsToldInTheWordsOfTheProgram) {
    if (!have_ffmpeg()) SUPPLE_SKIP("ffmpeg is not installed (apt-get install ffmpeg)");
    try {
        VideoWriter video({.path = path("no/such/folder/a.mp4"), .width = 64, .height = 48});
        for (int i = 0; i < 200; ++i) video.write(gradient(64, 48));
        video.finish();
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::external_tool);
        EXPECT_NE(e.message().find("No such file or directory"), std::string::npos) << e.what();
    }
}

TEST_F(RenderFiles, VideoRefusesWhatH264Cannot) {
    EXPECT_THROW(VideoWriter({.path = path("a.mp4"), .width = 63, .height = 48}), Error);
    EXPECT_THROW(VideoWriter({.path = path("a.mp4"), .width = 64, .height = 0}), Error);
    EXPECT_THROW(VideoWriter({.path = "", .width = 64, .height = 48}), Error);
    EXPECT_THROW(VideoWriter({.path = path("a.mp4"), .width = 64, .height = 48, .frames_per_s = NAN}), Error);
}

}  // namespace
}  // namespace supple
