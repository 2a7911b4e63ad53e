#include "supple/fem/corners.h"

namespace supple::fem {

CornerMap make_corner_map(std::size_t vertices, std::span<const Tet> tets) {
    CornerMap map;
    map.start.assign(vertices + 1, 0);
    for (const Tet& tet : tets)
        for (const std::int32_t v : tet) ++map.start[std::size_t(v) + 1];
    for (std::size_t v = 0; v < vertices; ++v) map.start[v + 1] += map.start[v];
    map.corner.resize(tets.size() * 4);
    map.element.resize(tets.size() * 4);
    std::vector<std::int64_t> next(map.start.begin(), map.start.end() - 1);
    for (std::size_t e = 0; e < tets.size(); ++e)
        for (std::size_t a = 0; a < 4; ++a) {
            const std::size_t i = std::size_t(next[std::size_t(tets[e][a])]++);
            map.corner[i] = std::uint32_t(e * 4 + a);
            map.element[i] = std::int32_t(e);
        }
    return map;
}

void gather_corners(const CornerMap& map, const double* corner_value, std::size_t begin, std::size_t end, Vec3* out) {
    for (std::size_t v = begin; v < end; ++v) {
        double x = 0, y = 0, z = 0;
        for (std::int64_t i = map.start[v]; i < map.start[v + 1]; ++i) {
            const double* c = corner_value + std::size_t(map.corner[std::size_t(i)]) * 4;
            x += c[0];
            y += c[1];
            z += c[2];
        }
        out[v] = Vec3(x, y, z);
    }
}

}  // namespace supple::fem
