// VTK XML unstructured grids (.vtu): the little of XML that they need.
#include <algorithm>
#include <limits>
#include <map>

#include "supple/io/refusals.h"
#include "supple/io/vtk.h"
#include "supple/io/vtk_cells.h"

namespace supple::io {

namespace {

constexpr std::int64_t kBig = std::numeric_limits<std::int64_t>::max();

struct Tag {
    std::string_view name;  ///< with the slash of a closing tag
    std::map<std::string_view, std::string_view> attributes;
    const char* position = nullptr;
    const char* behind = nullptr;  ///< first character after it
    bool empty = false;            ///< ends with "/>"

    std::string_view attribute(std::string_view key) const {
        const auto found = attributes.find(key);
        return found == attributes.end() ? std::string_view() : found->second;
    }
};

bool is_space(char c) { return is_blank(c) || c == '\n'; }

/// Cuts the tags out of the text, one after the other.
class TagReader {
public:
    TagReader(std::string_view text, const TextScanner& scanner) : text_(text), scanner_(scanner) {}

    /// False at the end of the text.
    bool next(Tag& tag) {
        for (;;) {
            at_ = text_.find('<', at_);
            if (at_ == std::string_view::npos) return false;
            if (starts("<!--")) {
                jump_behind("-->");
            } else if (starts("<?")) {
                jump_behind("?>");
            } else {
                break;
            }
        }
        const char* begin = text_.data() + at_;
        const std::size_t end = text_.find_first_of("<>", at_ + 1);
        if (end == std::string_view::npos || text_[end] == '<') scanner_.fail("a tag is not closed with >", begin);
        std::string_view inside = text_.substr(at_ + 1, end - at_ - 1);
        at_ = end + 1;
        tag = {};
        tag.position = begin;
        tag.behind = text_.data() + at_;
        if (!inside.empty() && inside.back() == '/') {
            tag.empty = true;
            inside.remove_suffix(1);
        }
        read_inside(inside, tag);
        return true;
    }

private:
    bool starts(std::string_view head) const { return text_.substr(at_, head.size()) == head; }

    void jump_behind(std::string_view closing) {
        const std::size_t end = text_.find(closing, at_);
        if (end == std::string_view::npos) scanner_.fail("a comment is not closed: the file is truncated", text_.data() + at_);
        at_ = end + closing.size();
    }

    void read_inside(std::string_view inside, Tag& tag) const {
        const auto skip_space = [&] {
            while (!inside.empty() && is_space(inside.front())) inside.remove_prefix(1);
        };
        std::size_t length = 0;
        while (length < inside.size() && !is_space(inside[length])) ++length;
        tag.name = inside.substr(0, length);
        inside.remove_prefix(length);
        for (skip_space(); !inside.empty(); skip_space()) {
            const std::size_t equals = inside.find('=');
            if (equals == std::string_view::npos)
                scanner_.fail("an attribute of <" + std::string(tag.name) + "> has no value", tag.position);
            std::string_view key = inside.substr(0, equals);
            while (!key.empty() && is_space(key.back())) key.remove_suffix(1);
            inside.remove_prefix(equals + 1);
            skip_space();
            const char mark = inside.empty() ? ' ' : inside.front();
            const std::size_t end = mark == '"' || mark == '\'' ? inside.find(mark, 1) : std::string_view::npos;
            if (end == std::string_view::npos)
                scanner_.fail("the value of an attribute of <" + std::string(tag.name) + "> must stand in quotes", tag.position);
            tag.attributes[key] = inside.substr(1, end - 1);
            inside.remove_prefix(end + 1);
        }
    }

