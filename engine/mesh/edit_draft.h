#pragma once
#include <map>
#include <set>

#include "supple/mesh/mesh_edit.h"

namespace supple::mesh {

/// An element of a mesh under edit.
struct DraftElement {
    std::array<std::int32_t, 8> vertex{-1, -1, -1, -1, -1, -1, -1, -1};
    std::int32_t corners = 4;
    std::int32_t parent = -1;  ///< in the old mesh
    double share = 1;
    bool alive = true;
};

/// Vertices of a face ascending, -1 behind three: its name.
using FaceKey = std::array<std::int32_t, 4>;

inline FaceKey ascending(FaceKey v, std::size_t corners) {
    for (std::size_t i = 1; i < corners; ++i)  // four at most: no library sort
        for (std::size_t k = i; k > 0 && v[k] < v[k - 1]; --k) std::swap(v[k], v[k - 1]);
    return v;
}

/// A mesh under edit. Elements 0.. are those of the old mesh, parts of tets follow. Vertices keep their numbers until finish().
class Draft {
public:
    explicit Draft(const VolumeMesh& old);

    const VolumeMesh& old;
    std::vector<DraftElement> elements;
    std::vector<Vec3> vertices;
    std::vector<VertexParents> parents;

    /// A point on an edge: (1 - t) a + t b. Both are vertices of the old mesh.
    std::int32_t add_point(std::int32_t a, std::int32_t b, double t);
    FaceKey face(std::int32_t element, int face) const;
    int faces(std::int32_t element) const { return elements[std::size_t(element)].corners == 4 ? 4 : 6; }
    double volume(std::int32_t element) const;  ///< at rest

    /// Finds the living elements at each vertex, for star().
    void index();
    std::span<const std::int32_t> star(std::int32_t vertex) const;

    /// Gives every set of elements at a vertex that hangs together across faces not in `torn` a vertex of its own, for each of `affected`. Where the boundary then touches
    /// itself, `torn` loses faces (torn given) or elements go (torn empty and `may_remove`), and all is done again.
    void separate(std::set<FaceKey> torn, std::set<std::int32_t> affected, bool may_remove);
    /// The same for a mesh whose lips were put on the same vertices: `glued` are faces to shut, `torn` those that stay open. Where the boundary then touches itself, faces at the fault are
    /// torn after all. Returns what is glued.
    std::set<FaceKey> glue(std::set<FaceKey> glued, std::set<FaceKey> torn, const std::set<std::int32_t>& affected);
    /// After separate() and glue(): the face-connected sets at an affected vertex.
    const std::vector<std::vector<std::int32_t>>& sets(std::int32_t vertex) const { return sets_.at(vertex); }
    /// Vertices of `affected` at which the boundary touches itself, nothing torn; with the other end where it does along an edge, else -1.
    std::vector<std::array<std::int32_t, 2>> pinches(const std::set<std::int32_t>& affected);
    std::size_t open_faces() const { return open_; }  ///< of those torn, after separate()

    MeshEdit finish() const;

private:
    struct Fault {
        std::int32_t vertex, other;   ///< a pinched edge, both by their old names; other -1: a pinched vertex
        std::vector<std::int32_t> elements;  ///< to take away
    };
    std::vector<ElementFace> at_face(const FaceKey& key) const;
    bool folds(const FaceKey& key) const;
    std::int32_t corner_name(std::int32_t element, std::int32_t vertex) const;
    void label(const std::set<FaceKey>& torn, std::int32_t vertex);
    void look_for_fault(std::int32_t vertex, std::vector<Fault>& faults) const;
    std::vector<std::int32_t> smallest_fan(std::span<const std::int32_t> part, std::int32_t vertex, std::int32_t other) const;
    std::vector<std::int32_t> bridge(std::span<const std::int32_t> part, std::int32_t vertex, const std::map<std::int32_t, int>& fan_of_element) const;

    std::vector<std::int32_t> star_start_, star_;
    std::map<std::int32_t, std::vector<std::vector<std::int32_t>>> sets_;  ///< [vertex] its face-connected elements, each set ascending, by first element
    std::size_t open_ = 0;
};

/// Edges along which two boundary triangles run the same way: lips of a quad that share a diagonal lie on one another as triangles.
std::vector<std::array<std::int32_t, 2>> doubled_edges(const VolumeMesh& mesh);

}  // namespace supple::mesh
