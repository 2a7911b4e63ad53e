#include <charconv>
#include <cmath>
#include <set>

#include "supple/base/error.h"
#include "supple/io/gmsh.h"

namespace supple::io {

namespace {

[[noreturn]] void refuse(const std::string& where, const std::string& message) {
    throw Error(ErrorCode::invalid_argument, "write_gmsh: VolumeMesh." + where, message);
}

void append(std::string& text, std::int64_t value) {
    char digits[24];
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

void append(std::string& text, double value) {
    char digits[40];
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 17).ptr);
}

void check_name(const std::string& name, const std::string& where) {
    if (name.empty() || name.find_first_of("\r\n") != std::string::npos) refuse(where, "a name must not be empty or hold a line break");
}

void check(const VolumeMesh& mesh) {
    const auto check_index = [&](std::int32_t v, const char* field) {
        if (v < 0 || std::size_t(v) >= mesh.vertices.size()) {
            refuse(field, "vertex " + std::to_string(v) + " is outside [0, " + std::to_string(mesh.vertices.size()) + ")");
        }
    };
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        if (!mesh.vertices[i].allFinite()) refuse("vertices[" + std::to_string(i) + "]", "a coordinate is not finite");
    }
    for (const Tet& tet : mesh.tets) {
        for (std::int32_t v : tet) check_index(v, "tets");
    }
    for (const Hex& hex : mesh.hexes) {
        for (std::int32_t v : hex) check_index(v, "hexes");
    }
    const std::size_t labels = mesh.element_region.size();
    if (labels != 0 && labels != mesh.element_count()) {
        refuse("element_region", "has " + std::to_string(labels) + " entries for " + std::to_string(mesh.element_count()) +
                                     " elements; give one each, or none");
    }
    for (std::int32_t r : mesh.element_region) {
        if (r < -1 || r >= std::int32_t(mesh.regions.size())) refuse("element_region", "region " + std::to_string(r) + " does not exist");
    }
    for (const Region& region : mesh.regions) check_name(region.name, "regions");
    for (const VertexGroup& group : mesh.groups) {
        check_name(group.name, "groups");
        for (std::int32_t v : group.vertices) check_index(v, "groups");
    }
}

/// The tags that go into the file: those of the mesh where they are positive and unique, free numbers for the others.
std::vector<int> region_tags(const VolumeMesh& mesh) {
    std::set<int> taken;
    std::vector<int> tags;
    for (const Region& region : mesh.regions) tags.push_back(region.tag > 0 && taken.insert(region.tag).second ? region.tag : 0);
    int next = 1;
    for (int& tag : tags) {
        if (tag != 0) continue;
        while (!taken.insert(next).second) ++next;
        tag = next;
    }
    return tags;
}

void append_names(std::string& text, const VolumeMesh& mesh, const std::vector<int>& tags) {
    if (mesh.regions.empty() && mesh.groups.empty()) return;
    text += "$PhysicalNames\n" + std::to_string(mesh.regions.size() + mesh.groups.size()) + "\n";
    for (std::size_t g = 0; g < mesh.groups.size(); ++g) text += "0 " + std::to_string(g + 1) + " \"" + mesh.groups[g].name + "\"\n";
    for (std::size_t r = 0; r < tags.size(); ++r) text += "3 " + std::to_string(tags[r]) + " \"" + mesh.regions[r].name + "\"\n";
    text += "$EndPhysicalNames\n";
}

/// "number type 2 physical elementary vertices"
template <class Vertices>
void append_element(std::string& text, std::int64_t number, int type, int physical, const Vertices& vertices) {
    append(text, number);
    text += ' ';
    append(text, std::int64_t(type));
    text += " 2 ";
    append(text, std::int64_t(physical));
    text += ' ';
    append(text, std::int64_t(physical > 0 ? physical : 1));
    for (std::int32_t v : vertices) {
        text += ' ';
        append(text, std::int64_t(v) + 1);
    }
    text += '\n';
}

}  // namespace

std::string format_gmsh(const VolumeMesh& mesh) {
    check(mesh);
    const std::vector<int> tags = region_tags(mesh);
    std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    text.reserve(64 * mesh.vertices.size() + 48 * mesh.element_count());
    append_names(text, mesh, tags);
    text += "$Nodes\n" + std::to_string(mesh.vertices.size()) + "\n";
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        append(text, std::int64_t(i) + 1);
        for (int axis = 0; axis < 3; ++axis) {
            text += ' ';
            append(text, mesh.vertices[i][axis]);
        }
        text += '\n';
    }
    std::size_t points = 0;
    for (const VertexGroup& group : mesh.groups) points += group.vertices.size();
    text += "$EndNodes\n$Elements\n" + std::to_string(mesh.element_count() + points) + "\n";
    std::int64_t number = 0;
    const auto physical = [&](std::size_t element) {
        if (mesh.element_region.empty() || mesh.element_region[element] < 0) return 0;
        return tags[std::size_t(mesh.element_region[element])];
    };
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) append_element(text, ++number, 4, physical(e), mesh.tets[e]);
    for (std::size_t e = 0; e < mesh.hexes.size(); ++e) append_element(text, ++number, 5, physical(mesh.tets.size() + e), mesh.hexes[e]);
    for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
        for (std::int32_t v : mesh.groups[g].vertices) append_element(text, ++number, 15, int(g) + 1, std::array<std::int32_t, 1>{v});
    }
    text += "$EndElements\n";
    return text;
}

}  // namespace supple::io
