// Gmsh 1 and 2: one record per line, a flat list of nodes and one of elements.
#include <limits>

#include "supple/io/gmsh_parts.h"

namespace supple::io {

namespace {

constexpr std::int64_t kMostTags = 1 << 16;
constexpr std::int64_t kBig = std::numeric_limits<std::int64_t>::max();

std::int64_t read_count(TextScanner& scanner, const char* what) {
    scanner.skip_space();
    const std::int64_t count = scanner.integer(what, 0, kBig);
    scanner.end_line(what);
    return count;
}

/// "node 17 of 181": where in the list a truncated file stops. Made only for a message.
void check_not_ended(TextScanner& scanner, const char* what, std::int64_t index, std::int64_t count) {
    scanner.skip_space();
    if (!scanner.at_end()) return;
    scanner.fail(std::string(what) + " " + std::to_string(index + 1) + " of " + std::to_string(count) +
                 " was expected here: the file is truncated, or the count is wrong");
}

}  // namespace

void read_gmsh2_nodes(TextScanner& scanner, MeshBuilder& builder, bool parametric) {
    const std::int64_t count = read_count(scanner, "the number of nodes");
    builder.reserve_vertices(scanner.plausible(count, 8));  // "1 0 0 0\n"
    for (std::int64_t i = 0; i < count; ++i) {
        check_not_ended(scanner, "node", i, count);
        const char* line = scanner.position();
        const std::int64_t id = scanner.integer("the node number");
        Vec3 x;
        x[0] = scanner.real("the x coordinate");
        x[1] = scanner.real("the y coordinate");
        x[2] = scanner.real("the z coordinate");
        builder.add_vertex(id, x, line);
        if (parametric) {
            scanner.next_line();  // entity and parameters on it
        } else {
            scanner.end_line("the z coordinate");
        }
    }
}

void read_gmsh2_elements(TextScanner& scanner, MeshBuilder& builder, bool version1) {
    const std::int64_t count = read_count(scanner, "the number of elements");
    std::int64_t ids[kMostElementVertices];
    for (std::int64_t i = 0; i < count; ++i) {
        check_not_ended(scanner, "element", i, count);
        const char* line = scanner.position();
        scanner.integer("the element number");
        const ElementType& type = gmsh_element_type(scanner, line, scanner.integer("the element type"));
        std::int64_t physical = 0;
        if (version1) {
            physical = scanner.integer("the physical tag", std::numeric_limits<int>::min() + 1, std::numeric_limits<int>::max());
            scanner.integer("the elementary tag");
            scanner.integer("the number of nodes", type.vertex_count, type.vertex_count);
        } else {
            const std::int64_t tags = scanner.integer("the number of tags", 0, kMostTags);
            for (std::int64_t t = 0; t < tags; ++t) {
                const std::int64_t tag = scanner.integer("a tag", std::numeric_limits<int>::min() + 1, std::numeric_limits<int>::max());
                if (t == 0) physical = tag;
            }
        }
        for (int v = 0; v < type.vertex_count; ++v) ids[v] = scanner.integer("a node number of the element");
        scanner.end_line("the nodes of the element");
        if (physical < 0) physical = -physical;  // a negative tag says "reversed", not another group
        builder.add_element(scanner, line, type, {ids, std::size_t(type.vertex_count)}, {&physical, 1});
    }
}

}  // namespace supple::io
