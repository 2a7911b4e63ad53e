#include "supple/fem/corners.h"

#include <algorithm>

namespace supple::fem {

std::span<const std::int32_t> element_vertices(const VolumeMesh& mesh, std::size_t element) {
    if (element < mesh.tets.size()) return mesh.tets[element];
    return mesh.hexes[element - mesh.tets.size()];
}

ElementMap make_element_map(const VolumeMesh& mesh) {
    ElementMap map;
    map.start.assign(mesh.vertices.size() + 1, 0);
    const auto each = [&](auto&& visit) {
        for (std::size_t e = 0; e < mesh.element_count(); ++e)
            for (const std::int32_t v : element_vertices(mesh, e)) visit(e, std::size_t(v));
    };
    each([&](std::size_t, std::size_t v) { ++map.start[v + 1]; });
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) map.start[v + 1] += map.start[v];
    map.element.resize(std::size_t(map.start.back()));
    std::vector<std::int64_t> next(map.start.begin(), map.start.end() - 1);
    each([&](std::size_t e, std::size_t v) { map.element[std::size_t(next[v]++)] = std::int32_t(e); });
    return map;
}

CornerSums make_corner_sums(const Tet4Rest& rest, std::size_t chunk) {
    CornerSums sums;
    sums.chunk = chunk;
    std::vector<std::pair<std::int32_t, std::uint16_t>> corners;  // vertex, number of the corner
    for (std::size_t begin = 0; begin < rest.blocks(); begin += chunk) {
        sums.first.push_back(std::uint32_t(sums.vertex.size()));
        corners.clear();
        for (std::size_t i = begin * kBlock; i < std::min((begin + chunk) * kBlock, rest.elements); ++i) {
            for (std::size_t a = 0; a < 4; ++a) {
                corners.emplace_back(rest.vertex[(i / kBlock * 4 + a) * kBlock + i % kBlock], std::uint16_t((i - begin * kBlock) * 4 + a));
            }
        }
        std::sort(corners.begin(), corners.end());
        std::vector<std::pair<std::uint16_t, std::size_t>> places;  // count, first of its corners
        for (std::size_t k = 0; k < corners.size(); ++k) {
            if (k == 0 || corners[k].first != corners[k - 1].first) places.emplace_back(std::uint16_t(0), k);
            ++places.back().first;
        }
        std::sort(places.begin(), places.end());
        for (const auto& [count, k] : places) {
            sums.vertex.push_back(corners[k].first);
            sums.count.push_back(count);
            for (std::size_t c = k; c < k + count; ++c) sums.corner.push_back(corners[c].second);
        }
    }
    sums.first.push_back(std::uint32_t(sums.vertex.size()));
    return sums;
}

void CornerSums::add_up(const double* value, std::size_t begin, double* sum) const {
    const std::uint16_t* from = corner.data() + begin * kBlock * 4;
    for (std::size_t place = first[begin / chunk]; place < first[begin / chunk + 1]; ++place, sum += 4) {
        double x = 0, y = 0, z = 0;
        for (const std::uint16_t* const last = from + count[place]; from != last; ++from) {
            const double* v = value + 4 * std::size_t(*from);
            x += v[0];
            y += v[1];
            z += v[2];
        }
        sum[0] = x;
        sum[1] = y;
        sum[2] = z;
        sum[3] = 0;
    }
}

void gather_places(const PlaceMap& map, const double* value, std::size_t begin, std::size_t end, Vec3* out) {
    for (std::size_t v = begin; v < end; ++v) {
        double x = 0, y = 0, z = 0;
        for (std::int64_t i = map.start[v]; i < map.start[v + 1]; ++i) {
            const double* c = value + std::size_t(map.place[std::size_t(i)]) * 4;
            x += c[0];
            y += c[1];
            z += c[2];
        }
        out[v] = Vec3(x, y, z);
    }
}

}  // namespace supple::fem
