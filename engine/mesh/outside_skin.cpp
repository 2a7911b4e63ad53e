#include "supple/mesh/outside_skin.h"

#include <algorithm>
#include <memory>

#include "supple/mesh/surface.h"
#include "supple/mesh/triangle_tree.h"

namespace supple::mesh {

OutsideSkin::OutsideSkin(const TriangleMesh& skin, std::span<const std::int32_t> triangles, const Embedding& embedding, const VolumeMesh& mesh) {
    constexpr double kBeyond = 1.5;  // walls lean: they meet the skin later than its distance
    std::unique_ptr<TriangleTree> boundary;
    const auto outside = [&](std::int32_t p) {
        const auto w = embedding.weights().subspan(std::size_t(p) * embedding.corners(), embedding.corners());
        return *std::min_element(w.begin(), w.end()) < -1e-9;
    };
    for (const std::int32_t t : triangles) {
        const Triangle& corner = skin.triangles[std::size_t(t)];
        const auto x = [&](std::size_t k) -> const Vec3& { return skin.vertices[std::size_t(corner[k])]; };
        if (std::none_of(corner.begin(), corner.end(), outside)) continue;
        if (!boundary) boundary = std::make_unique<TriangleTree>(TriangleMesh{mesh.vertices, extract_boundary(mesh).triangles});
        const Vec3 middle = (x(0) + x(1) + x(2)) / 3;
        double far = 0;
        for (const Vec3& at : {x(0), x(1), x(2), middle}) far = std::max(far, boundary->nearest(at).distance);
        samples_.push_back({middle, kBeyond * far, std::max({(x(0) - middle).norm(), (x(1) - middle).norm(), (x(2) - middle).norm()})});
    }
}

double OutsideSkin::reach(const Vec3& at) const {
    double out = 0;
    for (const Sample& s : samples_)
        if (s.reach > out && (s.middle - at).norm() < 2 * (s.reach + s.radius)) out = s.reach;
    return out;
}

}  // namespace supple::mesh
