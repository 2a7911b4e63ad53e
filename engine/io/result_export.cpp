#include "supple/io/result_export.h"

#include <algorithm>

#include "supple/io/mesh_formats.h"
#include "supple/io/result_parts.h"
#include "supple/io/surface_file.h"

namespace supple::io {

namespace fs = std::filesystem;

BodySurface body_surface(const BodyTemplate& shape) {
    BodySurface surface{{}, shape.boundary().triangles};
    std::vector<std::int32_t> number(shape.mesh().vertices.size(), -1);
    for (const Triangle& t : surface.triangles)
        for (const std::int32_t v : t) number[std::size_t(v)] = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] < 0) continue;
        number[v] = std::int32_t(surface.vertices.size());
        surface.vertices.push_back(std::int32_t(v));
    }
    for (Triangle& t : surface.triangles)
        for (std::int32_t& v : t) v = number[std::size_t(v)];
    return surface;
}

std::string frame_number(std::uint64_t number) {
    const std::string digits = std::to_string(number);
    return std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits;
}

namespace {

class SurfaceExport final : public ResultExport {
public:
    SurfaceExport(fs::path file, bool every_frame) : file_(std::move(file)), every_frame_(every_frame) {}

    void add_frame(const World& world) override {
        last_ = {};
        for (const BodyId body : world.bodies()) {
            const BodySurface surface = body_surface(world.shape(body));
            const auto first = std::int32_t(last_.vertices.size());
            const auto positions = world.positions(body);
            for (const std::int32_t v : surface.vertices) last_.vertices.push_back(positions[std::size_t(v)]);
            for (const Triangle& t : surface.triangles) last_.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        }
        if (!every_frame_) return;
        const std::string name = file_.stem().string() + "_" + frame_number(world.step_count()) + file_.extension().string();
        write_surface(file_.parent_path() / name, last_);
    }
    void finish() override {
        if (!every_frame_) write_surface(file_, last_);
    }

private:
    fs::path file_;
    bool every_frame_;
    mesh::TriangleMesh last_;
};

void make_folder(const fs::path& folder) {
    std::error_code failed;
    fs::create_directories(folder, failed);
    if (failed) throw Error(ErrorCode::file_unreadable, folder.string(), "the folder cannot be made: " + failed.message());
}

}  // namespace

std::unique_ptr<ResultExport> make_surface_export(const fs::path& file, bool every_frame) {
    return std::make_unique<SurfaceExport>(file, every_frame);
}

std::unique_ptr<ResultExport> ResultExport::open(const fs::path& target, const World& world, bool every_frame) {
    std::string ending = target.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    std::error_code ignored;
    if (fs::is_directory(target, ignored) || ending.empty()) {
        make_folder(target);
        return make_vtu_export(target, "", target / "results.pvd");
    }
    const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
    make_folder(folder);
    if (ending == ".pvd") return make_vtu_export(folder, target.stem().string() + "_", target);
    if (ending == ".gltf" || ending == ".glb") return make_gltf_export(target);
    if (ending == ".vtu") {
        if (world.bodies().size() != 1)
            throw Error(
                ErrorCode::unsupported, target.string(),
                "one VTU file holds one body, and the scene has " + std::to_string(world.bodies().size()) + "; give a folder or FILE.pvd");
        return make_last_vtu_export(target);
    }
    if (ending == ".obj" || ending == ".ply" || ending == ".stl" || ending == ".off") return make_surface_export(target, every_frame);
    throw Error(ErrorCode::unsupported, target.string(),
                "results cannot be written as \"" + ending +
                    "\"; give a folder, or a name that ends with .pvd, .vtu, .gltf, .glb, .obj, .ply, .stl or .off");
}

}  // namespace supple::io
