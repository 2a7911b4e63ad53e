// VTK legacy files. Up to version 4.2 a cell is "n id ... id"; version 5 has lists of offsets and of ids.
#include <algorithm>
#include <limits>

#include "supple/io/refusals.h"
#include "supple/io/vtk.h"
#include "supple/io/vtk_cells.h"

namespace supple::io {

namespace {

constexpr std::int64_t kBig = std::numeric_limits<std::int64_t>::max();

/// The lines before the data; leaves the scanner behind the DATASET line.
void read_head(TextScanner& scanner) {
    scanner.next_line();  // "# vtk DataFile Version"
    scanner.next_line();  // title
    scanner.skip_space();
    const char* encoding_line = scanner.position();
    const std::string_view encoding = scanner.word();
    if (encoding != "ASCII" && encoding != "BINARY") scanner.fail("ASCII or BINARY was expected, found " + quoted(encoding), encoding_line);
    scanner.next_line();
    scanner.skip_space();
    const char* line = scanner.position();
    const std::string_view keyword = scanner.word();
    if (keyword != "DATASET") scanner.fail("DATASET was expected, found " + quoted(keyword), line);
    const std::string_view kind = scanner.word();
    if (kind == "POLYDATA") throw surface_error(scanner.name(), "VTK PolyData");
    if (kind != "UNSTRUCTURED_GRID") {
        scanner.fail("a VTK data set of the kind " + quoted(kind) + " is not read; save an unstructured grid of tetrahedra", line,
                     ErrorCode::unsupported);
    }
    if (encoding == "BINARY") {
        scanner.fail("this VTK file is binary; only ASCII is read: save it again as ASCII (vtkUnstructuredGridWriter: SetFileTypeToASCII)",
                     encoding_line, ErrorCode::unsupported);
    }
    scanner.next_line();
}

struct Cells {
    std::vector<std::int64_t> offsets = {0}, ids;  ///< cell i has ids[offsets[i]] .. ids[offsets[i + 1]]
    std::vector<const char*> positions;            ///< of each cell in the file
};

void read_points(TextScanner& scanner, MeshBuilder& builder) {
    const std::int64_t count = scanner.integer("the number of points", 0, kBig);
    scanner.next_line();  // the type of the numbers
    builder.reserve_vertices(scanner.plausible(count, 6));
    for (std::int64_t i = 0; i < count; ++i) {
        scanner.skip_space();
        const char* position = scanner.position();
        Vec3 x;
        for (int axis = 0; axis < 3; ++axis) {
            scanner.skip_space();
            x[axis] = scanner.real("a coordinate of a point");
        }
        builder.add_vertex(i, x, position);
    }
}

std::int64_t next_integer(TextScanner& scanner, const char* what, std::int64_t low, std::int64_t high) {
    scanner.skip_space();
    return scanner.integer(what, low, high);
}

void read_cells(TextScanner& scanner, Cells& cells) {
    const std::int64_t count = scanner.integer("the number of cells", 0, kBig);
    const std::int64_t size = scanner.integer("the size of the cell list", 0, kBig);
    scanner.end_line("the head of the cells");
    scanner.skip_space();
    if (!scanner.at_end() && *scanner.position() == 'O') {  // version 5: count is that of the offsets
        scanner.next_line();
        for (std::int64_t i = 0; i < count; ++i) {
            const std::int64_t offset = next_integer(scanner, "an offset", i == 0 ? 0 : cells.offsets.back(), i == 0 ? 0 : size);
            if (i > 0) cells.offsets.push_back(offset);
        }
        scanner.skip_space();
        const char* position = scanner.position();
        if (scanner.word() != "CONNECTIVITY") scanner.fail("CONNECTIVITY was expected", position);
        scanner.next_line();
        std::size_t cell = 0;
        for (std::int64_t i = 0; i < size; ++i) {
            scanner.skip_space();
            for (; cell + 1 < cells.offsets.size() && cells.offsets[cell] <= i; ++cell) cells.positions.push_back(scanner.position());
            cells.ids.push_back(scanner.integer("a point number", 0, kBig));
        }
        for (; cell + 1 < cells.offsets.size(); ++cell) cells.positions.push_back(scanner.position());
        return;
    }
    for (std::int64_t i = 0; i < count; ++i) {
        scanner.skip_space();
        cells.positions.push_back(scanner.position());
        const std::int64_t vertices = scanner.integer("the number of points of a cell", 0, kBig);
        for (std::int64_t v = 0; v < vertices; ++v) cells.ids.push_back(next_integer(scanner, "a point number", 0, kBig));
        cells.offsets.push_back(std::int64_t(cells.ids.size()));
    }
}

void read_types(TextScanner& scanner, MeshBuilder& builder, Cells& cells) {
    const std::int64_t count = std::int64_t(cells.offsets.size()) - 1;
    scanner.integer("the number of cell types", count, count);
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t type = next_integer(scanner, "a cell type", 0, 255);
        const std::size_t begin = std::size_t(cells.offsets[std::size_t(i)]), end = std::size_t(cells.offsets[std::size_t(i) + 1]);
        add_vtk_cell(scanner, cells.positions[std::size_t(i)], builder, type, {cells.ids.data() + begin, end - begin});
    }
}

}  // namespace

VolumeMesh parse_vtk_legacy(std::string_view text, const std::string& name) {
    TextScanner scanner(text, name);
    read_head(scanner);
    MeshBuilder builder;
    Cells cells;
    bool has_points = false, has_cells = false, has_types = false;
    for (scanner.skip_space(); !scanner.at_end(); scanner.skip_space()) {
        const char* position = scanner.position();
        const std::string_view keyword = scanner.word();
        if (keyword == "POINT_DATA" || keyword == "CELL_DATA") break;
        const auto once = [&](bool& done, bool ready, const char* needs) {
            if (done) scanner.fail("a second section " + quoted(keyword), position);
            if (!ready) scanner.fail("section " + quoted(keyword) + " stands before " + needs + ", which it needs", position);
            done = true;
        };
        if (keyword == "POINTS") {
            once(has_points, true, "");
            read_points(scanner, builder);
            builder.close_vertices(scanner);
        } else if (keyword == "CELLS") {
            once(has_cells, true, "");
            read_cells(scanner, cells);
        } else if (keyword == "CELL_TYPES") {
            once(has_types, has_points && has_cells, "POINTS and CELLS");
            read_types(scanner, builder, cells);
        } else {
            scanner.next_line();  // field data and METADATA say nothing about the shape
        }
    }
    if (!has_points || !has_cells || !has_types) {
        scanner.fail("the file ends without POINTS, CELLS and CELL_TYPES: it is truncated");
    }
    return builder.finish(name);
}

}  // namespace supple::io
