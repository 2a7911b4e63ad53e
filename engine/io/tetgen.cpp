#include <cmath>
#include <limits>

#include "supple/io/binary_file.h"
#include "supple/io/mesh_builder.h"
#include "supple/io/number_text.h"
#include "supple/io/volume_formats.h"

namespace supple::io {

namespace {

constexpr std::int64_t kBig = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMostAttributes = 1 << 16;

/// Goes to the next record, over empty lines and comments.
void next_record(TextScanner& scanner, const char* what) {
    for (;;) {
        if (scanner.at_end())
            scanner.fail("nothing is left where " + std::string(what) + " was expected: the file is truncated, or its count is wrong");
        if (!scanner.line_ended() && *scanner.position() != '#') return;
        scanner.next_line();
    }
}

/// A comment may follow a record.
void end_record(TextScanner& scanner, const char* what) {
    if (!scanner.line_ended() && *scanner.position() != '#') scanner.end_line(what);
    scanner.next_line();
}

struct NodeMarks {
    std::vector<std::int64_t> ids, marks;
};

NodeMarks read_nodes(TextScanner& scanner, MeshBuilder& builder) {
    next_record(scanner, "the number of nodes");
    const std::int64_t count = scanner.integer("the number of nodes", 0, kBig);
    if (count == 0)
        scanner.fail("the file has no nodes of its own (they are in a .poly file); run TetGen, which writes them", scanner.position(),
                     ErrorCode::unsupported);
    scanner.integer("the dimension", 3, 3);
    const std::int64_t attributes = scanner.line_ended() ? 0 : scanner.integer("the number of attributes", 0, kMostAttributes);
    const bool marked = !scanner.line_ended() && scanner.integer("the number of boundary markers", 0, 1) == 1;
    end_record(scanner, "the head of the nodes");
    builder.reserve_vertices(scanner.plausible(count, 8));
    NodeMarks marks;
    for (std::int64_t i = 0; i < count; ++i) {
        next_record(scanner, "a node");
        const char* position = scanner.position();
        const std::int64_t id = scanner.integer("the number of a node");
        Vec3 x;
        for (int axis = 0; axis < 3; ++axis) x[axis] = scanner.real("a coordinate of a node");
        for (std::int64_t a = 0; a < attributes; ++a) scanner.real("an attribute of a node");
        const int kInt = std::numeric_limits<int>::max();
        const std::int64_t mark = marked ? scanner.integer("the boundary marker of a node", -kInt, kInt) : 0;
        end_record(scanner, "a node");
        builder.add_vertex(id, x, position);
        if (mark == 0) continue;
        marks.ids.push_back(id);
        marks.marks.push_back(mark);
    }
    builder.close_vertices(scanner);
    return marks;
}

void read_elements(TextScanner& scanner, MeshBuilder& builder) {
    next_record(scanner, "the number of tetrahedra");
    const char* head = scanner.position();
    const std::int64_t count = scanner.integer("the number of tetrahedra", 0, kBig);
    const std::int64_t corners = scanner.integer("the number of nodes of a tetrahedron");
    if (corners != 4)
        scanner.fail("tetrahedra of " + std::to_string(corners) + " nodes are not read; run TetGen without -o2", head,
                     ErrorCode::unsupported);
    const std::int64_t attributes = scanner.line_ended() ? 0 : scanner.integer("the number of attributes", 0, kMostAttributes);
    end_record(scanner, "the head of the tetrahedra");
    for (std::int64_t i = 0; i < count; ++i) {
        next_record(scanner, "a tetrahedron");
        const char* position = scanner.position();
        scanner.integer("the number of a tetrahedron");
        std::int64_t ids[4], region = 0;
        for (std::int64_t& id : ids) id = scanner.integer("a node of a tetrahedron");
        for (std::int64_t a = 0; a < attributes; ++a) {
            const double value = scanner.real("an attribute of a tetrahedron");
            if (a > 0) continue;
            if (value != std::floor(value) || std::abs(value) > std::numeric_limits<int>::max())
                scanner.fail("the first attribute is the region and must be a whole number of 32 bits, found " + to_text(value), position);
            region = std::int64_t(value);
        }
        end_record(scanner, "a tetrahedron");
        builder.add_element(scanner, position, kTetType, ids, {&region, 1});
    }
}

}  // namespace

void read_tetgen(const MeshSource& source, std::string_view nodes, const std::string& nodes_name, MeshBuilder& builder) {
    TextScanner node_scanner(nodes, nodes_name);
    const NodeMarks marks = read_nodes(node_scanner, builder);
    TextScanner elements(source.bytes, source.name);
    read_elements(elements, builder);
    for (std::size_t i = 0; i < marks.ids.size(); ++i)
        builder.add_element(node_scanner, nullptr, kPointType, {&marks.ids[i], 1}, {&marks.marks[i], 1});
}

void read_tetgen(const MeshSource& source, MeshBuilder& builder) {
    const std::filesystem::path file(source.name);
    const bool is_node = file.extension() == ".node";
    const std::filesystem::path partner = std::filesystem::path(file).replace_extension(is_node ? ".ele" : ".node");
    const std::string text = read_partner(source, partner.filename(), source.name);
    if (is_node) return read_tetgen({text, partner.string(), source.folder}, source.bytes, source.name, builder);
    read_tetgen(source, text, partner.string(), builder);
}

void write_tetgen(const std::filesystem::path& file, const VolumeMesh& mesh) {
    require_writable_mesh(mesh, "write_mesh");
    if (!mesh.hexes.empty())
        throw Error(
            ErrorCode::unsupported, file.string(),
            "TetGen files hold tetrahedra only, and the mesh has " + std::to_string(mesh.hexes.size()) + " hexahedra; write Gmsh or VTU");
    std::string nodes = std::to_string(mesh.vertices.size()) + " 3 0 0\n";
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        append(nodes, v + 1);
        nodes += ' ';
        append(nodes, mesh.vertices[v]);
        nodes += '\n';
    }
    const bool has_regions = !mesh.regions.empty();
    const std::vector<int> tags = element_tags(mesh);
    std::string elements = std::to_string(mesh.tets.size()) + " 4 " + (has_regions ? "1" : "0") + "\n";
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
        append(elements, e + 1);
        for (const std::int32_t v : mesh.tets[e]) {
            elements += ' ';
            append(elements, std::int64_t(v) + 1);
        }
        if (has_regions) {
            elements += ' ';
            append(elements, tags[e]);
        }
        elements += '\n';
    }
    write_text_file(std::filesystem::path(file).replace_extension(".node"), nodes);
    write_text_file(std::filesystem::path(file).replace_extension(".ele"), elements);
}

}  // namespace supple::io
