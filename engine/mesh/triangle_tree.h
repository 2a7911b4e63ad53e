#pragma once
#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "supple/mesh/box_tree.h"
#include "supple/mesh/surface.h"
#include "supple/mesh/triangle_mesh.h"

namespace supple {

/// Point of a triangle nearest to x.
struct NearestPoint {
    std::int32_t triangle = -1;  ///< -1: none within the limit
    std::array<double, 3> barycentric{};
    Vec3 point = Vec3::Zero();
    double distance = std::numeric_limits<double>::infinity();
};

/// Nearest point of the triangle a b c to x, in any case (edges, corners, degenerate triangles).
NearestPoint nearest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

/// Any set of triangles that answers how far, how often around and what a ray hits first, in O(log n). Immutable: any number of threads may ask.
class TriangleTree {
public:
    /// Triangles of no area count for distances, not for winding numbers.
    /// @error Error(invalid_argument) for no triangle, an index out of range or a coordinate that is not finite
    explicit TriangleTree(const mesh::TriangleMesh& surface);

    /// Nearest point to x no farther than `limit`; of equal distances the one found first, the same in every run.
    NearestPoint nearest(const Vec3& x, double limit = std::numeric_limits<double>::infinity()) const;

    /// Generalised winding number: how often the surface goes around x; 1 inside, 0 outside of a closed surface, in between near holes, sums where
    /// closed parts overlap. Clusters farther than `accuracy` times their radius are replaced by their expansion to second order (Barill, Dickson,
    /// Schmidt, Levin and Jacobson 2018, "Fast Winding Numbers for Soups and Clouds"): errors below 0.01 at the default.
    double winding_number(const Vec3& x, double accuracy = 2.3) const;

    /// The sum over all solid angles, O(n): what winding_number() approximates.
    double exact_winding_number(const Vec3& x) const;

    /// First triangle that a ray meets, from either side.
    std::optional<RayHit> first_hit(const Ray& ray) const;

    const Box& box() const { return tree_.nodes()[0].box; }
    std::size_t size() const { return corners_.size(); }

private:
    struct Cluster {                       ///< of a node: what winding numbers need of it
        Vec3 centre = Vec3::Zero();        ///< mean of the triangles by area
        Vec3 area = Vec3::Zero();          ///< sum of area normals
        Mat3 moment = Mat3::Zero();        ///< first and second moments, see the top of triangle_tree.cpp
        Vec3 vector = Vec3::Zero();
        std::array<double, 10> cubic{};
        double radius = 0;                 ///< of a ball around centre that holds the triangles
    };
    using Corners = std::array<Vec3, 3>;

    static Cluster make_cluster(std::span<const Corners> triangles, const Box& box);
    void build_clusters();

    BoxTree tree_;
    std::vector<Corners> corners_;  ///< in the order of the leaves
    std::vector<Cluster> clusters_;
};

}  // namespace supple
