#include "open_show.h"

#include "command.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "framing.h"
#include "supple/base/error.h"
#include "supple/io/probe_table.h"
#include "supple/io/scene.h"

namespace supple::demos {
namespace {

namespace fs = std::filesystem;

/// A scene file as a show: nobody touches it; the camera is the file's, or frames all bodies.
class SceneShow : public Show {
public:
    SceneShow(const io::Scene& scene, std::string name)
        : world_(io::build_world(scene)), edits_(io::make_edits(scene, world_)), probes_(io::make_probes(scene, world_)), name_(std::move(name)) {
        for (const io::SceneBody& body : scene.bodies) colors_.push_back({body.color, body.inner_color});
        if (scene.camera) {
            camera_.eye_m = scene.camera->eye_m;
            camera_.target_m = scene.camera->target_m;
            camera_.fov_deg = scene.camera->fov_deg;
            camera_.up = up_direction(world_);
        } else {
            camera_ = frame_bodies(world_);
        }
    }

    World& world() override { return world_; }
    void before_step() override {
        if (edits_on_) edits_.before_step(world_);
    }
    void let_go() override { edits_on_ = false; }
    void decorate(FrameView& view) override {
        view.camera = camera_;
        for (std::size_t b = 0; b < std::min(colors_.size(), view.surfaces.size()); ++b) {
            if (!view.surfaces[b].color) view.surfaces[b].color = colors_[b][0];
            view.surfaces[b].inner_color = colors_[b][1];
        }
        if (world_.time_s() < 3) view.caption = name_;
    }
    std::vector<Probe> make_probes() override { return probes_; }
    double duration_s() const override { return 300 * world_.def().time_step_s; }

private:
    World world_;
    EditScript edits_;
    bool edits_on_ = true;
    std::vector<Probe> probes_;
    std::string name_;
    std::vector<std::array<std::optional<std::array<float, 3>>, 2>> colors_;  ///< [body] outside and inside
    Camera camera_;
};

std::string demo_names() {
    std::string names;
    for (const Demo& demo : all_demos()) names += (names.empty() ? "" : ", ") + demo.name;
    return names;
}

}  // namespace

OpenedShow open_show(const std::string& scene, const ShowOptions& options) {
    for (const Demo& demo : all_demos())
        if (demo.name == scene && options.refine > 0)
            throw Error(ErrorCode::invalid_argument, "--refine", "\"" + scene + "\" is a demo, which brings its own meshes; scene files and the standard bars can be refined");
    for (const Demo& demo : all_demos())
        if (demo.name == scene) return {demo.name, true, demo.make(options)};
    if (!fs::exists(scene))
        throw Error(ErrorCode::invalid_argument, scene, "is neither a scene file nor a demo; the demos are: " + demo_names());
    io::Scene read = io::read_scene(scene, options.refine);
    if (options.threads > 0) read.world.threads = options.threads;
    if (options.isa) read.world.isa = options.isa;
    const std::string name = fs::path(scene).stem().string();
    return {name, false, std::make_unique<SceneShow>(read, name)};
}

void add_isa_option(CLI::App& command, ShowOptions& options) {
    command.add_option_function<std::string>(
               "--isa",
               [&options](const std::string& word) {
                   options.isa.reset();
                   for (const Isa isa : kAllIsas) {
                       if (word == name(isa)) options.isa = isa;
                   }
               },
               "instruction set of the kernels [auto: the widest that the processor has]")
        ->check(CLI::IsMember({"auto", "scalar", "baseline", "avx2", "avx512"}));
}

fs::path find_asset(const std::string& name) {
    std::vector<fs::path> folders;
    if (const char* chosen = std::getenv("SUPPLE_ASSETS")) folders.emplace_back(chosen);
    std::error_code ignored;
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    if (!program.empty()) folders.push_back(program.parent_path() / SUPPLE_ASSETS_INSTALLED);
    folders.emplace_back(SUPPLE_ASSETS_SOURCE);
    folders.emplace_back(SUPPLE_ASSETS_COOKED);
    std::string looked;
    for (const fs::path& folder : folders) {
        if (fs::exists(folder / name)) return folder / name;
        looked += (looked.empty() ? "" : ", ") + folder.lexically_normal().string();
    }
    throw Error(ErrorCode::file_unreadable, name, "is in none of: " + looked + "; set SUPPLE_ASSETS to the folder that holds it");
}

}  // namespace supple::demos
