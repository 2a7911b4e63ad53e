#pragma once
#include <set>
#include <vector>

#include "supple/mesh/edit_draft.h"

namespace supple::mesh {

/// A mesh with the lips of its edits a little apart: at rest they lie on one another, and so would what is looked for by place.
struct MovedLips {
    std::vector<Vec3> x;             ///< [vertex]
    std::vector<char> on_lip;        ///< [vertex] 1: moved
    bool any = false;
    std::set<FaceKey> lip_faces;     ///< by vertices

    explicit MovedLips(const VolumeMesh& mesh);
    MovedLips(const MovedLips& before, const MeshEdit& edit);  ///< after an edit of the mesh: x, on_lip and any

    /// Whether a triangle of an element's boundary is of a face that lies on another one.
    bool is_lip(const VolumeMesh& mesh, std::int32_t element, const Triangle& t) const;
};

}  // namespace supple::mesh