    std::string_view text_;
    const TextScanner& scanner_;
    std::size_t at_ = 0;
};

struct Numbers {
    std::vector<std::int64_t> values;
    std::vector<const char*> positions;
};

/// The text of a data array, up to the next tag.
TextScanner content(const TextScanner& file, const Tag& array) {
    const std::string_view format = array.attribute("format");
    if (format != "ascii") {
        file.fail("the data array is stored as " + quoted(format) +
                      "; only ASCII is read: save it again as ASCII (vtkXMLWriter: SetDataModeToAscii)",
                  array.position, ErrorCode::unsupported);
    }
    const char* end = std::find(array.behind, file.end(), '<');
    return file.part(array.behind, array.empty ? array.behind : end);
}

Numbers read_integers(const TextScanner& file, const Tag& array) {
    TextScanner scanner = content(file, array);
    Numbers numbers;
    for (scanner.skip_space(); !scanner.at_end(); scanner.skip_space()) {
        numbers.positions.push_back(scanner.position());
        numbers.values.push_back(scanner.integer("an entry of the array", 0, kBig));
    }
    return numbers;
}

/// One <Piece> of the grid; several stand one after another.
struct Piece {
    bool open = false, has_points = false;
    const char* position = nullptr;
    std::int64_t point_count = 0, cell_count = 0;
    std::vector<Vec3> points;
    std::vector<const char*> point_positions;
    Numbers connectivity, offsets, types;
};

std::int64_t read_count(const TextScanner& file, const Tag& tag, std::string_view key) {
    const std::string_view value = tag.attribute(key);
    std::int64_t count = -1;
    const auto [rest, error] = std::from_chars(value.data(), value.data() + value.size(), count);
    if (error != std::errc() || rest != value.data() + value.size() || count < 0) {
        file.fail(std::string(key) + " must be a whole number, found " + quoted(value), tag.position);
    }
    return count;
}

void read_points(const TextScanner& file, const Tag& array, Piece& piece) {
    if (piece.has_points) file.fail("a second array of points", array.position);
    piece.has_points = true;
    TextScanner scanner = content(file, array);
    for (scanner.skip_space(); !scanner.at_end(); scanner.skip_space()) {
        piece.point_positions.push_back(scanner.position());
        Vec3 x;
        for (int axis = 0; axis < 3; ++axis) {
            scanner.skip_space();
            x[axis] = scanner.real("a coordinate of a point");
        }
        piece.points.push_back(x);
    }
}

void check_counts(const TextScanner& file, const Piece& piece) {
    const auto check = [&](const char* what, std::size_t found, std::int64_t expected) {
        if (std::int64_t(found) == expected) return;
        file.fail("the piece announces " + std::to_string(expected) + " " + what + ", but has " + std::to_string(found), piece.position);
    };
    check("points", piece.points.size(), piece.point_count);
    check("cells, so many offsets", piece.offsets.values.size(), piece.cell_count);
    check("cells, so many types", piece.types.values.size(), piece.cell_count);
}

/// Vertices are numbered through all pieces; `cells` waits until all of them are known.
struct PendingCell {
    std::int64_t type;
    const char* position;
    std::size_t begin, end;  ///< in the list of ids
};

void close_piece(const TextScanner& file, Piece& piece, MeshBuilder& builder, std::vector<std::int64_t>& ids,
                 std::vector<PendingCell>& cells) {
    check_counts(file, piece);
    const std::int64_t first = std::int64_t(builder.vertex_count());
    for (std::size_t i = 0; i < piece.points.size(); ++i)
        builder.add_vertex(first + std::int64_t(i), piece.points[i], piece.point_positions[i]);
    std::int64_t begin = 0;
    for (std::size_t c = 0; c < piece.types.values.size(); ++c) {
        const std::int64_t end = piece.offsets.values[c];
        if (end < begin || end > std::int64_t(piece.connectivity.values.size())) {
            file.fail("offset " + std::to_string(end) + " is outside [" + std::to_string(begin) + ", " +
                          std::to_string(piece.connectivity.values.size()) + "]",
                      piece.offsets.positions[c]);
        }
        const std::size_t start = ids.size();
        for (std::int64_t i = begin; i < end; ++i) {
            const std::int64_t id = piece.connectivity.values[std::size_t(i)];
            if (id >= piece.point_count) {
                file.fail("point " + std::to_string(id) + " does not exist; the piece has " + std::to_string(piece.point_count),
                          piece.connectivity.positions[std::size_t(i)]);
            }
            ids.push_back(first + id);
        }
        const char* position = begin < end ? piece.connectivity.positions[std::size_t(begin)] : piece.types.positions[c];
        cells.push_back({piece.types.values[c], position, start, ids.size()});
        begin = end;
    }
    piece = {};
}

}  // namespace

VolumeMesh parse_vtk_xml(std::string_view text, const std::string& name) {
    const TextScanner file(text, name);
    TagReader reader(text, file);
    MeshBuilder builder;
    Piece piece;
    std::vector<std::int64_t> ids;
    std::vector<PendingCell> cells;
    std::string_view parent;
    bool closed = false;
    for (Tag tag; !closed && reader.next(tag);) {
        if (tag.name == "VTKFile") {
            const std::string_view kind = tag.attribute("type");
            if (kind == "PolyData") throw surface_error(name, "VTK PolyData");
            if (kind != "UnstructuredGrid") {
                file.fail("a VTK file of the kind " + quoted(kind) + " is not read; save an unstructured grid of tetrahedra", tag.position,
                          ErrorCode::unsupported);
            }
        } else if (tag.name == "Piece") {
            if (piece.open) file.fail("a piece begins inside another one", tag.position);
            piece.open = true;
            piece.position = tag.position;
            piece.point_count = read_count(file, tag, "NumberOfPoints");
            piece.cell_count = read_count(file, tag, "NumberOfCells");
            // Nothing is inside of <Piece ... />, nor of one that holds nothing.
            if (tag.empty) close_piece(file, piece, builder, ids, cells);
        } else if (tag.name == "/Piece") {
            if (!piece.open) file.fail("</Piece> without <Piece>", tag.position);
            close_piece(file, piece, builder, ids, cells);
        } else if (tag.name == "Points" || tag.name == "Cells" || tag.name == "PointData" || tag.name == "CellData" ||
                   tag.name == "FieldData") {
            parent = tag.empty ? std::string_view() : tag.name;
        } else if (tag.name == "DataArray" && piece.open) {
            if (parent == "Points") read_points(file, tag, piece);
            const std::string_view which = parent == "Cells" ? tag.attribute("Name") : std::string_view();
            if (which == "connectivity") piece.connectivity = read_integers(file, tag);
            if (which == "offsets") piece.offsets = read_integers(file, tag);
            if (which == "types") piece.types = read_integers(file, tag);
        } else if (tag.name == "/VTKFile" || tag.name == "AppendedData") {
            closed = true;  // appended data are bytes, not tags
        } else if (!tag.name.empty() && tag.name.substr(1) == parent) {
            parent = {};
        }
    }
    if (!closed) file.fail("</VTKFile> is missing: the file is truncated", file.end());
    builder.close_vertices(file);
    for (const PendingCell& cell : cells)
        add_vtk_cell(file, cell.position, builder, cell.type, {ids.data() + cell.begin, cell.end - cell.begin});
    return builder.finish(name);
}

}  // namespace supple::io
