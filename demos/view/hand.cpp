#include "view/hand.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "framing.h"
#include "view/drag_spring.h"

namespace supple::demos::view {
namespace {

constexpr double kTurn_rad = 3.6;        // for a movement across the height of the picture
constexpr double kZoomPerStep = 0.88;

/// Uses the tool on the body under the cursor; false where there is none and the tool needs one.
bool use_tool(Desk& desk, const Pointer& pointer) {
    World& world = desk.session.world();
    const auto hit = world.pick(pointer.ray);
    const std::vector<BodyId> bodies = world.bodies();
    if (!hit && (!desk.tool_at_hand().begins_beside() || bodies.empty())) return false;
    desk.session.take_over();
    if (hit) desk.body = std::size_t(std::find(bodies.begin(), bodies.end(), hit->body) - bodies.begin());
    desk.body = std::min(desk.body, bodies.size() - 1);
    const SceneBounds bounds = bounds_of(world);
    return desk.tool_at_hand().press(world, pointer, {(bounds.max_m - bounds.min_m).norm(), weight_of(world, bodies[desk.body])});
}

}  // namespace

void Hand::begin(Desk& desk, const Pointer& pointer) {
    const ImGuiIO& io = ImGui::GetIO();
    for (int button = 0; button < 3; ++button) {
        if (!ImGui::IsMouseClicked(button)) continue;
        button_ = button;
        if (button == 0) at_ = !io.KeyAlt && use_tool(desk, pointer) ? At::tool : At::turn;
        if (button == 1) at_ = io.KeyShift ? At::shift : At::turn;
        if (button == 2) at_ = At::shift;
        return;
    }
}

void Hand::act(Desk& desk) {
    const ImGuiIO& io = ImGui::GetIO();
    const Viewport& view = desk.viewport;
    const ImVec2 cursor = io.MousePos;
    const bool over = !io.WantCaptureMouse && view.contains(cursor.x, cursor.y);
    World& world = desk.session.world();
    Tool& tool = desk.tool_at_hand();
    if (at_ != At::nothing && !ImGui::IsMouseDown(button_)) {
        if (at_ == At::tool) tool.release(world);
        at_ = At::nothing;
    }
    const bool wheel = over && io.MouseWheel != 0;
    if (at_ == At::nothing && !over) return;
    const Pointer pointer = view.pointer(desk.camera.camera(), cursor.x, cursor.y);
    if (at_ == At::nothing) begin(desk, pointer);
    const double right = double(io.MouseDelta.x / view.height), down = double(io.MouseDelta.y / view.height);
    if (at_ == At::tool && tool.holds()) tool.move(world, pointer);
    if (at_ == At::turn) desk.camera.orbit(-kTurn_rad * right, kTurn_rad * down);
    if (at_ == At::shift) desk.camera.pan(-right, down);
    if (!wheel) return;
    if (tool.holds()) tool.scroll(world, double(io.MouseWheel));
    else desk.camera.zoom(std::pow(kZoomPerStep, double(io.MouseWheel)));
}

}  // namespace supple::demos::view
