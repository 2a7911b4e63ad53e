#include <cstdio>

#include "view/gui.h"
#include "view/panels.h"

namespace supple::demos::view {

void time_panel(Desk& desk) {
    if (!header("Time and gravity", false)) return;
    Session& session = desk.session;
    const World& world = session.world();
    slider("Pace", "pace", session.time_scale, 0.02, 4, "x %.2f", "simulated over real time: 0.1 is slow motion [- and +]", true);
    double gravity = world.def().gravity_m_s2.norm();
    if (slider("Gravity", "gravity", gravity, 0, 30, "%.2f m/s2", "along the direction that the scene began with")) session.set_gravity(gravity * session.down());
    char line[160];
    std::snprintf(line, sizeof line, "Time step %.4g ms, at most %d steps a frame.", 1000 * world.def().time_step_s, world.def().max_catch_up_steps);
    quiet_sentence(line);
    bool script = session.script_plays();
    if (checkbox("Scripted touch plays", "script", script, "the demo's own tool; it ends when you touch a body, and begins anew with Restart") && !script) session.take_over();
}

}  // namespace supple::demos::view
