// Gmsh 2 and 4.1 as bytes: the same sections with their numbers stored as int32, uint64 and float64; in version 2 the counts are still
// text.
#include <cstdlib>
#include <limits>

#include "supple/io/binary_scanner.h"
#include "supple/io/gmsh_parts.h"

namespace supple::io {

namespace {

/// The section that a TextScanner stands in, as bytes; the TextScanner follows to where this has read.
class Bytes {
public:
    Bytes(TextScanner& scanner, std::endian order)
        : scanner_(scanner), begin_(scanner.position()), bytes_({begin_, scanner.bytes_left()}, scanner.name(), order) {}
    ~Bytes() { scanner_.seek(position()); }
    Bytes(const Bytes&) = delete;
    Bytes& operator=(const Bytes&) = delete;

    const char* position() const { return begin_ + bytes_.position(); }
    template <class T>
    T read(const char* what) {
        require(1, sizeof(T), what);
        return bytes_.read<T>(what);
    }
    void skip(std::uint64_t count, const char* what) {
        require(count, 1, what);
        bytes_.skip(count, what);
    }
    /// Refuses a count that the section cannot hold.
    void require(std::uint64_t count, std::uint64_t bytes_each, const char* what) const {
        if (count <= bytes_.bytes_left() / bytes_each) return;
        scanner_.fail("the file announces " + std::to_string(count) + " x " + what + ", but its section has only " +
                          std::to_string(bytes_.bytes_left()) + " bytes left: it is truncated, or the count is wrong",
                      position());
    }
    Vec3 vector(const char* what) {
        Vec3 x;
        const char* begin = position();
        for (int axis = 0; axis < 3; ++axis) x[axis] = read<double>(what);
        if (!x.allFinite()) scanner_.fail(std::string(what) + " is not a finite number", begin);
        return x;
    }
    std::int64_t tag(const char* what) {
        const char* begin = position();
        const auto value = read<std::uint64_t>(what);
        if (value > std::uint64_t(std::numeric_limits<std::int64_t>::max())) scanner_.fail(std::string(what) + " is beyond 2^63", begin);
        return std::int64_t(value);
    }

private:
    TextScanner& scanner_;
    const char* begin_;
    BinaryScanner bytes_;
};

/// A count in text, on a line of its own before bytes.
std::uint64_t text_count(TextScanner& scanner, const char* what) {
    scanner.skip_space();
    const std::int64_t count = scanner.integer(what, 0, std::numeric_limits<std::int64_t>::max());
    scanner.end_line(what);
    return std::uint64_t(count);
}

}  // namespace

void read_gmsh2_nodes_binary(TextScanner& scanner, std::endian order, MeshBuilder& builder) {
    const std::uint64_t count = text_count(scanner, "the number of nodes");
    Bytes bytes(scanner, order);
    bytes.require(count, 28, "a node");
    builder.reserve_vertices(std::size_t(count));
    for (std::uint64_t i = 0; i < count; ++i) {
        const char* position = bytes.position();
        const auto id = bytes.read<std::int32_t>("the node number");
        builder.add_vertex(id, bytes.vector("a coordinate"), position);
    }
}

void read_gmsh2_elements_binary(TextScanner& scanner, std::endian order, MeshBuilder& builder) {
    const std::uint64_t total = text_count(scanner, "the number of elements");
    Bytes bytes(scanner, order);
    std::int64_t ids[kMostElementVertices];
    for (std::uint64_t done = 0; done < total;) {
        const char* head = bytes.position();
        const auto code = bytes.read<std::int32_t>("the element type");
        const auto count = bytes.read<std::int32_t>("the number of elements of a block");
        const auto tags = bytes.read<std::int32_t>("the number of tags");
        const ElementType& type = gmsh_element_type(scanner, head, code);
        if (count <= 0 || std::uint64_t(count) > total - done || tags < 0 || tags > 1 << 16)
            scanner.fail("a block of " + std::to_string(count) + " elements with " + std::to_string(tags) + " tags, where " +
                             std::to_string(total - done) + " elements are left",
                         head);
        bytes.require(std::uint64_t(count), 4 * std::uint64_t(1 + tags + type.vertex_count), "an element");
        for (std::int32_t i = 0; i < count; ++i) {
            const char* position = bytes.position();
            bytes.read<std::int32_t>("the element number");
            std::int64_t physical = 0;
            for (std::int32_t t = 0; t < tags; ++t) {
                const auto tag = bytes.read<std::int32_t>("a tag");
                if (t == 0) physical = std::abs(std::int64_t(tag));
            }
            for (int v = 0; v < type.vertex_count; ++v) ids[v] = bytes.read<std::int32_t>("a node number of the element");
            builder.add_element(scanner, position, type, {ids, std::size_t(type.vertex_count)}, {&physical, 1});
        }
        done += std::uint64_t(count);
    }
}

GmshEntities read_gmsh4_entities_binary(TextScanner& scanner, std::endian order) {
    Bytes bytes(scanner, order);
    std::uint64_t counts[4];
    for (std::uint64_t& count : counts) count = bytes.read<std::uint64_t>("the number of entities");
    GmshEntities entities;
    for (int dimension = 0; dimension < 4; ++dimension) {
        bytes.require(counts[dimension], dimension == 0 ? 36 : 68, "an entity");
        for (std::uint64_t i = 0; i < counts[dimension]; ++i) {
            const auto tag = bytes.read<std::int32_t>("the entity tag");
            bytes.skip(dimension == 0 ? 24 : 48, "the bounds of the entity");
            const auto physical_count = bytes.read<std::uint64_t>("the number of physical groups");
            bytes.require(physical_count, 4, "a physical tag");
            std::vector<std::int64_t> physicals;
            for (std::uint64_t p = 0; p < physical_count; ++p)
                physicals.push_back(std::abs(std::int64_t(bytes.read<std::int32_t>("a physical tag"))));
            if (dimension > 0) {
                const auto bounds = bytes.read<std::uint64_t>("the number of bounding entities");
                bytes.require(bounds, 4, "a bounding entity");
                bytes.skip(4 * bounds, "the bounding entities");
            }
            if (!physicals.empty()) entities[{dimension, tag}] = std::move(physicals);
        }
    }
    return entities;
}

void read_gmsh4_nodes_binary(TextScanner& scanner, std::endian order, MeshBuilder& builder) {
    Bytes bytes(scanner, order);
    const auto blocks = bytes.read<std::uint64_t>("the number of node blocks");
    const auto total = bytes.read<std::uint64_t>("the number of nodes");
    bytes.skip(16, "the least and the largest tag");
    bytes.require(blocks, 20, "a node block");
    bytes.require(total, 32, "a node");
    builder.reserve_vertices(std::size_t(total));
    std::vector<std::int64_t> ids;
    std::uint64_t done = 0;
    for (std::uint64_t block = 0; block < blocks; ++block) {
        const char* head = bytes.position();
        const auto dimension = bytes.read<std::int32_t>("the dimension of the entity");
        bytes.skip(4, "the entity tag");
        const auto parametric = bytes.read<std::int32_t>("the parametric mark");
        const auto count = bytes.read<std::uint64_t>("the number of nodes of the block");
        if (dimension < 0 || dimension > 3) scanner.fail("the dimension of an entity is " + std::to_string(dimension), head);
        if (count > total - done)
            scanner.fail("a block of " + std::to_string(count) + " nodes, where " + std::to_string(total - done) + " are left", head);
        const std::uint64_t parameters = parametric != 0 ? 8 * std::uint64_t(dimension) : 0;
        bytes.require(count, 32 + parameters, "a node");
        ids.clear();
        for (std::uint64_t i = 0; i < count; ++i) ids.push_back(bytes.tag("a node tag"));
        for (std::uint64_t i = 0; i < count; ++i) {
            const char* position = bytes.position();
            builder.add_vertex(ids[std::size_t(i)], bytes.vector("a coordinate"), position);
            bytes.skip(parameters, "the parameters of a node");
        }
        done += count;
    }
    if (done != total)
        scanner.fail("the blocks hold " + std::to_string(done) + " nodes, but the head of the section announces " + std::to_string(total),
                     bytes.position());
}

void read_gmsh4_elements_binary(TextScanner& scanner, std::endian order, MeshBuilder& builder, const GmshEntities& entities) {
    Bytes bytes(scanner, order);
    const auto blocks = bytes.read<std::uint64_t>("the number of element blocks");
    const auto total = bytes.read<std::uint64_t>("the number of elements");
    bytes.skip(16, "the least and the largest tag");
    bytes.require(blocks, 20, "an element block");
    std::int64_t ids[kMostElementVertices];
    std::uint64_t done = 0;
    for (std::uint64_t block = 0; block < blocks; ++block) {
        const char* head = bytes.position();
        const auto dimension = bytes.read<std::int32_t>("the dimension of the entity");
        const auto entity = bytes.read<std::int32_t>("the entity tag");
        const ElementType& type = gmsh_element_type(scanner, head, bytes.read<std::int32_t>("the element type"));
        const auto count = bytes.read<std::uint64_t>("the number of elements of the block");
        if (type.dimension != dimension)
            scanner.fail("a " + std::string(type.name) + " cannot lie in an entity of dimension " + std::to_string(dimension), head);
        if (count > total - done)
            scanner.fail("a block of " + std::to_string(count) + " elements, where " + std::to_string(total - done) + " are left", head);
        bytes.require(count, 8 * std::uint64_t(1 + type.vertex_count), "an element");
        const auto found = entities.find({dimension, entity});
        const std::span<const std::int64_t> physicals = found == entities.end() ? std::span<const std::int64_t>() : found->second;
        for (std::uint64_t i = 0; i < count; ++i) {
            const char* position = bytes.position();
            bytes.skip(8, "the element tag");
            for (int v = 0; v < type.vertex_count; ++v) ids[v] = bytes.tag("a node tag of the element");
            builder.add_element(scanner, position, type, {ids, std::size_t(type.vertex_count)}, physicals);
        }
        done += count;
    }
    if (done != total)
        scanner.fail(
            "the blocks hold " + std::to_string(done) + " elements, but the head of the section announces " + std::to_string(total),
            bytes.position());
}

}  // namespace supple::io
