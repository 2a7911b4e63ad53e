#include "supple/io/vtk_grid.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <utility>

namespace supple::io {

namespace {

// Numbers: vtkCellType.h of VTK's documentation.
enum VtkCell : std::int64_t {
    empty = 0,
    vertex = 1,
    poly_vertex = 2,
    line = 3,
    poly_line = 4,
    triangle = 5,
    strip = 6,
    polygon = 7,
    pixel = 8,
    quad = 9,
    tetra = 10,
    voxel = 11,
    hexahedron = 12
};

/// Dimension of the cells that are no volumes; 3 for those that are, or that are not known.
int dimension_of(std::int64_t type) {
    if (type == vertex || type == poly_vertex) return 0;
    if (type == line || type == poly_line || type == 21 || type == 35) return 1;  // and quadratic, cubic edges
    const bool flat =
        (type >= triangle && type <= quad) || type == 22 || type == 23 || type == 28 || type == 30 || type == 34 || type == 36;
    return flat ? 2 : 3;
}

const char* volume_name(std::int64_t type) {
    switch (type) {
        case 13:
            return "wedge";
        case 14:
            return "pyramid";
        case 24:
            return "quadratic tetrahedron";
        case 25:
            return "quadratic hexahedron";
        case 42:
            return "polyhedron";
        default:
            return "cell";
    }
}

/// Every second triangle of a strip is turned; repeated points join two strips.
void feed_strip(const TextScanner& scanner, MeshBuilder& builder, const char* position, std::span<const std::int64_t> ids) {
    for (std::size_t i = 2; i < ids.size(); ++i) {
        std::int64_t corners[3] = {ids[i - 2], ids[i - 1], ids[i]};
        if (i % 2 == 1) std::swap(corners[0], corners[1]);
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
            builder.add_polygon(scanner, position, corners);
    }
}

}  // namespace

bool VtkGrid::names_regions(std::string_view array) {
    std::string name(array);
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    for (const char* known : {"region", "regions", "gmsh:physical", "medit:ref", "cellentityids", "materialids", "materialid", "material",
                              "material_id", "partid", "part_id", "cell_tags"})
        if (name == known) return true;
    return false;
}

void VtkGrid::add_cells(const TextScanner& scanner, const Numbers& offsets, const Numbers& connectivity,
                        const std::vector<std::int64_t>& types, std::int64_t first_point, std::int64_t piece_points) {
    for (std::size_t c = 0; c < types.size(); ++c) {
        const std::int64_t begin = offsets.values[c], end = offsets.values[c + 1];
        if (begin < 0 || end < begin || end > std::int64_t(connectivity.values.size())) {
            scanner.fail("cell " + std::to_string(c) + " ends at offset " + std::to_string(end) + ", outside [" + std::to_string(begin) +
                             ", " + std::to_string(connectivity.values.size()) + "]",
                         offsets.position(c + 1));
        }
        const std::size_t start = ids_.size();
        for (std::int64_t i = begin; i < end; ++i) {
            const std::int64_t id = connectivity.values[std::size_t(i)];
            if (id < 0 || id >= piece_points) {
                scanner.fail(
                    "point " + std::to_string(id) + " does not exist; there are " + std::to_string(piece_points) + ", numbered from 0",
                    connectivity.position(std::size_t(i)));
            }
            ids_.push_back(first_point + id);
        }
        cells_.push_back({types[c], connectivity.position(std::size_t(begin)), start, ids_.size()});
    }
}

void VtkGrid::add_cell_tags(const TextScanner& scanner, std::string_view array, std::size_t first_cell, const Numbers& tags) {
    if (!tag_array_.empty() && tag_array_ != array) return;
    tag_array_ = array;
    tags_.resize(first_cell, 0);
    for (std::size_t i = 0; i < tags.values.size(); ++i) {
        const std::int64_t tag = tags.values[i];
        if (tag <= std::numeric_limits<int>::min() || tag > std::numeric_limits<int>::max())
            scanner.fail("the region number " + std::to_string(tag) + " is beyond 32 bits", tags.position(i));
        tags_.push_back(tag);
    }
}

void VtkGrid::name_region(const TextScanner& scanner, const char* position, std::int64_t tag, std::string name) {
    if (tag <= std::numeric_limits<int>::min() || tag > std::numeric_limits<int>::max() || tag == 0 || name.empty())
        scanner.fail("the field array that names region " + std::to_string(tag) + " must hold a number of 32 bits other than 0, and a name",
                     position);
    names_.emplace_back(tag, std::move(name));
}

void VtkGrid::add_group_marks(std::string name, std::int64_t first_point, const std::vector<std::int64_t>& marks) {
    if (groups_.empty() || groups_.back().first != name) {
        auto found = std::find_if(groups_.begin(), groups_.end(), [&](const auto& g) { return g.first == name; });
        if (found == groups_.end()) {
            groups_.emplace_back(std::move(name), std::vector<std::int64_t>());
        } else {
            std::rotate(found, found + 1, groups_.end());
        }
    }
    for (std::size_t i = 0; i < marks.size(); ++i)
        if (marks[i] != 0) groups_.back().second.push_back(first_point + std::int64_t(i));
}

void VtkGrid::feed_cell(const TextScanner& scanner, MeshBuilder& builder, const Cell& cell, std::int64_t tag) {
    const std::span<std::int64_t> ids(ids_.data() + cell.begin, cell.end - cell.begin);
    if (cell.type == empty) return;
    const int dimension = dimension_of(cell.type);
    if (dimension < 2) return builder.note_lower_elements(dimension, 1);
    if (cell.type == strip) return feed_strip(scanner, builder, cell.position, ids);
    if (cell.type == pixel && ids.size() == 4) std::swap(ids[2], ids[3]);
    if (dimension == 2 && cell.type <= quad) {
        if (cell.type == triangle && ids.size() == 3) return builder.add_element(scanner, cell.position, kTriangleType, ids, {&tag, 1});
        if ((cell.type == quad || cell.type == pixel) && ids.size() == 4)
            return builder.add_element(scanner, cell.position, kQuadType, ids, {&tag, 1});
        return builder.add_polygon(scanner, cell.position, ids);
    }
    if (dimension == 2) return builder.note_lower_elements(2, 1);  // of higher order
    if (cell.type != tetra && cell.type != voxel && cell.type != hexahedron) {
        scanner.fail("a " + std::string(volume_name(cell.type)) + " (VTK cell type " + std::to_string(cell.type) +
                         ") cannot be simulated; mesh the part with linear tetrahedra or hexahedra",
                     cell.position, ErrorCode::unsupported);
    }
    const ElementType& element = cell.type == tetra ? kTetType : kHexType;
    if (ids.size() != std::size_t(element.vertex_count)) {
        scanner.fail("a cell of type " + std::to_string(cell.type) + " has " + std::to_string(ids.size()) + " vertices, but needs " +
                         std::to_string(element.vertex_count),
                     cell.position);
    }
    if (cell.type == voxel) {  // rows of x, then y, then z; a hexahedron goes round its faces
        std::swap(ids[2], ids[3]);
        std::swap(ids[6], ids[7]);
    }
    builder.add_element(scanner, cell.position, element, ids, {&tag, 1});
}

void VtkGrid::feed(const TextScanner& scanner, MeshBuilder& builder) {
    builder.reserve_vertices(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) builder.add_vertex(std::int64_t(i), points_[i], positions_[i]);
    builder.close_vertices(scanner);
    for (auto& [tag, name] : names_) builder.name_group(3, tag, std::move(name));
    tags_.resize(cells_.size(), 0);
    for (std::size_t c = 0; c < cells_.size(); ++c) feed_cell(scanner, builder, cells_[c], tags_[c]);
    for (auto& [name, ids] : groups_) builder.add_vertex_group(scanner, nullptr, std::move(name), ids);
}

}  // namespace supple::io
