// What every writer asks of a mesh before the first byte.
#include <set>

#include "supple/base/error.h"
#include "supple/io/volume_formats.h"

namespace supple::io {

void require_writable_mesh(const VolumeMesh& mesh, const std::string& writer) {
    const auto refuse = [&](const std::string& where, const std::string& message) {
        throw Error(ErrorCode::invalid_argument, writer + ": VolumeMesh." + where, message);
    };
    const auto check_name = [&](const std::string& name, const std::string& where) {
        if (name.empty() || name.find_first_of("\r\n") != std::string::npos) refuse(where, "a name must not be empty or hold a line break");
    };
    const auto check_index = [&](std::int32_t v, const char* field) {
        if (v < 0 || std::size_t(v) >= mesh.vertices.size())
            refuse(field, "vertex " + std::to_string(v) + " is outside [0, " + std::to_string(mesh.vertices.size()) + ")");
    };
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        if (!mesh.vertices[i].allFinite()) refuse("vertices[" + std::to_string(i) + "]", "a coordinate is not finite");
    for (const Tet& tet : mesh.tets)
        for (std::int32_t v : tet) check_index(v, "tets");
    for (const Hex& hex : mesh.hexes)
        for (std::int32_t v : hex) check_index(v, "hexes");
    const std::size_t labels = mesh.element_region.size();
    if (labels != 0 && labels != mesh.element_count())
        refuse("element_region", "has " + std::to_string(labels) + " entries for " + std::to_string(mesh.element_count()) +
                                     " elements; give one each, or none");
    for (std::int32_t r : mesh.element_region)
        if (r < -1 || r >= std::int32_t(mesh.regions.size())) refuse("element_region", "region " + std::to_string(r) + " does not exist");
    for (const Region& region : mesh.regions) check_name(region.name, "regions");
    for (const VertexGroup& group : mesh.groups) {
        check_name(group.name, "groups");
        for (std::int32_t v : group.vertices) check_index(v, "groups");
    }
}

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

std::vector<int> element_tags(const VolumeMesh& mesh) {
    const std::vector<int> tags = region_tags(mesh);
    std::vector<int> result(mesh.element_count(), 0);
    for (std::size_t e = 0; e < mesh.element_region.size(); ++e)
        if (mesh.element_region[e] >= 0) result[e] = tags[std::size_t(mesh.element_region[e])];
    return result;
}

}  // namespace supple::io
