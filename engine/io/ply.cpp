// PLY: a text head that declares elements and their properties, then the values, as text or as bytes of either order.
#include <limits>

#include "supple/io/binary_scanner.h"
#include "supple/io/number_text.h"
#include "supple/io/surface_builder.h"
#include "supple/io/surface_formats.h"
#include "supple/mesh/surface_check.h"

namespace supple::io {

namespace {

constexpr std::int64_t kBig = std::numeric_limits<std::int64_t>::max();

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct TypeName {
    const char *name, *other;
    Type type;
    std::size_t bytes;
};
constexpr TypeName kTypes[] = {
    {"char", "int8", Type::int8, 1},        {"uchar", "uint8", Type::uint8, 1},      {"short", "int16", Type::int16, 2},
    {"ushort", "uint16", Type::uint16, 2},  {"int", "int32", Type::int32, 4},        {"uint", "uint32", Type::uint32, 4},
    {"float", "float32", Type::float32, 4}, {"double", "float64", Type::float64, 8},
};

struct Property {
    std::string name;
    bool is_list = false;
    Type length = Type::uint8, value = Type::float32;
};
struct Element {
    std::string name;
    std::int64_t count;
    std::vector<Property> properties;
};

enum class Encoding { ascii, little, big };

struct Head {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
};

Type read_type(TextScanner& scanner) {
    const char* position = scanner.position();
    const std::string_view word = scanner.word();
    for (const TypeName& row : kTypes)
        if (word == row.name || word == row.other) return row.type;
    scanner.fail("a type such as float, uchar or int32 was expected, found " + quoted(word), position);
}

Encoding read_encoding(TextScanner& scanner) {
    scanner.line_ended();
    const char* position = scanner.position();
    const std::string_view word = scanner.word();
    if (word == "ascii") return Encoding::ascii;
    if (word == "binary_little_endian") return Encoding::little;
    if (word == "binary_big_endian") return Encoding::big;
    scanner.fail("the format must be ascii, binary_little_endian or binary_big_endian, found " + quoted(word), position);
}

Property read_property(TextScanner& scanner) {
    Property property;
    scanner.line_ended();
    const char* position = scanner.position();
    if (scanner.word() == "list") {
        property.is_list = true;
        property.length = read_type(scanner);
        if (property.length == Type::float32 || property.length == Type::float64)
            scanner.fail("the length of a list must be a whole number's type", position);
    } else {
        scanner.seek(position);
    }
    property.value = read_type(scanner);
    property.name = std::string(scanner.word());
    if (property.name.empty()) scanner.fail("the property has no name", position);
    return property;
}

/// Leaves the scanner behind the end_header line.
Head read_head(TextScanner& scanner) {
    Head head;
    bool has_format = false;
    scanner.word();  // "ply"
    scanner.next_line();
    for (;; scanner.next_line()) {
        scanner.skip_space();
        if (scanner.at_end()) scanner.fail("the head has no end_header: the file is truncated");
        const char* position = scanner.position();
        const std::string_view keyword = scanner.word();
        if (keyword == "end_header") break;
        if (keyword == "format") {
            head.encoding = read_encoding(scanner);
            has_format = true;
        } else if (keyword == "element") {
            const std::string_view title = scanner.word();
            head.elements.push_back({std::string(title), scanner.integer("the number of elements", 0, kBig), {}});
        } else if (keyword == "property") {
            if (head.elements.empty()) scanner.fail("a property stands before the first element", position);
            head.elements.back().properties.push_back(read_property(scanner));
        } else if (keyword != "comment" && keyword != "obj_info") {
            scanner.fail("unknown line " + quoted(keyword) + " in the head", position);
        }
    }
    scanner.next_line();
    if (!has_format) scanner.fail("the head has no format line");
    return head;
}

/// Values as text.
class TextValues {
public:
    explicit TextValues(TextScanner& scanner) : scanner_(scanner) {}
    double number(Type) {
        scanner_.skip_space();
        return scanner_.real("a value of an element");
    }
    std::int64_t whole(Type) {
        scanner_.skip_space();
        return scanner_.integer("a number of an element");
    }
    void skip_list(std::int64_t count, Type type) {
        for (std::int64_t i = 0; i < count; ++i) number(type);
    }
    void require(std::int64_t count, const Element& element) const {
        std::uint64_t words = element.properties.size();
        if (words > 0 && std::uint64_t(count) > (scanner_.bytes_left() + 1) / (2 * words))
            scanner_.fail("the head announces " + std::to_string(count) + " of element " + io::quoted(element.name) +
                          ", more than the file can hold: it is truncated, or the count is wrong");
    }
    [[noreturn]] void fail(const std::string& message) const { scanner_.fail(message); }
    const char* position() const { return scanner_.position(); }

private:
    TextScanner& scanner_;
};

/// Values as bytes.
class ByteValues {
public:
    explicit ByteValues(BinaryScanner& scanner) : scanner_(scanner) {}
    double number(Type type) {
        const char* what = "a value of an element";
        switch (type) {
            case Type::int8:
                return double(scanner_.read<std::int8_t>(what));
            case Type::uint8:
                return double(scanner_.read<std::uint8_t>(what));
            case Type::int16:
                return double(scanner_.read<std::int16_t>(what));
            case Type::uint16:
                return double(scanner_.read<std::uint16_t>(what));
            case Type::int32:
                return double(scanner_.read<std::int32_t>(what));
            case Type::uint32:
                return double(scanner_.read<std::uint32_t>(what));
            case Type::float32:
                return double(scanner_.read<float>(what));
            case Type::float64:
                return scanner_.read<double>(what);
        }
        return 0;
    }
    std::int64_t whole(Type type) {
        const double value = number(type);
        if (!(value >= -9e15 && value <= 9e15) || value != double(std::int64_t(value))) fail("a whole number was expected");
        return std::int64_t(value);
    }
    void skip_list(std::int64_t count, Type type) { scanner_.skip(std::uint64_t(count) * kTypes[int(type)].bytes, "a list"); }
    void require(std::int64_t count, const Element& element) const {
        std::uint64_t bytes = 0;
        for (const Property& p : element.properties) bytes += kTypes[int(p.is_list ? p.length : p.value)].bytes;
        scanner_.require(std::uint64_t(count), bytes, "of element " + io::quoted(element.name));
    }
    [[noreturn]] void fail(const std::string& message) const { scanner_.fail(message); }
    const char* position() const { return nullptr; }

private:
    BinaryScanner& scanner_;
};

template <class Values>
void read_vertices(Values& values, const Element& element, SurfaceBuilder& builder) {
    int axis_of[3] = {-1, -1, -1};
    for (std::size_t p = 0; p < element.properties.size(); ++p)
        for (int axis = 0; axis < 3; ++axis)
            if (element.properties[p].name == std::string(1, "xyz"[axis]) && !element.properties[p].is_list) axis_of[axis] = int(p);
    for (int axis = 0; axis < 3; ++axis)
        if (axis_of[axis] < 0) values.fail("the vertices have no property " + io::quoted(std::string(1, "xyz"[axis])));
    builder.reserve_vertices(std::size_t(element.count));
    for (std::int64_t i = 0; i < element.count; ++i) {
        Vec3 x = Vec3::Zero();
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const Property& property = element.properties[p];
            if (property.is_list) {
                const std::int64_t length = values.whole(property.length);
                if (length > 0) values.skip_list(length, property.value);
                continue;
            }
            const double value = values.number(property.value);
            for (int axis = 0; axis < 3; ++axis)
                if (axis_of[axis] == int(p)) x[axis] = value;
        }
        if (!x.allFinite()) values.fail("a coordinate of vertex " + std::to_string(i) + " is not a finite number");
        builder.add_vertex(x);
    }
}

/// A strip of triangles, every second one turned; -1 begins another strip.
void add_strip(SurfaceBuilder& builder, const std::vector<std::int64_t>& ids, const char* position) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (ids[i] == -1) {
            begin = i + 1;
            continue;
        }
        if (i < begin + 2) continue;
        const bool turned = (i - begin) % 2 == 1;
        const std::int64_t triangle[3] = {ids[turned ? i - 1 : i - 2], ids[turned ? i - 2 : i - 1], ids[i]};
        if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0]) builder.add_polygon(triangle, position);
    }
}

