#include "supple/io/surface_builder.h"

#include <bit>
#include <limits>

#include "supple/io/number_text.h"
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

void append_lines(std::string& out, const mesh::TriangleMesh& mesh) {
    for (const Vec3& x : mesh.vertices) {
        append(out, x);
        out += '\n';
    }
    for (const Triangle& t : mesh.triangles) {
        out += '3';
        for (const std::int32_t v : t) {
            out += ' ';
            append(out, v);
        }
        out += '\n';
    }
}

}  // namespace supple::io
