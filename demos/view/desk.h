#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "frame_builder.h"
#include "view/history.h"
#include "view/orbit_camera.h"
#include "view/recorder.h"
#include "view/session.h"
#include "view/tool.h"
#include "view/viewport.h"

namespace supple::demos::view {

/// The curves of the plots.
struct Curves {
    History frame_ms, steps_ms, draw_ms, iterations, kinetic_j, elastic_j, force_n;
    std::array<History, kStageCount> stage_ms;

    void clear() { *this = Curves{}; }
};

/// A line at the foot of the picture that goes by itself.
struct Message {
    std::string text;
    bool is_error = false;
    double left_s = 0;
};

/// How the colours' range is chosen.
enum class RangeKind { scene, automatic, fixed };

/// What a person asks for in panels and by keys; the viewer does it between two frames.
struct Wishes {
    std::string open;         ///< a scene; empty: none
    bool restart = false, step = false, frame_camera = false, picture = false, window_picture = false, film = false, undo = false, quit = false;
};

/// Everything that lies on the desk of the viewer: what is open, how it is seen, what is at hand. Panels read and change it.
struct Desk {
    explicit Desk(const ShowOptions& options) : session(options), tools(make_tools()) {}

    Session session;
    OrbitCamera camera;
    Viewport viewport;
    FrameOptions frame;
    int range_kind = 0;             ///< RangeKind
    double range_high_pa = 1000;    ///< of RangeKind::fixed
    double legend_high = 0;         ///< upper end of the colours of the last picture; 0: none
    bool ground = true, hud = true, captions = true;
    std::size_t body = 0;           ///< chosen, in the order of World::bodies()
    std::vector<std::unique_ptr<Tool>> tools;
    std::size_t tool = 0;
    Recorder recorder;
    Curves curves;
    FrameSteps steps;               ///< of the last frame
    double frame_s = 1.0 / 60;      ///< between the last two
    double speed = 1;               ///< simulated over real time, smoothed
    bool panels = true, help = false;
    Message message;
    Wishes wishes;

    Tool& tool_at_hand() { return *tools[tool]; }
    void say(const std::string& text, bool is_error = false, double for_s = 5);
    void choose_tool(std::size_t number);
};

}  // namespace supple::demos::view
