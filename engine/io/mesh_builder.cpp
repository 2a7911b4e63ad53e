#include "supple/io/mesh_builder.h"

#include <algorithm>
#include <limits>

#include "supple/io/polygon.h"
#include "supple/io/refusals.h"
#include "supple/mesh/surface.h"

namespace supple::io {

namespace {

constexpr std::size_t kMostVertices = std::size_t(std::numeric_limits<std::int32_t>::max());

void sort_unique(std::vector<std::int32_t>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

void MeshBuilder::name_group(int dimension, std::int64_t tag, std::string name) {
    groups_[std::size_t(group(dimension, tag))].name = std::move(name);
}

std::int32_t MeshBuilder::group(int dimension, std::int64_t tag) {
    const std::pair key(dimension, tag);
    if (key == last_key_) return last_group_;
    const auto [entry, is_new] = group_index_.try_emplace(key, std::int32_t(groups_.size()));
    if (is_new) {
        static const char* const kPrefix[] = {"point_", "curve_", "surface_", "region_"};
        groups_.push_back({dimension, tag, kPrefix[dimension] + std::to_string(tag), false, {}});
    }
    last_key_ = key;
    return last_group_ = entry->second;
}

void MeshBuilder::reserve_vertices(std::size_t count) {
    mesh_.vertices.reserve(mesh_.vertices.size() + count);
    ids_.reserve(ids_.size() + count);
    positions_.reserve(positions_.size() + count);
}

void MeshBuilder::add_vertex(std::int64_t id, const Vec3& x, const char* position) {
    ids_.push_back(id);
    positions_.push_back(position);
    mesh_.vertices.push_back(x);
}

void MeshBuilder::close_vertices(const TextScanner& scanner) {
    if (ids_.empty()) return;
    if (ids_.size() > kMostVertices) scanner.fail("more than 2^31 - 1 nodes", positions_.back());
    const auto [low, high] = std::minmax_element(ids_.begin(), ids_.end());
    first_id_ = *low;
    const std::uint64_t span = std::uint64_t(*high) - std::uint64_t(*low);
    const auto fail_repeated = [&](std::size_t i) {
        scanner.fail("node " + std::to_string(ids_[i]) + " is defined a second time", positions_[i]);
    };
    if (span < 4 * std::uint64_t(ids_.size()) + 1024) {
        dense_.assign(std::size_t(span) + 1, -1);
        for (std::size_t i = 0; i < ids_.size(); ++i) {
            std::int32_t& slot = dense_[std::size_t(ids_[i] - first_id_)];
            if (slot >= 0) fail_repeated(i);
            slot = std::int32_t(i);
        }
    } else {
        sparse_.reserve(ids_.size());
        for (std::size_t i = 0; i < ids_.size(); ++i) sparse_.emplace_back(ids_[i], std::int32_t(i));
        std::sort(sparse_.begin(), sparse_.end());
        for (std::size_t i = 1; i < sparse_.size(); ++i) {
            if (sparse_[i].first == sparse_[i - 1].first) fail_repeated(std::size_t(sparse_[i].second));
        }
    }
    positions_ = {};
    ids_ = {};
}

std::int32_t MeshBuilder::vertex(std::int64_t id) const {
    if (!dense_.empty()) {
        const std::uint64_t offset = std::uint64_t(id) - std::uint64_t(first_id_);
        return offset < dense_.size() ? dense_[std::size_t(offset)] : -1;
    }
    const auto found =
        std::lower_bound(sparse_.begin(), sparse_.end(), id, [](const auto& entry, std::int64_t value) { return entry.first < value; });
    return found != sparse_.end() && found->first == id ? found->second : -1;
}

std::int32_t MeshBuilder::known_vertex(const TextScanner& scanner, const char* position, std::int64_t id) const {
    const std::int32_t v = vertex(id);
    if (v < 0) scanner.fail("the element uses node " + std::to_string(id) + ", which the file does not define", position);
    return v;
}

void MeshBuilder::add_element(const TextScanner& scanner, const char* position, const ElementType& type, std::span<const std::int64_t> ids,
                              std::span<const std::int64_t> physicals) {
    std::int32_t corner[kMostElementVertices];
    for (std::size_t i = 0; i < ids.size(); ++i) corner[i] = known_vertex(scanner, position, ids[i]);
    const std::span<const std::int32_t> corners(corner, ids.size());
    std::int32_t region = -1;
    for (std::int64_t tag : physicals) {
        if (tag == 0) continue;
        const std::int32_t g = group(type.dimension, tag);
        if (type.dimension == 3 && region < 0) {
            region = g;
            continue;
        }
        Group& other = groups_[std::size_t(g)];
        if (g == region) continue;
        other.overlaps = type.dimension == 3;
        other.vertices.insert(other.vertices.end(), corners.begin(), corners.end());
    }
    if (type.code == 4) {
        mesh_.tets.push_back({corner[0], corner[1], corner[2], corner[3]});
        tet_group_.push_back(region);
    } else if (type.code == 5) {
        Hex& hex = mesh_.hexes.emplace_back();
        std::copy_n(corner, 8, hex.begin());
        hex_group_.push_back(region);
    } else {
        ++lower_count_[type.dimension];
        if (type.code != 2 && type.code != 3) return;
        polygon_corners_.insert(polygon_corners_.end(), corners.begin(), corners.end());
        polygon_ends_.push_back(polygon_corners_.size());
    }
}

void MeshBuilder::add_polygon(const TextScanner& scanner, const char* position, std::span<const std::int64_t> ids) {
    for (const std::int64_t id : ids) polygon_corners_.push_back(known_vertex(scanner, position, id));
    polygon_ends_.push_back(polygon_corners_.size());
    ++lower_count_[2];
}

void MeshBuilder::add_vertex_group(const TextScanner& scanner, const char* position, std::string name, std::span<const std::int64_t> ids) {
    Group& added = groups_.emplace_back(Group{0, 0, std::move(name), false, {}});
    for (const std::int64_t id : ids) added.vertices.push_back(known_vertex(scanner, position, id));
}

mesh::TriangleMesh MeshBuilder::finish_surface(const std::string& name) {
    mesh::TriangleMesh surface;
    if (mesh_.element_count() > 0) {
        VolumeMesh volume = finish(name);
        check_and_repair(volume);
        surface.triangles = extract_boundary(volume).triangles;
        std::vector<std::int32_t> number(volume.vertices.size(), -1);
        for (const Triangle& t : surface.triangles)
            for (const std::int32_t v : t) number[std::size_t(v)] = 0;
        for (std::size_t v = 0; v < number.size(); ++v) {
            if (number[v] < 0) continue;
            number[v] = std::int32_t(surface.vertices.size());
            surface.vertices.push_back(volume.vertices[v]);
        }
        for (Triangle& t : surface.triangles)
            for (std::int32_t& v : t) v = number[std::size_t(v)];
        return surface;
    }
    surface.vertices = std::move(mesh_.vertices);
    std::size_t begin = 0;
    for (const std::size_t end : polygon_ends_) {
        append_polygon({polygon_corners_.data() + begin, end - begin}, surface.vertices, surface.triangles);
        begin = end;
    }
    if (surface.triangles.empty()) throw Error(ErrorCode::parse, name, "the file holds no triangles, polygons or volume elements");
    return surface;
}

void MeshBuilder::set_fill(const TextScanner& scanner, const char* position, std::vector<double> fill) {
    if (fill.size() != mesh_.element_count())
        scanner.fail("the element data \"fill\" has " + std::to_string(fill.size()) + " values for " + std::to_string(mesh_.element_count()) +
                         " volume elements; it needs one each",
                     position);
    mesh_.fill = std::move(fill);
}

VolumeMesh MeshBuilder::finish(const std::string& name) {
    if (mesh_.element_count() == 0) refuse_empty(name);
    if (mesh_.element_count() > kMostVertices) throw Error(ErrorCode::unsupported, name, "more than 2^31 - 1 elements");
    mesh_.source = name;
    finish_regions(mesh_);
    finish_groups(mesh_);
    return std::move(mesh_);
}

void MeshBuilder::finish_regions(VolumeMesh& mesh) {
    tet_group_.insert(tet_group_.end(), hex_group_.begin(), hex_group_.end());
    std::vector<bool> has_elements(groups_.size(), false);
    for (std::int32_t g : tet_group_) {
        if (g >= 0) has_elements[std::size_t(g)] = true;
    }
    std::vector<std::int32_t> region_of(groups_.size(), -1);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const Group& group = groups_[g];
        if (group.dimension < 3 || (group.overlaps && !has_elements[g])) continue;
        region_of[g] = std::int32_t(mesh.regions.size());
        mesh.regions.push_back({group.name, int(group.tag)});
    }
    if (mesh.regions.empty()) return;
    mesh.element_region.resize(tet_group_.size());
    for (std::size_t e = 0; e < tet_group_.size(); ++e) {
        mesh.element_region[e] = tet_group_[e] < 0 ? -1 : region_of[std::size_t(tet_group_[e])];
    }
}

void MeshBuilder::finish_groups(VolumeMesh& mesh) {
    // A volume group that shares elements with another one is given as vertices too: all of them, not only those of its own elements.
    for (std::size_t e = 0; e < tet_group_.size(); ++e) {
        if (tet_group_[e] < 0 || !groups_[std::size_t(tet_group_[e])].overlaps) continue;
        std::vector<std::int32_t>& list = groups_[std::size_t(tet_group_[e])].vertices;
        if (e < mesh.tets.size()) {
            list.insert(list.end(), mesh.tets[e].begin(), mesh.tets[e].end());
        } else {
            const Hex& hex = mesh.hexes[e - mesh.tets.size()];
            list.insert(list.end(), hex.begin(), hex.end());
        }
    }
    for (Group& group : groups_) {
        if (group.dimension == 3 && !group.overlaps) continue;
        // Gmsh allows one name per dimension; to a user it is one group.
        auto same = std::find_if(mesh.groups.begin(), mesh.groups.end(), [&](const VertexGroup& g) { return g.name == group.name; });
        if (same == mesh.groups.end()) {
            mesh.groups.push_back({std::move(group.name), std::move(group.vertices)});
        } else {
            same->vertices.insert(same->vertices.end(), group.vertices.begin(), group.vertices.end());
        }
    }
    for (VertexGroup& group : mesh.groups) sort_unique(group.vertices);
}

void MeshBuilder::refuse_empty(const std::string& name) const {
    if (lower_count_[2] > 0) throw surface_error(name, std::to_string(lower_count_[2]) + " triangles or quadrangles");
    const std::size_t thin = lower_count_[0] + lower_count_[1];
    if (thin > 0) throw surface_error(name, "only " + std::to_string(thin) + " line and point elements");
    throw Error(ErrorCode::parse, name, "the file holds no elements; a volume mesh needs tetrahedra or hexahedra");
}

}  // namespace supple::io
