// VTK legacy files. Up to version 4.2 a cell is "n id ... id"; version 5 has lists of offsets and of ids. Bytes are big-endian.
#include <limits>

#include "supple/io/binary_scanner.h"
#include "supple/io/mesh_builder.h"
#include "supple/io/refusals.h"
#include "supple/io/volume_formats.h"
#include "supple/io/vtk_grid.h"
#include "supple/io/vtk_names.h"

namespace supple::io {

namespace {

constexpr std::int64_t kBig = std::numeric_limits<std::int64_t>::max();

enum class Type { bit, int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
struct TypeRow {
    const char* name;
    Type type;
    int bytes;
};
constexpr TypeRow kTypes[] = {
    {"bit", Type::bit, 0},          {"char", Type::int8, 1},           {"signed_char", Type::int8, 1},    {"unsigned_char", Type::uint8, 1},
    {"short", Type::int16, 2},      {"unsigned_short", Type::uint16, 2}, {"int", Type::int32, 4},         {"unsigned_int", Type::uint32, 4},
    {"vtkIdType", Type::int32, 4},  {"long", Type::int64, 8},          {"unsigned_long", Type::uint64, 8}, {"vtktypeint64", Type::int64, 8},
    {"vtktypeuint64", Type::uint64, 8}, {"float", Type::float32, 4},   {"double", Type::float64, 8},
};

class Legacy {
public:
    explicit Legacy(const MeshSource& source) : scanner_(source.bytes, source.name) {}

    void read(MeshBuilder& builder) {
        read_head();
        while (read_section()) {}
        if (!has_points_ || (is_grid_ && (!has_cells_ || !has_types_)))
            scanner_.fail(is_grid_ ? "the file ends without POINTS, CELLS and CELL_TYPES: it is truncated"
                                   : "the file ends without POINTS: it is truncated");
        grid_.feed(scanner_, builder);
    }

private:
    enum class Of { nothing, cells, points };

    /// The lines before the data; leaves the scanner behind the DATASET line.
    void read_head() {
        scanner_.next_line();  // "# vtk DataFile Version"
        scanner_.next_line();  // title
        scanner_.skip_space();
        const char* encoding_line = scanner_.position();
        const std::string_view encoding = scanner_.word();
        if (encoding != "ASCII" && encoding != "BINARY")
            scanner_.fail("ASCII or BINARY was expected, found " + quoted(encoding), encoding_line);
        binary_ = encoding == "BINARY";
        scanner_.next_line();
        scanner_.skip_space();
        const char* line = scanner_.position();
        const std::string_view keyword = scanner_.word();
        if (keyword != "DATASET") scanner_.fail("DATASET was expected, found " + quoted(keyword), line);
        const std::string_view kind = scanner_.word();
        if (kind != "UNSTRUCTURED_GRID" && kind != "POLYDATA") {
            scanner_.fail("a VTK data set of the kind " + quoted(kind) + " is not read; save an unstructured grid of tetrahedra", line,
                          ErrorCode::unsupported);
        }
        is_grid_ = kind == "UNSTRUCTURED_GRID";
        scanner_.next_line();
        if (binary_) scanner_.set_binary_from(scanner_.position());
    }

    /// False where nothing is left that could be of use.
    bool read_section() {
        scanner_.skip_space();
        if (scanner_.at_end()) return false;
        const char* position = scanner_.position();
        const std::string_view keyword = scanner_.word();
        const auto once = [&](bool& done, bool ready, const char* needs) {
            if (done) scanner_.fail("a second section " + quoted(keyword), position);
            if (!ready) scanner_.fail("section " + quoted(keyword) + " stands before " + needs + ", which it needs", position);
            done = true;
        };
        if (keyword == "POINTS") {
            once(has_points_, true, "");
            read_points();
        } else if (is_grid_ && keyword == "CELLS") {
            once(has_cells_, true, "");
            read_cells();
        } else if (is_grid_ && keyword == "CELL_TYPES") {
            once(has_types_, has_points_ && has_cells_, "POINTS and CELLS");
            read_types();
        } else if (!is_grid_ && (keyword == "POLYGONS" || keyword == "TRIANGLE_STRIPS" || keyword == "VERTICES" || keyword == "LINES")) {
            if (!has_points_) scanner_.fail("section " + quoted(keyword) + " stands before POINTS, which it needs", position);
            read_cells();
            const std::int64_t type = keyword == "POLYGONS" ? 7 : keyword == "TRIANGLE_STRIPS" ? 6 : keyword == "LINES" ? 4 : 2;
            const std::vector<std::int64_t> types(offsets_.values.size() - 1, type);
            grid_.add_cells(scanner_, offsets_, ids_, types, 0, std::int64_t(grid_.point_count()));
        } else if (keyword == "CELL_DATA" || keyword == "POINT_DATA") {
            of_ = keyword == "CELL_DATA" ? Of::cells : Of::points;
            of_count_ = scanner_.integer("the number of values", 0, kBig);
            scanner_.next_line();
        } else if (keyword == "METADATA") {
            scanner_.next_line();
            while (!scanner_.at_end() && !scanner_.line_ended()) scanner_.next_line();
        } else {
            return read_attribute(keyword, position);
        }
        return true;
    }

