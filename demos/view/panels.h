#pragma once
#include "view/desk.h"

namespace supple::demos::view {

// The parts of the side panel, a file each: a header and what is under it.
void scene_panel(Desk& desk);       ///< what can be opened, the bodies
void time_panel(Desk& desk);        ///< pace, gravity, the scripted touch
void tool_panel(Desk& desk, double ui_scale);
void material_panel(Desk& desk);
void solver_panel(Desk& desk);
void picture_panel(Desk& desk);     ///< colours, wireframe, ground
void report_panel(Desk& desk);      ///< flags and their cures, times, energy
void plots(Desk& desk, float width, float height);  ///< as many side by side as fit

void toolbar(Desk& desk);           ///< in the current window: play, step, tools, picture, film
void help_window(Desk& desk, float ui_scale);

/// Lays out all of it around the viewport, which it sets. One side panel that scrolls; plots below the picture where there is room, otherwise in the panel.
void draw_panels(Desk& desk, float width, float height, float ui_scale);

}  // namespace supple::demos::view
