// VTK legacy files, version 3.0: what every reader of VTK files knows.
#include "supple/io/binary_scanner.h"
#include "supple/io/number_text.h"
#include "supple/io/volume_formats.h"
#include "supple/io/vtk_names.h"

namespace supple::io {

namespace {

class Values {
public:
    Values(std::string& text, bool binary) : text_(text), bytes_(text, std::endian::big), binary_(binary) {}
    template <class T>
    void add(T value) {
        if (binary_) return bytes_.add(value);
        if (text_.back() != '\n') text_ += ' ';
        if constexpr (sizeof(T) == 1) {
            append(text_, int(value));
        } else {
            append(text_, value);
        }
    }
    void end_record() {
        if (!binary_) text_ += '\n';
    }
    void end_section() {
        if (binary_) text_ += '\n';
    }

private:
    std::string& text_;
    BinaryText bytes_;
    bool binary_;
};

void add_cells(std::string& text, Values& values, const VolumeMesh& mesh) {
    text += "CELLS " + std::to_string(mesh.element_count()) + " " + std::to_string(5 * mesh.tets.size() + 9 * mesh.hexes.size()) + "\n";
    const auto add = [&](const auto& cells) {
        for (const auto& cell : cells) {
            values.add(std::int32_t(cell.size()));
            for (const std::int32_t v : cell) values.add(v);
            values.end_record();
        }
    };
    add(mesh.tets);
    add(mesh.hexes);
    values.end_section();
    text += "CELL_TYPES " + std::to_string(mesh.element_count()) + "\n";
    for (std::size_t e = 0; e < mesh.element_count(); ++e) {
        values.add(std::int32_t(e < mesh.tets.size() ? 10 : 12));
        values.end_record();
    }
    values.end_section();
}

std::string format(const VolumeMesh& mesh, bool binary) {
    require_writable_mesh(mesh, "write_mesh");
    const std::vector<int> tags = region_tags(mesh);
    std::string text =
        std::string("# vtk DataFile Version 3.0\nvolume mesh\n") + (binary ? "BINARY" : "ASCII") + "\nDATASET UNSTRUCTURED_GRID\n";
    Values values(text, binary);
    if (!tags.empty()) {
        text += "FIELD FieldData " + std::to_string(tags.size()) + "\n";
        for (std::size_t r = 0; r < tags.size(); ++r) {
            text += encode_vtk_name(std::string(kRegionPrefix) + mesh.regions[r].name) + " 1 1 int\n";
            values.add(std::int32_t(tags[r]));
            text += '\n';
        }
    }
    text += "POINTS " + std::to_string(mesh.vertices.size()) + " double\n";
    for (const Vec3& x : mesh.vertices) {
        for (int axis = 0; axis < 3; ++axis) values.add(x[axis]);
        values.end_record();
    }
    values.end_section();
    add_cells(text, values, mesh);
    if (!tags.empty()) {
        text += "CELL_DATA " + std::to_string(mesh.element_count()) + "\nSCALARS " + std::string(kRegionArray) +
                " int 1\nLOOKUP_TABLE default\n";
        for (const int tag : element_tags(mesh)) {
            values.add(std::int32_t(tag));
            values.end_record();
        }
        values.end_section();
    }
    if (mesh.groups.empty()) return text;
    text += "POINT_DATA " + std::to_string(mesh.vertices.size()) + "\nFIELD FieldData " + std::to_string(mesh.groups.size()) + "\n";
    for (const VertexGroup& group : mesh.groups) {
        text += encode_vtk_name(std::string(kGroupPrefix) + group.name) + " 1 " + std::to_string(mesh.vertices.size()) + " unsigned_char\n";
        std::vector<std::uint8_t> marks(mesh.vertices.size(), 0);
        for (const std::int32_t v : group.vertices) marks[std::size_t(v)] = 1;
        for (const std::uint8_t mark : marks) {
            values.add(mark);
            values.end_record();
        }
        values.end_section();
    }
    return text;
}

}  // namespace

std::string format_vtk(const VolumeMesh& mesh) { return format(mesh, false); }
std::string format_vtk_binary(const VolumeMesh& mesh) { return format(mesh, true); }

}  // namespace supple::io
