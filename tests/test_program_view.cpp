// `supple view` as a person uses it, by scripts under a virtual screen: bodies are pulled, sliders moved, pictures looked at.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "supple/io/mesh_file.h"
#include "supple/mesh/box_mesh.h"
#include "supple/render/image.h"
#include "support/skip.h"
#include "view/material_edit.h"
#include "view/orbit_camera.h"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string read_text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// An X server without a screen, for as long as the tests of this file run.
class VirtualScreen {
public:
    VirtualScreen() {
        int ends[2];
        if (pipe(ends) != 0) return;
        process_ = fork();
        if (process_ == 0) {
            close(ends[0]);
            const std::string fd = std::to_string(ends[1]);
            const int nothing = open("/dev/null", O_WRONLY);
            dup2(nothing, 2);
            execlp("Xvfb", "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", "1600x1200x24", "-nolisten", "tcp", static_cast<char*>(nullptr));
            _exit(127);
        }
        close(ends[1]);
        char letter = 0;
        while (read(ends[0], &letter, 1) == 1 && letter != '\n') display_ += letter;  // its number, once it listens; nothing if it cannot run
        close(ends[0]);
    }
    ~VirtualScreen() {
        if (process_ <= 0) return;
        kill(process_, SIGTERM);
        waitpid(process_, nullptr, 0);
    }
    VirtualScreen(const VirtualScreen&) = delete;
    VirtualScreen& operator=(const VirtualScreen&) = delete;
    /// ":3"; empty where there is no Xvfb.
    std::string display() const { return display_.empty() ? "" : ":" + display_; }

private:
    pid_t process_ = -1;
    std::string display_;
};

struct Result {
    int status = -1;
    std::string out, err;
    std::vector<Json> states;  ///< what `print` printed
};

class View : public testing::Test {
protected:
    static void SetUpTestSuite() { screen_ = std::make_unique<VirtualScreen>(); }
    static void TearDownTestSuite() { screen_.reset(); }

    void SetUp() override {
#ifndef SUPPLE_VIEW
        SUPPLE_SKIP("this build has no window (libglfw3-dev, libimgui-dev); nothing of `supple view` was tested");
#endif
        folder_ = fs::path(testing::TempDir()) / ("supple_view_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" + std::to_string(getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override {
        if (!folder_.empty()) fs::remove_all(folder_);
    }

    static bool no_screen() { return screen_->display().empty(); }

    Result run(const std::string& arguments, const std::string& environment) const {
        const std::string line = "cd '" + folder_.string() + "' && " + environment + " '" SUPPLE_PROGRAM "' " + arguments + " >stdout.txt 2>stderr.txt </dev/null";
        const int status = std::system(line.c_str());
        Result r{WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), read_text(path("stdout.txt")), read_text(path("stderr.txt")), {}};
        std::istringstream lines(r.out);
        for (std::string text; std::getline(lines, text);)
            if (!text.empty() && text[0] == '{') r.states.push_back(Json::parse(text));
        return r;
    }
    Result view(const std::string& scene, const std::string& script, const std::string& more = "--size 800x600", int status = 0) const {
        std::ofstream(path("script.txt")) << script;
        // The drivers of Mesa and X keep caches until the process dies, and LeakSanitizer would blame us for them.
        const Result r = run("view " + scene + " --script script.txt --samples 0 " + more,
                             "ASAN_OPTIONS=detect_leaks=0 DISPLAY=" + screen_->display() + " LIBGL_ALWAYS_SOFTWARE=1");
        EXPECT_EQ(r.status, status) << r.err;
        return r;
    }
    fs::path path(const std::string& name) const { return folder_ / name; }
    supple::Image picture(const std::string& name) const { return supple::read_png(path(name).string()); }

    /// A small bar held at its left end, in a scene file that opens at once.
    void write_bar() const {
        supple::io::write_mesh(path("bar.msh"), supple::make_tet_box({.max_m = {0.4, 0.1, 0.1}, .cells = {8, 2, 2}}));
        std::ofstream(path("bar.json")) << R"({"supple_scene": 1, "time_step_s": 0.01, "gravity_m_s2": [0, -9.81, 0],
            "bodies": [{"name": "bar", "mesh": "bar.msh", "density_kg_m3": 1000, "material": {"law": "corotational", "young_pa": 2e5, "poisson": 0.4},
                        "fixed": [{"box": {"min_m": [-1, -1, -1], "max_m": [1e-6, 1, 1]}}]}]})";
    }

