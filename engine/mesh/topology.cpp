#include "supple/mesh/topology.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "supple/base/error.h"

namespace supple {
namespace {

/// A half-face filed under its smallest vertex: the other vertices ascending (-1 behind a triangle).
struct FiledFace {
    std::array<std::int32_t, 3> others;
    HalfFace half_face;

    bool same_face(const FiledFace& o) const { return others == o.others; }
    bool operator<(const FiledFace& o) const { return others != o.others ? others < o.others : half_face < o.half_face; }
};

std::int32_t smallest_vertex(const Face& f) { return *std::min_element(f.vertices.begin(), f.vertices.begin() + f.corners); }

FiledFace file_face(const Face& f, HalfFace h) {
    std::array<std::int32_t, 4> v = f.vertices;
    for (int i = 1; i < f.corners; ++i)  // four at most: no library sort
        for (int k = i; k > 0 && v[k] < v[k - 1]; --k) std::swap(v[k], v[k - 1]);
    return {{v[1], v[2], v[3]}, h};
}

}  // namespace

HalfFace half_face_count(const VolumeMesh& mesh) {
    const std::uint64_t n = 4 * static_cast<std::uint64_t>(mesh.tets.size()) + 6 * static_cast<std::uint64_t>(mesh.hexes.size());
    if (n >= std::numeric_limits<HalfFace>::max())
        throw Error(
            ErrorCode::unsupported, mesh.source.empty() ? "mesh" : mesh.source,
            std::to_string(mesh.element_count()) + " elements have too many faces; at most 715 million elements per mesh, split it");
    return static_cast<HalfFace>(n);
}

Face half_face(const VolumeMesh& mesh, HalfFace h) {
    const HalfFace tet_faces = static_cast<HalfFace>(4 * mesh.tets.size());
    Face face;
    if (h < tet_faces) {
        const Tet& t = mesh.tets[h / 4];
        face.element = static_cast<std::int32_t>(h / 4);
        for (int i = 0; i < 3; ++i) face.vertices[i] = t[kTetFaces[h % 4][i]];
    } else {
        const HalfFace g = h - tet_faces;
        const Hex& x = mesh.hexes[g / 6];
        face.element = static_cast<std::int32_t>(mesh.tets.size() + g / 6);
        face.corners = 4;
        for (int i = 0; i < 4; ++i) face.vertices[i] = x[kHexFaces[g % 6][i]];
    }
    return face;
}

void for_each_face(const VolumeMesh& mesh, FunctionRef<void(std::span<const HalfFace>)> visit) {
    const HalfFace count = half_face_count(mesh);
    // A counting sort by the smallest vertex, then small sorts: no hashing, and an order that depends on nothing but the mesh.
    std::vector<HalfFace> start(mesh.vertices.size() + 1, 0);
    for (HalfFace h = 0; h < count; ++h) ++start[smallest_vertex(half_face(mesh, h)) + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<FiledFace> filed(count);
    std::vector<HalfFace> next(start.begin(), start.end() - 1);
    for (HalfFace h = 0; h < count; ++h) {
        const Face face = half_face(mesh, h);
        filed[next[smallest_vertex(face)]++] = file_face(face, h);
    }
    std::vector<HalfFace> group;
    for (std::size_t v = 0; v + 1 < start.size(); ++v) {
        const auto begin = filed.begin() + start[v], end = filed.begin() + start[v + 1];
        std::sort(begin, end);
        for (auto i = begin; i != end;) {
            group.clear();
            const auto first = i;
            for (; i != end && i->same_face(*first); ++i) group.push_back(i->half_face);
            visit(group);
        }
    }
}

}  // namespace supple