template <class Values>
void read_polygons(Values& values, const Element& element, SurfaceBuilder& builder, bool strips) {
    std::vector<std::int64_t> ids;
    for (std::int64_t i = 0; i < element.count; ++i) {
        for (const Property& property : element.properties) {
            if (!property.is_list) {
                values.number(property.value);
                continue;
            }
            const std::int64_t length = values.whole(property.length);
            if (length < 0) values.fail("the length of a list is " + std::to_string(length));
            if (property.name != "vertex_indices" && property.name != "vertex_index") {
                values.skip_list(length, property.value);
                continue;
            }
            const char* position = values.position();
            ids.clear();
            for (std::int64_t k = 0; k < length; ++k) ids.push_back(values.whole(property.value));
            strips ? add_strip(builder, ids, position) : builder.add_polygon(ids, position);
        }
    }
}

template <class Values>
void read_body(Values& values, const Head& head, SurfaceBuilder& builder) {
    for (const Element& element : head.elements) {
        if (element.properties.empty()) continue;
        values.require(element.count, element);
        if (element.name == "vertex") {
            read_vertices(values, element, builder);
        } else if (element.name == "face" || element.name == "tristrips") {
            read_polygons(values, element, builder, element.name == "tristrips");
        } else {
            for (std::int64_t i = 0; i < element.count; ++i) {
                for (const Property& p : element.properties) {
                    if (!p.is_list) {
                        values.number(p.value);
                    } else if (const std::int64_t length = values.whole(p.length); length > 0) {
                        values.skip_list(length, p.value);
                    }
                }
            }
        }
    }
}

