// Gmsh 4.1: nodes and elements in blocks, one per geometric entity; physical groups belong to the entities.
#include <cstdlib>
#include <limits>

#include "supple/io/gmsh_parts.h"

namespace supple::io {

namespace {

constexpr std::int64_t kBig = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kInt = std::numeric_limits<int>::max();

struct Header {
    std::int64_t blocks, records;
};

Header read_header(TextScanner& scanner, const char* records) {
    scanner.skip_space();
    Header header{};
    header.blocks = scanner.integer("the number of entity blocks", 0, kBig);
    header.records = scanner.integer(records, 0, kBig);
    scanner.integer("the least tag");
    scanner.integer("the largest tag");
    scanner.end_line("the head of the section");
    return header;
}

void check_not_ended(TextScanner& scanner, const char* what, std::int64_t index, std::int64_t count) {
    scanner.skip_space();
    if (!scanner.at_end()) return;
    scanner.fail(std::string(what) + " " + std::to_string(index + 1) + " of " + std::to_string(count) +
                 " was expected here: the file is truncated, or the count is wrong");
}

/// The count of a block may not exceed what the section's head leaves.
std::int64_t read_block_count(TextScanner& scanner, const char* what, std::int64_t done, std::int64_t total) {
    const char* position = scanner.position();
    const std::int64_t count = scanner.integer(what, 0, kBig);
    if (count > total - done) {
        scanner.fail(std::string(what) + " is " + std::to_string(count) + ", but the head of the section announces " +
                         std::to_string(total) + " in all, " + std::to_string(done) + " of them before this block",
                     position);
    }
    scanner.end_line("the head of the block");
    return count;
}

void check_total(TextScanner& scanner, const char* what, std::int64_t done, std::int64_t total) {
    if (done == total) return;
    scanner.fail("the blocks hold " + std::to_string(done) + " " + what + ", but the head of the section announces " +
                 std::to_string(total));
}

}  // namespace

GmshEntities read_gmsh4_entities(TextScanner& scanner) {
    scanner.skip_space();
    std::int64_t counts[4];
    for (std::int64_t& count : counts) count = scanner.integer("the number of entities", 0, kBig);
    scanner.end_line("the numbers of entities");
    GmshEntities entities;
    for (int dimension = 0; dimension < 4; ++dimension) {
        for (std::int64_t i = 0; i < counts[dimension]; ++i) {
            check_not_ended(scanner, "entity", i, counts[dimension]);
            const std::int64_t tag = scanner.integer("the entity tag");
            const int numbers = dimension == 0 ? 3 : 6;  // a point, or a bounding box
            for (int n = 0; n < numbers; ++n) scanner.real("a bound of the entity");
            const std::int64_t physical_count = scanner.integer("the number of physical groups", 0, kBig);
            std::vector<std::int64_t> physicals;
            for (std::int64_t p = 0; p < physical_count; ++p) {
                physicals.push_back(std::abs(scanner.integer("a physical tag", -kInt, kInt)));  // negative says "reversed"
            }
            scanner.next_line();  // the bounding entities
            if (!physicals.empty()) entities[{dimension, tag}] = std::move(physicals);
        }
    }
    return entities;
}

void read_gmsh4_nodes(TextScanner& scanner, MeshBuilder& builder) {
    const Header header = read_header(scanner, "the number of nodes");
    builder.reserve_vertices(scanner.plausible(header.records, 8));  // "1\n0 0 0\n"
    std::int64_t done = 0;
    std::vector<std::int64_t> ids;
    for (std::int64_t block = 0; block < header.blocks; ++block) {
        check_not_ended(scanner, "node block", block, header.blocks);
        scanner.integer("the dimension of the entity", 0, 3);
        scanner.integer("the entity tag");
        const bool parametric = scanner.integer("the parametric mark", 0, 1) == 1;
        const std::int64_t count = read_block_count(scanner, "the number of nodes of the block", done, header.records);
        ids.clear();
        ids.reserve(scanner.plausible(count, 8));
        for (std::int64_t i = 0; i < count; ++i) {
            check_not_ended(scanner, "node tag", i, count);
            ids.push_back(scanner.integer("the node tag"));
        }
        for (std::int64_t i = 0; i < count; ++i) {
            check_not_ended(scanner, "node", i, count);
            const char* line = scanner.position();
            Vec3 x;
            x[0] = scanner.real("the x coordinate");
            x[1] = scanner.real("the y coordinate");
            x[2] = scanner.real("the z coordinate");
            if (parametric) {
                scanner.next_line();
            } else {
                scanner.end_line("the z coordinate");
            }
            builder.add_vertex(ids[std::size_t(i)], x, line);
        }
        done += count;
    }
    check_total(scanner, "nodes", done, header.records);
}

void read_gmsh4_elements(TextScanner& scanner, MeshBuilder& builder, const GmshEntities& entities) {
    const Header header = read_header(scanner, "the number of elements");
    std::int64_t done = 0;
    std::int64_t ids[kMostElementVertices];
    for (std::int64_t block = 0; block < header.blocks; ++block) {
        check_not_ended(scanner, "element block", block, header.blocks);
        const char* head = scanner.position();
        const std::int64_t dimension = scanner.integer("the dimension of the entity", 0, 3);
        const std::int64_t entity = scanner.integer("the entity tag");
        const ElementType& type = gmsh_element_type(scanner, head, scanner.integer("the element type"));
        const std::int64_t count = read_block_count(scanner, "the number of elements of the block", done, header.records);
        if (type.dimension != dimension) {
            scanner.fail("a " + std::string(type.name) + " cannot lie in an entity of dimension " + std::to_string(dimension), head);
        }
        const auto found = entities.find({int(dimension), entity});
        const std::span<const std::int64_t> physicals = found == entities.end() ? std::span<const std::int64_t>() : found->second;
        for (std::int64_t i = 0; i < count; ++i) {
            check_not_ended(scanner, "element", i, count);
            const char* line = scanner.position();
            scanner.integer("the element tag");
            for (int v = 0; v < type.vertex_count; ++v) ids[v] = scanner.integer("a node tag of the element");
            scanner.end_line("the nodes of the element");
            builder.add_element(scanner, line, type, {ids, std::size_t(type.vertex_count)}, physicals);
        }
        done += count;
    }
    check_total(scanner, "elements", done, header.records);
}

}  // namespace supple::io
