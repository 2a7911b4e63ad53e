// VTK XML unstructured grids (.vtu) and PolyData (.vtp): their tags, piece by piece.
#include <charconv>
#include <optional>

#include "supple/io/mesh_builder.h"
#include "supple/io/volume_formats.h"
#include "supple/io/vtk_grid.h"
#include "supple/io/vtk_names.h"
#include "supple/io/vtu_arrays.h"

namespace supple::io {

namespace {

/// Lists of cells of one kind; in PolyData the type goes without saying.
struct CellLists {
    Numbers connectivity, offsets, types;
};

constexpr std::pair<std::string_view, std::int64_t> kPolyKinds[] = {{"Verts", 2}, {"Lines", 4}, {"Polys", 7}, {"Strips", 6}};

/// One <Piece>; several stand one after another.
struct Piece {
    bool open = false, has_points = false;
    const char* position = nullptr;
    std::int64_t point_count = 0, cell_count = 0;
    std::vector<double> points;
    std::vector<const char*> point_positions;
    CellLists cells;
    CellLists poly[4];
    std::vector<std::pair<std::string, Numbers>> cell_tags;
    std::vector<std::pair<std::string, Numbers>> marks;
};

class VtkXml {
public:
    explicit VtkXml(const MeshSource& source) : text_(source.bytes), file_(source.bytes, source.name) {}

    void read(MeshBuilder& builder) {
        XmlTagReader reader(text_, file_);
        bool closed = false;
        for (XmlTag tag; !closed && reader.next(tag);) closed = read_tag(tag);
        if (!closed) file_.fail("</VTKFile> is missing: the file is truncated", file_.end());
        if (piece_.open) file_.fail("a piece is not closed with </Piece>", piece_.position);
        grid_.feed(file_, builder);
    }

private:
    /// True at the end.
    bool read_tag(const XmlTag& tag) {
        if (tag.name == "VTKFile") {
            read_head(tag);
        } else if (tag.name == "Piece") {
            if (piece_.open) file_.fail("a piece begins inside another one", tag.position);
            piece_.open = true;
            piece_.position = tag.position;
            piece_.point_count = read_count(tag, "NumberOfPoints");
            if (is_grid_) piece_.cell_count = read_count(tag, "NumberOfCells");
            // Nothing is inside of <Piece ... />, nor of one that holds nothing.
            if (tag.empty) close_piece();
        } else if (tag.name == "/Piece") {
            if (!piece_.open) file_.fail("</Piece> without <Piece>", tag.position);
            close_piece();
        } else if (tag.name == "DataArray") {
            read_array(tag);
        } else if (tag.name == "/VTKFile" || tag.name == "AppendedData") {
            return true;  // appended data are bytes, not tags
        } else if (tag.name == "Points" || tag.name == "Cells" || tag.name == "PointData" || tag.name == "CellData" ||
                   tag.name == "FieldData" || poly_kind(tag.name)) {
            parent_ = tag.empty ? std::string_view() : tag.name;
        } else if (!tag.name.empty() && tag.name.substr(1) == parent_) {
            parent_ = {};
        }
        return false;
    }

    void read_head(const XmlTag& tag) {
        const std::string_view kind = tag.attribute("type");
        if (kind != "UnstructuredGrid" && kind != "PolyData")
            file_.fail("a VTK file of the kind " + quoted(kind) + " is not read; save an unstructured grid of tetrahedra", tag.position,
                       ErrorCode::unsupported);
        is_grid_ = kind == "UnstructuredGrid";
        storage_ = read_vtu_storage(file_, text_, tag);
    }

    static std::optional<std::size_t> poly_kind(std::string_view name) {
        for (std::size_t k = 0; k < std::size(kPolyKinds); ++k)
            if (kPolyKinds[k].first == name) return k;
        return std::nullopt;
    }

    std::int64_t read_count(const XmlTag& tag, std::string_view key) const {
        const std::string_view value = tag.attribute(key);
        std::int64_t count = -1;
        const auto [rest, error] = std::from_chars(value.data(), value.data() + value.size(), count);
        if (error != std::errc() || rest != value.data() + value.size() || count < 0)
            file_.fail(std::string(key) + " must be a whole number, found " + quoted(value), tag.position);
        return count;
    }

    Numbers integers(const XmlTag& tag) const { return read_vtu_integers(file_, storage_, tag); }

