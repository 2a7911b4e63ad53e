#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "supple/world/world.h"

namespace supple::io {

struct SceneCamera {
    Vec3 eye_m, target_m;
    double fov_deg = 40;
};

struct SceneBody {
    BodyDef def;                         ///< shape is built
    struct Support {
        Selection where;
        Axes axes;
    };
    std::vector<Support> fixed;
    std::vector<Motion> prescribed;
    std::vector<Load> loads;
};

/// A scene file, read and validated.
struct Scene {
    WorldDef world;
    std::vector<SceneBody> bodies;
    std::optional<SceneCamera> camera;
};

/// Reads a scene file (JSON with comments); mesh paths are relative to it.
/// @error Error(parse) "file:line" for syntax, "file:/json/pointer" for meaning; an unknown key names the nearest known one
Scene read_scene(const std::filesystem::path& file);
Scene parse_scene(const std::string& text, const std::filesystem::path& folder, const std::string& name);

/// Builds the world: bodies in the order of the file, with their supports, motions and loads.
World build_world(const Scene& scene, const LogSink& log = {});

}  // namespace supple::io
