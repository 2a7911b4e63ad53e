#pragma once
#include <span>
#include <vector>

#include "supple/mesh/triangle_mesh.h"
#include "supple/mesh/volume_mesh.h"

namespace supple {

/// A vertex as a weighted mean of vertices of the mesh before: itself (weight 1), up to four corners of the tet that it lies in or is continued from, or those merged in it.
/// Weights sum to one.
struct VertexParents {
    std::array<std::int32_t, 4> vertex{-1, -1, -1, -1};  ///< ascending, -1 behind them
    std::array<double, 4> weight{};
};

/// What an edit did to a mesh. Elements are numbered as in VolumeMesh, tets first.
struct TopologyDelta {
    std::vector<std::int32_t> vertex_to_new;    ///< [old vertex] the same vertex now (of several that were merged, the same one); -1: gone with its elements
    std::vector<VertexParents> vertex_parents;  ///< [new vertex]
    std::vector<std::int32_t> element_to_new;   ///< [old element] the same element now; -1: removed, or cut into parts
    std::vector<std::int32_t> element_parent;   ///< [new element] the old one that it is, or is a part of
    std::vector<double> element_share;          ///< [new element] its part of the parent's rest volume, (0, 1]; 0: new matter, made like the parent

    bool is_merged(std::size_t new_vertex) const;       ///< of several old ones
    bool is_identity() const;                           ///< nothing was done
    std::vector<std::int32_t> removed_elements() const; ///< old ones of which no part is left
    std::vector<std::int32_t> cut_elements() const;     ///< old ones that live on in several parts
    std::vector<std::int32_t> added_vertices() const;   ///< new ones that are no old one: copies and points on edges
};

/// Nothing done to a mesh. O(n).
TopologyDelta identity_delta(const VolumeMesh& mesh);

/// First, then second.
/// @pre second was made for the mesh that first gave
TopologyDelta compose(const TopologyDelta& first, const TopologyDelta& second);

/// A mesh after an edit. Old vertices and elements that live on keep their order; new vertices follow them, parts of tets follow the tets. Regions, fill and groups are
/// inherited: a vertex belongs to a group if all its parents do. The boundary stays a closed manifold where it was one: every face-connected set of elements
/// at a vertex gets a vertex of its own.
struct MeshEdit {
    VolumeMesh mesh;
    TopologyDelta delta;
};

/// Takes elements away. Where what is left would touch itself along an edge or at a vertex within one part, more elements go: the smaller fan at an edge, the
/// shortest chain between two fans at a vertex. Vertices without elements go, too. O(n).
/// @error Error(invalid_argument) for an element out of range, or if none would be left
MeshEdit remove_elements(const VolumeMesh& mesh, std::span<const std::int32_t> elements);

/// A face by one of the elements at it.
struct ElementFace {
    std::int32_t element = -1;
    std::int32_t face = -1;  ///< kTetFaces or kHexFaces

    bool operator==(const ElementFace&) const = default;
};

/// Tears along faces between elements: they open where their edges reach the boundary or other torn faces; a face whose vertices all still hang together through other
/// elements stays shut, and so do faces at which the boundary would touch itself. Faces of the boundary are passed over. O(n).
/// @error Error(invalid_argument) for an element or face out of range
MeshEdit separate_faces(const VolumeMesh& mesh, std::span<const ElementFace> faces);

struct CutDef {
    double snap = 0.1;               ///< a crossing nearer to an end of its edge than this part of it becomes that end, [0, 0.5]
    double min_radius_ratio = 0.05;  ///< of the parts of a tet (TetQuality), or that of the tet where it is worse, [0, 1]
    double min_volume_share = 1e-3;  ///< of the parts, by the mean element volume of the mesh, [0, 1]
};

struct CutReport {
    std::size_t crossings = 0;  ///< edges that the blade meets
    std::size_t snapped = 0;    ///< of them, moved to a vertex: too near to it, or a part would have fallen below a bound
    std::size_t split_edges = 0;
    std::size_t opened_faces = 0;
};

/// Cuts with a blade, any set of triangles, given where the body is now. Tets are split along it: each crossed edge gets a vertex at the crossing, edge by edge from the longest
/// (at rest; ties by number), which makes the parts of neighbours fit. Crossings too near to a vertex, or whose parts would fall below a bound of `def`, move to the
/// vertex: the cut is snapped, never the rest shape. Where the blade ends within a tet the cut ends at the last face between parts that it crossed wholly. Hexes are
/// not split: they are separated at the faces whose two elements have their centres on both sides. Edges of hexes are not split either.
/// @param positions  [vertex] the mesh as the blade meets it [m]
/// @param blade      triangles, either way round but all alike; crossings of an edge with an even number of them do nothing
/// @return           the identity where the blade opens nothing
/// @error Error(invalid_argument) for positions of another count, a blade without triangles or with bad indices or coordinates, or a number of `def` out of range
MeshEdit cut(const VolumeMesh& mesh, std::span<const Vec3> positions, const mesh::TriangleMesh& blade, const CutDef& def = {}, CutReport* report = nullptr);

/// The strip that a polyline sweeps between two poses: two triangles per segment, none where it does not move.
/// @error Error(invalid_argument) if the two have different lengths, or fewer than two points
mesh::TriangleMesh swept_blade(std::span<const Vec3> from, std::span<const Vec3> to);

/// Per new boundary triangle: the old one that it is or is a part of; -1 where the edit laid the inside open. O(n).
std::vector<std::int32_t> boundary_parents(const VolumeMesh& before, const MeshEdit& edit);

/// Parts of a mesh that share no vertex: a label per element, numbered by their first elements. O(n).
struct Pieces {
    std::vector<std::int32_t> of_element;
    std::vector<double> volume_m3;  ///< [piece] at rest
};
Pieces find_pieces(const VolumeMesh& mesh);

}  // namespace supple
