#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>

#include "supple/io/text_scanner.h"
#include "supple/mesh/triangle_mesh.h"

namespace supple::io {

/// Gathers vertices and polygons of a surface file. Polygons may come before their vertices.
class SurfaceBuilder {
public:
    void reserve_vertices(std::size_t count) { surface_.vertices.reserve(count); }
    std::size_t vertex_count() const { return surface_.vertices.size(); }
    void add_vertex(const Vec3& x) { surface_.vertices.push_back(x); }
    /// The vertex at exactly this position, added if there is none (-0 is 0).
    std::int32_t weld_vertex(const Vec3& x);

    /// @param ids       from 0; may be those of vertices that come later
    /// @param position  where the record stands in the text, or null
    void add_polygon(std::span<const std::int64_t> ids, const char* position = nullptr);
    void add_triangle(std::int32_t a, std::int32_t b, std::int32_t c) { surface_.triangles.push_back({a, b, c}); }

    /// @param scanner     names the file
    /// @param first_id    how the file numbers its first vertex, for messages
    /// @error Error(parse) where a polygon uses a vertex that is not there, where nothing was read, or for more than 2^31 - 1 vertices
    mesh::TriangleMesh finish(const TextScanner& scanner, std::int64_t first_id = 0);

private:
    struct PositionHash {
        std::size_t operator()(const Vec3& x) const;
    };
    struct PositionEqual {
        bool operator()(const Vec3& a, const Vec3& b) const { return a.x() == b.x() && a.y() == b.y() && a.z() == b.z(); }
    };

    mesh::TriangleMesh surface_;
    std::vector<std::int64_t> corners_;
    std::vector<std::size_t> ends_;  ///< of each polygon in corners_
    std::vector<const char*> positions_;
    std::unordered_map<Vec3, std::int32_t, PositionHash, PositionEqual> welded_;
};

/// A vertex a line, then a triangle a line as "3 a b c": the body of OFF and of ASCII PLY.
void append_lines(std::string& out, const mesh::TriangleMesh& mesh);

}  // namespace supple::io
