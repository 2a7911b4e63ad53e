#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "supple/render/frame_view.h"
#include "supple/world/probe.h"
#include "supple/world/world.h"

namespace supple::demos {

/// What the colours of the surfaces show.
enum class ColorBy { nothing, stress, stiffness };

/// A number that a show tells beside its bodies: a force, a count.
struct Reading {
    std::string name;
    double value = 0;
    std::string unit;  ///< empty: a count
};

/// A running demo or scene: a world, what is done to it over time, and how it is shown.
class Show {
public:
    virtual ~Show() = default;
    virtual World& world() = 0;
    virtual void before_step() {}                    ///< scripted touch; simulated time is world().time_s()
    virtual void let_go() {}                         ///< ends the scripted touch for good: a person takes over
    virtual void decorate(FrameView& view) { (void)view; }  ///< camera, caption, colour range, arrows; surfaces are already there
    virtual ColorBy color_by() const { return ColorBy::stress; }  ///< at this moment, unless the command line says otherwise
    virtual std::vector<Probe> make_probes() { return {}; }  ///< what `run --probes` watches; none: every body as a whole
    virtual std::vector<Reading> readings() { return {}; }  ///< at this moment; they stand in the line at the top of the picture
    virtual double duration_s() const { return 10; } ///< how long `record` runs by default
};

/// Settings that the command line overrides before the world is built.
struct ShowOptions {
    int threads = 0;
    std::optional<Isa> isa{};  ///< empty: the widest
    int refine = 0;            ///< times that the meshes of a scene file are refined
    bool edits = true;         ///< false: bodies stay whole, all else is the same; of those that cut, carve and tear over time
};

/// A demo. Each lives in one file of demos/ and registers itself with a `const RegisterDemo`.
struct Demo {
    std::string name;
    std::string summary;  ///< one line for `supple list`
    std::function<std::unique_ptr<Show>(const ShowOptions&)> make;
};

struct RegisterDemo {
    explicit RegisterDemo(Demo demo);
};

const std::vector<Demo>& all_demos();  ///< sorted by name

}  // namespace supple::demos