    fs::path folder_;
    static std::unique_ptr<VirtualScreen> screen_;
};
std::unique_ptr<VirtualScreen> View::screen_;

#define NEEDS_SCREEN() \
    if (no_screen()) SUPPLE_SKIP("no Xvfb (apt-get install xvfb); the window was not tested")

/// Part of a picture, in parts of its size.
supple::Image crop(const supple::Image& image, double x0, double y0, double x1, double y1) {
    const auto px = [&](double s) { return std::size_t(s * image.width); };
    const auto py = [&](double s) { return std::size_t(s * image.height); };
    supple::Image part;
    part.width = int(px(x1) - px(x0));
    part.height = int(py(y1) - py(y0));
    for (std::size_t y = py(y0); y < py(y1); ++y)
        for (std::size_t i = 3 * px(x0); i < 3 * px(x1); ++i) part.rgb.push_back(image.rgb[y * 3 * std::size_t(image.width) + i]);
    return part;
}

std::size_t colours(const supple::Image& image) {
    std::set<int> seen;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) seen.insert(image.rgb[i] << 16 | image.rgb[i + 1] << 8 | image.rgb[i + 2]);
    return seen.size();
}

double brightness(const supple::Image& image) {
    double sum = 0;
    for (const std::uint8_t c : image.rgb) sum += c;
    return sum / double(image.rgb.size());
}

double x_of(const Json& state) { return state["centre_m"][0].get<double>(); }
double y_of(const Json& state) { return state["centre_m"][1].get<double>(); }

TEST_F(View, ADragMovesTheLiverAndASliderStiffensIt) {
    NEEDS_SCREEN();
    const Result r = view("liver",
                          "wait 30\nprint\npicture before.png\n"
                          "move 0.42 0.5\npress left\nmove 0.75 0.5 20\nwait 10\nprint\npicture pulled.png\nrelease left\nwait 20\nprint\n"
                          "slide young 0.7\nwait 60\nprint\npicture stiff.png\n");
    ASSERT_EQ(r.states.size(), 4u) << r.out << r.err;
    const Json &before = r.states[0], &pulled = r.states[1], &released = r.states[2], &stiff = r.states[3];
    EXPECT_FALSE(before["holds"]);
    EXPECT_TRUE(before["script"]);
    EXPECT_TRUE(pulled["holds"]) << "the cursor met no body";
    EXPECT_FALSE(pulled["script"]) << "a hand ends the scripted touch";
    EXPECT_GT(pulled["force_n"], 0.5);
    EXPECT_GT(x_of(pulled), x_of(before) + 0.005) << "pulled to the right of the picture, which is x";
    EXPECT_LT(x_of(released), x_of(pulled) - 0.002) << "let go, it swings back";
    EXPECT_FALSE(released["holds"]);
    EXPECT_EQ(before["young_pa"], 6000);
    EXPECT_GT(stiff["young_pa"], 1e6) << "0.7 of a logarithmic slider from 10 to 1e9 Pa";
    EXPECT_LT(stiff["young_pa"], 2e7);
    EXPECT_GT(y_of(stiff), y_of(released) + 0.002) << "stiffer, it sags less";

    const supple::Image first = picture("before.png"), second = picture("pulled.png");
    ASSERT_EQ(first.width, 800);
    ASSERT_EQ(first.height, 600);
    // The panels are the left 46 %, the toolbar is above, the scene is the rest.
    const auto panel = [](const supple::Image& image) { return crop(image, 0, 0.1, 0.4, 1); };
    const auto scene = [](const supple::Image& image) { return crop(image, 0.48, 0.1, 1, 1); };
    EXPECT_GT(colours(scene(first)), 1000u) << "the scene is blank";
    EXPECT_GT(colours(panel(first)), 40u) << "the panels are blank";
    EXPECT_LT(brightness(panel(first)), 80) << "the panels are dark, with light letters";
    EXPECT_GT(compare(scene(first), scene(second)).fraction_above_16, 0.02) << "the liver looks as it did before the drag";
    EXPECT_LT(compare(panel(first), panel(second)).fraction_above_16, 0.1) << "the panels stay where they are";
}

