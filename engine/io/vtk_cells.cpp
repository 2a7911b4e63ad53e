#include "supple/io/vtk_cells.h"

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
    strip = 6,
    quad = 9,
    tetra = 10,
    voxel = 11,
    hexahedron = 12
};

/// Dimension of the cells that are no volumes; 3 for those that are, or that are not known.
int dimension_of(std::int64_t type) {
    if (type == vertex || type == poly_vertex) return 0;
    if (type == line || type == poly_line || type == 21 || type == 35) return 1;  // and quadratic, cubic edges
    const bool flat = (type >= 5 && type <= quad) || type == 22 || type == 23 || type == 28 || type == 30 || type == 34 || type == 36;
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

}  // namespace

void add_vtk_cell(const TextScanner& scanner, const char* position, MeshBuilder& builder, std::int64_t type, std::span<std::int64_t> ids) {
    if (type == empty) return;
    if (type != tetra && type != voxel && type != hexahedron) {
        const int dimension = dimension_of(type);
        if (dimension < 3) return builder.note_lower_elements(dimension, 1);
        scanner.fail("a " + std::string(volume_name(type)) + " (VTK cell type " + std::to_string(type) +
                         ") cannot be simulated; mesh the part with linear tetrahedra or hexahedra",
                     position, ErrorCode::unsupported);
    }
    const ElementType& element = type == tetra ? kTetType : kHexType;
    if (ids.size() != std::size_t(element.vertex_count)) {
        scanner.fail("a cell of type " + std::to_string(type) + " has " + std::to_string(ids.size()) + " vertices, but needs " +
                         std::to_string(element.vertex_count),
                     position);
    }
    if (type == voxel) {  // rows of x, then y, then z; a hexahedron goes round its faces
        std::swap(ids[2], ids[3]);
        std::swap(ids[6], ids[7]);
    }
    builder.add_element(scanner, position, element, ids, {});
}

}  // namespace supple::io