    void read_lists(const XmlTag& tag, CellLists& lists) {
        const std::string_view name = tag.attribute("Name");
        if (name == "connectivity") lists.connectivity = integers(tag);
        if (name == "offsets") lists.offsets = integers(tag);
        if (name == "types") lists.types = integers(tag);
    }

    void read_array(const XmlTag& tag) {
        const std::string name = unescape_xml(tag.attribute("Name"));
        const std::string_view components = tag.attribute("NumberOfComponents");
        const bool plain = (components.empty() || components == "1") && tag.attribute("type").find("Int") != std::string_view::npos;
        const auto has_prefix = [&](std::string_view prefix) { return std::string_view(name).substr(0, prefix.size()) == prefix; };
        if (parent_ == "FieldData" && plain && has_prefix(kRegionPrefix)) {
            const Numbers tags = integers(tag);
            if (tags.values.size() != 1) file_.fail("the field array " + io::quoted(name) + " must hold one number", tag.position);
            grid_.name_region(file_, tag.position, tags.values[0], name.substr(kRegionPrefix.size()));
        }
        if (!piece_.open) return;
        if (parent_ == "Points") {
            if (piece_.has_points) file_.fail("a second array of points", tag.position);
            piece_.has_points = true;
            piece_.points = read_vtu_reals(file_, storage_, tag, piece_.point_positions);
        } else if (parent_ == "Cells") {
            read_lists(tag, piece_.cells);
        } else if (const auto kind = poly_kind(parent_)) {
            read_lists(tag, piece_.poly[*kind]);
        } else if (parent_ == "CellData" && is_grid_ && plain && VtkGrid::names_regions(name)) {
            piece_.cell_tags.emplace_back(name, integers(tag));
        } else if (parent_ == "PointData" && plain && has_prefix(kGroupPrefix)) {
            piece_.marks.emplace_back(name.substr(kGroupPrefix.size()), integers(tag));
        }
    }

    void check(const char* what, std::size_t found, std::int64_t expected) const {
        if (std::int64_t(found) == expected) return;
        file_.fail("the piece announces " + std::to_string(expected) + " " + what + ", but has " + std::to_string(found), piece_.position);
    }

    void add_cells(CellLists& lists, const std::vector<std::int64_t>& types, std::int64_t first) {
        lists.offsets.values.insert(lists.offsets.values.begin(), 0);
        if (!lists.offsets.positions.empty()) lists.offsets.positions.insert(lists.offsets.positions.begin(), lists.offsets.start);
        grid_.add_cells(file_, lists.offsets, lists.connectivity, types, first, piece_.point_count);
    }

    void close_piece() {
        if (piece_.points.size() % 3 != 0) file_.fail("the coordinates of the points are not three each", piece_.position);
        check("points", piece_.points.size() / 3, piece_.point_count);
        const auto first = std::int64_t(grid_.point_count());
        const std::size_t first_cell = grid_.cell_count();
        for (std::size_t i = 0; i < piece_.point_positions.size(); ++i)
            grid_.add_point({piece_.points[3 * i], piece_.points[3 * i + 1], piece_.points[3 * i + 2]}, piece_.point_positions[i]);
        if (is_grid_) {
            check("cells, so many offsets", piece_.cells.offsets.values.size(), piece_.cell_count);
            check("cells, so many types", piece_.cells.types.values.size(), piece_.cell_count);
            add_cells(piece_.cells, piece_.cells.types.values, first);
        } else {
            for (std::size_t k = 0; k < std::size(kPolyKinds); ++k)
                add_cells(piece_.poly[k], std::vector(piece_.poly[k].offsets.values.size(), kPolyKinds[k].second), first);
        }
        for (const auto& [name, tags] : piece_.cell_tags) {
            check("cells, so many region numbers", tags.values.size(), piece_.cell_count);
            grid_.add_cell_tags(file_, name, first_cell, tags);
        }
        for (auto& [name, marks] : piece_.marks) {
            check("points, so many marks of a group", marks.values.size(), piece_.point_count);
            grid_.add_group_marks(name, first, marks.values);
        }
        piece_ = {};
    }

    std::string_view text_, parent_;
    TextScanner file_;
    VtuStorage storage_;
    VtkGrid grid_;
    Piece piece_;
    bool is_grid_ = true;
};

}  // namespace

void read_vtk_xml(const MeshSource& source, MeshBuilder& builder) { VtkXml(source).read(builder); }

}  // namespace supple::io