    const TypeRow& type_named(std::string_view name, const char* position) {
        for (const TypeRow& row : kTypes)
            if (name == row.name) return row;
        scanner_.fail("a type such as float, double or int was expected, found " + quoted(name), position);
    }
    const TypeRow& read_type() {
        scanner_.line_ended();
        const char* position = scanner_.position();
        return type_named(scanner_.word(), position);
    }

    /// Refuses a count of values that the file cannot hold.
    void require(std::int64_t count, const TypeRow& type, std::string_view what) {
        const std::uint64_t left = scanner_.bytes_left();
        const std::uint64_t most = !binary_ ? (left + 1) / 2 : type.bytes == 0 ? 8 * left : left / std::uint64_t(type.bytes);
        if (std::uint64_t(count) > most)
            scanner_.fail("the file announces " + std::to_string(count) + " values of " + std::string(what) + ", but only " +
                          std::to_string(left) + " bytes are left: it is truncated, or the count is wrong");
    }

    std::int64_t read_whole_binary(BinaryScanner& bytes, Type type, const char* position) {
        switch (type) {
            case Type::int8:
                return bytes.read<std::int8_t>("a list");
            case Type::uint8:
                return bytes.read<std::uint8_t>("a list");
            case Type::int16:
                return bytes.read<std::int16_t>("a list");
            case Type::uint16:
                return bytes.read<std::uint16_t>("a list");
            case Type::int32:
                return bytes.read<std::int32_t>("a list");
            case Type::uint32:
                return bytes.read<std::uint32_t>("a list");
            case Type::int64:
            case Type::uint64:
                return bytes.read<std::int64_t>("a list");
            default:
                scanner_.fail("whole numbers were expected in this list", position);
        }
    }

    Numbers read_wholes(std::int64_t count, const TypeRow& type, std::string_view what) {
        require(count, type, what);
        Numbers numbers;
        numbers.start = scanner_.position();
        numbers.values.reserve(std::size_t(count));
        if (!binary_) {
            for (std::int64_t i = 0; i < count; ++i) {
                scanner_.skip_space();
                numbers.positions.push_back(scanner_.position());
                numbers.values.push_back(scanner_.integer(what));
            }
            return numbers;
        }
        BinaryScanner bytes({scanner_.position(), scanner_.bytes_left()}, scanner_.name(), std::endian::big);
        for (std::int64_t i = 0; i < count; ++i) numbers.values.push_back(read_whole_binary(bytes, type.type, numbers.start));
        scanner_.seek(numbers.start + bytes.position());
        return numbers;
    }

    void skip_values(std::int64_t count, const TypeRow& type, std::string_view what) {
        require(count, type, what);
        if (!binary_) {
            for (std::int64_t i = 0; i < count; ++i) {
                scanner_.skip_space();
                if (scanner_.at_end()) scanner_.fail("the file ends inside " + std::string(what) + ": it is truncated");
                scanner_.word();
            }
        } else {
            scanner_.seek(scanner_.position() + (type.bytes == 0 ? (count + 7) / 8 : count * type.bytes));
        }
    }

