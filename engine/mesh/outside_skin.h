#pragma once
#include <span>
#include <vector>

#include "supple/mesh/embedding.h"
#include "supple/mesh/triangle_mesh.h"

namespace supple::mesh {

/// How far outside of a mesh a skin lies, place by place: walls that reach farther would meet other parts of it.
class OutsideSkin {
public:
    /// @param triangles  of the skin, those to look at
    /// @param embedding  of the skin in the mesh
    OutsideSkin(const TriangleMesh& skin, std::span<const std::int32_t> triangles, const Embedding& embedding, const VolumeMesh& mesh);

    /// How far walls at a rest point of the boundary have to go [m]; 0 where the skin lies on the mesh or within.
    double reach(const Vec3& at) const;

private:
    struct Sample {
        Vec3 middle;
        double reach, radius;
    };
    std::vector<Sample> samples_;
};

}  // namespace supple::mesh
