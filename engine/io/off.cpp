#include <limits>

#include "supple/io/number_text.h"
#include "supple/io/surface_builder.h"
#include "supple/io/surface_formats.h"
#include "supple/mesh/surface_check.h"

namespace supple::io {

namespace {

constexpr std::int64_t kBig = std::numeric_limits<std::int64_t>::max();

/// Goes to the next word, over line ends and comments.
void skip(TextScanner& scanner) {
    scanner.skip_space();
    while (!scanner.at_end() && *scanner.position() == '#') {
        scanner.next_line();
        scanner.skip_space();
    }
}

/// The line's rest holds colours and the like.
void skip_rest(TextScanner& scanner) { scanner.next_line(); }

}  // namespace

mesh::TriangleMesh parse_off(std::string_view text, const std::string& name) {
    TextScanner scanner(text, name);
    skip(scanner);
    const char* head = scanner.position();
    const std::string_view keyword = scanner.word();
    if (keyword.size() < 3 || keyword.substr(keyword.size() - 3) != "OFF") scanner.fail("OFF was expected, found " + quoted(keyword), head);
    if (keyword.find('n') != std::string_view::npos || keyword.find('4') != std::string_view::npos)
        scanner.fail("only three-dimensional OFF files are read, this is " + quoted(keyword), head, ErrorCode::unsupported);
    if (!scanner.line_ended()) {
        const char* position = scanner.position();
        if (scanner.word() == "BINARY")
            scanner.fail("binary OFF files are not read; save it as text or as PLY", position, ErrorCode::unsupported);
        scanner.seek(position);
    }
    skip(scanner);
    const std::int64_t vertices = scanner.integer("the number of vertices", 0, kBig);
    skip(scanner);
    const std::int64_t faces = scanner.integer("the number of faces", 0, kBig);
    skip_rest(scanner);  // the number of edges, often left out
    SurfaceBuilder builder;
    builder.reserve_vertices(scanner.plausible(vertices, 6));
    for (std::int64_t i = 0; i < vertices; ++i) {
        skip(scanner);
        Vec3 x;
        x[0] = scanner.real("the x coordinate of a vertex");
        x[1] = scanner.real("the y coordinate of a vertex");
        x[2] = scanner.real("the z coordinate of a vertex");
        builder.add_vertex(x);
        skip_rest(scanner);
    }
    std::vector<std::int64_t> corners;
    for (std::int64_t i = 0; i < faces; ++i) {
        skip(scanner);
        const char* position = scanner.position();
        const std::int64_t count = scanner.integer("the number of corners of a face", 0, kBig);
        corners.clear();
        for (std::int64_t c = 0; c < count; ++c) {
            skip(scanner);
            corners.push_back(scanner.integer("a corner of a face", 0, vertices - 1));
        }
        builder.add_polygon(corners, position);
        skip_rest(scanner);
    }
    return builder.finish(scanner);
}

std::string format_off(const mesh::TriangleMesh& mesh) {
    mesh::require_sound(mesh);
    std::string out = "OFF\n" + std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n";
    append_lines(out, mesh);
    return out;
}

}  // namespace supple::io
