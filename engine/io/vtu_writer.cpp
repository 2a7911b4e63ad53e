#include "supple/io/vtu_writer.h"

#include <zlib.h>

#include <type_traits>

#include "supple/io/base64.h"
#include "supple/io/binary_scanner.h"
#include "supple/io/number_text.h"
#include "supple/io/vtk_names.h"

namespace supple::io {

namespace {

constexpr std::size_t kBlock = 1 << 18;

bool is_zlib(VtuEncoding e) { return e == VtuEncoding::inline_zlib || e == VtuEncoding::appended_zlib; }
bool is_inline(VtuEncoding e) { return e == VtuEncoding::inline_base64 || e == VtuEncoding::inline_zlib; }
bool is_base64(VtuEncoding e) { return is_inline(e) || e == VtuEncoding::appended_base64; }

}  // namespace

/// The size, or the sizes of the compressed blocks, then the data.
std::string VtuWriter::packed(std::string_view bytes) const {
    std::string head, data;
    BinaryText numbers(head);
    if (!is_zlib(encoding_)) {
        numbers.add(std::uint64_t(bytes.size()));
        data = bytes;
        // Without compression, head and data are encoded as one.
        data.insert(0, head);
        head.clear();
    } else {
        const std::size_t blocks = (bytes.size() + kBlock - 1) / kBlock;
        numbers.add(std::uint64_t(blocks));
        numbers.add(std::uint64_t(kBlock));
        numbers.add(std::uint64_t(bytes.size() % kBlock));
        for (std::size_t b = 0; b < blocks; ++b) {
            const std::string_view block = bytes.substr(b * kBlock, kBlock);
            uLongf size = compressBound(uLong(block.size()));
            const std::size_t begin = data.size();
            data.resize(begin + size);
            if (compress2(reinterpret_cast<Bytef*>(data.data() + begin), &size, reinterpret_cast<const Bytef*>(block.data()),
                          uLong(block.size()), Z_DEFAULT_COMPRESSION) != Z_OK)
                throw Error(ErrorCode::external_tool, "VtuWriter", "zlib could not compress an array");
            data.resize(begin + size);
            numbers.add(std::uint64_t(size));
        }
    }
    if (!is_base64(encoding_)) return head + data;
    return to_base64(head) + to_base64(data);
}

template <class T>
void VtuWriter::add(std::string& xml, const char* type, std::string_view name, int components, std::span<const T> values) {
    xml += std::string("<DataArray type=\"") + type + "\" Name=\"" + escape_xml(name) + "\"";
    if (components != 1) xml += " NumberOfComponents=\"" + std::to_string(components) + "\"";
    if (&xml == &fields_) xml += " NumberOfTuples=\"" + std::to_string(values.size()) + "\"";
    if (encoding_ == VtuEncoding::ascii) {
        xml += " format=\"ascii\">\n";
        for (std::size_t i = 0; i < values.size(); ++i) {
            if constexpr (sizeof(T) == 1) {
                append(xml, int(values[i]));
            } else {
                append(xml, values[i]);
            }
            xml += (i + 1) % (components == 1 ? 16 : std::size_t(components)) == 0 || i + 1 == values.size() ? '\n' : ' ';
        }
        xml += "</DataArray>\n";
        return;
    }
    std::string bytes;
    bytes.reserve(values.size_bytes());
    BinaryText numbers(bytes);
    for (const T value : values) numbers.add(value);
    if (is_inline(encoding_)) {
        xml += " format=\"binary\">\n" + packed(bytes) + "\n</DataArray>\n";
    } else {
        xml += " format=\"appended\" offset=\"" + std::to_string(appended_.size()) + "\"/>\n";
        appended_ += packed(bytes);
    }
}

void VtuWriter::field(std::string_view name, std::int32_t value) {
    add(fields_, "Int32", name, 1, std::span<const std::int32_t>(&value, 1));
}
void VtuWriter::point_data(std::string_view name, int components, std::span<const double> values) {
    add(point_data_, "Float64", name, components, values);
}
void VtuWriter::point_data(std::string_view name, std::span<const std::uint8_t> values) { add(point_data_, "UInt8", name, 1, values); }
void VtuWriter::cell_data(std::string_view name, int components, std::span<const double> values) {
    add(cell_data_, "Float64", name, components, values);
}
void VtuWriter::cell_data(std::string_view name, std::span<const std::int32_t> values) { add(cell_data_, "Int32", name, 1, values); }

std::string VtuWriter::finish(std::span<const Vec3> points, std::span<const Tet> tets, std::span<const Hex> hexes) {
    std::vector<double> coordinates;
    coordinates.reserve(3 * points.size());
    for (const Vec3& x : points) coordinates.insert(coordinates.end(), {x.x(), x.y(), x.z()});
    std::vector<std::int64_t> connectivity, offsets;
    std::vector<std::uint8_t> types;
    const auto add_cells = [&](const auto& cells, std::uint8_t type) {
        for (const auto& cell : cells) {
            connectivity.insert(connectivity.end(), cell.begin(), cell.end());
            offsets.push_back(std::int64_t(connectivity.size()));
            types.push_back(type);
        }
    };
    add_cells(tets, 10);
    add_cells(hexes, 12);
    std::string point_part, cell_part;
    add(point_part, "Float64", "Points", 3, std::span<const double>(coordinates));
    add(cell_part, "Int64", "connectivity", 1, std::span<const std::int64_t>(connectivity));
    add(cell_part, "Int64", "offsets", 1, std::span<const std::int64_t>(offsets));
    add(cell_part, "UInt8", "types", 1, std::span<const std::uint8_t>(types));

    std::string xml =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"";
    if (is_zlib(encoding_)) xml += " compressor=\"vtkZLibDataCompressor\"";
    xml += ">\n<UnstructuredGrid>\n";
    if (!fields_.empty()) xml += "<FieldData>\n" + fields_ + "</FieldData>\n";
    xml += "<Piece NumberOfPoints=\"" + std::to_string(points.size()) + "\" NumberOfCells=\"" + std::to_string(types.size()) + "\">\n";
    xml += "<PointData>\n" + point_data_ + "</PointData>\n<CellData>\n" + cell_data_ + "</CellData>\n<Points>\n" + point_part +
           "</Points>\n<Cells>\n" + cell_part + "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
    if (encoding_ != VtuEncoding::ascii && !is_inline(encoding_))
        xml += std::string("<AppendedData encoding=\"") + (is_base64(encoding_) ? "base64" : "raw") + "\">\n_" + appended_ +
               "\n</AppendedData>\n";
    return xml + "</VTKFile>\n";
}

std::string format_vtu(const VolumeMesh& mesh, VtuEncoding encoding) {
    require_writable_mesh(mesh, "write_mesh");
    VtuWriter writer(encoding);
    const std::vector<int> tags = region_tags(mesh);
    for (std::size_t r = 0; r < tags.size(); ++r) writer.field(std::string(kRegionPrefix) + mesh.regions[r].name, tags[r]);
    if (!tags.empty()) writer.cell_data(kRegionArray, element_tags(mesh));
    for (const VertexGroup& group : mesh.groups) {
        std::vector<std::uint8_t> marks(mesh.vertices.size(), 0);
        for (const std::int32_t v : group.vertices) marks[std::size_t(v)] = 1;
        writer.point_data(std::string(kGroupPrefix) + group.name, marks);
    }
    return writer.finish(mesh.vertices, mesh.tets, mesh.hexes);
}

}  // namespace supple::io