TEST_F(View, KeysAndPanelsActOnTheRunningScene) {
    NEEDS_SCREEN();
    write_bar();
    const Result r = view("bar.json",
                          "wait 20\nkey space\nprint\nwait 5\nprint\nkey period\nprint\n"                        // 0 paused, 1 still, 2 one step on
                          "click Solver\nslide tolerance 0.2\nclick preconditioner\nclick preconditioner/block Jacobi\nprint\n"  // 3
                          "click law\nclick law/NeoHookean\nslide factor 0.75\nprint\n"                          // 4
                          "key r\nwait 2\nprint\n"                                                               // 5
                          "slide range high 0.5\n",                                                              // which is there with a fixed range alone
                          "--size 1280x720", 2);
    EXPECT_NE(r.err.find("no control \"range high\""), std::string::npos) << r.err;
    ASSERT_EQ(r.states.size(), 6u) << r.out << r.err;
    EXPECT_FALSE(r.states[0]["playing"]);
    EXPECT_EQ(r.states[0]["hash"], r.states[1]["hash"]);
    EXPECT_EQ(r.states[2]["steps"].get<int>(), r.states[1]["steps"].get<int>() + 1);
    EXPECT_EQ(r.states[2]["tolerance"], 1e-5);
    EXPECT_LT(r.states[3]["tolerance"], 1e-6);
    EXPECT_GT(r.states[3]["tolerance"], 1e-8);
    EXPECT_EQ(r.states[4]["law"], "NeoHookean");
    EXPECT_NEAR(r.states[4]["young_pa"].get<double>(), 2e5, 1e-6);
    EXPECT_GT(r.states[4]["factor"], 5);
    for (const char* kept : {"tolerance", "law", "factor"}) EXPECT_EQ(r.states[5][kept], r.states[4][kept]) << kept << " is forgotten by Restart";
    EXPECT_EQ(r.states[5]["steps"], 0);
}

TEST_F(View, EveryToolHoldsAndReportsAForce) {
    NEEDS_SCREEN();
    write_bar();
    for (const char* key : {"1", "2", "3"}) {
        const Result r = view("bar.json", std::string("key ") + key + "\nwait 10\nmove 0.5 0.5\npress left\nwait 20\nscroll 2\nwait 10\nprint\nrelease left\nwait 2\nprint\n");
        ASSERT_EQ(r.states.size(), 2u) << r.out << r.err;
        EXPECT_TRUE(r.states[0]["holds"]) << r.states[0];
        EXPECT_GT(r.states[0]["force_n"], 0.01) << r.states[0];
        EXPECT_FALSE(r.states[1]["holds"]) << r.states[1];
    }
}

TEST_F(View, PiecesStayInTheirBodyWhereThatIsAskedFor) {
    NEEDS_SCREEN();
    write_bar();
    const std::string cut = "move 0.5 0.15\npress left\nmove 0.5 0.95 20\nrelease left\nprint\n";
    const Result r = view("bar.json", "key 4\nwait 10\nprint\nslide blade depth 0.9\nclick part pieces\n" + cut + "wait 20\nprint\nkey u\nwait 1\nprint\n");
    ASSERT_EQ(r.states.size(), 4u) << r.out << r.err;
    EXPECT_EQ(r.states[1]["bodies"], 1);
    EXPECT_EQ(r.states[1]["pieces"], 2);
    EXPECT_GT(r.states[1]["elements"], r.states[0]["elements"]) << "tets are split along it";
    EXPECT_LT(y_of(r.states[2]), y_of(r.states[1]) - 0.05) << "what was cut off falls";
    EXPECT_EQ(r.states[3]["elements"], r.states[0]["elements"]);
}

