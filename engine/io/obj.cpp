#include <initializer_list>

#include "supple/io/number_text.h"
#include "supple/io/surface_builder.h"
#include "supple/io/surface_formats.h"
#include "supple/mesh/surface_check.h"

namespace supple::io {

namespace {

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> list) {
    for (const std::string_view item : list)
        if (word == item) return true;
    return false;
}

/// A backslash at the line's end joins the next line to it.
bool record_ended(TextScanner& scanner) {
    while (true) {
        if (scanner.line_ended()) return true;
        const char* at = scanner.position();
        if (*at == '#') return true;
        if (*at != '\\') return false;
        const char* next = at + 1;
        while (next != scanner.end() && is_blank(*next)) ++next;
        if (next == scanner.end()) return true;
        if (*next != '\n') return false;
        scanner.seek(next + 1);
    }
}

/// The vertex number of "7", "7/1", "7//3", "7/1/3" or "-1": from 0.
std::int64_t corner_of(TextScanner& scanner, std::size_t vertices) {
    const char* position = scanner.position();
    const std::string_view word = scanner.word();
    const std::string_view number = word.substr(0, word.find('/'));
    std::int64_t value = 0;
    const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error != std::errc() || rest != number.data() + number.size() || value == 0)
        scanner.fail("a corner of a face must be a vertex number from 1, or a negative one, found " + quoted(word), position);
    if (value > 0) return value - 1;
    if (std::uint64_t(-(value + 1)) >= vertices)
        scanner.fail("vertex " + std::to_string(value) + " counts back from here, where only " + std::to_string(vertices) + " are known",
                     position);
    return std::int64_t(vertices) + value;
}

}  // namespace

mesh::TriangleMesh parse_obj(std::string_view text, const std::string& name) {
    TextScanner scanner(text, name);
    SurfaceBuilder builder;
    std::vector<std::int64_t> corners;
    for (; !scanner.at_end(); scanner.next_line()) {
        if (scanner.line_ended()) continue;
        const char* line = scanner.position();
        const std::string_view keyword = scanner.word();
        if (keyword == "v") {
            Vec3 x;
            for (int axis = 0; axis < 3; ++axis) {
                record_ended(scanner);
                x[axis] = scanner.real("a coordinate of a vertex");
            }
            builder.add_vertex(x);
        } else if (keyword == "f" || keyword == "fo") {
            corners.clear();
            while (!record_ended(scanner)) corners.push_back(corner_of(scanner, builder.vertex_count()));
            if (corners.size() < 3) scanner.fail("a face needs at least three corners, this has " + std::to_string(corners.size()), line);
            builder.add_polygon(corners, line);
        } else if (is_one_of(keyword, {"curv", "curv2", "surf", "parm", "cstype", "deg"})) {
            scanner.fail("curves and free-form surfaces are not read; export the object as polygons", line, ErrorCode::unsupported);
        } else if (keyword.front() != '#') {
            while (!record_ended(scanner)) scanner.word();
        }
    }
    return builder.finish(scanner, 1);
}

std::string format_obj(const mesh::TriangleMesh& mesh) {
    mesh::require_sound(mesh);
    std::string out = "# " + std::to_string(mesh.vertices.size()) + " vertices, " + std::to_string(mesh.triangles.size()) + " triangles\n";
    for (const Vec3& x : mesh.vertices) {
        out += "v ";
        append(out, x);
        out += '\n';
    }
    for (const Triangle& t : mesh.triangles) {
        out += 'f';
        for (const std::int32_t v : t) {
            out += ' ';
            append(out, v + std::int64_t(1));
        }
        out += '\n';
    }
    return out;
}

}  // namespace supple::io
