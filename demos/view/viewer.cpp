#include "view/viewer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <thread>
#include <utility>

#include "command.h"
#include "framing.h"
#include "supple/base/clock.h"
#include "supple/render/renderer.h"
#include "view/gui.h"
#include "view/hand.h"
#include "view/keys.h"
#include "view/panels.h"
#include "view/script.h"
#include "view/state_line.h"

namespace supple::demos::view {
namespace {

constexpr double kFixedFrame_s = 1.0 / 60;
constexpr std::size_t kWarmUpFrames = 3;   // of a scene: shaders and preconditioners are made in them; the plots leave them out
constexpr double kLongestFrame_s = 0.25, kShortestFrame_s = 1.0 / 120;
constexpr double kUsualAspect = 1.35;  // below it the cameras that demos choose would cut their bodies off

/// Over the left shoulder of the camera that a scene begins with; it stays there while the camera moves.
Vec3 key_light_of(const Camera& camera) {
    const Vec3 up = camera.up.normalized(), side = up.cross(camera.eye_m - camera.target_m).normalized();
    return (-0.62 * side + 1.15 * up + 0.55 * side.cross(up)).normalized();
}

class Viewer {
public:
    Viewer(const ViewOptions& o, Desk& desk, Script& script)
        : o_(o), desk_(desk), script_(script), fixed_(o.frames > 0 || script.plays()),
          window_(o.width, o.height, "Supple", !fixed_), gui_(window_.handle(), o.ui_scale > 0 ? float(o.ui_scale) : window_.content_scale(), !script.plays()),
          renderer_({.width = 640, .height = 360, .samples = o.samples}) {
        desk_.session.set_before_step([this](double step_s) { desk_.tool_at_hand().before_step(desk_.session.world(), step_s); });
    }
    ~Viewer() { desk_.session.set_before_step({}); }

    int run();

private:
    void frame(double elapsed_s);
    void fulfil_wishes();
    void undo_edit();
    void take_up_scene();
    void simulate(double elapsed_s);
    void draw_scene(double elapsed_s);
    void pictures(double elapsed_s);
    Image window_image() const;
    template <class Act>
    void careful(Act&& act);