TEST_F(View, TheScalpelCutsAlongADragAndUndoTakesItBack) {
    NEEDS_SCREEN();
    write_bar();
    const Result r = view("bar.json",
                          "key 4\nwait 10\nprint\nslide blade depth 0.9\nmove 0.5 0.15\npress left\nmove 0.5 0.5 10\nprint\npicture preview.png\nmove 0.5 0.95 10\nprint\nrelease left\nprint\n"
                          "wait 20\nprint\npicture cut.png\n"                                           // 4: what was cut off falls
                          "key u\nwait 1\nprint\n"                                                      // 5: whole again
                          "key 1\nmove 0.5 0.5\npress left\nmove 0.55 0.4 10\nprint\nrelease left\n"  // 6: other tools go on
                          "key u\nwait 2\nprint\n");                                                    // 7: nothing is left to undo
    ASSERT_EQ(r.states.size(), 8u) << r.out << r.err;
    EXPECT_EQ(r.states[0]["tool"], "Scalpel");
    EXPECT_EQ(r.states[0]["pieces"], 1);
    EXPECT_TRUE(r.states[1]["holds"]) << "it may begin beside the body";
    EXPECT_EQ(r.states[2]["edits"], 0) << "it cuts when it is let go";
    EXPECT_EQ(r.states[3]["edits"], 2) << r.states[3];
    EXPECT_EQ(r.states[3]["bodies"], 2) << "through: the end that nothing holds is a body of its own";
    EXPECT_EQ(r.states[3]["pieces"], 1);
    EXPECT_LT(r.states[3]["elements"], r.states[0]["elements"]) << "its elements are gone from the bar";
    EXPECT_EQ(r.states[5]["pieces"], 1);
    EXPECT_EQ(r.states[5]["bodies"], 1);
    EXPECT_EQ(r.states[5]["elements"], r.states[0]["elements"]);
    EXPECT_NEAR(y_of(r.states[5]), y_of(r.states[2]), 0.02) << "as it stood before the cut";
    EXPECT_TRUE(r.states[6]["holds"]);
    EXPECT_GT(r.states[6]["force_n"], 0.01);
    EXPECT_NE(r.states[7]["message"].get<std::string>().find("nothing to undo"), std::string::npos) << r.states[7];
    EXPECT_GT(compare(crop(picture("preview.png"), 0.48, 0.1, 1, 0.7), crop(picture("cut.png"), 0.48, 0.1, 1, 0.7)).fraction_above_16, 0.01);
}

TEST_F(View, TheScalpelTakesPiecesBelowItsBoundAway) {
    NEEDS_SCREEN();
    write_bar();
    for (const bool bound : {false, true}) {  // a tenth of the bar at most: its end
        const Result r = view("bar.json", std::string("key 4\nwait 10\nprint\nslide blade depth 0.9\nclick part pieces\n") + (bound ? "slide smallest piece 1\n" : "") +
                                              "move 0.75 0.15\npress left\nmove 0.75 0.95 20\nrelease left\nprint\nkey u\nwait 1\nkey u\nwait 1\nprint\n");
        ASSERT_EQ(r.states.size(), 3u) << r.out << r.err;
        EXPECT_EQ(r.states[1]["pieces"], bound ? 1 : 2);
        EXPECT_EQ(r.states[1]["edits"], bound ? 2 : 1);
        EXPECT_EQ(r.states[1]["bodies"], 1);
        EXPECT_EQ(r.states[2]["elements"], r.states[0]["elements"]) << "undone";
    }
}

