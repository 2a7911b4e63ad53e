#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "supple/io/mesh_builder.h"

namespace supple::io {

/// Whole numbers of a file with their places, for messages.
struct Numbers {
    std::vector<std::int64_t> values;
    std::vector<const char*> positions;  ///< one each in text, none in bytes
    const char* start = nullptr;         ///< of the list

    const char* position(std::size_t i) const { return i < positions.size() ? positions[i] : start; }
};

/// What both kinds of VTK files hold: points, cells, and the arrays from which regions and groups are made.
class VtkGrid {
public:
    std::size_t point_count() const { return points_.size(); }
    std::size_t cell_count() const { return cells_.size(); }

    void reserve_points(std::size_t count) { points_.reserve(count); }
    void add_point(const Vec3& x, const char* position) {
        points_.push_back(x);
        positions_.push_back(position);
    }
    /// Cells i with points connectivity[offsets[i]] .. connectivity[offsets[i + 1]), moved by `first_point`.
    /// @error Error(parse) for offsets that do not fit, or a point beyond `piece_points`
    void add_cells(const TextScanner& scanner, const Numbers& offsets, const Numbers& connectivity, const std::vector<std::int64_t>& types,
                   std::int64_t first_point, std::int64_t piece_points);

    /// A cell array may hold regions: see volume_formats.h for its names.
    static bool names_regions(std::string_view array);
    /// Tags of the cells from `first_cell` on; only the first such array counts.
    void add_cell_tags(const TextScanner& scanner, std::string_view array, std::size_t first_cell, const Numbers& tags);
    void name_region(const TextScanner& scanner, const char* position, std::int64_t tag, std::string name);
    /// Points first_point + i with a mark other than 0 belong to the group.
    void add_group_marks(std::string name, std::int64_t first_point, const std::vector<std::int64_t>& marks);

    /// Hands everything to the builder.
    void feed(const TextScanner& scanner, MeshBuilder& builder);

private:
    struct Cell {
        std::int64_t type;
        const char* position;
        std::size_t begin, end;  ///< in ids_
    };
    void feed_cell(const TextScanner& scanner, MeshBuilder& builder, const Cell& cell, std::int64_t tag);

    std::vector<Vec3> points_;
    std::vector<const char*> positions_;
    std::vector<Cell> cells_;
    std::vector<std::int64_t> ids_, tags_;
    std::string tag_array_;
    std::vector<std::pair<std::int64_t, std::string>> names_;
    std::vector<std::pair<std::string, std::vector<std::int64_t>>> groups_;
};

}  // namespace supple::io
