#pragma once
#include <string>

#include "demo.h"

namespace supple::demos::view {

struct ViewOptions {
    std::string scene = "liver";  ///< demo, scene file or mesh file
    ShowOptions show;
    int width = 1280, height = 720;
    double ui_scale = 0;          ///< of the panels; 0: as the screen asks for
    int samples = 4;              ///< RendererDef
    std::size_t frames = 0;       ///< above 0, or with a script: each frame is 1/60 s whatever the clock says, and it ends by itself
    std::string script;           ///< file of a view::Script; empty: a person uses mouse and keys
    std::string screenshot;       ///< PNG of the window in the last frame
};

/// Opens the window and stays until it is closed.
/// @return exit status of the program
/// @error Error(no_display), and what opening the scene throws
int run_viewer(const ViewOptions& options);

}  // namespace supple::demos::view
