#include "supple/fem/corners.h"

#include <algorithm>

namespace supple::fem {

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
    // In a chunk places come by count, of one count by vertex; counting sorts, since a mesh under the knife asks for it in every frame.
    const std::size_t corners = rest.elements * 4, chunks = (rest.blocks() + chunk - 1) / chunk;
    const auto vertex_of = [&](std::size_t corner) {
        const std::size_t i = corner / 4;
        return rest.vertex[(i / kBlock * 4 + corner % 4) * kBlock + i % kBlock];
    };
    const auto chunk_of = [&](std::uint32_t corner) { return corner / 4 / (chunk * kBlock); };
    std::vector<std::uint32_t> start(rest.vertices + 1, 0), at_vertex(corners);
    for (std::size_t c = 0; c < corners; ++c) ++start[std::size_t(vertex_of(c)) + 1];
    for (std::size_t v = 0; v < rest.vertices; ++v) start[v + 1] += start[v];
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    for (std::size_t c = 0; c < corners; ++c) at_vertex[next[std::size_t(vertex_of(c))]++] = std::uint32_t(c);
    struct Place {
        std::int32_t vertex;
        std::uint32_t first, count;  ///< in at_vertex
    };
    std::vector<Place> found, in_chunks;  // by vertex; by chunk and vertex
    CornerSums sums;
    sums.chunk = chunk;
    sums.first.assign(chunks + 1, 0);
    for (std::size_t v = 0; v < rest.vertices; ++v) {
        for (std::uint32_t k = start[v]; k < start[v + 1];) {
            std::uint32_t end = k + 1;
            while (end < start[v + 1] && chunk_of(at_vertex[end]) == chunk_of(at_vertex[k])) ++end;
            found.push_back({std::int32_t(v), k, end - k});
            ++sums.first[chunk_of(at_vertex[k]) + 1];
            k = end;
        }
    }
    for (std::size_t c = 0; c < chunks; ++c) sums.first[c + 1] += sums.first[c];
    in_chunks.resize(found.size());
    next.assign(sums.first.begin(), sums.first.end() - 1);
    for (const Place& place : found) in_chunks[next[chunk_of(at_vertex[place.first])]++] = place;
    sums.vertex.reserve(found.size());
    sums.count.reserve(found.size());
    sums.corner.reserve(corners);
    std::vector<std::uint32_t> of_count, order;
    for (std::size_t c = 0; c < chunks; ++c) {
        const std::span<const Place> places(in_chunks.data() + sums.first[c], sums.first[c + 1] - sums.first[c]);
        std::uint32_t most = 0;
        for (const Place& place : places) most = std::max(most, place.count);
        of_count.assign(most + 2, 0);
        for (const Place& place : places) ++of_count[place.count + 1];
        for (std::size_t k = 0; k + 1 < of_count.size(); ++k) of_count[k + 1] += of_count[k];
        order.resize(places.size());
        for (std::size_t k = 0; k < places.size(); ++k) order[of_count[places[k].count]++] = std::uint32_t(k);
        for (const std::uint32_t k : order) {
            sums.vertex.push_back(places[k].vertex);
            sums.count.push_back(std::uint16_t(places[k].count));
            for (std::uint32_t i = 0; i < places[k].count; ++i) sums.corner.push_back(std::uint16_t(at_vertex[places[k].first + i] - c * chunk * kBlock * 4));
        }
    }
    return sums;
}

void CornerSums::add_up(const double* value, std::size_t begin, double* sum) const {
    const std::uint16_t* from = corner.data() + begin * kBlock * 4;
    for (std::size_t place = first[begin / chunk]; place < first[begin / chunk + 1]; ++place, sum += 4) {
        double total[4] = {0, 0, 0, 0};  // the fourth goes along: two registers
        for (const std::uint16_t* const last = from + count[place]; from != last; ++from) {
            const double* v = value + 4 * std::size_t(*from);
            for (int k = 0; k < 4; ++k) total[k] += v[k];
        }
        std::copy(total, total + 4, sum);
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