TEST_F(View, TheBurrTakesElementsAwayAndEscapeCancelsAScalpel) {
    NEEDS_SCREEN();
    write_bar();
    const Result r = view("bar.json",
                          "wait 5\nprint\nkey 5\nmove 0.5 0.5\npress left\nwait 12\nprint\nrelease left\nwait 5\nprint\nclick undo\nwait 1\nprint\n"
                          "key 4\nmove 0.5 0.15\npress left\nmove 0.5 0.95 10\nkey escape\nrelease left\nwait 2\nprint\n");
    ASSERT_EQ(r.states.size(), 5u) << r.out << r.err;
    const auto elements = [&](std::size_t i) { return r.states[i]["elements"].get<int>(); };
    EXPECT_EQ(r.states[1]["tool"], "Burr");
    EXPECT_TRUE(r.states[1]["holds"]);
    EXPECT_LT(elements(1), elements(0));
    EXPECT_GT(elements(1), 0);
    EXPECT_EQ(elements(2), elements(1)) << "let go, it eats no more";
    EXPECT_GT(elements(3), elements(2)) << "undo gives a bite back";
    EXPECT_EQ(elements(4), elements(3)) << "cancelled";
    EXPECT_FALSE(r.states[4]["holds"]);
}

TEST_F(View, TheSameScriptGivesTheSameBits) {
    NEEDS_SCREEN();
    write_bar();
    const std::string script = "wait 5\nmove 0.5 0.5\npress left\nmove 0.6 0.4 15\nrelease left\nwait 10\nprint\n";
    const Result one = view("bar.json", script, "--size 640x480 --threads 1"), two = view("bar.json", script, "--size 640x480 --threads 2");
    ASSERT_EQ(one.states.size(), 1u);
    ASSERT_EQ(two.states.size(), 1u);
    EXPECT_EQ(one.states[0]["hash"], two.states[0]["hash"]);
}

TEST_F(View, CameraHelpAndPanelsFollowMouseAndKeys) {
    NEEDS_SCREEN();
    write_bar();
    const Result r = view("bar.json",
                          "print\nmove 0.5 0.1\npress right\nmove 0.7 0.2 5\nrelease right\nprint\nscroll 3\nprint\n"  // 0, 1 turned, 2 nearer
                          "key f1\nwait 2\npicture help.png\nprint\nkey escape\nkey tab\nwait 2\nprint\npicture bare.png\n"  // 3, 4
                          "resize 640 480\nwait 5\npicture small.png\n");
    ASSERT_EQ(r.states.size(), 5u) << r.out << r.err;
    const auto eye = [](const Json& s) { return supple::Vec3(s["eye_m"][0], s["eye_m"][1], s["eye_m"][2]); };
    const supple::Vec3 middle(0.2, 0.05, 0.05);
    EXPECT_GT((eye(r.states[1]) - eye(r.states[0])).norm(), 0.1);
    EXPECT_NEAR((eye(r.states[1]) - middle).norm(), (eye(r.states[0]) - middle).norm(), 1e-9) << "it turns around the middle";
    EXPECT_LT((eye(r.states[2]) - middle).norm(), 0.8 * (eye(r.states[1]) - middle).norm());
    EXPECT_TRUE(r.states[3]["help"]);
    EXPECT_FALSE(r.states[4]["help"]);
    EXPECT_FALSE(r.states[4]["panels"]);
    EXPECT_GT(compare(picture("help.png"), picture("bare.png")).fraction_above_16, 0.3);
    EXPECT_EQ(picture("small.png").width, 640);
}

