#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "supple/io/result_export.h"
#include "supple/mesh/triangle_mesh.h"

namespace supple::io {

std::unique_ptr<ResultExport> make_vtu_export(const std::filesystem::path& folder, const std::string& stem,
                                              const std::filesystem::path& list);
std::unique_ptr<ResultExport> make_last_vtu_export(const std::filesystem::path& file);
std::unique_ptr<ResultExport> make_surface_export(const std::filesystem::path& file, bool every_frame);
std::unique_ptr<ResultExport> make_gltf_export(const std::filesystem::path& file);

/// The vertices on a body's boundary and its triangles numbered by them.
struct BodySurface {
    std::vector<std::int32_t> vertices;
    std::vector<Triangle> triangles;
};
BodySurface body_surface(const BodyTemplate& shape);

/// "000042"
std::string frame_number(std::uint64_t number);

}  // namespace supple::io
