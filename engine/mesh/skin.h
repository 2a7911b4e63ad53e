#pragma once
#include <memory>

#include "supple/mesh/embedding.h"
#include "supple/mesh/mesh_edit.h"

namespace supple {

/// A render surface embedded in a simulation mesh: what is drawn and picked instead of the mesh's own boundary. Immutable, shared by bodies of the same template.
class Skin {
public:
    /// Points at the same place are made one, triangles of no area are left out, unused points too; order is kept otherwise.
    /// @param surface  in the mesh's rest coordinates [m]
    /// @error Error(invalid_argument) for a surface without triangles, an index out of range or a coordinate that is not finite
    static std::shared_ptr<const Skin> build(const VolumeMesh& mesh, const mesh::TriangleMesh& surface);

    /// The skin after an edit of its mesh. Each triangle follows one side of a cut, that of its middle: points across the cut are made twice. Triangles go with
    /// the elements that moved them. What the edit laid open becomes part of the skin: the faces of the mesh there.
    std::shared_ptr<const Skin> follow(const VolumeMesh& before, const MeshEdit& edit) const;

    const mesh::TriangleMesh& surface() const { return surface_; }  ///< at rest
    const Embedding& embedding() const { return embedding_; }
    std::size_t mesh_vertices() const { return mesh_vertices_; }    ///< of the mesh it was made for

private:
    Skin(mesh::TriangleMesh surface, const VolumeMesh& mesh);
    Skin(mesh::TriangleMesh surface, Embedding embedding, std::size_t mesh_vertices);
    mesh::TriangleMesh surface_;
    Embedding embedding_;
    std::size_t mesh_vertices_;
};

/// Unit normals of the vertices: the mean of their triangles' by area; +z where there is none.
std::vector<Vec3> vertex_normals(const mesh::TriangleMesh& surface);

/// Makes points at the very same place one and drops degenerate triangles (a repeated vertex, or no area) and unused points. Order is kept.
mesh::TriangleMesh weld(const mesh::TriangleMesh& surface);

}  // namespace supple
