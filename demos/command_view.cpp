#include <cstdio>
#include <memory>

#include "command.h"
#include "supple/base/error.h"
#include "view/viewer.h"

namespace supple::demos {
namespace {

int view_scene(const view::ViewOptions& options) {
#ifdef SUPPLE_VIEW
    try {
        return view::run_viewer(options);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::no_display) throw;
        std::fprintf(stderr, "supple: %s\n", error.what());
        return kBadInput;  // a window was asked for where there is no place for one
    }
#else
    (void)options;
    throw Error(ErrorCode::unsupported, "supple view",
                "this program was built without its window. Install the packages libglfw3-dev and libimgui-dev, then configure and build again; "
                "`supple record` draws without them");
#endif
}

}  // namespace

void add_view_command(CLI::App& app, int& status) {
    auto o = std::make_shared<view::ViewOptions>();
    auto size = std::make_shared<std::string>();
    CLI::App* command = app.add_subcommand("view", "open a scene in a window: pull, pinch and poke bodies, change materials while they move (F1 lists the keys)");
    command->add_option("scene", o->scene, "demo, scene file or mesh file [liver]");
    command->add_option("--size", *size, "WIDTHxHEIGHT of the window [1280x720]");
    command->add_option("--ui-scale", o->ui_scale, "size of the panels [as the screen asks for]")->check(CLI::Range(0.5, 4.0));
    command->add_option("--samples", o->samples, "per pixel: 0 on a slow machine [4]")->check(CLI::Range(0, 16));
    command->add_option("--threads", o->show.threads, "threads [those of the scene, or all cores]")->check(CLI::Range(1, 256));
    add_isa_option(*command, o->show);
    command->add_option("--frames", o->frames, "draw so many frames of 1/60 s, whatever the clock says, and end")->check(CLI::Range(1, 10000000));
    command->add_option("--script", o->script, "play mouse and keys from a file (demos/view/script.h), and end with it");
    command->add_option("--screenshot", o->screenshot, "PNG file: the window in its last frame; needs --frames or --script");
    command->callback([o, size, &status] {
        if (!size->empty()) read_size(*size, o->width, o->height);
        if (!o->screenshot.empty() && o->frames == 0 && o->script.empty())
            throw Error(ErrorCode::invalid_argument, "--screenshot", "needs --frames N or --script FILE: only they have a last frame; key P takes pictures");
        status = view_scene(*o);
    });
}

}  // namespace supple::demos