std::string head_text(const mesh::TriangleMesh& mesh, const char* encoding) {
    return std::string("ply\nformat ") + encoding + " 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
           "\nproperty double x\nproperty double y\nproperty double z\nelement face " + std::to_string(mesh.triangles.size()) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
}

}  // namespace

mesh::TriangleMesh parse_ply(std::string_view bytes, const std::string& name) {
    TextScanner scanner(bytes, name);
    const Head head = read_head(scanner);
    SurfaceBuilder builder;
    if (head.encoding == Encoding::ascii) {
        TextValues values(scanner);
        read_body(values, head, builder);
        return builder.finish(scanner);
    }
    const std::endian order = head.encoding == Encoding::little ? std::endian::little : std::endian::big;
    BinaryScanner binary(bytes, name, order, std::size_t(scanner.position() - bytes.data()));
    ByteValues values(binary);
    read_body(values, head, builder);
    return builder.finish(scanner);
}

std::string format_ply_ascii(const mesh::TriangleMesh& mesh) {
    mesh::require_sound(mesh);
    std::string out = head_text(mesh, "ascii");
    append_lines(out, mesh);
    return out;
}

std::string format_ply_binary(const mesh::TriangleMesh& mesh) {
    mesh::require_sound(mesh);
    std::string out = head_text(mesh, "binary_little_endian");
    BinaryText numbers(out);
    for (const Vec3& x : mesh.vertices)
        for (int axis = 0; axis < 3; ++axis) numbers.add(x[axis]);
    for (const Triangle& t : mesh.triangles) {
        numbers.add(std::uint8_t(3));
        for (const std::int32_t v : t) numbers.add(v);
    }
    return out;
}

}  // namespace supple::io