    void read_points() {
        const std::int64_t count = scanner_.integer("the number of points", 0, kBig / 3);
        const TypeRow& type = read_type();
        scanner_.next_line();
        require(3 * count, type, "points");
        if (type.type != Type::float32 && type.type != Type::float64 && binary_)
            scanner_.fail("points must be float or double", scanner_.position(), ErrorCode::unsupported);
        grid_.reserve_points(std::size_t(count));
        BinaryScanner bytes({scanner_.position(), scanner_.bytes_left()}, scanner_.name(), std::endian::big);
        const char* begin = scanner_.position();
        for (std::int64_t i = 0; i < count; ++i) {
            Vec3 x;
            if (!binary_) scanner_.skip_space();
            const char* position = binary_ ? begin + bytes.position() : scanner_.position();
            for (int axis = 0; axis < 3; ++axis) {
                if (binary_) {
                    x[axis] = type.type == Type::float32 ? double(bytes.read<float>("the points")) : bytes.read<double>("the points");
                } else {
                    scanner_.skip_space();
                    x[axis] = scanner_.real("a coordinate of a point");
                }
            }
            if (!x.allFinite()) scanner_.fail("a coordinate of point " + std::to_string(i) + " is not a finite number", position);
            grid_.add_point(x, position);
        }
        if (binary_) scanner_.seek(begin + bytes.position());
    }

    /// Fills offsets_ and ids_.
    void read_cells() {
        const std::int64_t count = scanner_.integer("the number of cells", 0, kBig);
        const std::int64_t size = scanner_.integer("the size of the cell list", 0, kBig);
        scanner_.end_line("the head of the cells");
        const TypeRow& int32 = type_named("int", nullptr);
        offsets_ = {};
        ids_ = {};
        const char* data = scanner_.position();
        scanner_.skip_space();
        constexpr std::string_view kOffsets = "OFFSETS";
        if (scanner_.bytes_left() >= kOffsets.size() && std::string_view(scanner_.position(), kOffsets.size()) == kOffsets) {
            scanner_.word();  // version 5: count is that of the offsets
            const TypeRow& offset_type = read_type();
            scanner_.next_line();
            offsets_ = read_wholes(count, offset_type, "an offset");
            if (offsets_.values.empty()) offsets_.values.push_back(0);
            scanner_.skip_space();
            const char* position = scanner_.position();
            if (scanner_.word() != "CONNECTIVITY") scanner_.fail("CONNECTIVITY was expected", position);
            const TypeRow& id_type = read_type();
            scanner_.next_line();
            ids_ = read_wholes(size, id_type, "a point number");
            return;
        }
        scanner_.seek(data);
        offsets_.values.push_back(0);
        const Numbers list = read_wholes(size, int32, "a point number of a cell");
        ids_.start = offsets_.start = list.start;
        std::size_t at = 0;
        for (std::int64_t i = 0; i < count; ++i) {
            if (at >= list.values.size()) scanner_.fail("the list of cells ends before its cell " + std::to_string(i) + ": its size is wrong");
            const std::int64_t corners = list.values[at];
            const char* place = list.position(at++);
            if (corners < 0 || std::uint64_t(corners) > list.values.size() - at)
                scanner_.fail("a cell of " + std::to_string(corners) + " points does not fit into the list of cells", place);
            for (std::int64_t c = 0; c < corners; ++c, ++at) {
                ids_.values.push_back(list.values[at]);
                if (!binary_) ids_.positions.push_back(list.position(at));
            }
            offsets_.values.push_back(std::int64_t(ids_.values.size()));
        }
        if (at != list.values.size()) scanner_.fail("the list of cells is longer than its cells: a count is wrong", list.position(at));
    }

    void read_types() {
        const auto count = std::int64_t(offsets_.values.size()) - 1;
        scanner_.integer("the number of cell types", count, count);
        scanner_.next_line();
        const Numbers types = read_wholes(count, type_named("int", nullptr), "a cell type");
        grid_.add_cells(scanner_, offsets_, ids_, types.values, 0, std::int64_t(grid_.point_count()));
    }

    /// An array of `tuples` x `components` values.
    void read_array(const std::string& name, std::int64_t components, std::int64_t tuples, const TypeRow& type, const char* position) {
        if (components != 0 && tuples > kBig / components) scanner_.fail("the array " + io::quoted(name) + " is too long", position);
        const bool whole = type.type != Type::bit && type.type != Type::float32 && type.type != Type::float64 && components == 1;
        if (whole && of_ == Of::nothing && name.substr(0, kRegionPrefix.size()) == kRegionPrefix && tuples == 1) {
            grid_.name_region(scanner_, position, read_wholes(1, type, "a region's number").values[0], name.substr(kRegionPrefix.size()));
        } else if (whole && of_ == Of::cells && VtkGrid::names_regions(name) && std::uint64_t(tuples) == grid_.cell_count() && is_grid_) {
            grid_.add_cell_tags(scanner_, name, 0, read_wholes(tuples, type, "a region number"));
        } else if (whole && of_ == Of::points && name.substr(0, kGroupPrefix.size()) == kGroupPrefix &&
                   std::uint64_t(tuples) == grid_.point_count()) {
            grid_.add_group_marks(name.substr(kGroupPrefix.size()), 0, read_wholes(tuples, type, "a mark of a point").values);
        } else {
            skip_values(components * tuples, type, "an array");
        }
    }

