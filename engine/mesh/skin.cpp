#include "supple/mesh/skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <string>

#include "supple/base/error.h"

namespace supple {

mesh::TriangleMesh weld(const mesh::TriangleMesh& surface, std::vector<std::int32_t>* kept) {
    const std::size_t count = surface.vertices.size();
    const auto refuse = [](const std::string& message) { throw Error(ErrorCode::invalid_argument, "surface", message); };
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (const std::int32_t v : surface.triangles[t])
            if (v < 0 || std::size_t(v) >= count)
                refuse("triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) + " of " + std::to_string(count));
    for (std::size_t v = 0; v < count; ++v)
        if (!surface.vertices[v].allFinite()) refuse("vertex " + std::to_string(v) + " is not finite");
    // Equal points become neighbours; each takes the name of the first of them.
    std::vector<std::int32_t> order(count), first(count);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        const Vec3 &x = surface.vertices[std::size_t(a)], &y = surface.vertices[std::size_t(b)];
        for (int k = 0; k < 3; ++k)
            if (x[k] != y[k]) return x[k] < y[k];
        return a < b;
    });
    for (std::size_t i = 0; i < count; ++i) {
        const auto v = std::size_t(order[i]);
        const bool same = i > 0 && surface.vertices[v] == surface.vertices[std::size_t(order[i - 1])];
        first[v] = same ? first[std::size_t(order[i - 1])] : order[i];
    }
    mesh::TriangleMesh out;
    std::vector<char> used(count, 0);
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
        Triangle t = surface.triangles[i];
        for (std::int32_t& v : t) v = first[std::size_t(v)];
        const auto X = [&](std::size_t a) -> const Vec3& { return surface.vertices[std::size_t(t[a])]; };
        if (!((X(1) - X(0)).cross(X(2) - X(0)).squaredNorm() > 0)) continue;
        out.triangles.push_back(t);
        if (kept != nullptr) kept->push_back(std::int32_t(i));
        for (const std::int32_t v : t) used[std::size_t(v)] = 1;
    }
    if (out.triangles.empty()) refuse("it has no triangle with an area");
    std::vector<std::int32_t> number(count, -1);
    for (std::size_t v = 0; v < count; ++v)
        if (used[v]) {
            number[v] = std::int32_t(out.vertices.size());
            out.vertices.push_back(surface.vertices[v]);
        }
    for (Triangle& t : out.triangles)
        for (std::int32_t& v : t) v = number[std::size_t(v)];
    return out;
}

std::vector<Vec3> vertex_normals(const mesh::TriangleMesh& surface) {
    std::vector<Vec3> normals(surface.vertices.size(), Vec3::Zero());
    for (const Triangle& t : surface.triangles) {
        const auto X = [&](std::size_t a) -> const Vec3& { return surface.vertices[std::size_t(t[a])]; };
        const Vec3 area = (X(1) - X(0)).cross(X(2) - X(0));
        for (const std::int32_t v : t) normals[std::size_t(v)] += area;
    }
    for (Vec3& n : normals) {
        const double length = n.norm();
        n = length > 0 ? Vec3(n / length) : Vec3(0, 0, 1);
    }
    return normals;
}

double area_of(const mesh::TriangleMesh& surface) {
    double sum = 0;
    for (const Triangle& t : surface.triangles) {
        const auto X = [&](std::size_t a) -> const Vec3& { return surface.vertices[std::size_t(t[a])]; };
        sum += 0.5 * (X(1) - X(0)).cross(X(2) - X(0)).norm();
    }
    return sum;
}

Skin::Skin(mesh::TriangleMesh surface, std::vector<TextureCorners> texture, const VolumeMesh& mesh)
    : surface_(std::move(surface)), texture_(std::move(texture)), embedding_(mesh, surface_.vertices), mesh_vertices_(mesh.vertices.size()) {}

std::shared_ptr<const Skin> Skin::build(const VolumeMesh& mesh, const mesh::TriangleMesh& surface, std::span<const TextureCorners> texture) {
    if (!texture.empty() && texture.size() != surface.triangles.size())
        throw Error(ErrorCode::invalid_argument, "texture", std::to_string(texture.size()) + " triangles for a surface of " + std::to_string(surface.triangles.size()));
    std::vector<std::int32_t> kept;
    mesh::TriangleMesh welded = weld(surface, &kept);
    std::vector<TextureCorners> of_kept;
    for (const std::int32_t t : kept)
        if (!texture.empty()) of_kept.push_back(texture[std::size_t(t)]);
    return std::shared_ptr<const Skin>(new Skin(std::move(welded), std::move(of_kept), mesh));
}

std::size_t Skin::inner_triangles() const { return std::size_t(std::count_if(opened_.begin(), opened_.end(), [](std::int32_t e) { return e >= 0; })); }

}  // namespace supple
