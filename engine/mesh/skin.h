#pragma once
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "supple/mesh/embedding.h"
#include "supple/mesh/mesh_edit.h"

namespace supple {

/// Texture coordinates u v of the corners of a triangle.
using TextureCorners = std::array<std::array<double, 2>, 3>;

/// A render surface embedded in a simulation mesh: what is drawn and picked instead of the mesh's own boundary. Immutable, shared by bodies of the same template.
class Skin {
public:
    /// Points at the same place are made one, triangles of no area are left out, unused points too; order is kept otherwise.
    /// @param surface  in the mesh's rest coordinates [m]
    /// @param texture  [triangle of `surface`], or empty
    /// @error Error(invalid_argument) for a surface without triangles, an index out of range, a coordinate that is not finite, or a texture of another count
    static std::shared_ptr<const Skin> build(const VolumeMesh& mesh, const mesh::TriangleMesh& surface, std::span<const TextureCorners> texture = {});

    /// The skin after an edit of its mesh. Its triangles are split along the faces that the edit laid open, and beyond them where they reach the boundary; each part stays with
    /// its side, or goes with elements that are gone. The opened faces, as far as they lie within the skin, become part of it, with the same points along the lips. Where a
    /// heal has shut all that edits opened, and nothing was taken away, it is the skin before the first edit again.
    std::shared_ptr<const Skin> follow(const VolumeMesh& before, const MeshEdit& edit) const;

    const mesh::TriangleMesh& surface() const { return surface_; }  ///< at rest
    const Embedding& embedding() const { return embedding_; }
    std::size_t mesh_vertices() const { return mesh_vertices_; }    ///< of the mesh it was made for

    bool is_inner(std::size_t triangle) const { return !opened_.empty() && opened_[triangle] >= 0; }  ///< laid open by an edit: another material for a renderer
    std::size_t inner_triangles() const;
    /// [triangle] Given ones are interpolated where triangles were split; those of inner triangles are lengths [m] along two axes of the cut, the same on both lips. Empty where none were
    /// given and nothing was laid open; then zero for the triangles that had none.
    std::span<const TextureCorners> texture() const { return texture_; }

private:
    struct Origin {
        mesh::TriangleMesh surface;
        std::vector<TextureCorners> texture;
        double area;
    };
    struct Parts;  ///< of a skin under edit
    Skin(mesh::TriangleMesh surface, std::vector<TextureCorners> texture, const VolumeMesh& mesh);
    Skin(Parts parts, const VolumeMesh& mesh);
    std::shared_ptr<const Skin> healed(const VolumeMesh& before, const MeshEdit& edit) const;
    std::shared_ptr<const Origin> origin() const;

    mesh::TriangleMesh surface_;
    std::vector<TextureCorners> texture_;
    std::vector<std::int32_t> opened_;      ///< [triangle] the element whose opened face it is a part of, -1: none; or empty
    Embedding embedding_;
    std::size_t mesh_vertices_;
    std::shared_ptr<const Origin> origin_;  ///< before the first edit; null: this
};

/// Area of a surface [m^2].
double area_of(const mesh::TriangleMesh& surface);

/// Unit normals of the vertices: the mean of their triangles' by area; +z where there is none.
std::vector<Vec3> vertex_normals(const mesh::TriangleMesh& surface);

/// Makes points at the very same place one and drops degenerate triangles (a repeated vertex, or no area) and unused points. Order is kept.
/// @param kept  gets the triangles that are left
mesh::TriangleMesh weld(const mesh::TriangleMesh& surface, std::vector<std::int32_t>* kept = nullptr);

}  // namespace supple
