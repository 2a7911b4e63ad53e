#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "supple/io/text_scanner.h"
#include "supple/mesh/triangle_mesh.h"

namespace supple::io {

/// A kind of element; the code is Gmsh's number for it.
struct ElementType {
    int code;
    const char* name;
    int dimension;
    int vertex_count;
};

inline constexpr int kMostElementVertices = 125;  ///< of any element in the table

inline constexpr ElementType kPointType{15, "point", 0, 1};
inline constexpr ElementType kEdgeType{1, "2-node line", 1, 2};
inline constexpr ElementType kTriangleType{2, "3-node triangle", 2, 3};
inline constexpr ElementType kQuadType{3, "4-node quadrangle", 2, 4};
inline constexpr ElementType kTetType{4, "4-node tetrahedron", 3, 4};
inline constexpr ElementType kHexType{5, "8-node hexahedron", 3, 8};

/// Gathers what the file formats have in common - numbered vertices, elements of any dimension, tagged groups - and makes the mesh of it.
class MeshBuilder {
public:
    void name_group(int dimension, std::int64_t tag, std::string name);

    /// @param position  where the record stands, for messages
    void add_vertex(std::int64_t id, const Vec3& x, const char* position);
    void reserve_vertices(std::size_t count);
    std::size_t vertex_count() const { return mesh_.vertices.size(); }
    void close_vertices(const TextScanner& scanner);  ///< makes the ids known; a repeated id is an error

    /// @param ids        vertex ids of the file, as many as the type has
    /// @param physicals  tags of its physical groups, zeros ignored
    void add_element(const TextScanner& scanner, const char* position, const ElementType& type, std::span<const std::int64_t> ids,
                     std::span<const std::int64_t> physicals);

    /// VolumeMesh::fill, in the order in which the volume elements were added; after the last of them.
    void set_fill(const TextScanner& scanner, const char* position, std::vector<double> fill);

    /// A polygon of a surface, without a group.
    void add_polygon(const TextScanner& scanner, const char* position, std::span<const std::int64_t> ids);

    /// A group of elements that was named, but whose elements are told elsewhere.
    /// @param vertices  ids of the file
    void add_vertex_group(const TextScanner& scanner, const char* position, std::string name, std::span<const std::int64_t> ids);

    /// Counts elements that the mesh has no use for, so that a file without volume elements can be named for what it is.
    void note_lower_elements(int dimension, std::size_t count) { lower_count_[dimension] += count; }

    /// @error Error(surface_mesh) where nothing fills a volume, Error(parse) where there are no elements at all
    VolumeMesh finish(const std::string& name);

    /// The surface that the file holds: the boundary of its volume elements where it has any (repaired as check_and_repair() does), otherwise
    /// its triangles and polygons. Vertices that no triangle uses stay, but for a boundary.
    /// @error Error(parse) where there are none
    mesh::TriangleMesh finish_surface(const std::string& name);

private:
    struct Group {
        int dimension;
        std::int64_t tag;
        std::string name;
        bool overlaps = false;               ///< a volume group that holds elements whose region is another one
        std::vector<std::int32_t> vertices;  ///< as met; sorted at the end
    };

    std::int32_t vertex(std::int64_t id) const;  ///< -1 if unknown
    std::int32_t known_vertex(const TextScanner& scanner, const char* position, std::int64_t id) const;
    std::int32_t group(int dimension, std::int64_t tag);
    [[noreturn]] void refuse_empty(const std::string& name) const;
    void finish_regions(VolumeMesh& mesh);
    void finish_groups(VolumeMesh& mesh);

    VolumeMesh mesh_;
    std::vector<std::int32_t> tet_group_, hex_group_;  ///< per element: index into groups_, -1 for none
    std::vector<Group> groups_;
    std::map<std::pair<int, std::int64_t>, std::int32_t> group_index_;
    std::pair<int, std::int64_t> last_key_{-1, 0};  ///< neighbours in a file share their group: saves the look-up
    std::int32_t last_group_ = -1;
    std::size_t lower_count_[3] = {0, 0, 0};  ///< point, curve and surface elements met
    std::vector<std::int32_t> polygon_corners_;
    std::vector<std::size_t> polygon_ends_;  ///< of each polygon in polygon_corners_

    std::vector<std::int64_t> ids_;
    std::vector<const char*> positions_;
    std::int64_t first_id_ = 0;
    std::vector<std::int32_t> dense_;                            ///< id - first_id_ -> vertex
    std::vector<std::pair<std::int64_t, std::int32_t>> sparse_;  ///< sorted by id, where ids are far apart
};

}  // namespace supple::io
