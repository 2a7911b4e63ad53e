#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>

#include "supple/io/binary_scanner.h"
#include "supple/io/number_text.h"
#include "supple/io/surface_builder.h"
#include "supple/io/surface_formats.h"
#include "supple/mesh/surface_check.h"

namespace supple::io {

namespace {

constexpr std::size_t kHeader = 80, kRecord = 50;

bool is_word(std::string_view word, std::string_view wanted) {
    return std::equal(word.begin(), word.end(), wanted.begin(), wanted.end(),
                      [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

void expect(TextScanner& scanner, std::string_view wanted) {
    scanner.skip_space();
    const char* position = scanner.position();
    const std::string_view word = scanner.word();
    if (!is_word(word, wanted)) {
        if (word.empty()) scanner.fail("the file ends where \"" + std::string(wanted) + "\" was expected: it is truncated", position);
        scanner.fail("\"" + std::string(wanted) + "\" was expected, found " + quoted(word), position);
    }
}

Vec3 next_vector(TextScanner& scanner, const char* what) {
    Vec3 x;
    for (int axis = 0; axis < 3; ++axis) {
        scanner.skip_space();
        x[axis] = scanner.real(what);
    }
    return x;
}

mesh::TriangleMesh parse_ascii(std::string_view text, const std::string& name) {
    TextScanner scanner(text, name);
    SurfaceBuilder builder;
    for (scanner.skip_space(); !scanner.at_end(); scanner.skip_space()) {
        const char* position = scanner.position();
        const std::string_view word = scanner.word();
        if (is_word(word, "solid") || is_word(word, "endsolid") || is_word(word, "color")) {
            scanner.next_line();
            continue;
        }
        if (!is_word(word, "facet")) scanner.fail("\"facet\" was expected, found " + quoted(word), position);
        scanner.next_line();  // its normal: some programs write nan there, and it says nothing that the corners do not
        expect(scanner, "outer");
        expect(scanner, "loop");
        std::int32_t corner[3];
        for (std::int32_t& c : corner) {
            expect(scanner, "vertex");
            c = builder.weld_vertex(next_vector(scanner, "a coordinate of a vertex"));
        }
        expect(scanner, "endloop");
        expect(scanner, "endfacet");
        builder.add_triangle(corner[0], corner[1], corner[2]);
    }
    return builder.finish(scanner);
}

mesh::TriangleMesh parse_binary(std::string_view bytes, const std::string& name) {
    BinaryScanner scanner(bytes, name, std::endian::little);
    scanner.skip(kHeader, "the header");
    const auto count = scanner.read<std::uint32_t>("the number of triangles");
    scanner.require(count, kRecord, "triangles");
    SurfaceBuilder builder;
    for (std::uint32_t t = 0; t < count; ++t) {
        scanner.skip(12, "a normal");
        std::int32_t corner[3];
        for (std::int32_t& c : corner) {
            Vec3 x;
            for (int axis = 0; axis < 3; ++axis) x[axis] = double(scanner.read<float>("a vertex"));
            if (!x.allFinite()) scanner.fail("a coordinate of triangle " + std::to_string(t) + " is not a finite number");
            c = builder.weld_vertex(x);
        }
        scanner.skip(2, "the attribute of a triangle");
        builder.add_triangle(corner[0], corner[1], corner[2]);
    }
    return builder.finish(TextScanner({}, name));
}

Vec3 unit_normal(const mesh::TriangleMesh& mesh, const Triangle& t) {
    const Vec3 n = (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    const double length = n.norm();
    return length > 0 && std::isfinite(length) ? Vec3(n / length) : Vec3(Vec3::Zero());
}

}  // namespace

bool is_binary_stl(std::string_view bytes) {
    if (bytes.size() < kHeader + 4) return false;
    std::uint64_t count = 0;
    for (int i = 3; i >= 0; --i) count = 256 * count + static_cast<unsigned char>(bytes[kHeader + std::size_t(i)]);
    return bytes.size() == kHeader + 4 + kRecord * count;
}

mesh::TriangleMesh parse_stl(std::string_view bytes, const std::string& name) {
    if (is_binary_stl(bytes)) return parse_binary(bytes, name);
    // Not of the right size: ASCII if it looks so, otherwise a binary file that is truncated or has something behind it.
    TextScanner scanner(bytes, name);
    scanner.skip_space();
    return is_word(scanner.word(), "solid") ? parse_ascii(bytes, name) : parse_binary(bytes, name);
}

std::string format_stl_ascii(const mesh::TriangleMesh& mesh) {
    mesh::require_sound(mesh);
    std::string out = "solid supple\n";
    for (const Triangle& t : mesh.triangles) {
        out += "facet normal ";
        append(out, unit_normal(mesh, t));
        out += "\nouter loop\n";
        for (const std::int32_t v : t) {
            out += "vertex ";
            append(out, mesh.vertices[v]);
            out += '\n';
        }
        out += "endloop\nendfacet\n";
    }
    return out + "endsolid supple\n";
}

std::string format_stl_binary(const mesh::TriangleMesh& mesh) {
    mesh::require_sound(mesh);
    if (mesh.triangles.size() > 0xffffffffu)
        throw Error(ErrorCode::unsupported, "format_stl_binary", "more than 2^32 - 1 triangles; write PLY instead");
    std::string out = "binary STL";
    out.resize(kHeader, ' ');
    BinaryText numbers(out);
    numbers.add(std::uint32_t(mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles) {
        const Vec3 n = unit_normal(mesh, t);
        for (int axis = 0; axis < 3; ++axis) numbers.add(float(n[axis]));
        for (const std::int32_t v : t)
            for (int axis = 0; axis < 3; ++axis) numbers.add(float(mesh.vertices[v][axis]));
        numbers.add(std::uint16_t(0));
    }
    return out;
}

}  // namespace supple::io