TEST_F(View, OpensWhatIsDroppedAndSaysWhatItCannot) {
    NEEDS_SCREEN();
    write_bar();
    std::ofstream(path("nonsense.msh")) << "this is no mesh\n";
    const Result r = view("bar.json", "wait 2\ndrop nonsense.msh\nwait 2\nprint\ndrop bar.msh\nwait 30\nprint\nkey p\nkey v\nwait 10\nkey v\nwait 2\nprint\n");
    ASSERT_EQ(r.states.size(), 3u) << r.out << r.err;
    EXPECT_NE(r.states[0]["message"].get<std::string>().find("nonsense.msh"), std::string::npos) << r.states[0];
    EXPECT_EQ(r.states[0]["body"], "bar");
    EXPECT_EQ(r.states[0]["scene"], "bar");
    EXPECT_EQ(r.states[1]["poisson"], 0.4);
    EXPECT_GT(r.states[1]["steps"], 40) << "the mesh moves";
    EXPECT_LT(y_of(r.states[1]), 0.05) << "a mesh alone stands on its foot and sags a little";
    EXPECT_GT(y_of(r.states[1]), 0.04);
    EXPECT_GT(colours(picture("bar_001.png")), 300u);
    EXPECT_TRUE(fs::exists(path("bar_001.mp4"))) << r.err;
    EXPECT_GT(fs::file_size(path("bar_001.mp4")), 1000u);
}

TEST_F(View, RefusesWhatItCannotDo) {
    const Result no_display = run("view liver", "env -u DISPLAY -u WAYLAND_DISPLAY");
    EXPECT_EQ(no_display.status, 2);
    EXPECT_NE(no_display.err.find("no window can be opened"), std::string::npos) << no_display.err;
    EXPECT_NE(no_display.err.find("supple record"), std::string::npos) << no_display.err;

    const Result viewed = run("view livr", "env -u DISPLAY"), ran = run("run livr", "");
    EXPECT_EQ(viewed.status, 2);
    EXPECT_EQ(viewed.err, ran.err);

    const Result aimless = run("view liver --screenshot a.png", "env -u DISPLAY");
    EXPECT_EQ(aimless.status, 2);
    EXPECT_NE(aimless.err.find("--frames"), std::string::npos) << aimless.err;

    std::ofstream(path("script.txt")) << "wait 2\n\ndance\n";
    const Result dance = run("view liver --script script.txt", "env -u DISPLAY");
    EXPECT_EQ(dance.status, 2);
    EXPECT_NE(dance.err.find("script.txt:3"), std::string::npos) << dance.err;
}

TEST(ViewMaterial, EveryLawTakesAndGivesItsModuli) {
    using namespace supple::demos::view;
    const supple::Material start = supple::Corotational{.young_pa = 3e4, .poisson = 0.35};
    for (std::size_t law = 0; law < law_names().size(); ++law) {
        const supple::Material other = of_law(law, start);
        EXPECT_EQ(other.index(), law);
        EXPECT_NEAR(moduli_of(other).young_pa, 3e4, 3e4 * 1e-9) << law_names()[law];
        EXPECT_NEAR(moduli_of(other).poisson, 0.35, 1e-9) << law_names()[law];
        const supple::Material changed = with_moduli(other, {2e6, 0.2});
        EXPECT_NEAR(moduli_of(changed).young_pa, 2e6, 2e6 * 1e-9) << law_names()[law];
        EXPECT_NEAR(moduli_of(changed).poisson, 0.2, 1e-9) << law_names()[law];
    }
    supple::NeoHookean fibrous;
    fibrous.fibres.fibre = {supple::Vec3(1, 0, 0)};
    fibrous.fibres.fibre_stiffness_pa = 5e3;
    EXPECT_EQ(supple::fibres_of(of_law(8, fibrous))->fibre_stiffness_pa, 5e3);
}

TEST(ViewCamera, NeverLooksAlongTheVertical) {
    supple::demos::view::OrbitCamera camera;
    camera.look({.eye_m = supple::Vec3(0, 0, 2), .target_m = supple::Vec3::Zero(), .up = supple::Vec3(0, 3, 0), .fov_deg = 40});
    for (int i = 0; i < 50; ++i) {
        camera.orbit(0.1, 0.3);
        ASSERT_NO_THROW(supple::require_legal(camera.camera()));
        EXPECT_NEAR(camera.camera().eye_m.norm(), 2, 1e-9);
    }
    EXPECT_GT(camera.camera().eye_m.y(), 1.9) << "up is up";
    camera.pan(1, 0);
    EXPECT_NEAR((camera.camera().eye_m - camera.camera().target_m).norm(), 2, 1e-9);
}

}  // namespace
