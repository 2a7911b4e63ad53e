#pragma once
#include <cstdint>
#include <span>
#include <optional>
#include <vector>

#include "supple/mesh/triangle_tree.h"
#include "supple/mesh/volume_mesh.h"

namespace supple {

/// A fine surface that follows a coarse volume mesh: each of its points is a weighted sum of the vertices of one element, by the element's own shape functions
/// (barycentric for tets, trilinear for hexes). A point outside of the mesh belongs to the nearest element, whose map goes on beyond it (from the nearest point of a
/// hex on, linearly). Weights of a point sum to one and reproduce every affine motion of the mesh. Immutable, independent of worlds.
class Embedding {
public:
    static constexpr std::size_t kMaxCorners = 8;

    struct Report {
        std::size_t outside = 0;       ///< points outside of all elements
        double farthest_m = 0;         ///< largest distance of a point from the mesh
        double least_weight = 0;       ///< most negative weight of a point outside; 0 where all are inside
        std::int32_t worst_point = -1; ///< the one of it; -1 where all are inside
    };

    /// @pre mesh passed check_and_repair(). O(n log n); the same for every run.
    /// @error Error(invalid_argument) for a mesh without elements or a point that is not finite
    Embedding(const VolumeMesh& mesh, std::span<const Vec3> points);

    /// Points that belong to given elements, in them or beyond them; report() is empty. @pre elements in range, one per point
    static Embedding bound(const VolumeMesh& mesh, std::span<const Vec3> points, std::vector<std::int32_t> elements);

    std::size_t size() const { return element_.size(); }
    const Report& report() const { return report_; }
    std::span<const std::int32_t> elements() const { return element_; }  ///< per point

    /// Corners per point, 4 where the mesh has tets only, else 8; vertices() and weights() hold so many per point, unused ones vertex 0 of the element, weight 0.
    std::size_t corners() const { return corners_; }
    std::span<const std::int32_t> vertices() const { return vertex_; }
    std::span<const double> weights() const { return weight_; }

    std::span<const Vec3> gradients() const { return gradient_; }  ///< of the weights by rest position, per point and corner [1/m]

    /// Points [m] for positions of the mesh's vertices [m]. out has size() entries.
    void deform(std::span<const Vec3> positions, std::span<Vec3> out) const;

    /// Unit normals: cof(F) n of the unit rest normals, F the deformation gradient of the point's element there. A normal of a collapsed element stays as it was.
    void deform_normals(std::span<const Vec3> positions, std::span<const Vec3> rest_normals, std::span<Vec3> out) const;

    /// Deformation gradient at a point.
    Mat3 deformation_gradient(std::size_t point, std::span<const Vec3> positions) const;

    /// A number per vertex of the mesh at the points; never beyond the corners' own values, so that a stress stays one.
    void interpolate(std::span<const double> per_vertex, std::span<double> out) const;

private:
    Embedding() = default;
    void bind(const VolumeMesh& mesh, std::size_t point, const Vec3& x, std::int32_t element);
    std::size_t corners_ = 4;
    std::vector<std::int32_t> element_, vertex_;
    std::vector<double> weight_;
    std::vector<Vec3> gradient_;
    Report report_;
};

/// Weights of the corners of one element at a rest point, in it or beyond it; `gradient` (4 or 8, or null) gets their derivatives by position.
/// @param element  index among tets, then hexes
void shape_weights(const VolumeMesh& mesh, std::int32_t element, const Vec3& x, std::span<double> weights, Vec3* gradient = nullptr);

/// Finds elements by place, O(log n). The mesh must outlive it.
class ElementLocator {
public:
    explicit ElementLocator(const VolumeMesh& mesh);
    std::int32_t holding(const Vec3& x) const;                  ///< the element that x lies in, on a face one of the two; -1 if none
    std::int32_t nearest(const Vec3& x, double& distance_m);    ///< the element behind the nearest point of the boundary, and how far that is

private:
    const VolumeMesh& mesh_;
    std::vector<Box> boxes_;
    BoxTree tree_;
    BoundarySurface boundary_;  ///< made when first asked for
    std::optional<TriangleTree> boundary_tree_;
};

}  // namespace supple
