#pragma once
#include <set>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple::mesh {

/// How far an element's shape functions reach to a rest point: the least weight, positive inside.
double least_weight(const VolumeMesh& mesh, std::int32_t element, const Vec3& x);

/// How elements of a mesh hang together across few vertices: on one side of a cut, or around its end.
class ElementNeighbours {
public:
    explicit ElementNeighbours(const VolumeMesh& mesh) : mesh_(mesh) {}

    /// Vertices on the shortest way from one to the other; most + 1 where it takes more.
    int distance(std::int32_t a, std::int32_t b, int most);
    /// Of those that hang together with an element across two vertices, the one that a rest point lies in or is least outside of.
    std::int32_t nearest(std::int32_t element, const Vec3& x);

private:
    void advance(std::set<std::int32_t>& seen, std::vector<std::int32_t>& front);

    const VolumeMesh& mesh_;
    std::vector<std::vector<std::int32_t>> around_;  ///< [vertex] its elements; made when first asked for
};

}  // namespace supple::mesh
