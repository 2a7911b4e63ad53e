#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "supple/io/text_scanner.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::io {

struct GmshElementType {
    int code;
    const char* name;
    int dimension;
    int vertex_count;
};

inline constexpr int kGmshMostVertices = 125;  ///< of any element in the table

/// @error Error(unsupported) at the scanner's line if the code is unknown or is that of a volume element other than tet4 and hex8
const GmshElementType& gmsh_element_type(const TextScanner& scanner, const char* position, std::int64_t code);

/// Gathers what the versions of the format have in common and makes the mesh of it.
class GmshBuilder {
public:
    void name_group(int dimension, std::int64_t tag, std::string name);

    /// @param position  where the record stands, for messages
    void add_vertex(std::int64_t id, const Vec3& x, const char* position);
    void reserve_vertices(std::size_t count);
    void close_vertices(const TextScanner& scanner);  ///< makes the ids known; a repeated id is an error

    /// @param ids        vertex ids of the file, as many as the type has
    /// @param physicals  tags of its physical groups, zeros ignored
    void add_element(const TextScanner& scanner, const char* position, const GmshElementType& type, std::span<const std::int64_t> ids,
                     std::span<const std::int64_t> physicals);

    VolumeMesh finish(const std::string& name);

private:
    struct Group {
        int dimension;
        std::int64_t tag;
        std::string name;
        bool overlaps = false;                ///< a volume group that holds elements whose region is another one
        std::vector<std::int32_t> vertices;   ///< as met; sorted at the end
    };

    std::int32_t vertex(std::int64_t id) const;  ///< -1 if unknown
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

    std::vector<std::int64_t> ids_;
    std::vector<const char*> positions_;
    std::int64_t first_id_ = 0;
    std::vector<std::int32_t> dense_;                                  ///< id - first_id_ -> vertex
    std::vector<std::pair<std::int64_t, std::int32_t>> sparse_;        ///< sorted by id, where ids are far apart
};

/// The parts of the file that each version reads in its own way; the scanners stand behind the section's head line.
void read_gmsh2_nodes(TextScanner& scanner, GmshBuilder& builder, bool parametric);
void read_gmsh2_elements(TextScanner& scanner, GmshBuilder& builder, bool version1);

/// Physical tags of each entity (dimension, tag).
using GmshEntities = std::map<std::pair<int, std::int64_t>, std::vector<std::int64_t>>;
GmshEntities read_gmsh4_entities(TextScanner& scanner);
void read_gmsh4_nodes(TextScanner& scanner, GmshBuilder& builder);
void read_gmsh4_elements(TextScanner& scanner, GmshBuilder& builder, const GmshEntities& entities);

}  // namespace supple::io