    bool read_attribute(std::string_view keyword, const char* position) {
        const std::string name = decode_vtk_name(scanner_.word());
        if (keyword == "FIELD") {
            const std::int64_t arrays = scanner_.integer("the number of arrays", 0, kBig);
            scanner_.next_line();
            for (std::int64_t i = 0; i < arrays; ++i)
                if (!read_field_array()) return false;
            return true;
        }
        if (keyword == "LOOKUP_TABLE") {
            const std::int64_t size = scanner_.integer("the size of the table", 0, kBig / 4);
            scanner_.next_line();
            skip_values(4 * size, type_named(binary_ ? "unsigned_char" : "float", nullptr), "a colour table");
            return true;
        }
        if (keyword == "COLOR_SCALARS") {
            const std::int64_t components = scanner_.integer("the number of components", 0, 1 << 20);
            scanner_.next_line();
            read_array(name, components, of_count_, type_named(binary_ ? "unsigned_char" : "float", nullptr), position);
            return true;
        }
        std::int64_t components = 0;
        if (keyword == "SCALARS" || keyword == "GLOBAL_IDS" || keyword == "PEDIGREE_IDS" || keyword == "EDGE_FLAGS") components = 1;
        if (keyword == "VECTORS" || keyword == "NORMALS") components = 3;
        if (keyword == "TENSORS6") components = 6;
        if (keyword == "TENSORS") components = 9;
        if (keyword == "TEXTURE_COORDINATES") components = scanner_.integer("the number of components", 1, 3);
        if (components == 0) {
            // Whatever it is, it says nothing about the shape; where that is complete, the rest may be anything.
            if (has_points_ && (has_types_ || !is_grid_) && of_ != Of::nothing) return false;
            scanner_.next_line();
            return true;
        }
        const TypeRow& type = read_type();
        if (keyword == "SCALARS") {
            if (!scanner_.line_ended()) components = scanner_.integer("the number of components", 1, 1 << 20);
            scanner_.next_line();
            scanner_.skip_space();
            const char* table = scanner_.position();
            if (scanner_.word() != "LOOKUP_TABLE") scanner_.seek(table);
            else scanner_.next_line();
        } else {
            scanner_.next_line();
        }
        read_array(name, components, of_count_, type, position);
        return true;
    }

    bool read_field_array() {
        scanner_.skip_space();
        const char* position = scanner_.position();
        std::string name = decode_vtk_name(scanner_.word());
        while (name == "METADATA") {  // of the array before
            scanner_.next_line();
            while (!scanner_.at_end() && !scanner_.line_ended()) scanner_.next_line();
            scanner_.skip_space();
            position = scanner_.position();
            name = decode_vtk_name(scanner_.word());
        }
        const std::int64_t components = scanner_.integer("the number of components", 0, kBig);
        const std::int64_t tuples = scanner_.integer("the number of tuples", 0, kBig);
        scanner_.line_ended();
        const char* type_place = scanner_.position();
        const std::string_view type = scanner_.word();
        scanner_.next_line();
        if (type == "string" || type == "utf8_string" || type == "variant") {
            if (has_points_ && (has_types_ || !is_grid_)) return false;
            scanner_.fail("a field of strings stands before the mesh; remove it, or save a VTU file", type_place, ErrorCode::unsupported);
        }
        read_array(name, components, tuples, type_named(type, type_place), position);
        return true;
    }

    TextScanner scanner_;
    VtkGrid grid_;
    bool binary_ = false, is_grid_ = true, has_points_ = false, has_cells_ = false, has_types_ = false;
    Of of_ = Of::nothing;
    std::int64_t of_count_ = 0;
    Numbers offsets_{{0}, {}, nullptr}, ids_;
};

}  // namespace

void read_vtk_legacy(const MeshSource& source, MeshBuilder& builder) { Legacy(source).read(builder); }

}  // namespace supple::io