    const ViewOptions& o_;
    Desk& desk_;
    Script& script_;
    bool fixed_;
    Window window_;
    Gui gui_;
    Renderer renderer_;
    Hand hand_;
    std::optional<FrameBuilder> builder_;
    std::size_t opening_ = 0;  ///< Session::openings() that the builder is of
    bool keeps_camera_ = false;
    Vec3 key_light_ = Vec3(0, 1, 0);
    Image image_;
    std::size_t frames_ = 0, frames_of_scene_ = 0;
};

/// A mistake of the person at the window is a message there, not the end of the program.
template <class Act>
void Viewer::careful(Act&& act) {
    try {
        act();
    } catch (const Error& error) {
        desk_.say(error.what(), true, 12);
    }
}

void Viewer::fulfil_wishes() {
    Wishes wishes = std::exchange(desk_.wishes, {});
    Session& session = desk_.session;
    if (!wishes.open.empty() || wishes.restart) {
        desk_.tool_at_hand().cancel(session.world());
        keeps_camera_ = wishes.open.empty();
        careful([&] {
            if (wishes.restart) session.restart();
            if (!wishes.open.empty()) session.open(wishes.open);
        });
    }
    if (session.openings() != opening_) take_up_scene();
    if (wishes.step) {
        session.playing = false;
        desk_.steps = session.step_once();
    }
    if (wishes.undo) undo_edit();
    if (wishes.frame_camera) desk_.camera.frame(bounds_of(session.world()), desk_.viewport.aspect());
    if (wishes.picture)
        careful([&] {
            const std::string file = free_name(session.name(), ".png");
            write_png(file, renderer_.read_pixels());
            desk_.say("wrote " + file);
        });
    if (wishes.window_picture)
        careful([&] {
            const std::string file = free_name(session.name() + "_window", ".png");
            write_png(file, window_image());
            desk_.say("wrote " + file);
        });
    if (wishes.film)
        careful([&] {
            if (desk_.recorder.records()) {
                desk_.recorder.end();
                desk_.say("wrote " + desk_.recorder.file());
            } else {
                desk_.recorder.begin(session.name(), renderer_.width(), renderer_.height());
                desk_.say("films to " + desk_.recorder.file());
            }
        });
    if (wishes.quit) window_.close();
}

/// Of the body that was cut last; of the chosen one where that has nothing to undo.
void Viewer::undo_edit() {
    World& world = desk_.session.world();
    desk_.tool_at_hand().cancel(world);  // it may hold what goes
    for (const auto& tool : desk_.tools)
        if (tool->undo(world)) return;
    std::vector<BodyId> bodies = world.bodies();
    if (desk_.body < bodies.size()) std::swap(bodies[0], bodies[desk_.body]);
    for (const BodyId body : bodies)
        if (world.undo_edit(body)) return;
    desk_.say("there is nothing to undo");
}

/// Another world than in the last frame: what was made for the old one goes.
void Viewer::take_up_scene() {
    opening_ = desk_.session.openings();
    desk_.curves.clear();
    frames_of_scene_ = 0;
    desk_.body = 0;
    for (const auto& tool : desk_.tools) tool->forget();
    builder_.emplace(desk_.session.show(), desk_.frame);
    window_.set_title("Supple: " + desk_.session.name());
    if (keeps_camera_) return;
    const Camera camera = builder_->build(1, "", 0).camera;
    desk_.camera.look(camera);
    desk_.camera.zoom(std::max(1.0, kUsualAspect / desk_.viewport.aspect()));
    key_light_ = key_light_of(camera);
}

void Viewer::simulate(double elapsed_s) {
    Session& session = desk_.session;
    World& world = session.world();
    if (session.playing) {
        careful([&] { desk_.steps = session.advance(elapsed_s); });
        const double done = desk_.steps.steps * world.def().time_step_s / std::max(elapsed_s, 1e-9);
        desk_.speed += 0.05 * (done - desk_.speed);
    }
    if (desk_.steps.steps == 0) return;
    if (frames_of_scene_ < kWarmUpFrames) return void(desk_.steps = {});
    Curves& c = desk_.curves;
    c.steps_ms.add(float(desk_.steps.step_ms));
    for (std::size_t s = 0; s < kStageCount; ++s) c.stage_ms[s].add(float(desk_.steps.stage_ms[s]));
    c.iterations.add(float(desk_.steps.iterations));
    const Energy energy = world.energy();
    c.kinetic_j.add(float(energy.kinetic_j));
    c.elastic_j.add(float(energy.elastic_j));
    c.force_n.add(float(desk_.tool_at_hand().force_n(world)));
    desk_.steps = {};
}

void Viewer::draw_scene(double elapsed_s) {
    int window_w = 1, window_h = 1, pixel_w = 1, pixel_h = 1;
    window_.size(window_w, window_h);
    window_.pixel_size(pixel_w, pixel_h);
    const Viewport& v = desk_.viewport;
    const float dots = float(pixel_w) / float(std::max(window_w, 1));
    const auto pixels = [&](float length) { return int(std::lround(length * dots)); };
    renderer_.resize(std::max(16, pixels(v.width)), std::max(16, pixels(v.height)));

    FrameOptions frame = desk_.frame;
    frame.automatic_range = RangeKind(desk_.range_kind) == RangeKind::automatic;
    const bool of_stress = frame.color_by.value_or(desk_.session.show().color_by()) == ColorBy::stress;
    if (RangeKind(desk_.range_kind) == RangeKind::fixed && of_stress) frame.range_pa = {0.0, desk_.range_high_pa};
    builder_->options() = frame;
    const double simulated_s = desk_.session.playing ? elapsed_s * desk_.session.time_scale : 0;
    FrameView& view = builder_->build(desk_.session.alpha(), desk_.hud ? desk_.session.hud_text() : "", simulated_s);
    view.camera = desk_.camera.camera();
    view.key_light = key_light_;
    if (!desk_.hud) view.hud.clear();
    if (!desk_.ground) view.ground_height_m.reset();
    if (!desk_.captions || !desk_.session.script_plays()) view.caption.clear();
    desk_.tool_at_hand().draw(desk_.session.world(), view);
    desk_.legend_high = view.scale ? view.scale->high : 0;
    renderer_.draw(view);

    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, pixel_w, pixel_h);
    glDisable(GL_SCISSOR_TEST);
    const ImVec4 behind = ImGui::GetStyle().Colors[ImGuiCol_WindowBg];
    glClearColor(behind.x, behind.y, behind.z, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    renderer_.blit_to(0, renderer_.width(), renderer_.height(), pixels(v.x), pixel_h - pixels(v.y) - renderer_.height());
}

Image Viewer::window_image() const {
    Image image;
    window_.pixel_size(image.width, image.height);
    const std::size_t row = std::size_t(image.width) * 3;
    std::vector<std::uint8_t> upwards(row * std::size_t(image.height));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    glReadBuffer(GL_BACK);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, image.width, image.height, GL_RGB, GL_UNSIGNED_BYTE, upwards.data());
    image.rgb.resize(upwards.size());
    for (std::size_t y = 0; y < std::size_t(image.height); ++y)
        std::copy_n(upwards.end() - std::ptrdiff_t((y + 1) * row), row, image.rgb.begin() + std::ptrdiff_t(y * row));
    return image;
}

void Viewer::pictures(double elapsed_s) {
    if (!script_.picture().empty()) write_png(script_.picture(), window_image());
    if (script_.prints()) std::printf("%s\n", state_line(desk_, frames_).c_str());
    if (!desk_.recorder.records()) return;
    careful([&] {
        renderer_.read_pixels(image_);
        if (desk_.recorder.add(image_, elapsed_s)) return;
        desk_.recorder.end();
        desk_.say("the picture changed its size, so the film ends; wrote " + desk_.recorder.file());
    });
}

void Viewer::frame(double elapsed_s) {
    window_.poll();
    const Stopwatch watch;
    gui_.begin_backend();
    ImGuiIO& io = ImGui::GetIO();
    if (fixed_) io.DeltaTime = float(elapsed_s);
    if (script_.plays()) script_.play(desk_.viewport, window_);
    ImGui::NewFrame();
    controls().begin_frame();
    for (const KeyPress& key : window_.take_keys())
        if (!io.WantTextInput) handle_key(desk_, key);
    for (const std::string& file : window_.take_drops()) desk_.wishes.open = file;
    draw_panels(desk_, io.DisplaySize.x, io.DisplaySize.y, gui_.scale());
    fulfil_wishes();
    careful([&] { hand_.act(desk_); });
    simulate(elapsed_s);
    const Stopwatch drawing;
    if (!window_.is_minimised()) draw_scene(elapsed_s);
    gui_.draw();
    pictures(elapsed_s);
    const bool last = (o_.frames > 0 && frames_ + 1 >= o_.frames) || (script_.plays() && script_.ended());
    if (last && !o_.screenshot.empty()) write_png(o_.screenshot, window_image());
    const double draw_ms = drawing.ms();
    window_.show();
    if (++frames_of_scene_ > kWarmUpFrames) {
        desk_.curves.draw_ms.add(float(draw_ms));
        desk_.curves.frame_ms.add(float(watch.ms()));
    }
    desk_.message.left_s -= elapsed_s;
    desk_.frame_s += 0.1 * (elapsed_s - desk_.frame_s);
    ++frames_;
}

int Viewer::run() {
    Stopwatch since_last;
    while (!window_.closes()) {
        double elapsed_s = kFixedFrame_s;
        if (!fixed_) {
            const double spare_s = kShortestFrame_s - since_last.ms() / 1000;
            if (frames_ > 0 && spare_s > 0) std::this_thread::sleep_for(std::chrono::duration<double>(spare_s));
            elapsed_s = std::min(since_last.ms() / 1000, kLongestFrame_s);
            since_last = {};
        }
        frame(elapsed_s);
        if (o_.frames > 0 && frames_ >= o_.frames) break;
        if (script_.plays() && script_.ended()) break;
    }
    careful([&] { desk_.recorder.end(); });
    desk_.tool_at_hand().cancel(desk_.session.world());
    if (!script_.plays() || script_.ended()) return kAllWell;
    std::fprintf(stderr, "supple view: the window closed before the script was over\n");
    return kRunFailed;
}

}  // namespace

int run_viewer(const ViewOptions& options) {
    Script script;
    if (!options.script.empty()) script = Script(options.script);
    Desk desk(options.show);
    desk.session.open(options.scene);  // before any window: a wrong name needs no display to be found
    return Viewer(options, desk, script).run();
}

}  // namespace supple::demos::view
