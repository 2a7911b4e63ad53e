#include <cctype>
#include <limits>

#include "supple/io/mesh_builder.h"
#include "supple/io/number_text.h"
#include "supple/io/refusals.h"
#include "supple/io/volume_formats.h"

namespace supple::io {

namespace {

constexpr std::int64_t kBig = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kInt = std::numeric_limits<int>::max();

struct Section {
    const char* keyword;
    ElementType type;
};
constexpr Section kElementSections[] = {
    {"Edges", kEdgeType}, {"Triangles", kTriangleType}, {"Quadrilaterals", kQuadType}, {"Tetrahedra", kTetType}, {"Hexahedra", kHexType},
};

/// Sections whose elements fill a volume that would be missing without them.
constexpr const char* kOtherVolumes[] = {"Prisms",      "Pentahedra",  "Pyramids",    "TetrahedraP2", "TetrahedraP3", "TetrahedraP4",
                                         "HexahedraQ2", "HexahedraQ3", "HexahedraQ4", "PrismsP2",     "PyramidsP2",   "Polyhedra"};

/// Free format: line ends mean nothing, # begins a comment.
void skip(TextScanner& scanner) {
    scanner.skip_space();
    while (!scanner.at_end() && *scanner.position() == '#') {
        scanner.next_line();
        scanner.skip_space();
    }
}

std::int64_t next_integer(TextScanner& scanner, const char* what, std::int64_t low = -kBig, std::int64_t high = kBig) {
    skip(scanner);
    return scanner.integer(what, low, high);
}

double next_real(TextScanner& scanner, const char* what) {
    skip(scanner);
    return scanner.real(what);
}

void read_vertices(TextScanner& scanner, MeshBuilder& builder, std::vector<std::int64_t>& references) {
    const std::int64_t count = next_integer(scanner, "the number of vertices", 0, kBig);
    builder.reserve_vertices(scanner.plausible(count, 8));
    references.reserve(scanner.plausible(count, 8));
    for (std::int64_t i = 0; i < count; ++i) {
        skip(scanner);
        const char* position = scanner.position();
        Vec3 x;
        x[0] = next_real(scanner, "the x coordinate of a vertex");
        x[1] = next_real(scanner, "the y coordinate of a vertex");
        x[2] = next_real(scanner, "the z coordinate of a vertex");
        references.push_back(next_integer(scanner, "the reference of a vertex", -kInt, kInt));
        builder.add_vertex(i + 1, x, position);
    }
}

void read_elements(TextScanner& scanner, MeshBuilder& builder, const ElementType& type) {
    const std::int64_t count = next_integer(scanner, "the number of elements", 0, kBig);
    std::int64_t ids[8];
    for (std::int64_t i = 0; i < count; ++i) {
        skip(scanner);
        const char* position = scanner.position();
        for (int v = 0; v < type.vertex_count; ++v) ids[v] = next_integer(scanner, "a vertex number of an element");
        const std::int64_t reference = next_integer(scanner, "the reference of an element", -kInt, kInt);
        builder.add_element(scanner, position, type, {ids, std::size_t(type.vertex_count)}, {&reference, 1});
    }
}

void require_three_dimensions(TextScanner& scanner) {
    const char* position = scanner.position();
    const std::int64_t dimension = next_integer(scanner, "the dimension", 2, 3);
    if (dimension == 2) throw surface_error(scanner.where(position), "a Medit file of dimension 2");
}

/// Goes to the next word that begins with a letter: sections that nobody reads hold numbers only.
void skip_numbers(TextScanner& scanner) {
    for (skip(scanner); !scanner.at_end() && !std::isalpha(static_cast<unsigned char>(*scanner.position())); skip(scanner)) scanner.word();
}

}  // namespace

void read_medit(const MeshSource& source, MeshBuilder& builder) {
    TextScanner scanner(source.bytes, source.name);
    std::vector<std::int64_t> references;
    bool has_vertices = false;
    for (skip(scanner); !scanner.at_end(); skip(scanner)) {
        const char* position = scanner.position();
        const std::string_view keyword = scanner.word();
        if (!std::isalpha(static_cast<unsigned char>(keyword.front()))) {
            scanner.fail(
                "a section such as Vertices or Tetrahedra must begin here, found " + quoted(keyword) + "; the count before it may be wrong",
                position);
        }
        if (keyword == "End") break;
        if (keyword == "Dimension") {
            require_three_dimensions(scanner);
            continue;
        }
        if (keyword == "Vertices") {
            if (has_vertices) scanner.fail("a second section of vertices; only one is allowed", position);
            has_vertices = true;
            read_vertices(scanner, builder, references);
            builder.close_vertices(scanner);
            for (std::size_t i = 0; i < references.size(); ++i) {
                const std::int64_t id = std::int64_t(i) + 1;
                if (references[i] != 0) builder.add_element(scanner, position, kPointType, {&id, 1}, {&references[i], 1});
            }
            continue;
        }
        bool known = false;
        for (const Section& section : kElementSections) {
            if (keyword != section.keyword) continue;
            if (!has_vertices) scanner.fail("the elements stand before the vertices that they use", position);
            read_elements(scanner, builder, section.type);
            known = true;
        }
        if (known) continue;
        for (const char* other : kOtherVolumes) {
            if (keyword == other && next_integer(scanner, "the number of elements", 0, kBig) > 0) {
                scanner.fail(quoted(keyword) + " cannot be simulated; mesh the part with linear tetrahedra or hexahedra", position,
                             ErrorCode::unsupported);
            }
        }
        skip_numbers(scanner);
    }
}

std::string format_medit(const VolumeMesh& mesh) {
    require_writable_mesh(mesh, "write_mesh");
    const std::vector<int> tags = element_tags(mesh);
    std::string text = "MeshVersionFormatted 2\nDimension 3\nVertices\n" + std::to_string(mesh.vertices.size()) + "\n";
    for (const Vec3& x : mesh.vertices) {
        append(text, x);
        text += " 0\n";
    }
    std::size_t e = 0;
    const auto add_elements = [&](const char* keyword, const auto& elements) {
        if (elements.empty()) return;
        text += std::string(keyword) + "\n" + std::to_string(elements.size()) + "\n";
        for (const auto& element : elements) {
            for (const std::int32_t v : element) {
                append(text, std::int64_t(v) + 1);
                text += ' ';
            }
            append(text, tags[e++]);
            text += '\n';
        }
    };
    add_elements("Tetrahedra", mesh.tets);
    add_elements("Hexahedra", mesh.hexes);
    return text + "End\n";
}

}  // namespace supple::io
