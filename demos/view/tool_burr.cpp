#include <imgui.h>

#include <algorithm>
#include <optional>

#include "supple/world/edit_events.h"
#include "view/gui.h"
#include "view/tools.h"

namespace supple::demos::view {
namespace {

constexpr int kFrames = 3;          // from bite to bite: an edit costs some steps
constexpr double kCrumb = 2e-3;     // pieces below this part of the body's volume go with the bite

/// A ball at the surface under the cursor: elements whose centres it reaches go, bite by bite. It eats, it does not push.
class Burr : public Tool {
public:
    const char* name() const override { return "Burr"; }
    const char* hint() const override { return "Hold the left button on a body: what the ball reaches is taken away, ever deeper where it stays."; }
    bool edits() const override { return true; }

    bool press(World& world, const Pointer& pointer, const ToolScale& scale) override {
        const auto hit = world.pick(pointer.ray);
        if (!hit) return false;
        scale_ = scale;
        body_ = hit->body;
        at_ = hit->position_m;
        wait_ = 0;
        return true;
    }

    void move(World& world, const Pointer& pointer) override {
        if (!body_) return;
        const auto hit = world.pick(pointer.ray);
        at_.reset();
        if (!hit || hit->body != body_) return;
        at_ = hit->position_m;
        if (wait_-- <= 0) bite(world);
    }

    void scroll(World&, double steps) override { radius_ = std::clamp(radius_ + 0.005 * steps, 0.01, 0.3); }
    void release(World&) override { body_ = {}; }
    bool holds() const override { return bool(body_); }
    double force_n(const World&) const override { return 0; }

    void draw(const World&, FrameView& view) const override {
        if (body_ && at_) view.markers.push_back({*at_, radius_ * scale_.size_m, {1.0f, 0.62f, 0.25f}});
    }

    void panel(double) override { percent_slider("Radius", "tool radius", radius_, 0.01, 0.3, "of the ball, as a part of the scene's size; the wheel while it bites, too"); }

private:
    void bite(World& world) {
        const auto bodies = world.bodies();
        if (std::find(bodies.begin(), bodies.end(), body_) == bodies.end()) return;
        const std::size_t all = world.shape(body_).mesh().element_count();
        const auto gone = elements_near(world, body_, *at_, *at_, radius_ * scale_.size_m);
        if (gone.empty() || gone.size() >= all) return;  // the last of a body stays
        world.remove_elements(body_, gone);
        wait_ = kFrames - 1;
        const std::vector<Piece> pieces = world.pieces(body_);
        if (pieces.size() < 2) return;
        double volume = 0;
        for (const Piece& piece : pieces) volume += piece.volume_m3;
        world.remove_pieces(body_, kCrumb * volume);
    }

    BodyId body_;
    std::optional<Vec3> at_;  ///< none: the cursor is beside the body
    ToolScale scale_;
    int wait_ = 0;
    double radius_ = 0.05;
};

}  // namespace

std::unique_ptr<Tool> make_burr_tool() { return std::make_unique<Burr>(); }

}  // namespace supple::demos::view
