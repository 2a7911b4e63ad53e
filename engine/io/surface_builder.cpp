#include "supple/io/surface_builder.h"

#include <bit>
#include <limits>

#include "supple/io/polygon.h"

namespace supple::io {

std::size_t SurfaceBuilder::PositionHash::operator()(const Vec3& x) const {
    std::uint64_t h = 0;
    for (int i = 0; i < 3; ++i) {
        h ^= std::bit_cast<std::uint64_t>(x[i] + 0.0);
        h *= 0x9e3779b97f4a7c15ULL;
        h ^= h >> 29;
    }
    return std::size_t(h);
}

std::int32_t SurfaceBuilder::weld_vertex(const Vec3& x) {
    const auto [entry, is_new] = welded_.try_emplace(x, std::int32_t(surface_.vertices.size()));
    if (is_new) surface_.vertices.push_back(x);
    return entry->second;
}

void SurfaceBuilder::add_polygon(std::span<const std::int64_t> ids, const char* position) {
    corners_.insert(corners_.end(), ids.begin(), ids.end());
    ends_.push_back(corners_.size());
    positions_.push_back(position);
}

mesh::TriangleMesh SurfaceBuilder::finish(const TextScanner& scanner, std::int64_t first_id) {
    constexpr std::size_t kMost = std::size_t(std::numeric_limits<std::int32_t>::max());
    const std::size_t count = surface_.vertices.size();
    if (count > kMost) throw Error(ErrorCode::unsupported, scanner.name(), "more than 2^31 - 1 vertices");
    std::vector<std::int32_t> polygon;
    std::size_t begin = 0;
    for (std::size_t p = 0; p < ends_.size(); ++p) {
        polygon.clear();
        for (std::size_t i = begin; i < ends_[p]; ++i) {
            if (corners_[i] < 0 || std::uint64_t(corners_[i]) >= count) {
                const std::string what = "face " + std::to_string(p + 1) + " uses vertex " + std::to_string(corners_[i] + first_id) +
                                         ", but the file has " + std::to_string(count) + " vertices, numbered from " +
                                         std::to_string(first_id);
                if (positions_[p]) scanner.fail(what, positions_[p]);
                throw Error(ErrorCode::parse, scanner.name(), what);
            }
            polygon.push_back(std::int32_t(corners_[i]));
        }
        append_polygon(polygon, surface_.vertices, surface_.triangles);
        begin = ends_[p];
    }
    if (surface_.triangles.empty())
        throw Error(ErrorCode::parse, scanner.name(), "the file holds no triangles or polygons; a surface needs them");
    if (surface_.triangles.size() > kMost) throw Error(ErrorCode::unsupported, scanner.name(), "more than 2^31 - 1 triangles");
    return std::move(surface_);
}

void require_sound(const mesh::TriangleMesh& mesh) {
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        if (!mesh.vertices[v].allFinite())
            throw Error(ErrorCode::invalid_argument, "TriangleMesh.vertices[" + std::to_string(v) + "]", "the position is not finite");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const std::int32_t v : mesh.triangles[t])
            if (v < 0 || std::size_t(v) >= mesh.vertices.size())
                throw Error(ErrorCode::invalid_argument, "TriangleMesh.triangles[" + std::to_string(t) + "]",
                            "vertex " + std::to_string(v) + " is outside [0, " + std::to_string(mesh.vertices.size()) + ")");
}

}  // namespace supple::io
