#include "supple/io/skin_file.h"

#include "supple/io/binary_file.h"
#include "supple/io/binary_scanner.h"
#include "supple/io/surface_file.h"
#include "supple/io/text_scanner.h"

namespace supple::io {

namespace {

constexpr const char* kTitle = "supple_skin";

void add_vector(BinaryText& bytes, const Vec3& x) {
    for (int axis = 0; axis < 3; ++axis) bytes.add(float(x[axis]));
}

mesh::TriangleMesh parse_skin(const std::string& text, const std::string& name) {
    TextScanner scanner(text, name);
    if (scanner.word() != kTitle || scanner.integer("the version") != 1) scanner.fail("a skin file begins with \"supple_skin 1\"");
    scanner.next_line();
    std::int64_t counts[4];
    constexpr const char* kNames[4] = {"vertices", "triangles", "corners", "mesh_vertices"};
    for (int i = 0; i < 4; ++i) {
        if (scanner.word() != kNames[i]) scanner.fail(std::string("the line \"") + kNames[i] + " <count>\" must stand here");
        counts[i] = scanner.integer("the count", 0, std::int64_t(1) << 31);
        scanner.end_line(kNames[i]);
    }
    if (scanner.word() != "end_head") scanner.fail("the line \"end_head\" must stand here");
    scanner.next_line();
    BinaryScanner bytes(text, name, std::endian::little, std::size_t(scanner.position() - text.data()));
    bytes.require(std::uint64_t(counts[0]), 24, "vertices");
    mesh::TriangleMesh surface;
    surface.vertices.resize(std::size_t(counts[0]));
    for (Vec3& x : surface.vertices)
        for (int axis = 0; axis < 3; ++axis) x[axis] = bytes.read<float>("the positions");
    bytes.skip(std::uint64_t(counts[0]) * 12, "the normals");
    bytes.require(std::uint64_t(counts[1]), 12, "triangles");
    surface.triangles.resize(std::size_t(counts[1]));
    for (Triangle& t : surface.triangles)
        for (std::int32_t& v : t) {
            v = bytes.read<std::int32_t>("the triangles");
            if (v < 0 || v >= counts[0]) bytes.fail("vertex " + std::to_string(v) + " is outside [0, " + std::to_string(counts[0]) + ")");
        }
    return surface;
}

}  // namespace

std::string format_skin(const Skin& skin) {
    const mesh::TriangleMesh& surface = skin.surface();
    const Embedding& embedding = skin.embedding();
    std::string text = std::string(kTitle) + " 1\nvertices " + std::to_string(surface.vertices.size()) + "\ntriangles " + std::to_string(surface.triangles.size()) +
                       "\ncorners " + std::to_string(embedding.corners()) + "\nmesh_vertices " + std::to_string(skin.mesh_vertices()) + "\nend_head\n";
    BinaryText bytes(text);
    for (const Vec3& x : surface.vertices) add_vector(bytes, x);
    for (const Vec3& n : vertex_normals(surface)) add_vector(bytes, n);
    for (const Triangle& t : surface.triangles)
        for (const std::int32_t v : t) bytes.add(v);
    for (const std::int32_t e : embedding.elements()) bytes.add(e);
    for (const std::int32_t v : embedding.vertices()) bytes.add(v);
    for (const double w : embedding.weights()) bytes.add(float(w));
    for (const Vec3& g : embedding.gradients()) add_vector(bytes, g);
    return text;
}

void write_skin(const std::filesystem::path& file, const Skin& skin) { write_text_file(file, format_skin(skin)); }

mesh::TriangleMesh read_skin_surface(const std::filesystem::path& file) {
    if (file.extension() == ".skin") return parse_skin(read_text_file(file), file.string());
    return read_surface(file);
}

}  // namespace supple::io
