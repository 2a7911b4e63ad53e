#include "supple/mesh/element_neighbours.h"

#include <algorithm>
#include <array>

#include "supple/mesh/embedding.h"

namespace supple::mesh {

double least_weight(const VolumeMesh& mesh, std::int32_t element, const Vec3& x) {
    std::array<double, Embedding::kMaxCorners> w{};
    shape_weights(mesh, element, x, w);
    return *std::min_element(w.begin(), w.begin() + std::ptrdiff_t(element_vertices(mesh, std::size_t(element)).size()));
}

int ElementNeighbours::distance(std::int32_t a, std::int32_t b, int most) {
    std::set<std::int32_t> seen{a};
    std::vector<std::int32_t> front{a};
    for (int hop = 0; hop <= most; ++hop) {
        if (seen.contains(b)) return hop;
        if (hop < most) advance(seen, front);
    }
    return most + 1;
}

std::int32_t ElementNeighbours::nearest(std::int32_t element, const Vec3& x) {
    std::set<std::int32_t> seen{element};
    std::vector<std::int32_t> front{element};
    for (int hop = 0; hop < 2; ++hop) advance(seen, front);
    std::int32_t best = element;
    double most = least_weight(mesh_, element, x);
    for (const std::int32_t e : seen) {
        const double least = least_weight(mesh_, e, x);
        if (least <= most) continue;
        best = e;
        most = least;
    }
    return best;
}

void ElementNeighbours::advance(std::set<std::int32_t>& seen, std::vector<std::int32_t>& front) {
    if (around_.empty()) {
        around_.resize(mesh_.vertices.size());
        for (std::size_t e = 0; e < mesh_.element_count(); ++e)
            for (const std::int32_t v : element_vertices(mesh_, e)) around_[std::size_t(v)].push_back(std::int32_t(e));
    }
    std::vector<std::int32_t> next;
    for (const std::int32_t e : front)
        for (const std::int32_t v : element_vertices(mesh_, std::size_t(e)))
            for (const std::int32_t n : around_[std::size_t(v)])
                if (seen.insert(n).second) next.push_back(n);
    front = std::move(next);
}

}  // namespace supple::mesh
